"""Judges rows by themselves: what moves advances by what its rates and their rates say.

Where the rows show the motion, that is where second differences of accelerations are smaller than first ones:
about rate of oscillation times step.  Medians tell it, so that a spoilt row does not hide itself.
"""

import numpy as np

from .rows import ROUND_OFF, Verdict

RESOLVED = 0.5
LEAST_ROWS = 7
MOVING = (
    ("body/position", "body/velocity", "body/acceleration"),
    ("body/euler_parameters", "body/euler_parameter_rates", "body/euler_parameter_accelerations"),
    ("point/position", "point/velocity", "point/acceleration"),
    ("coordinate/u", "coordinate/u_rate"),
)


def judge_rates(result, smooth: bool = True, coarse: bool = False) -> bool:
    """Return whether any moving quantity shows its motion; raise Verdict where its rates contradict it.

    With `coarse` steps, that leave out the highest modes, accelerations are not those of the rows: places are
    compared with velocities alone.  Without `smooth`, stops and cables of the deck give its accelerations
    corners, which lie between rows.
    """
    time, moving = result["time"], False
    if len(time) < LEAST_ROWS or _turns_unseen(result, time):
        return False
    # A step of generalised-alpha is itself off by as much as rows can show.
    exact = smooth and result.attributes["dialect"] != "vsdf"
    for names in MOVING:
        if all(name in result for name in names):
            if coarse:
                moving |= _places_alone(result, names, time)
                continue
            *_, rate, second = (result[name].reshape(len(time), -1) for name in names)
            shown = _shown(second)
            moving |= bool((shown & (np.ptp(second, axis=0) > 0)).any())
            if len(names) == 3:
                place = result[names[0]].reshape(len(time), -1)
                _same(names[0], _by_hermite(time, place, rate, second, exact), shown)
            _same(names[-2], _by_simpson(time, rate, second, exact), shown)
    return moving


def _turns_unseen(result, time):
    """Return whether a body turns by more than half a turn between rows: they may then show a slow motion."""
    if "body/angular_velocity" not in result:
        return False
    return np.linalg.norm(result["body/angular_velocity"], axis=-1).max() * np.diff(time).max() > np.pi


def _places_alone(result, names, time):
    """Compare Δx with h (v0 + v1) / 2, which is off by h² a' / 12; return whether rows show it."""
    if len(names) < 3:
        return False
    place, rate = (result[name].reshape(len(time), -1) for name in names[:2])
    once = np.abs(np.diff(rate, axis=0))
    shown = np.median(once, axis=0) <= RESOLVED * np.median(np.abs(rate), axis=0)
    h = np.diff(time)[:, None]
    gap = np.diff(place, axis=0) - h * (rate[1:] + rate[:-1]) / 2
    _same(names[0], (gap, h * once.max(axis=0) + ROUND_OFF * (1 + np.abs(place).max())), shown)
    return bool((shown & (np.ptp(place, axis=0) > 0)).any())


def _shown(second):
    once, twice = (np.median(np.abs(np.diff(second, n=n, axis=0)), axis=0) for n in (1, 2))
    return twice <= RESOLVED * once


def _by_hermite(time, place, rate, second, exact):
    """Gap and allowed gap of Δx = h (v0 + v1) / 2 + h² (a0 - a1) / 12, off by h⁵/720 of the fifth rate."""
    h, bend = np.diff(time)[:, None], np.abs(np.diff(second, axis=0))
    gap = np.diff(place, axis=0) - h * (rate[1:] + rate[:-1]) / 2 + h**2 * np.diff(second, axis=0) / 12
    return gap, (0.01 if exact else 1.0) * h**2 * bend.max(axis=0) + ROUND_OFF * (1 + np.abs(place).max())


def _by_simpson(time, rate, second, exact):
    """The same of v2 - v0 = h (a0 + 4 a1 + a2) / 3, off by h⁵/90 of the fifth rate."""
    h = np.diff(time)[:-1, None]
    gap = rate[2:] - rate[:-2] - h * (second[:-2] + 4 * second[1:-1] + second[2:]) / 3
    once, twice = (np.abs(np.diff(second, n=n, axis=0)).max(axis=0) for n in (1, 2))
    return gap, h * (0.1 * twice if exact else once) + ROUND_OFF * (1 + np.abs(rate).max())


def _same(name, reported, shown):
    gap, allowed = reported
    bad = shown & (np.abs(gap) > allowed)
    # A spin-up may be over within the first step: no row shows its acceleration.
    bad[0] = False
    if bad.any():
        k, column = np.argwhere(bad)[0]
        raise Verdict(f"{name} against its rates: {gap[k, column]:.3g} at row {k}, number {column}")
