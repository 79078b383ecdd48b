"""Laws of time: polynomials, spin-up, sines and tables, with their first two derivatives.

The spin-up is that of Kane, Ryan and Banerjee (1987): from rest to the rate w over the time T.
"""

import math

import numpy as np

from ..errors import Place
from ..quick_dataclass import dataclass

POLYNOMIAL, SPIN_UP, SINE, TABLE, HELD_TABLE = 1, 2, 3, 4, 5


@dataclass(frozen=True)
class MotionLaw:
    """A law of `kind` with constants `c` (4,); SI units.

    1: c0 + c1 t + c2 t² + c3 t³.  2: (w/T) (t²/2 + (T/2 pi)² (cos(2 pi t/T) - 1)) up to T = c1, then
    w (t - T/2), with w = c0.  3: c0 + c1 sin(c2 t + c3).  4: the natural cubic spline through the points
    (`times`, `values`), whose `curvature` (k,) is known at each; outside it goes on straight.  5: the same,
    which keeps its first and last value outside.
    """

    kind: int
    c: tuple[float, float, float, float] = (0.0, 0.0, 0.0, 0.0)
    times: tuple[float, ...] = ()
    values: tuple[float, ...] = ()
    curvature: tuple[float, ...] = ()

    def at(self, t: float) -> tuple[float, float, float]:
        """Value and its first and second derivative at time `t`, s."""
        laws = {POLYNOMIAL: _polynomial, SPIN_UP: _spin_up, SINE: _sine, TABLE: _spline, HELD_TABLE: _held}
        return laws[self.kind](self, t)

    @property
    def of_factor(self) -> "MotionLaw":
        """A table as the factor of a load: linear between its points, constant outside.

        A spline would swing beyond the values given, and pull before a pulse begins.
        """
        return MotionLaw(HELD_TABLE, self.c, self.times, self.values, (0.0,) * len(self.times))


def table_law(times, values) -> MotionLaw:
    """The law through at least two points, times ascending."""
    t, f = np.asarray(times, float), np.asarray(values, float)
    curvature = _natural_curvature(np.diff(t).tolist(), (np.diff(f) / np.diff(t)).tolist())
    return MotionLaw(
        TABLE, times=tuple(map(float, t)), values=tuple(map(float, f)), curvature=tuple(curvature)
    )


def _natural_curvature(h, slopes):
    """Second derivatives at the points, 0 at the ends, from the lengths (k-1) and slopes of the pieces.

    Three diagonals, the middle one larger than the others together: eliminated without pivots.  A full
    matrix would take 8 k² bytes.
    """
    inner = range(1, len(h))
    ahead, reduced = [0.0], [0.0]
    for i in inner:
        pivot = 2 * (h[i - 1] + h[i]) - h[i - 1] * ahead[-1]
        ahead.append(h[i] / pivot)
        reduced.append((6 * (slopes[i] - slopes[i - 1]) - h[i - 1] * reduced[-1]) / pivot)
    curvature = [0.0]
    for i in reversed(inner):
        curvature.append(reduced[i] - ahead[i] * curvature[-1])
    return [0.0, *curvature[:0:-1], 0.0]


def _polynomial(law, t):
    c0, c1, c2, c3 = law.c
    return c0 + t * (c1 + t * (c2 + t * c3)), c1 + t * (2 * c2 + 3 * t * c3), 2 * c2 + 6 * t * c3


def _spin_up(law, t):
    w, T = law.c[:2]
    if t >= T:
        return w * (t - T / 2), w, 0.0
    turn = math.tau * t / T
    value = w / T * (t * t / 2 + (T / math.tau) ** 2 * (math.cos(turn) - 1))
    return value, w / T * (t - T / math.tau * math.sin(turn)), w / T * (1 - math.cos(turn))


def _sine(law, t):
    c0, c1, c2, c3 = law.c
    phase = c2 * t + c3
    return c0 + c1 * math.sin(phase), c1 * c2 * math.cos(phase), -c1 * c2 * c2 * math.sin(phase)


def _spline(law, t):
    times, f, g = law.times, law.values, law.curvature
    inside = min(max(t, times[0]), times[-1])
    k = min(max(int(np.searchsorted(times, inside, side="right")) - 1, 0), len(times) - 2)
    h = times[k + 1] - times[k]
    a, b = (times[k + 1] - inside) / h, (inside - times[k]) / h
    value = a * f[k] + b * f[k + 1] + ((a**3 - a) * g[k] + (b**3 - b) * g[k + 1]) * h * h / 6
    rate = (f[k + 1] - f[k]) / h + ((3 * b * b - 1) * g[k + 1] - (3 * a * a - 1) * g[k]) * h / 6
    if inside != t:
        return value + rate * (t - inside), rate, 0.0
    return value, rate, a * g[k] + b * g[k + 1]


def _held(law, t):
    if law.times[0] <= t <= law.times[-1]:
        return _spline(law, t)
    return law.values[0 if t < law.times[0] else -1], 0.0, 0.0


@dataclass(frozen=True)
class Motion:
    """What a law prescribes: a coordinate of a body (`kind` TRAX ... ROTZ), or of a joint (ANGL, STRK)."""

    name: str
    kind: str
    target: int
    law: MotionLaw
    place: Place | None = None
