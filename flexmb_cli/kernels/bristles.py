"""Friction by bristles, which bend before anything slides, and hold what is pushed by less than friction.

Canudas de Wit, Olsson, Åström and Lischinsky, A New Model for Control of Systems with Friction, IEEE
Transactions on Automatic Control 40 (1995), pages 419-425, per unit of the normal force.  A bristle of the
stiffness s0 that bears the force x bends by x/s0; at the sliding speed v, with Stribeck's μ(v),

    dx/dt = s0 v - s0 |v|/μ(v) x,    F = -(x + s1/s0 dx/dt).

The forces x are states of the motion, with those of signals.  In a stage of an implicit method,
x = known + ahead dx/dt: as this is linear in x, x follows from the speeds of the stage.
"""

import math
from typing import TYPE_CHECKING

from ._jit import kernel
from .linalg.vec3 import dot

if TYPE_CHECKING:
    from ..model.arrays.signals import Signals

Triple = tuple[float, float, float]


@kernel
def stribeck_friction(dynamic: float, static: float, stribeck: float, v: float) -> float:
    """Return the coefficient of friction at the sliding speed v >= 0, m/s."""
    return dynamic + (static - dynamic) * math.exp(-((v / stribeck) ** 2))


@kernel
def answer_bristles(
    signals: "Signals", first: int, components: int, stiffness: float, damping: float, mu: float, slip: Triple
) -> tuple[Triple, float]:
    """Fill the rates of the bristles from state `first` on at the sliding speeds, m/s, and μ(v).

    Returns the forces on what slides per unit of the normal force, and the share of the speed that bends
    the bristles.  stiffness and damping: s0, 1/m, and s1, s/m.
    """
    v = math.sqrt(dot(slip, slip))
    decay = stiffness * v / mu
    lag = damping / stiffness
    x, dx = _bend(signals, first, stiffness * slip[0], decay)
    y, dy = _bend(signals, first + 1, stiffness * slip[1], decay)
    z, dz = 0.0, 0.0
    if components == 3:
        z, dz = _bend(signals, first + 2, stiffness * slip[2], decay)
    along = (x * slip[0] + y * slip[1] + z * slip[2]) / (mu * v) if v > 0.0 else 0.0
    return (-x - lag * dx, -y - lag * dy, -z - lag * dz), min(max(1.0 - along, 0.0), 1.0)


@kernel
def _bend(signals: "Signals", k: int, drive: float, decay: float) -> tuple[float, float]:
    """State k of a bristle, and its rate, which is filled."""
    x, ahead = signals.states[k], signals.ahead[0]
    if ahead > 0.0:
        x = (signals.known[k] + ahead * drive) / (1.0 + ahead * decay)
    signals.rates[k] = drive - decay * x
    return x, signals.rates[k]


@kernel
def let_go(signals: "Signals", first: int, stiffness: float, damping: float) -> None:
    """Fill the rates of three bristles that touch nothing: they spring back."""
    for k in range(first, first + 3):
        _bend(signals, k, 0.0, stiffness / damping)
