"""A finite-element program in the loop: CalculiX writes the matrices of a beam, and finds the same modes."""

import math

import h5py
import numpy as np
import pytest
from click.testing import CliRunner
from scipy.integrate import solve_ivp

from flexmb_cli.cli.run import run
from scripts.brick_beam import Beam
from tests.fe.calculix import (
    asked,
    clamp,
    deck_of,
    needs_ccx,
    own_displacements,
    own_frequencies,
    reported,
    timoshenko,
)

pytestmark = [needs_ccx, pytest.mark.processes]

# No lateral contraction, so that the clamped face holds exactly what beam theory holds.
SLENDER = Beam((0.5, 0.01, 0.02), (12, 1, 2), "C3D20R", poisson=0.0)
ROOT = SLENDER.section(0.0)
Y, Z = SLENDER.size[1:]


def test_the_clamped_beam_has_the_frequencies_that_calculix_finds_itself(tmp_path):
    """CalculiX iterates to a residual; it prints seven digits, and its matrices have fourteen."""
    found = reported(deck_of(tmp_path, SLENDER, clamp(ROOT), 10))["frequencies"]
    np.testing.assert_allclose(found, own_frequencies(tmp_path, SLENDER, ROOT, 10), rtol=1e-6)


@pytest.mark.parametrize(
    "element, cells, tolerance", [("C3D20R", (12, 1, 2), 1e-3), ("C3D8I", (24, 1, 1), 6e-3)]
)
def test_the_clamped_beam_bends_as_timoshenko_says(tmp_path, element, cells, tolerance):
    """The tolerance is the mesh's, for the second mode in each plane."""
    beam = Beam(SLENDER.size, cells, element, poisson=0.0)
    found = reported(deck_of(tmp_path, beam, clamp(beam.section(0.0)), 4))["frequencies"]
    expected = sorted(timoshenko(beam, Y, 2) + timoshenko(beam, Z, 2))
    np.testing.assert_allclose(found, expected, rtol=tolerance)


def test_one_row_of_bricks_with_reduced_integration_is_told_to_move_without_strain(tmp_path):
    """C3D20R in a single row has hourglass motions, which neither K nor M feels."""
    beam = Beam(SLENDER.size, (12, 1, 1), "C3D20R")
    done = asked(deck_of(tmp_path, beam, clamp(beam.section(0.0)), 4))
    assert done.exit_code == 2
    assert "body 1: held in its frame the body still moves without strain" in done.stderr


def test_timoshenko_of_a_slender_beam_is_euler_and_bernoulli():
    """First roots of 1 + cos x cosh x = 0: 1.875104, 4.694091; shear and turning lower them by 1e-4 or so."""
    stiffness = math.sqrt(SLENDER.young * Y**2 / 12 / SLENDER.density)
    expected = [x**2 / SLENDER.size[0] ** 2 * stiffness / math.tau for x in (1.875104, 4.694091)]
    found = timoshenko(SLENDER, Y, 2)
    assert found == pytest.approx(expected, rel=4e-3)
    assert all(theory < euler for theory, euler in zip(found, expected, strict=True))


def test_the_unsupported_matrices_carry_the_mass_of_the_beam(tmp_path):
    found = reported(deck_of(tmp_path, SLENDER, clamp(ROOT), 1))
    assert found["mass"] == pytest.approx(SLENDER.density * np.prod(SLENDER.size), rel=1e-12)
    assert found["centre"] == pytest.approx([0.25, 0.005, 0.01], rel=1e-9)


LOADED = """\
DAMP
    1       0.0       0.0       1.0
JOIN
    1 FIXD    0    0    0    1{:5d}{:5d}    0{:5d}
FORC
    1{:5d}       0.0     100.0       0.0
    1{:5d}       0.0       0.0     -50.0
INTG
 RAD5    1.0E-8
OUTN
    1{:5d}{:5d}"""


@pytest.mark.parametrize("element, cells", [("C3D20R", (2, 1, 2)), ("C3D10", (1, 1, 1))])
def test_forces_on_nodes_bend_a_body_at_last_as_in_calculix_statics(tmp_path, element, cells):
    """Critically damped modes come to rest where CalculiX's static solution is, printed to seven digits.

    Shapes without mass carry 2e-2 of the displacement under a force on a node.
    """
    beam = Beam((0.2, 0.1, 0.1), cells, element)
    root, end = beam.section(0.0), beam.section(0.2)
    placed = beam.mesh()[0]
    bent = own_displacements(tmp_path, beam, root, {(end[0], 2): 100.0, (end[2], 3): -50.0})
    load = LOADED.format(root[0], root[1], root[-1], end[0], end[2], end[0], end[2])
    path = deck_of(tmp_path, beam, [*clamp(root), load], 0, time="     0.005     0.005")
    done = CliRunner().invoke(run, [str(path), "-q", "-o", str(tmp_path)])
    assert done.exit_code == 0, done.output
    with h5py.File(tmp_path / "beam.h5") as result:
        moved = result["point/position"][-1] - [placed[end[0]], placed[end[2]]]
    expected = bent[[end[0] - 1, end[2] - 1]]
    assert moved == pytest.approx(expected, abs=1e-6 * np.abs(expected).max())


SWING = """\
JOIN
    1 REVO    0    0    0    1{:5d}{:5d}
GRAV
       0.0       0.0     -9.81
INTG
 RK45    1.0E-9"""


def test_a_beam_of_calculix_swings_and_keeps_its_energy(tmp_path):
    """Held at the root's middle, let go horizontally: energy to 1e-7 of m g L/2, the tip as a rigid rod's.

    The rod is stiff: its first bending is at 150 Hz, its swing at 0.8 Hz, and the angle turned in 0.1 s
    is that of a compound pendulum, 3 g t²/(4 L) at first.
    """
    beam = SLENDER
    placed = beam.mesh()[0]
    pins = [node for node in ROOT if placed[node][2] == pytest.approx(0.01) and placed[node][1] != 0.005]
    tip = min(node for node in beam.section(0.5) if placed[node][2] == pytest.approx(0.01))
    cards = [SWING.format(*pins), "OUTN", f"    1{tip:5d}"]
    path = deck_of(tmp_path, beam, cards, 3, time="       0.1      0.01")
    done = CliRunner().invoke(run, [str(path), "-q", "-o", str(tmp_path)])
    assert done.exit_code == 0, done.output
    with h5py.File(tmp_path / "beam.h5") as result:
        total, kinetic = result["energy/total"][:], result["energy/kinetic"][:]
        drop = result["point/position"][:, 0, 2] - 0.01
    weight = 9.81 * beam.density * np.prod(beam.size) * beam.size[0] / 2
    assert np.abs(total - total[0]).max() < 1e-7 * weight
    assert kinetic[-1] > 0.05 * weight
    turned = solve_ivp(
        lambda t, y: [y[1], 1.5 * 9.81 / 0.5 / (1 + (0.02 / 0.5) ** 2 / 4) * math.cos(y[0])],
        (0.0, 0.1), [0.0, 0.0], rtol=1e-10, atol=1e-12,
    ).y[0, -1]  # fmt: skip
    assert drop[-1] == pytest.approx(-0.5 * math.sin(turned), rel=5e-3)
