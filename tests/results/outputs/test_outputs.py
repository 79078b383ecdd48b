"""Lines OUTPUT: relative motion against rotations of SciPy, angles without jumps, formulas in commands."""

from pathlib import Path

import h5py
import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from flexmb_cli import interface
from flexmb_cli.errors import FlexmbError
from flexmb_cli.results.outputs.relative_motion import rotation_vector
from flexmb_cli.run.check.check import check_deck
from flexmb_cli.run.outcome import RunOptions

DECKS = Path(__file__).resolve().parents[3] / "decks"
PAIR = (DECKS / "young/dynamics/IN-PAIR.dat").read_text()
ARM = (DECKS / "dafms/arm_elements.DAT").read_text()
TILT = np.array([np.sin(0.5), 0.0, np.cos(0.5)])
P, Q, HINGE = np.array([0.2, -0.3, 0.5]), np.array([-0.1, 0.2, 0.0]), np.array([0.4, 0.0, 0.1])


@pytest.fixture(scope="module")
def pair():
    return interface.solve(str(DECKS / "young/dynamics/IN-PAIR.dat"))


def turned(t):
    """Attitudes of the first body, of the second relative to it, and its angle and rate, closed forms."""
    angle, rate = 2 * t - 0.4 * t**2, 2 - 0.8 * t
    first = Rotation.from_rotvec(np.outer(1.3 * t, [0, 0, 1]))
    return first, Rotation.from_rotvec(np.outer(angle, TILT)), angle, rate


def test_angles_are_those_of_scipy_without_jumps(pair):
    first, second, angle, _ = turned(pair.time)
    whole = first * second
    # Capitals: turned about the new axes.
    wanted = np.unwrap(whole.as_euler("XYZ"), axis=0)
    assert np.abs(pair["output/cardan"] - wanted).max() < 1e-12
    assert np.ptp(pair["output/cardan"][:, 2]) > 2 * np.pi > np.ptp(whole.as_euler("XYZ")[:, 2])
    assert np.abs(pair["output/rpy"] - np.unwrap(whole.as_euler("ZYX")[:, ::-1], axis=0)).max() < 1e-12
    assert np.abs(pair["output/turn"] - np.outer(angle, TILT)).max() < 1e-12


def test_distances_and_relative_velocities_are_those_of_the_closed_form(pair):
    _, second, _, rate = turned(pair.time)
    arm = second.apply(P)
    apart, velocity = HINGE + arm - Q, np.cross(np.outer(rate, TILT), arm)
    distance = np.linalg.norm(apart, axis=1)
    assert np.abs(pair["output/apart"] - distance).max() < 1e-12
    assert np.abs(pair["output/closing"] - np.einsum("ni,ni->n", apart, velocity) / distance).max() < 1e-12
    assert np.abs(pair["output/seen"] - velocity).max() < 1e-12
    assert np.abs(pair["output/spin"] - np.outer(rate, TILT)).max() < 1e-12


# Worked problem "outputs-relative": Cardan angle z modulo 2 pi, distance, its rate.
@pytest.mark.parametrize(
    ("row", "z", "distance", "rate"),
    [(3, 0.870698752097, 1.10827598382, 0.144963865805), (16, -2.12790582516, 1.0974677078, -0.067391956892)],
)
def test_values_are_those_of_the_worked_problem(pair, row, z, distance, rate):
    found = pair["output/cardan"][row, 2]
    assert (found - z + np.pi) % (2 * np.pi) - np.pi == pytest.approx(0, abs=1e-9)
    assert pair["output/apart"][row] == pytest.approx(distance, abs=1e-9)
    assert pair["output/closing"][row] == pytest.approx(rate, abs=1e-9)


def test_a_formula_names_quantities_outputs_and_variables(pair):
    power = np.einsum("nk,nk->n", pair["driver/effort"], pair["coordinate/u"])
    assert np.array_equal(pair["output/power"], power)
    assert np.abs(pair["output/share"] - np.abs(2 - 0.8 * pair.time) * 0.5 / 2).max() < 1e-14
    assert pair.unit("output/apart") == "m"


def test_angles_follow_several_turns_between_two_rows(tmp_path):
    """Up to three turns lie between two rows; the angular velocities of the bodies count them."""
    fast = PAIR.replace("polynomial 0 2 -0.4", "polynomial 0 70 -2").replace("0 3 0.1", "0 3 0.25")
    path = tmp_path / "x.dat"
    path.write_text(fast)
    found = interface.solve(str(path))
    angle = 70 * found.time - 2 * found.time**2
    assert np.diff(angle).max() > 2.5 * 2 * np.pi
    assert np.abs(found["output/turn"] - np.outer(angle, TILT)).max() < 1e-9


def test_rotation_vectors_of_any_attitude_are_those_of_scipy():
    rotations = Rotation.random(500, rng=np.random.default_rng(4))
    half = Rotation.from_rotvec(np.pi * np.eye(3))
    assert np.abs(rotation_vector(rotations.as_matrix()) - rotations.as_rotvec()).max() < 1e-12
    assert np.abs(np.abs(rotation_vector(half.as_matrix())) - np.pi * np.eye(3)).max() < 1e-12


def test_both_formulations_and_blocks_of_rows_give_the_same(tmp_path):
    """The angle of a rotation vector about a fixed axis is the coordinate of the hinge."""
    text = ARM.replace(
        "  SPRING", "  OUTPUT turn rotation_vector body=1\n  OUTPUT far = turn.z + 2*elbow\n  SPRING"
    )
    text = text.replace("far = turn.z + 2*elbow", "far = turn.z + 2*element.elbow.effort")
    path = tmp_path / "x.DAT"
    path.write_text(text.replace("sine 0.0 0.6 3.0 0.0", "polynomial 0 1.8 8"))
    kane, absolute = (interface.solve(str(path), formulation=one) for one in ("kane", "absolute"))
    assert np.abs(kane["output/turn"][:, 2] - kane["coordinate/q"][:, 0]).max() < 1e-9
    assert np.abs(kane["output/far"] - absolute["output/far"]).max() < 1e-6
    assert kane["output/far"] == pytest.approx(
        kane["output/turn"][:, 2] + 2 * kane["element/effort"][:, 0], abs=0
    )


def test_files_and_studies_have_outputs(tmp_path):
    (tmp_path / "IN-PAIR.dat").write_text(PAIR)
    outcome = interface.solve_to_files(str(tmp_path / "IN-PAIR.dat"), RunOptions(folder=str(tmp_path)))
    with h5py.File(outcome.files[-1]) as file:
        last = file["output/share"][-1]
        assert file["output/seen"].attrs["units"] == "m/s"
    assert last == pytest.approx(0.4 * 0.25)
    study = 'deck = "IN-PAIR.dat"\n[parameters]\ntilt = [0.5, 1.0]\n[results]\nx = "last output.share"\n'
    (tmp_path / "s.toml").write_text(study)
    assert interface.sweep(tmp_path / "s.toml")["result/x"] == pytest.approx([last, 2 * last])


@pytest.mark.parametrize(
    ("line", "sentence"),
    {
        "OUTPUT x = body.2.q": "body.2.q: the result has no such quantity",
        "OUTPUT x = body.2.velocity": "body.2.velocity is more than one number",
        "OUTPUT x = y\n  OUTPUT y = 1": "the output y must be given on a line above",
        "OUTPUT x = (1": "this is not a formula: ')' is missing",
        "OUTPUT x cardan body=7": "body 7 is outside 0..3",
        "OUTPUT x distance body=2": "distance takes from= and to=",
        "OUTPUT x distance from=2:1 to=0(0,0,0)": "an output is of a point of a body",
        "OUTPUT apart = 1": "has this name",
    }.items(),
)  # fmt: skip
def test_wrong_outputs_are_faults(tmp_path, line, sentence):
    path = tmp_path / "x.dat"
    path.write_text(PAIR.replace("END\n", f"  {line}\nEND\n"))
    outcome = check_deck(str(path), RunOptions()).outcome
    assert outcome.exit_code == 2
    found = next(fault for fault in outcome.faults if fault.severity == "error")
    assert sentence in found.message and found.place is not None
    with pytest.raises(FlexmbError):
        interface.solve(str(path))
