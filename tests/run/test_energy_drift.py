"""The total energy of forward runs in absolute coordinates: steps that let it stray are told, others not."""

import h5py
import numpy as np
import pytest

from flexmb_cli.run.energy_drift import ConstrainedDrift
from tests.dialects.vsdf.vsdf_decks import changed
from tests.solvers.kinematics.young_linkages import AT_REST, outcome, reported, turned, young

MASS, ARM, INERTIA, GRAVITY = 1.0, 0.5, 0.1, 9.81
SWINGING = f"DYNAMICS forward\nMASS 2 {MASS} {ARM} 0 0 0.01 0.1 {INERTIA}\nGRAVITY 0 -{GRAVITY} 0\n"


def pendulum(steps):
    """A bar of 1 kg about a hinge, let go level: 3.7 rad/s for small swings."""
    return young(
        (turned(0, 0, 0), turned(0, 0, 0)), (0, 2, 0.1), f"{SWINGING}{steps}END\n",
        revolute=[(1, 2, 0, 0, 0, 0, 0, 0, 0, 0, 1, 0, 0, 1)], ground=[AT_REST],
    )  # fmt: skip


def test_steps_that_are_too_long_are_told_by_the_energy_they_lose(tmp_path):
    """J ω²/2 + m g y of the rows was zero at the start."""
    found = outcome(tmp_path, pendulum("GALF 0.05 0.3\n"))
    assert found.exit_code == 0
    with h5py.File(tmp_path / "OUT.h5") as result:
        spin, e = result["body/angular_velocity"][:, 1, 2], result["body/euler_parameters"][:, 1]
        notes = result.attrs["notes"]
    height = ARM * 2.0 * e[:, 0] * e[:, 3]
    energy = 0.5 * (INERTIA + MASS * ARM**2) * spin**2 + MASS * GRAVITY * height
    (fault,) = reported(found)
    assert fault.startswith(
        f"IN.dat: warning: total energy drifts by {np.abs(energy).max():.1e} J, the energies and the work "
        "done reach 4.9 J, which the equations keep constant: the motion is wrong"
    )
    assert fault.endswith("steps of GALF that are too long or damp too much (a spectral radius below 1)")
    assert notes in fault


@pytest.mark.long_motion
@pytest.mark.parametrize(
    "steps", ["", "GALF 0.005 0.9\n", "GALF 0 0.3\n"], ids=["explicit", "short", "chosen"]
)
def test_steps_that_keep_energy_are_not_doubted(steps, tmp_path):
    assert reported(outcome(tmp_path, pendulum(steps))) == []


@pytest.mark.long_motion
@pytest.mark.parametrize(("step", "warned"), [("0.1", True), ("0.0", False)])
def test_the_steps_of_a_vsdf_deck_are_doubted_alike(step, warned, tmp_path):
    text = changed(("       1.0      0.01\n", f"       1.0       0.1{step:>10}\nINTG\n GALF       0.5\n"))
    found = reported(outcome(tmp_path, text, "x.vsdf"))
    energy = [fault for fault in found if "total energy drifts by" in fault]
    assert len(energy) == warned
    assert all("steps of GALF that are too long (card TIME)" in fault for fault in energy)


def rows(kinetic, potential, work):
    kinetic, potential, work = (np.array(values, dtype=float) for values in (kinetic, potential, work))
    total = kinetic + potential - work
    return {"energy/total": total, "energy/potential": potential, "energy/applied_work": work}


def test_what_a_driver_or_a_damper_moves_is_the_measure_where_little_is_in_motion():
    """100 J lifted by a driver at a crawl, 0.05 J of them missing: a two-thousandth."""
    drift = ConstrainedDrift("")
    drift.add(rows([1e-6, 1e-6], [0.0, 50.0], [0.0, 50.0]))
    drift.add(rows([1e-6], [100.0], [99.95]))
    assert (drift.largest, drift.scale) == pytest.approx((0.05, 100.0))
    assert drift.warnings == ()


def test_a_mechanism_at_rest_is_not_doubted_for_round_off():
    drift = ConstrainedDrift("")
    drift.add(rows([0.0, 1e-30, 1e-28], [-1000.0, -1000.0 + 1e-13, -1000.0], [0.0, 0.0, 0.0]))
    assert drift.largest > 0.0
    assert drift.warnings == ()
