"""Angles that drivers ask for: too large to be an angle, or more turns than a report time can show."""

import math

from .diagnostics import Findings
from .mechanism import Driver, Mechanism, TimeGrid

LARGEST_ANGLE = 1e9  # rad; beyond it a double leaves less than ten digits to a position within a turn
MANY_REVOLUTIONS = 1000.0  # between two report times, each of which is followed
NO_ANGLE = f"beyond {LARGEST_ANGLE:.0e} rad a number determines no position within a turn"


def check_driver_angles(mechanism: Mechanism, findings: Findings) -> None:
    """Refuse angles beyond `LARGEST_ANGLE`; warn of `MANY_REVOLUTIONS` in a report step and of degrees."""
    for driver in mechanism.drivers:
        if driver.direction < 4:
            continue
        angle, revolutions = (
            _largest_angle(driver, mechanism.time),
            _revolutions_in_a_step(driver, mechanism.time),
        )
        if angle > LARGEST_ANGLE:
            message = f"its angle reaches {angle:.3g} rad; {NO_ANGLE}: C is in rad, B in rad/s, A in rad/s²"
            findings.error(driver.name, message, driver.place, id="MODEL-002")
        elif revolutions > MANY_REVOLUTIONS:
            message = (
                f"it turns {revolutions:.3g} times between two report times, each followed: is B in rad/s?"
            )
            findings.note(driver.name, message, driver.place, id="MODEL-003")
        elif abs(driver.C) > 2 * math.pi:
            findings.note(driver.name, _beyond_a_turn(driver.C), driver.place, id="MODEL-016")


def _beyond_a_turn(angle: float) -> str:
    """Return the note about a constant that turns more than once, as one in degrees does."""
    turns, degrees = abs(angle) / math.tau, math.radians(angle)
    return f"its C of {angle:.6g} rad is {turns:.3g} turns; {angle:.6g} degrees would be {degrees:.10g} rad"


def _largest_angle(driver: Driver, grid: TimeGrid) -> float:
    """Largest angle at the ends of the run and where the driver turns back, rad."""
    times = [grid.start, grid.end]
    if driver.A and grid.start < -driver.B / driver.A < grid.end:
        times.append(-driver.B / driver.A)
    return max(abs(driver.C + t * (driver.B + t * driver.A / 2)) for t in times)


def _revolutions_in_a_step(driver: Driver, grid: TimeGrid) -> float:
    fastest = max(abs(driver.B + driver.A * t) for t in (grid.start, grid.end))
    return fastest * grid.step / (2 * math.pi)
