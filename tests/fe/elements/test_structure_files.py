"""Beams and shells of Abaqus, CalculiX and bulk data files: sections, equal bodies by other cards, faults.

Expected: the same beam by CBAR; natural frequencies of CalculiX, which makes solids of them; a physical
pendulum.
"""

import re

import numpy as np
import pytest
import scipy
from scipy.special import ellipk

from flexmb_cli.fe.formats.matrix_file import FEFileFault
from flexmb_cli.fe.formats.structure_elements import has_structures
from flexmb_cli.interface import solve
from scripts.brick_beam import run_calculix
from tests.fe.calculix import needs_ccx
from tests.fe.elements.test_beams import (
    ALUMINIUM,
    AREA,
    BARS,
    GRIDS,
    HEIGHT,
    I1,
    I2,
    TORSION,
    WIDTH,
    matrices,
)
from tests.fe.elements.test_beams import relative as difference
from tests.fe.row_bodies.row_decks import DECKS

NODES = "*NODE\n101,0.,0.,0.\n102,.5,0.,0.\n103,1.,0.,0.\n"
B31 = NODES + "*ELEMENT,TYPE=B31,ELSET=E\n1,101,102\n2,102,103\n"
RECT = f"*BEAM SECTION,ELSET=E,MATERIAL=M,SECTION=RECT\n{WIDTH},{HEIGHT}\n0.,1.,0.\n"
MATERIAL = "*MATERIAL,NAME=M\n*ELASTIC\n7e10,.33\n*DENSITY\n2700.\n"
S4 = "*NODE\n1,0.,0.,0.\n2,1.,0.,0.\n3,1.,1.,0.\n4,0.,1.,0.\n*ELEMENT,TYPE=S4,ELSET=P\n1,1,2,3,4\n"
PLATE = "*SHELL SECTION,ELSET=P,MATERIAL=M\n.01,5\n"
QUAD = (
    "GRID,1,,0.,0.,0.\nGRID,2,,1.,0.,0.\nGRID,3,,1.,1.,0.\nGRID,4,,0.,1.,0.\n"
    "CQUAD4,1,7,1,2,3,4\nPSHELL,7,1,.01,1,,1\nMAT1,1,7.+10,,.33,2700.\n"
)


def torsion_of(height, width):
    """Torsion constant of a rectangle, m⁴: Timoshenko and Goodier, Theory of Elasticity, §109."""
    n = np.arange(1.0, 4000.0, 2.0)
    a = max(height, width)
    b = min(height, width)
    return float(
        a * b**3 * (1 / 3 - 64 * b / (np.pi**5 * a) * (np.tanh(n * np.pi * a / (2 * b)) / n**5).sum())
    )


EXACT_TORSION = torsion_of(HEIGHT, WIDTH)


def bar(share, torsion, inertias=(I1, I2), area=AREA):
    """The text of the same beams as CBAR; I1 for bending in the plane of x and y."""
    return (
        GRIDS
        + BARS
        + f"PBAR,1,1,{area!r},{inertias[0]!r},{inertias[1]!r},{torsion!r},,\n,,,,,,,,\n,{share},{share}\n"
    )


SECTIONS = {
    "a rectangle": (B31 + RECT, bar(0.85, EXACT_TORSION)),
    "a general one": (
        f"{B31}*BEAM GENERAL SECTION,ELSET=E,SECTION=GENERAL\n"
        f"{AREA!r},{I2!r},0.,{I1!r},{TORSION!r}\n0.,1.,0.\n",
        bar(1.0, TORSION),
    ),
    "a radius": (
        B31 + "*BEAM SECTION,ELSET=E,SECTION=CIRC\n.01\n",
        bar(0.89, np.pi * 0.5e-8, (np.pi * 0.25e-8,) * 2, np.pi * 1e-4),
    ),
    "diameters": (
        B31 + "*BEAM SECTION,ELSET=E,SECTION=CIRC\n.02,.02\n",
        bar(0.89, np.pi * 0.5e-8, (np.pi * 0.25e-8,) * 2, np.pi * 1e-4),
    ),
    "a beam of three nodes": (
        NODES + "*ELEMENT,TYPE=B32,ELSET=E\n1,101,102,103\n" + RECT, bar(0.85, EXACT_TORSION),
    ),
}  # fmt: skip


@pytest.mark.parametrize("case", SECTIONS)
def test_beams_of_input_files_are_those_of_bulk_data(tmp_path, case):
    own, other = SECTIONS[case]
    pairs = zip(matrices(tmp_path, own + MATERIAL, form="INP"), list(matrices(tmp_path, other)), strict=True)
    for found, expected in pairs:
        assert difference(found, expected) < 1e-11


def test_shells_of_input_files_are_those_of_bulk_data(tmp_path):
    own = list(matrices(tmp_path, S4 + PLATE + MATERIAL, form="INP"))
    for found, expected in zip(own, matrices(tmp_path, QUAD), strict=True):
        assert found.shape == (24, 24)
        assert (found == expected).all()


FAULTS = {
    "another material": (B31 + RECT + MATERIAL.replace("7e10", "7.1e10"), "E is 7.1e+10"),
    "another density": (B31 + RECT + MATERIAL.replace("2700.", "2.7e-9"), "density is 2.7e-09"),
    "no section": (B31 + S4.split("4,0.,1.,0.\n")[1] + PLATE, "no *BEAM SECTION of the set 'E'"),
    "an ellipse": (B31 + "*BEAM SECTION,ELSET=E,SECTION=CIRC\n.02,.01\n", "ellipses are not read"),
    "a pipe": (B31 + "*BEAM SECTION,ELSET=E,SECTION=PIPE\n.02,.01\n", "a section PIPE is not read"),
    "n1 along the beam": (B31 + RECT.replace("0.,1.,0.", "1.,0.,0."), "lies along it"),
    "a missing node": (B31.replace("2,102,103", "2,102,104") + RECT, "node 104, which the node table lacks"),
    "too few nodes": (B31.replace("2,102,103", "2,102") + RECT, "2 different nodes"),
    "two of a number": (B31.replace("2,102,103", "1,102,103") + RECT, "element 1 stands on lines"),
    "a triangle": (B31 + RECT + "*ELEMENT,TYPE=S3,ELSET=T\n9,101,102,103\n", "elements S3 do not go with"),
    "an offset": (S4 + PLATE.replace("=M", "=M,OFFSET=.5") + MATERIAL, "option OFFSET"),
    "no thickness": (S4 + PLATE.replace(".01", "0.") + MATERIAL, "a thickness above zero"),
    "corners across": (S4.replace("1,1,2,3,4", "1,1,3,2,4") + PLATE, "shell 1 is folded"),
    "a set": (B31 + RECT + "*ELSET,ELSET=F\n1\n", "name element sets by ELSET="),
}
BULK_FAULTS = {
    "membranes": (QUAD.replace(".01,1,,1", ".01"), "MID1, MID2 and MID3"),
    "a layer": (QUAD.replace(".01,1,,1", ".01,1,2.,1"), "12I/T"),
    "an offset": (QUAD.replace("1,2,3,4\n", "1,2,3,4,,.1\n"), "offsets and thicknesses"),
    "a triangle": (QUAD + "CTRIA3,2,7,1,2,3\n", "shells are CQUAD4"),
    "no property": (QUAD.replace("PSHELL,7", "PSHELL,8"), "there is no PSHELL 7"),
    "no thickness": (QUAD.replace(".01", "0."), "a thickness is above zero"),
    "two of a number": (QUAD + "CQUAD4,1,7,1,2,3,4\n", "two shells of one number"),
    "a missing node": (QUAD.replace("1,2,3,4\n", "1,2,3,5\n"), "node 5, which the node table lacks"),
}


@pytest.mark.parametrize("case", [("INP", key) for key in FAULTS] + [("BDF", key) for key in BULK_FAULTS])
def test_beams_and_shells_that_cannot_be_used_are_refused(tmp_path, case):
    form, key = case
    text, words = (FAULTS if form == "INP" else BULK_FAULTS)[key]
    with pytest.raises(FEFileFault, match=re.escape(words)):
        list(matrices(tmp_path, text, form=form))


def test_files_with_solid_elements_are_no_files_of_structures(tmp_path):
    (tmp_path / "x").write_text(S4 + PLATE)
    assert has_structures(tmp_path / "x", "INP")
    (tmp_path / "x").write_text(S4 + PLATE + "*ELEMENT,TYPE=C3D4\n2,1,2,3,4\n")
    assert not has_structures(tmp_path / "x", "INP")


def cantilever(folder, text, fixed, form="INP"):
    """Frequencies, Hz, of a body with the rows of its nodes `fixed` held."""
    K, M = matrices(folder, text, ALUMINIUM, form)
    free = np.arange(6 * fixed, len(K))
    return np.sqrt(scipy.linalg.eigh(K[free][:, free], M[free][:, free], eigvals_only=True)[:4]) / (2 * np.pi)


def by_calculix(folder, text, clamped):
    """Frequencies, Hz, of CalculiX with nodes 1 .. `clamped` held."""
    held = "".join(f"{node},1,6\n" for node in range(1, clamped + 1))
    step = f"*BOUNDARY\n{held}*STEP\n*FREQUENCY\n4\n*END STEP\n"
    (folder / "job.inp").write_text(text + step)
    run_calculix(folder, "job")
    rows = re.findall(r"^ +\d+ +\S+ +\S+ +(\S+) +\S+\s*$", (folder / "job.dat").read_text(), re.MULTILINE)
    return np.array(rows[:4], float)


@needs_ccx
@pytest.mark.parametrize("kind", ["B32", "S4"])
def test_frequencies_of_a_cantilever_are_those_of_calculix(tmp_path, kind):
    """CalculiX makes C3D20R of B32 and C3D8I of S4: 1 %, less with finer meshes (half at twice)."""
    if kind == "B32":
        n, fixed = 40, 1
        nodes = "".join(f"{i + 1},{i / n},0.,0.\n" for i in range(n + 1))
        elements = "".join(f"{i + 1},{2 * i + 1},{2 * i + 2},{2 * i + 3}\n" for i in range(n // 2))
        section = "*BEAM SECTION,ELSET=E,MATERIAL=M,SECTION=RECT\n.02,.03\n0.,1.,0.\n"
        elements = f"*ELEMENT,TYPE=B32{{}},ELSET=E\n{elements}"
    else:
        n, fixed = 18, 10
        nodes = "".join(f"{10 * i + j + 1},{i / n},{j / 27},0.\n" for i in range(n + 1) for j in range(10))
        first = [10 * i + j + 1 for i in range(n) for j in range(9)]
        corners = [(k, k + 10, k + 11, k + 1) for k in first]
        elements = "".join(f"{k + 1},{','.join(map(str, row))}\n" for k, row in enumerate(corners))
        section = "*SHELL SECTION,ELSET=E,MATERIAL=M\n.01\n"
        elements = f"*ELEMENT,TYPE=S4{{}},ELSET=E\n{elements}"
    text = f"*NODE\n{nodes}{elements}{MATERIAL}{section}"
    found = cantilever(tmp_path, text.format(""), fixed)
    expected = by_calculix(tmp_path, text.format("R" if kind == "B32" else ""), fixed)
    assert found == pytest.approx(expected, rel=0.01)


@pytest.mark.long_motion
def test_a_panel_of_shells_swings_like_a_rigid_pendulum():
    """shell_panel.vsdf: from the horizontal to the vertical in a quarter of the period 4 K(1/2) √(J/(m g c)).

    The plate and its rib as thin ones; bending, at 64 Hz free, changes the time by less than 1e-3.
    """
    result = solve(DECKS / "shell_panel.vsdf")
    length, panel, rib = 0.3, 2700 * 1e-3 * 0.2 * 0.3, 2700 * 12e-6 * 0.3
    inertia, weight = (panel + rib) * length**2 / 3, (panel + rib) * 9.81 * length / 2
    quarter = ellipk(0.5) * np.sqrt(inertia / weight)
    angle = np.arctan2(result["point.2.x"], -result["point.2.z"])
    assert np.interp(0.0, -angle, result["time"]) == pytest.approx(quarter, rel=1e-3)
