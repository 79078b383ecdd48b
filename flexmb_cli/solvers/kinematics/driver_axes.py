"""Attitudes of bodies with a rotational driver.

The driver's two rows, e_k = sin(θ/2) and e0 = cos(θ/2), stand in place of the body's normalisation:
the other two parameters must come out 0 from the joints, and so must their rates.  If they do not, the
joints turn the body away from its driver's axis: |p| is not 1 or does not stay 1, and the position is no
position, or the rates are no motion.
"""

from collections.abc import Iterator
from dataclasses import replace
from typing import Any

import numpy as np

from ...errors import AnalysisError, Fault, ModelError
from ...model.arrays.kinematic import kinematic_arrays
from ...model.mechanism import Driver, Mechanism
from ..projection import RESIDUAL_MET
from .assembly import assemble_by_search, mobility
from .position import Evaluator, KinematicSettings, kinematic_system
from .rows import Rows, twice_g

UPRIGHT = 1e-9
OFF_AXIS = 5e-5  # of an Euler parameter, or of its rates: |p| is UPRIGHT beyond 1
UNITS = "rad", "rad/s", "rad/s²"


def refuse_off_axis_drive(mechanism: Mechanism, first: Rows) -> None:
    """Raise ModelError naming the driven bodies that the first row shows off_axis."""
    faults = [
        Fault("error", _message(driver, off[0], off_axis[0]), driver.place, driver.name, id="SOLVE-010")
        for driver, off, off_axis in _axis_deviations(mechanism, first)
        if off_axis[0].any()
    ]
    if faults:
        raise ModelError(faults)


def refuse_contradicted_drive(mechanism: Mechanism, settings: KinematicSettings) -> None:
    """Raise ModelError if the mechanism can be assembled but for a rotational driver its joints contradict.

    Without that driver the body must be free to turn about the driver's axis, at an attitude that is
    a turn about it; else no value of the driver can ever be met.
    """
    for driver in _turning(mechanism):
        others = tuple(d for d in mechanism.drivers if d is not driver)
        arrays = kinematic_arrays(replace(mechanism, drivers=others))
        evaluator = Evaluator.of(arrays, kinematic_system(arrays, settings))
        t, expected = mechanism.time.start, arrays.screw_angles
        q, gap = assemble_by_search(evaluator, arrays.q, t, expected)
        if np.max(np.abs(gap)) > RESIDUAL_MET or evaluator.is_large:
            continue
        if not _can_turn(driver, q, mobility(evaluator, q, t, expected).motions):
            axis = "xyz"[driver.direction - 4]
            message = (
                f"the joints do not let body {driver.body + 1} turn about the global {axis} axis, as this "
                "driver asks; drive the direction that the joints leave free, or turn the mechanism"
            )
            raise ModelError([Fault("error", message, driver.place, driver.name, id="SOLVE-011")])


def _can_turn(driver: Driver, q: np.ndarray, motions: Any) -> Any:
    k, axis = 7 * driver.body + 3, np.eye(3)[driver.direction - 4]
    p = q[k : k + 4]
    upright = np.linalg.norm(np.cross(p[1:], axis)) <= UPRIGHT
    rates = [twice_g(p, motion[k : k + 4]) for motion in motions]
    return upright and any(abs(omega @ axis) > UPRIGHT for omega in rates)


def keeps_axis(mechanism: Mechanism, rows: Rows) -> Rows:
    """The rows, if all driven bodies keep their axes in them; raises AnalysisError at the first that does."""
    for driver, off, off_axis in _axis_deviations(mechanism, rows):
        if off_axis.any():
            k = int(np.argmax(off_axis.any(axis=1)))
            message = f"at t = {rows.time[k]:.6g} s {driver.name}: {_message(driver, off[k], off_axis[k])}"
            fault = Fault("error", message, driver.place, about=driver.name, id="SOLVE-012")
            raise AnalysisError(fault, float(rows.time[k]))
    return rows


def _turning(mechanism: Mechanism) -> list[Driver]:
    return [driver for driver in mechanism.drivers if driver.direction > 3]


def _axis_deviations(mechanism: Mechanism, rows: Rows) -> Iterator[tuple[Driver, np.ndarray, np.ndarray]]:
    """Rotational drivers, the parts of p, ṗ, p̈ of their bodies off the axis (T, 3), whether too large.

    Drivers whose parts are small whatever they are compared with are left out.

    The rates are compared with the fastest Euler parameter of the row: so far goes their round-off.
    """
    for driver in _turning(mechanism):
        parts = _parts_off_axis(driver, rows)
        if (np.abs(parts) <= 0.5 * OFF_AXIS).all():
            continue
        orders = rows.euler_parameter_rates, rows.euler_parameter_accelerations
        rate, second = (np.abs(order).max(axis=(1, 2)) for order in orders)
        sizes = 1.0 + np.stack([0.0 * rate, rate, second + rate**2], axis=-1)
        off = np.hypot(parts[:3], parts[3:]).T
        yield driver, off, off > OFF_AXIS * sizes


def on_axes(mechanism: Mechanism, rows: Rows) -> np.ndarray:
    """Return in which rows (T,) all driven bodies keep their axes, whatever their parts are compared with."""
    on = np.ones(rows.time.size, dtype=bool)
    for driver in _turning(mechanism):
        on &= (np.abs(_parts_off_axis(driver, rows)) <= 0.5 * OFF_AXIS).all(axis=0)
    return on


def _parts_off_axis(driver: Driver, rows: Rows) -> np.ndarray:
    """Two parts of each of p, ṗ, p̈ (6, T) that a turn about the driver's axis does not have."""
    orders = rows.euler_parameters, rows.euler_parameter_rates, rows.euler_parameter_accelerations
    across = (k for k in (1, 2, 3) if k != driver.direction - 3)
    return np.array([order[:, driver.body, k] for k in across for order in orders])


def _message(driver: Driver, off: np.ndarray, off_axis: np.ndarray) -> str:
    axis, k = "xyz"[driver.direction - 4], int(np.argmax(off_axis))
    return (
        f"the joints turn body {driver.body + 1} away from the global {axis} axis that this driver turns "
        f"it about, by {2.0 * off[k]:.3g} {UNITS[k]}; align the joint's axis with "
        f"{axis}, or describe the body in axes in which its attitude is a turn about it"
    )
