"""The first position of a mechanism, and warnings where assembly moved bodies far.

It is found by rigid motion, by deformation of flexible bodies if it must.
"""

import math
from collections.abc import Iterator

import numpy as np

from ...errors import Fault
from ...kernels.constrained.speeds import normalise
from ...model.arrays.system import SystemArrays
from ...model.flexible_mechanism import FlexibleMechanism
from ...model.joint_elements import CompositeJoint
from ...model.joints import DEPENDENT, Equation
from ...model.loads import DynamicModel
from ...model.mechanism import Joint
from ..assembly import Sized, displacements, is_closed, nearest_of
from ..kinematics.assembly import assembly_failure
from ..projection import Corrections, Instant, Position, largest, project, shortened
from ..singular.mobility import about, worst_gaps
from ..singular.overconstrained_loops import NearlyClosed, gap_error, nearly_closed
from .system import PositionGaps

OTHER_ASSEMBLY = 0.5  # of the size, or rad: a body moved more is in another one
SHORTEST = Corrections(met=1e-14, most=60, dependent=DEPENDENT)


def assemble(
    gaps: PositionGaps, t: float, tolerance: float, start: np.ndarray, *, estimates: bool = False
) -> tuple[np.ndarray, NearlyClosed | None]:
    """Return coordinates (n + b,) near those of `start` that meet the equations; raises AnalysisError.

    And what overconstrained loops leave, at most `tolerance`, where they close only nearly.  Bodies stay
    undeformed where their joints allow it.  `estimates`: the deck's positions are estimates.
    """
    arrays, q = gaps.arrays, start.copy()
    normalise(arrays.bodies, q)
    if not len(arrays.equations):
        return q, None
    instant, rigid = Instant(gaps, t, arrays.angles), np.arange(arrays.speeds) < 6 * arrays.bodies
    sized = Sized(instant, gaps, q, arrays.bodies)
    nearest = project(instant, q, SHORTEST, shortened, rigid)
    if is_closed(nearest[1]) and sized.is_near(q, nearest[0]):
        return nearest[0], None
    loose = nearly_closed(gaps, instant, sized, q, rigid, near=True)
    is_loose = loose is not None and loose.size <= tolerance
    for columns in (rigid, np.ones_like(rigid))[: 0 if is_loose else 1 + (not rigid.all())]:
        tried = _closest(sized, instant, q, columns)
        # Far away there may be positions where loops that nearly close here close, but cannot move.
        if is_closed(tried[1]) and (loose is None or sized.is_near(q, tried[0], OTHER_ASSEMBLY)):
            return tried[0], None
        nearest = min(nearest, tried, key=lambda one: largest(one[1]))
    loose = loose or nearly_closed(gaps, instant, sized, q, rigid, near=False)
    if loose and loose.size <= tolerance:
        return loose.q, loose
    if loose:
        raise gap_error(gaps, loose, t, tolerance)
    raise assembly_failure(gaps, nearest[1], t, estimates=(arrays.q, arrays.angles) if estimates else None)


def _closest(sized: Sized, instant: Instant, q: np.ndarray, columns: np.ndarray) -> Position:
    """Return the position near q (n + b,) that meets the equations best by changes of `columns` (n,)."""

    def finish(q: np.ndarray) -> Position:
        return project(instant, q, SHORTEST, shortened, None if columns.all() else columns)

    found = finish(q)
    if is_closed(found[1]) and sized.is_near(q, found[0]):
        return found
    return nearest_of(sized, q, finish, columns)


APART = 1e-2  # of the mechanism's size; of unit vectors
FAR_APART = 0.1  # the same of body estimates, which need not be exact
DEFORMED = 1e-6  # of the length scale: more than round-off
LOST_ANGLE = 1e-7  # an angle below it is lost in its cosine


def gap_warnings(mechanism: FlexibleMechanism, gaps: PositionGaps, q: np.ndarray, t: float) -> list[Fault]:
    """Warnings where assembly moved bodies far, or deformed them; q (n + b,) meets all equations."""
    limits = _limits(mechanism, gaps.arrays.equations)
    what = "where POSI and EULP put the bodies, more than a hundredth", "positions or nodes"
    links = {item.name: item.size for item in mechanism.joints}
    return [*_apart(gaps, q, t, limits, links, what), *_deformed(mechanism, gaps.arrays, q)]


def estimate_warnings(model: DynamicModel, gaps: PositionGaps, q: np.ndarray, t: float) -> list[Fault]:
    """Warnings where assembly moved bodies far from their estimates; q (n + b,) meets all equations."""
    composites = model.elements.composites
    joints: tuple[Joint | CompositeJoint, ...] = (*model.mechanism.joints, *composites)
    size = max((abs(x) for joint in joints for P in (joint.P_i, joint.P_j) for x in P), default=0.0)
    size = max([size, *(item.size for item in composites)]) or 1.0
    # Drivers and simplified constraints say where the mechanism begins.
    names = {joint.name for joint in joints}
    lengths = FAR_APART * np.where([item.is_length for item in gaps.arrays.equations], size, 1.0)
    limits = np.where([item.owner in names for item in gaps.arrays.equations], lengths, math.inf)
    what = "at the body estimates more than a tenth", "the estimates or the points of these joints"
    links = {item.name: item.size for item in composites}
    return list(_apart(gaps, q, t, limits, links, what))


def _apart(
    gaps: PositionGaps,
    q: np.ndarray,
    t: float,
    limits: np.ndarray,
    links: dict[str, float],
    what: tuple[str, str],
) -> Iterator[Fault]:
    """A warning where a residual at the deck's positions is above its limit; `links`: lengths of links, m."""
    arrays = gaps.arrays
    residual = gaps.residual(arrays.q, t, arrays.angles) * arrays.row_scale
    for k, equation in enumerate(arrays.equations):
        if equation.part == "distance" and (length := links.get(equation.owner, 0.0)):
            # (d² - L²)/(2 L) is the gap of nearly closed links only.
            residual[k] = math.sqrt(max(0.0, length * (length + 2.0 * residual[k]))) - length
    worst = worst_gaps(gaps.arrays, np.where(np.abs(residual) > limits, residual / arrays.row_scale, 0.0))
    if not worst:
        return
    where, remedy = what
    if any("h_i" in gap.equation.part for gap in worst):
        remedy = f"{remedy} (h_i and h_j of a translational joint stand at right angles)"
    message = (
        f"{where} of the mechanism's size is open at "
        f"{'; '.join(gap.text for gap in worst)}; to close it {_moved(arrays, q)}: correct {remedy} "
        "if that is not meant"
    )
    yield about("warning", message, *(gap.equation for gap in worst), id="SOLVE-049")


def _limits(mechanism: FlexibleMechanism, equations: tuple[Equation, ...]) -> np.ndarray:
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


def _moved(arrays: SystemArrays, q: np.ndarray) -> str:
    """The body that was moved most, in words."""
    way, turn = displacements(arrays.q, q, arrays.bodies)
    scale = arrays.coordinate_scale[0]
    k = int(np.argmax(way / scale + turn))
    metres, radians = (x if x > LOST_ANGLE * unit else 0.0 for x, unit in ((way[k], scale), (turn[k], 1.0)))
    return f"{arrays.body_names[k]} is moved by {metres:.3g} m and turned by {radians:.3g} rad"


def _deformed(mechanism: FlexibleMechanism, arrays: SystemArrays, q: np.ndarray) -> Iterator[Fault]:
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
