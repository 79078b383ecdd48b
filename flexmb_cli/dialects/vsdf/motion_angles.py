"""Motion functions of VSDF decks that are no numbers, no angles, or turn more than a report time shows."""

import math

import numpy as np

from ...model.diagnostics import Findings
from ...model.driver_angles import LARGEST_ANGLE, MANY_REVOLUTIONS, NO_ANGLE
from ...model.mechanism import TimeGrid
from ...model.time_functions import Motion, MotionFunction

LARGEST_RATE = 1e100  # its square still is a number
SAMPLES = 101  # even times of a run at which a function is evaluated


def check_motion_functions(motions: tuple[Motion, ...], grid: TimeGrid, findings: Findings) -> None:
    """Refuse functions that are no numbers, no angles; warn of `MANY_REVOLUTIONS` in a report step."""
    for motion in motions:
        values, rates, _ = reported = _sampled(motion.function, grid)
        if not (np.abs(reported) <= LARGEST_RATE).all():
            message = (
                f"its law or a derivative is beyond {LARGEST_RATE:.0e}, or no number; of a table, two points "
                "lie too close"
            )
            findings.error(motion.name, message, motion.place, id="VSDF-072")
        elif not motion.is_length and np.abs(values).max() > LARGEST_ANGLE:
            angle = np.abs(values).max()
            message = f"its angle reaches {angle:.3g} rad; {NO_ANGLE}: constants are in rad and s"
            findings.error(motion.name, message, motion.place, id="VSDF-073")
        elif (
            not motion.is_length
            and (revolutions := np.abs(rates).max() * grid.step / math.tau) > MANY_REVOLUTIONS
        ):
            message = (
                f"it turns {revolutions:.3g} times between two report times: are its constants in rad and s?"
            )
            findings.note(motion.name, message, motion.place, id="VSDF-074")


def _sampled(function: MotionFunction, grid: TimeGrid) -> np.ndarray:
    """Value, rate and acceleration of a function at even times, or at the points of its table, (3, times)."""
    # Each look into a table goes through all of its points.
    times = (grid.start, grid.end) if function.times else np.linspace(grid.start, grid.end, SAMPLES)
    try:
        reported = np.array([function.at(float(t)) for t in times]).T
    except ValueError:  # the sine of an infinite number
        return np.full((3, 1), np.nan)
    return np.hstack([reported, _at_points(function, grid)]) if function.times else reported


def _at_points(function: MotionFunction, grid: TimeGrid) -> np.ndarray:
    """The same at the points of a table that the run reaches; of the rates a bound."""
    t, f, g = (np.array(column) for column in (function.times, function.values, function.curvature))
    h = np.diff(t)
    with np.errstate(over="ignore"):
        rates = np.abs(np.diff(f)) / h + h * np.maximum(np.abs(g[:-1]), np.abs(g[1:])) / 2
    reached = (grid.start <= t) & (t <= grid.end)
    return np.array([f, np.append(rates, rates[-1]), g])[:, reached]
