"""Gaps of joints at the positions of a VSDF deck, and the displacements that close them."""

import math
from typing import TYPE_CHECKING, Any

import numpy as np

from ...errors import Fault
from ...model.flexible_mechanism import FlexibleMechanism
from ..singular.mobility import about, worst_gaps
from .position import PositionGaps

if TYPE_CHECKING:
    from collections.abc import Iterator

    from ...model.arrays.system import SystemArrays
    from ...model.equations import Equation


APART = 1e-2  # of the mechanism's size; of unit vectors
DEFORMED = 1e-6  # of the length scale: more than round-off
LOST_ANGLE = 1e-7  # an angle below it is lost in its cosine


def gap_warnings(mechanism: FlexibleMechanism, gaps: PositionGaps, q: np.ndarray, t: float) -> list[Fault]:
    """Warnings where assembly moved bodies far, or deformed them; q (n + b,) meets all equations."""
    return [*_apart(mechanism, gaps, q, t), *_deformed(mechanism, gaps.arrays, q)]


def _apart(mechanism: FlexibleMechanism, gaps: Any, q: np.ndarray, t: float) -> "Iterator[Fault]":
    arrays = gaps.arrays
    scaled = gaps.residual(arrays.q, t, arrays.angles)
    limits = _limits(mechanism, arrays.equations)
    worst = worst_gaps(gaps, np.where(np.abs(scaled) * arrays.row_scale > limits, scaled, 0.0))
    if not worst:
        return
    message = (
        "where POSI and EULP put the bodies, more than a hundredth of the mechanism's size is open at "
        f"{'; '.join(gap.text for gap in worst)}; to close it {_moved(arrays, q)}: correct positions or "
        "nodes if that is not meant"
    )
    yield about("warning", message, *(gap.equation for gap in worst))


def _limits(mechanism: FlexibleMechanism, equations: "tuple[Equation, ...]") -> np.ndarray:
    """Residuals from which gaps are reported, m or 1; inf for motions that say where the mechanism begins."""
    prescribed = {item.name for item in mechanism.motions if item.of_joint}
    length = APART * _size(mechanism)
    return np.array(
        [
            math.inf if equation.owner in prescribed else length if equation.is_length else APART
            for equation in equations
        ]
    )


def _size(mechanism: FlexibleMechanism) -> float:
    """The largest distance of a joint or node of a body from its origin, m."""
    points = [p for joint in mechanism.joints for p in (*joint.a, *joint.b)]
    points += [pin.point for pin in mechanism.pins]
    sizes = [float(np.abs(p.r0).max()) for p in points if p.body >= 0]
    sizes += [float(np.abs(body.flexible.r0).max()) for body in mechanism.bodies if body.flexible]
    return max(sizes, default=0.0) or 1.0


def _moved(arrays: "SystemArrays", q: np.ndarray) -> str:
    """The body that was moved most, in words."""
    size = 7 * arrays.bodies
    before, after = (x[:size].reshape(-1, 7) for x in (arrays.q, q))
    way = np.linalg.norm(after[:, :3] - before[:, :3], axis=1)
    turn = 2.0 * np.arccos(np.clip(np.abs(np.sum(after[:, 3:] * before[:, 3:], axis=1)), 0.0, 1.0))
    scale = arrays.coordinate_scale[0]
    k = int(np.argmax(way / scale + turn))
    metres, radians = (x if x > LOST_ANGLE * unit else 0.0 for x, unit in ((way[k], scale), (turn[k], 1.0)))
    return f"{arrays.body_names[k]} is moved by {metres:.3g} m and turned by {radians:.3g} rad"


def _deformed(mechanism: FlexibleMechanism, arrays: "SystemArrays", q: np.ndarray) -> "Iterator[Fault]":
    """Bodies that could be joined by bending them only."""
    first, length = 7 * arrays.bodies, arrays.coordinate_scale[0] if arrays.bodies else 1.0
    for body in mechanism.bodies:
        own = slice(first, first + body.modes)
        first += body.modes
        most = float(np.max(np.abs(q[own]) / arrays.coordinate_scale[own], initial=0.0))
        if most > DEFORMED:
            message = (
                f"it is bent by up to {most * length:.2g} m at the start, strains and all, since its joints "
                "cannot meet otherwise; correct positions or nodes if that is not meant"
            )
            yield Fault("warning", message, body.place, body.name, id="SOLVE-005")
