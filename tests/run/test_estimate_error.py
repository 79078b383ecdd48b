"""`run --estimate-error`: the global error of every quantity, against what is known to be right."""

import math

import h5py
import numpy as np
import pytest
from scipy.integrate import solve_ivp

from flexmb_cli.errors import AnalysisError, Fault
from flexmb_cli.run.error_estimate import ErrorEstimate
from flexmb_cli.run.outcome import RunOptions
from flexmb_cli.run.solution import run_deck
from tests.dialects.vsdf.test_rigid_links import young_rows
from tests.dialects.vsdf.vsdf_decks import changed
from tests.run.dafms_runs import altered, loaded, run
from tests.solvers.kinematics.young_linkages import AT_REST, four_bar, outcome, reported, turned, young

ARM, INERTIA, GRAVITY = 0.5, 0.1, 9.81


def pendulum(cards, analysis="forward", drivers=()):
    """A bar of 1 kg about a hinge, let go level."""
    return young(
        (turned(0, 0, 0), turned(0, 0, 0)), (0, 2, 0.1),
        f"DYNAMICS {analysis}\nMASS 2 1 {ARM} 0 0 0.01 0.1 {INERTIA}\nGRAVITY 0 -{GRAVITY} 0\n{cards}END\n",
        drivers=drivers, revolute=[(1, 2, 0, 0, 0, 0, 0, 0, 0, 0, 1, 0, 0, 1)], ground=[AT_REST],
    )  # fmt: skip


def speeds(times):
    """J φ̈ = -m g l cos φ, by DOP853 of SciPy."""
    rate = GRAVITY * ARM / (INERTIA + ARM**2)
    found = solve_ivp(
        lambda _, y: [y[1], -rate * math.cos(y[0])], (0, times[-1]), (0.0, 0.0), "DOP853", times,
        rtol=1e-13, atol=1e-13,
    )  # fmt: skip
    return found.y[1]


def test_the_estimate_is_the_error(tmp_path):
    found = outcome(tmp_path, pendulum("TOLERANCE 1e-5\n"), estimate_error=True)
    assert (found.exit_code, reported(found)) == (0, [])
    with h5py.File(tmp_path / "OUT.h5") as result:
        time, speed = result["time"][:], result["body/angular_velocity"][:, 1, 2]
        estimate = result["audit/global_error/body/angular_velocity"][:]
        assert result["audit/global_error/body/angular_velocity"].attrs["units"] == "rad/s"
    error = np.abs(speed - speeds(time))
    assert error.max() > 1e-7
    assert estimate == pytest.approx(error, abs=0.05 * error.max())
    assert found.errors["body/angular_velocity"]["error"] == estimate.max()
    assert found.as_dict()["global_error"] == found.errors


@pytest.mark.long_motion
def test_the_estimate_of_a_tree_is_the_error(tmp_path):
    """Against the same tree in absolute coordinates, to 1e-12."""
    deck = altered(tmp_path, "fourbar_rigid", ("  200\n", "   40\n"))
    found = run(deck, tmp_path, estimate_error=True, integration={"rtol": 1e-5, "atol": 1e-5})
    assert (found.exit_code, reported(found)) == (0, [])
    ours = loaded(tmp_path, "fourbar_rigid")
    run(deck, tmp_path / "absolute", formulation="absolute", integration={"rtol": 1e-12, "atol": 1e-12})
    other = loaded(tmp_path / "absolute", "fourbar_rigid")
    for path in ("coordinate/q", "coordinate/u"):
        error = np.abs(ours[path] - other[path]).max(axis=1)
        assert error.max() > 1e-7
        assert ours[f"audit/global_error/{path}"] == pytest.approx(error, abs=0.2 * error.max())


@pytest.mark.long_motion
def test_the_estimate_of_rigid_links_is_the_error(tmp_path):
    """Of a VSDF deck, against the same links as a YOUNG deck's, to 1e-11."""
    deck = tmp_path / "links.vsdf"
    deck.write_text(changed(("1.0      0.01\n", "1.0       0.1\nINTG\n RK45    1.0E-4\n")))
    found = run_deck(str(deck), RunOptions(folder=str(tmp_path), estimate_error=True))
    assert (found.exit_code, reported(found)) == (0, [])
    values, speed = loaded(tmp_path, "links"), "body/angular_velocity"
    error = np.abs(values[speed] - young_rows().angular_velocity[:, 1:]).max(axis=(1, 2))
    assert error.max() > 1e-6
    assert values[f"audit/global_error/{speed}"] == pytest.approx(error, abs=0.05 * error.max())


@pytest.mark.parametrize(
    ("deck", "reason"),
    [
        (pendulum("GALF 0.005 1\n"), "the steps have a given length (GALF)"),
        (four_bar(4, 1, 3, 3, (1, 1, 0), (0, 1, 0.5)), "nothing is integrated"),
        (pendulum("", "inverse", [(2, 6, 0, 1, 0)]), "nothing is integrated"),
    ],
)
def test_a_run_without_chosen_steps_says_that_nothing_can_be_estimated(tmp_path, deck, reason):
    found = outcome(tmp_path, deck, estimate_error=True)
    assert found.exit_code == 0
    assert f"--estimate-error has no effect: {reason}" in reported(found)[0]
    assert not found.errors


def test_a_tolerance_that_no_run_can_undercut_is_told(tmp_path):
    deck = altered(tmp_path, "fourbar_rigid", ("  200\n", "    2\n"))
    found = run(deck, tmp_path, estimate_error=True, integration={"rtol": 1e-14})
    assert "no second run can be finer than a tolerance of 1e-14" in reported(found)[0]


def test_a_second_run_that_stops_ends_the_estimate_but_not_the_run():
    def second():
        yield {"time": np.array([0.0, 1.0]), "body/position": np.zeros((2, 1, 3))}
        raise AnalysisError(Fault("error", "a dead centre"), 1.5)

    estimate = ErrorEstimate(second())
    values = {"time": np.arange(3.0), "body/position": np.full((3, 1, 3), 0.5)}
    assert estimate.of(values)["audit/global_error/body/position"] == pytest.approx(
        [0.5, 0.5, np.nan], nan_ok=True
    )
    assert estimate.of(values)["audit/global_error/body/position"] == pytest.approx([np.nan] * 3, nan_ok=True)
    assert estimate.as_dict["body/position"] == {"error": 0.5, "time": 0.0, "largest": 0.5}
    assert "errors are estimated up to t = 1.5 s only: a dead centre" in estimate.warnings[0].message
