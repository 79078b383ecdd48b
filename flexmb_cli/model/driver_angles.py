"""Angles that drivers ask for: too large to be an angle, or more turns than a report time can show."""

import math

import numpy as np

from .findings import Findings
from .mechanism import Driver, Mechanism, TimeGrid
from .motion_law import Motion

LARGEST_ANGLE = 1e9  # rad; beyond it a double leaves less than ten digits to a position within a turn
MANY_TURNS = 1000.0  # between two report times, each of which is followed
LARGEST_RATE = 1e100  # its square still is a number
SAMPLES = 101  # even times of a run at which a law of motion is looked at
TURNS = ("ANGL", "ROTX", "ROTY", "ROTZ")

_NO_ANGLE = f"beyond {LARGEST_ANGLE:.0e} rad numbers tell no position within a turn"


def check_driver_angles(mechanism: Mechanism, findings: Findings) -> None:
    """Refuse angles beyond `LARGEST_ANGLE`, and doubt `MANY_TURNS` in a report step."""
    for driver in mechanism.drivers:
        if driver.direction < 4:
            continue
        angle, turns = _largest_angle(driver, mechanism.time), _turns_in_a_step(driver, mechanism.time)
        if angle > LARGEST_ANGLE:
            message = f"its angle reaches {angle:.3g} rad; {_NO_ANGLE}: C is in rad, B in rad/s, A in rad/s²"
            findings.error(driver.name, message, driver.place)
        elif turns > MANY_TURNS:
            message = f"it turns {turns:.3g} times between two report times, each followed: is B in rad/s?"
            findings.note(driver.name, message, driver.place)


def check_motion_laws(motions: tuple[Motion, ...], grid: TimeGrid, findings: Findings) -> None:
    """The same for motions by laws, and refuse those that are no numbers."""
    for motion in motions:
        values, rates, _ = told = _sampled(motion.law, grid)
        if not (np.abs(told) <= LARGEST_RATE).all():
            message = (
                f"its law or a derivative is beyond {LARGEST_RATE:.0e}, or no number; of a table, two points "
                "lie too close"
            )
            findings.error(motion.name, message, motion.place)
        elif motion.kind in TURNS and np.abs(values).max() > LARGEST_ANGLE:
            angle = np.abs(values).max()
            message = f"its angle reaches {angle:.3g} rad; {_NO_ANGLE}: constants are in rad and s"
            findings.error(motion.name, message, motion.place)
        elif motion.kind in TURNS and (turns := np.abs(rates).max() * grid.step / math.tau) > MANY_TURNS:
            message = f"it turns {turns:.3g} times between two report times: are its constants in rad and s?"
            findings.note(motion.name, message, motion.place)


def _sampled(law, grid):
    """Value, rate and acceleration of a law at even times and at the points of its table, (3, times)."""
    times = np.concatenate([np.linspace(grid.start, grid.end, SAMPLES), law.times])
    try:
        return np.array([law.at(float(t)) for t in times if grid.start <= t <= grid.end]).T
    except ValueError:  # the sine of an infinite number
        return np.full((3, 1), np.nan)


def _largest_angle(driver: Driver, grid: TimeGrid) -> float:
    """Largest angle at the ends of the run and where the driver turns back, rad."""
    times = [grid.start, grid.end]
    if driver.A and grid.start < -driver.B / driver.A < grid.end:
        times.append(-driver.B / driver.A)
    return max(abs(driver.C + t * (driver.B + t * driver.A / 2)) for t in times)


def _turns_in_a_step(driver, grid):
    fastest = max(abs(driver.B + driver.A * t) for t in (grid.start, grid.end))
    return fastest * grid.step / (2 * math.pi)
