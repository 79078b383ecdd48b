"""Contact of two shapes: normal force, friction, rolling resistance, and energy, and their slopes.

Normal force: Hunt and Crossley, Journal of Applied Mechanics 42 (1975), pages 440-445: at the depth d > 0
that grows at the rate d', N = k d^n max(0, 1 + b d').  Friction: that of `laws`, by this normal force and the
sliding speed at the place of contact.

Record fields are those of `model.arrays.contacts`, numbers of the law those of `model.laws.CONTACT`.
"""

import math
from typing import TYPE_CHECKING

import numpy as np

from ._jit import kernel
from .bristles import answer_bristles, let_go, stribeck_friction
from .contact_shapes import Axes, across, nearest, outward
from .laws import SMALL
from .linalg.vec3 import cross, dot, minus, plus, scaled, store, triple

if TYPE_CHECKING:
    from ..model.arrays.contacts import Contacts
    from ..model.arrays.signals import Signals

Triple = tuple[float, float, float]
CONTACT = 6  # code of the law; a test compares it with model.laws
# Numbers of the law.
RIGIDITY, EXPONENT, LOSS, MU, MU_STATIC, MU_STRIBECK, MU_CREEP, ROLLING, TORSION = 0, 1, 2, 3, 4, 5, 6, 7, 8
BENDING, BENDING_LOSS = 9, 10
# Columns of the answers of systems with contacts, besides those of `laws`: force on body j, N, and place, m,
# both in global axes; number of touches, time of the last change, s.
PUSH, PLACE, TOUCHES, CHANGED = 8, 11, 14, 15
CONTACT_COLUMNS = 16
# States: the gap decides in each evaluation; apart or touching until an event.
BY_GAP, SEPARATE, TOUCHING = 0, 1, 2


@kernel
def answer_touch(
    c: np.ndarray, touch: np.void, contacts: "Contacts", signals: "Signals", i: np.void, j: np.void
) -> None:
    """Fill what kernels fill of a TOUCH between placed END records by the numbers c (11,) of a law."""
    axes_i = triple(i["axes"], 0), triple(i["axes"], 3), triple(i["axes"], 6)
    axes_j = triple(j["axes"], 0), triple(j["axes"], 3), triple(j["axes"], 6)
    w_i, w_j = triple(i["angular"], 0), triple(j["angular"], 0)
    d = minus(triple(j["position"], 0), triple(i["position"], 0))
    offset = outward(axes_j, triple(touch["offset_j"], 0))
    gap, n, arm = nearest(touch, contacts, plus(d, offset), axes_i, axes_j)
    arm_j = plus(offset, plus(arm, scaled(-touch["radius_j"] - 0.5 * gap, n)))
    arm_i = plus(d, arm_j)
    v = minus(triple(j["velocity"], 0), triple(i["velocity"], 0))
    slip = minus(plus(v, cross(w_j, arm_j)), cross(w_i, arm_i))
    rate = dot(n, slip)
    touch["gap"], touch["rate"] = gap, rate
    N = _normal_force(c, touch)
    store(arm_i, touch["arm_i"], 0)
    store(arm_j, touch["arm_j"], 0)
    store(n, touch["normal"], 0)
    if N != 0.0:
        v = minus(slip, scaled(rate, n))
        if touch["bristle"] >= 0:
            power = _bend_bristles(c, touch, signals, n, v, axes_i)
        else:
            power = _rub(c, touch, n, v)
        if c[ROLLING] > 0.0 or c[TORSION] > 0.0:
            power += _resist_turns(c, touch, n, minus(w_j, w_i))
        touch["power"] += power
    elif touch["bristle"] >= 0:
        let_go(signals, touch["bristle"], c[BENDING], c[BENDING_LOSS])


@kernel
def _normal_force(c: np.ndarray, touch: np.void) -> float:
    """Fill normal force, power, energy and slopes of a touch by its gap and rate; returns the force."""
    depth, n = max(-touch["gap"], 0.0), c[EXPONENT]
    touch["effort"] = touch["power"] = touch["energy"] = touch["stiffness"] = touch["damping"] = 0.0
    if depth == 0.0 or touch["state"] == SEPARATE:
        return 0.0
    spring = c[RIGIDITY] * depth**n
    share = max(0.0, 1.0 - c[LOSS] * touch["rate"])
    N = spring * share
    touch["stiffness"], touch["damping"] = (
        n * spring / depth * share,
        spring * c[LOSS] if share > 0.0 else 0.0,
    )
    touch["energy"] = spring * depth / (n + 1.0)
    touch["effort"], touch["power"] = N, (N - spring) * touch["rate"]
    return N


@kernel
def _rub(c: np.ndarray, touch: np.void, n: Triple, slip: Triple) -> float:
    """Fill what friction adds per unit of the normal force; return its power."""
    N, v = touch["effort"], math.sqrt(dot(slip, slip))
    share, slope = contact_friction(c, v)
    store(minus(n, scaled(share, slip)), touch["push"], 0)
    along = scaled(1.0 / v, slip) if v > SMALL * c[MU_CREEP] else across(n)
    store(along, touch["along"], 0)
    touch["slope_along"], touch["slope_across"] = N * max(slope, 0.0), N * share
    return -N * share * v * v


@kernel
def _bend_bristles(
    c: np.ndarray, touch: np.void, signals: "Signals", n: Triple, slip: Triple, axes: Axes
) -> float:
    """The same by bristles on body i, whose axes are at hand; only what lies across the normal pushes."""
    N, v = touch["effort"], math.sqrt(dot(slip, slip))
    mu = stribeck_friction(c[MU], max(c[MU_STATIC], c[MU]), c[MU_STRIBECK], v)
    own = dot(axes[0], slip), dot(axes[1], slip), dot(axes[2], slip)
    bent, share = answer_bristles(signals, touch["bristle"], 3, c[BENDING], c[BENDING_LOSS], mu, own)
    force = outward(axes, bent)
    force = minus(force, scaled(dot(n, force), n))
    store(plus(n, force), touch["push"], 0)
    store(scaled(1.0 / v, slip) if v > 0.0 else across(n), touch["along"], 0)
    touch["hold"] = N * c[BENDING] * share
    touch["slope_along"] = touch["slope_across"] = N * c[BENDING_LOSS] * share
    return N * dot(force, slip)


@kernel
def _resist_turns(c: np.ndarray, touch: np.void, n: Triple, w: Triple) -> float:
    """Fill the torque against rolling and drilling per unit of the normal force; return its power."""
    creep = c[MU_CREEP] / (touch["radius_j"] if touch["radius_j"] > 0.0 else 1.0)
    rolling, drilling = minus(w, scaled(dot(n, w), n)), scaled(dot(n, w), n)
    roll = plus(_lever(c[ROLLING], rolling, creep), _lever(c[TORSION], drilling, creep))
    store(roll, touch["roll"], 0)
    return touch["effort"] * dot(roll, w)


@kernel
def _lever(lever: float, w: Triple, creep: float) -> Triple:
    """Return the torque per unit of the normal force against an angular velocity w."""
    speed = math.sqrt(dot(w, w))
    return scaled(-lever * (math.tanh(speed / creep) / speed if speed > SMALL * creep else 1.0 / creep), w)


@kernel
def contact_friction(c: np.ndarray, v: float):
    """μ(v)/v and dμ/dv at the sliding speed v >= 0 by the numbers c (11,) of a contact law."""
    more = max(c[MU_STATIC] - c[MU], 0.0)
    fade, rise = math.exp(-((v / c[MU_STRIBECK]) ** 2)), math.tanh(v / c[MU_CREEP])
    mu = c[MU] + more * fade
    slope = mu * (1.0 - rise * rise) / c[MU_CREEP] - 2.0 * more * fade * v / c[MU_STRIBECK] ** 2 * rise
    return (mu * rise / v if v > SMALL * c[MU_CREEP] else mu / c[MU_CREEP]), slope
