"""The supplied slider-crank with a flexible rod against the rigid closed form and beam theory."""

import json
import math

import h5py
import numpy as np
import pytest
from click.testing import CliRunner

from flexmb_cli.cli.modes import modes
from flexmb_cli.cli.run import run
from tests.fe.supplied import FILES

DECK = str(FILES.parent / "slider_crank_flex.vsdf")
CRANK, ROD, RATE, RISE = 0.15, 0.5, 20.0, 0.25
YOUNG, DENSITY, WIDTH, HEIGHT = 2.1e11, 7850.0, 0.01, 0.02
AREA, BENDING = WIDTH * HEIGHT, HEIGHT * WIDTH**3 / 12


def crank_angle(t):
    """The spin-up of the deck: rate/rise (t²/2 + (rise/2 pi)² (cos(2 pi t/rise) - 1)), then even."""
    rising = RATE / RISE * (t**2 / 2 + (RISE / math.tau) ** 2 * (np.cos(math.tau * t / RISE) - 1))
    return np.where(t < RISE, rising, RATE * (t - RISE / 2))


def slider_position(t):
    phi = crank_angle(t)
    return CRANK * np.cos(phi) + np.sqrt(ROD**2 - CRANK**2 * np.sin(phi) ** 2)


def second_rate(function, t, h=1e-4):
    """d²/dt² of a closed form, to about 1e-6 of its size."""
    return (function(t + h) - 2 * function(t) + function(t - h)) / h**2


@pytest.fixture(scope="module")
def motion(tmp_path_factory):
    folder = tmp_path_factory.mktemp("slider_crank")
    done = CliRunner().invoke(run, [DECK, "-q", "-o", str(folder)])
    assert done.exit_code == 0, done.output
    with h5py.File(folder / "slider_crank_flex.h5") as result:
        return {name: result[name][:] for name in ("time", "point/position", "audit/constraint_residual")}


@pytest.mark.long_motion
def test_the_slider_moves_as_with_a_rigid_rod(motion):
    """The six modes bend and twist; between the reference nodes, which carry the joints, none stretches."""
    slider = motion["point/position"][:, 3]
    np.testing.assert_allclose(slider[:, 0], slider_position(motion["time"]), atol=1e-12)
    np.testing.assert_allclose(slider[:, 1:], 0.0, atol=1e-12)
    assert motion["audit/constraint_residual"].max() < 1e-12


@pytest.mark.long_motion
def test_the_rod_bends_as_a_pinned_beam_under_its_own_inertia(motion):
    """5 q L⁴/(384 E I) at the middle for a load that is linear along the rod, q = -mu a at both ends' mean.

    The crank's rate is 1/30 of the first bending frequency: 1e-3 of dynamic increase, and the start's
    transients; 1 % of the largest deflection covers both.
    """
    t, points = motion["time"], motion["point/position"]
    left, middle, right = points[:, 0], points[:, 1], points[:, 2]
    along = (right - left) / np.linalg.norm(right - left, axis=1)[:, None]
    normal = np.column_stack([-along[:, 1], along[:, 0]])
    found = np.einsum("ti,ti->t", (middle - (left + right) / 2)[:, :2], normal)
    pin = np.column_stack([
        second_rate(lambda t: CRANK * np.cos(crank_angle(t)), t),
        second_rate(lambda t: CRANK * np.sin(crank_angle(t)), t),
    ])  # fmt: skip
    slider = np.column_stack([second_rate(slider_position, t), np.zeros(len(t))])
    load = -DENSITY * AREA * np.einsum("ti,ti->t", (pin + slider) / 2, normal)
    expected = 5 * load * ROD**4 / (384 * YOUNG * BENDING)
    assert np.abs(expected).max() > 1e-4
    assert np.abs(found - expected)[1:].max() < 0.01 * np.abs(expected).max()


def test_the_rods_first_frequencies_are_those_of_a_pinned_beam():
    """(n pi/L)² sqrt(E I/mu), lowered by shear and turning: 0.1 % in its plane, 0.4 % across it."""
    done = CliRunner().invoke(modes, [DECK, "--at", "0", "--json"])
    assert done.exit_code == 0, done.output
    report = json.loads(done.stdout)
    stiffness = math.sqrt(YOUNG / 12 / DENSITY)
    expected = [math.pi**2 / ROD**2 * depth * stiffness / math.tau for depth in (WIDTH, HEIGHT)]
    assert report["bodies"][0]["frequencies"][:2] == pytest.approx(expected, rel=4e-3)
    assert report["mechanism"]["degrees_of_freedom"] == 6
    damped = [frequency * math.sqrt(1 - 0.02**2) for frequency in report["bodies"][0]["frequencies"]]
    assert report["mechanism"]["frequency"] == pytest.approx(damped, rel=1e-6)
    assert report["mechanism"]["damping"] == pytest.approx([0.02] * 6, rel=1e-5)


def test_the_files_are_what_calculix_writes_for_the_script(tmp_path):
    """`scripts/brick_beam.py rod --size 0.5 0.01 0.02 --cells 4 1 2 --solve`, zeros left out."""
    from scripts.brick_beam import Beam

    beam = Beam((ROD, WIDTH, HEIGHT), (4, 1, 2), "C3D20R")
    assert (FILES / "rod/rod.inp").read_text().split() == beam.input().split()
