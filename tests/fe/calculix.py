"""CalculiX as a program in the loop: beams that it meshes no finer than asked, and decks around its files."""

import json
import math
import shutil

import numpy as np
import pytest
from click.testing import CliRunner
from scipy.linalg import expm
from scipy.optimize import brentq

from flexmb_cli.cli.modes import modes
from scripts.brick_beam import Beam, run_calculix

needs_ccx = pytest.mark.skipif(
    shutil.which("ccx") is None, reason="CalculiX (ccx, Debian package calculix-ccx) is not installed"
)

DECK = """\
VSDF BEAM BY CALCULIX
BODY
    1 FLEX{modes:5d}
FEMN
    1 INP  beam.inp
FEMM
    1 CCX  beam.mas
FEMK
    1 CCX  beam.sti
FEMP
    1 CCX  beam.dof
{cards}
TIME
{time}
END
STAR
STOP
"""


def deck_of(folder, beam: Beam, cards: list[str], modes: int, time="       1.0       0.1"):
    """A VSDF deck in `folder` around the matrices that CalculiX writes for the unsupported beam."""
    (folder / "beam.inp").write_text(beam.input())
    run_calculix(folder, "beam")
    path = folder / "beam.vsdf"
    path.write_text(DECK.format(modes=modes, cards="\n".join(cards), time=time))
    return path


def clamp(nodes):
    """CLMP cards of ten nodes each for body 1."""
    rows = [nodes[i : i + 10] for i in range(0, len(nodes), 10)]
    return ["CLMP", *("    1" + "".join(f"{node:5d}" for node in row) for row in rows)]


def asked(path):
    """`flexmb modes --json` of the deck, done."""
    return CliRunner().invoke(modes, [str(path), "--json"])


def reported(path) -> dict:
    """What it tells of the deck's only body."""
    done = asked(path)
    assert done.exit_code == 0, done.output
    return json.loads(done.stdout)["bodies"][0]


def own_frequencies(folder, beam: Beam, clamped, count):
    """Frequencies, Hz, that CalculiX itself finds for the clamped beam; printed to seven digits in rad/s."""
    (folder / "clamped.inp").write_text(beam.input(tuple(clamped), count))
    run_calculix(folder, "clamped")
    rows = [line.split() for line in (folder / "clamped.dat").read_text().splitlines()]
    table = [row for row in rows if len(row) == 5 and row[0].isdigit()]
    return np.array([float(row[2]) for row in table[:count]]) / math.tau


def own_displacements(folder, beam: Beam, clamped, forces):
    """Displacements (n, 3), m, that CalculiX finds under `forces` {(node, direction): N}, seven digits."""
    loads = [f"{node}, {direction}, {force!r}" for (node, direction), force in forces.items()]
    step = ["*STATIC", "*CLOAD", *loads, "*NODE PRINT, NSET=NALL", "U"]
    text = beam.input(tuple(clamped), 1).replace("*FREQUENCY\n1", "\n".join(step))
    (folder / "loaded.inp").write_text(text)
    run_calculix(folder, "loaded")
    rows = [line.split() for line in (folder / "loaded.dat").read_text().splitlines()]
    return np.array([[float(word) for word in row[1:]] for row in rows if len(row) == 4 and row[0].isdigit()])


def timoshenko(beam: Beam, depth: float, count: int) -> list[float]:
    """Bending frequencies, Hz, of the clamped beam, `depth` m in the plane of bending.

    w' = psi + Q/(k G A), psi' = M/(E I), M' = -rho I omega^2 psi - Q, Q' = -rho A omega^2 w: at the free
    end M and Q vanish.  k = 10 (1 + nu)/(12 + 11 nu) (Cowper, J. Appl. Mech. 33 (1966), 335).
    """
    length, nu = beam.size[0], beam.poisson
    area = beam.size[1] * beam.size[2]
    bending = area * depth**2 / 12
    shear = 10 * (1 + nu) / (12 + 11 * nu) * beam.young / (2 * (1 + nu)) * area

    def free_end(omega):
        matrix = np.zeros((4, 4))
        matrix[0, 1], matrix[0, 3], matrix[1, 2] = 1.0, 1.0 / shear, 1.0 / (beam.young * bending)
        matrix[2, 1], matrix[2, 3] = -beam.density * bending * omega**2, -1.0
        matrix[3, 0] = -beam.density * area * omega**2
        # Lengths in m and forces in N differ by eleven powers of ten; the determinant's sign does not care.
        return np.linalg.det(expm(matrix * length)[2:, 2:])

    first = 3.516 / length**2 * math.sqrt(beam.young * bending / (beam.density * area))
    grid = first * np.linspace(0.5, 50.0, 2000)
    signs = np.sign([free_end(omega) for omega in grid])
    changes = np.flatnonzero(signs[1:] != signs[:-1])[:count]
    return [brentq(free_end, grid[k], grid[k + 1], xtol=1e-10) / math.tau for k in changes]
