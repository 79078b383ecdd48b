"""The motion between report rows: a spline through the rows of smooth quantities, of fifth degree.

Its error falls with the sixth power of the step.
"""

from typing import Any

import numpy as np

DEGREE = 5


def spline(times: np.ndarray, values: np.ndarray) -> Any:
    """Return the spline (a SciPy BSpline) through values (rows,) or (rows, k) at their times, s."""
    from scipy.interpolate import make_interp_spline

    degree = min(DEGREE, len(times) - 1)
    return make_interp_spline(times, values, k=degree - (degree > 1 and degree % 2 == 0))


def highest(times: np.ndarray, values: np.ndarray, start: float, end: float) -> float:
    """Return the largest value of a quantity (rows,) from `start` to `end`, s, also between rows."""
    from scipy.interpolate import PPoly

    start, end = max(start, times[0]), min(end, times[-1])
    if not start <= end or not np.all(np.isfinite(values)):
        return float("nan")
    if len(times) == 1:
        return float(values[0])
    curve = spline(times, values)
    still = PPoly.from_spline(curve).derivative().roots(extrapolate=False)
    inside = still[(still > start) & (still < end)]  # nan, of a part that is constant, is not
    return float(np.max(curve(np.array([start, *inside, end]))))


def nearest(curve: Any, points: np.ndarray, start: float, end: float, samples: int) -> np.ndarray:
    """Return the times (m,) at which a curve (`spline` of k columns) comes nearest to points (m, k)."""
    times = np.linspace(start, end, samples)
    distance = np.sum((curve(times)[:, None, :] - points[None]) ** 2, axis=2)
    t: np.ndarray = times[np.argmin(distance, axis=0)]
    slope, bend = curve.derivative(1), curve.derivative(2)
    width = times[1] - times[0]
    for _ in range(6):  # Newton's method, within the samples beside the nearest one
        gap, speed = curve(t) - points, slope(t)
        rate = np.sum(speed * speed + gap * bend(t), axis=1)
        steep = np.sum(speed * speed, axis=1)
        # Far from the curve the step follows from the speed alone.
        step = np.sum(gap * speed, axis=1) / np.maximum(np.where(rate > 0.1 * steep, rate, steep), 1e-300)
        t = np.clip(t - np.clip(step, -width, width), start, end)
    return t
