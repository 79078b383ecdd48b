"""The start of a forward run: an assembled position and independent equations."""

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from ...errors import AnalysisError, Fault
from ...kernels.constrained.accelerations import choose_order, evaluate_jacobian
from ...kernels.constrained.mass_matrix import mass_times
from ...kernels.constrained.projection import project_position
from ...kernels.constrained.system import NO_INERTIA
from ...model.by_size import by_size
from ...model.equations import DEPENDENT, Equation
from ...model.joint_elements import JointRate
from ...model.joints import ANGLE
from ...model.mechanism import Joint
from ...model.vectors import rotation_matrix
from ..singular.mobility import NAMED, Mobility, involved, sparse_basis
from ..singular.overconstrained_loops import choose_far_apart
from .large_start import order_of_many
from .system import dense_jacobian

if TYPE_CHECKING:
    from .analysis import ConstrainedMotion


def order_of_elimination(analysis: "ConstrainedMotion", q: np.ndarray, t: float) -> Mobility:
    """Choose the independent equations at q (n + b,), and which repeat others.

    Improves q to round-off on the way, unless the mechanism is large.
    """
    if analysis.starts_sparse:
        return order_of_many(analysis, q)
    system, work, arrays = analysis.system, analysis.work, analysis.arrays
    evaluate_jacobian(system, work, q)
    left, values, right = np.linalg.svd(dense_jacobian(work))
    rank = int(np.sum(values > analysis.dependent * values[0])) if values.size else 0
    found = (choose_far_apart if analysis.dependent > DEPENDENT else choose_order)(work, rank)
    if project_position(system, work, q, t, analysis.integration.angles[2]) == NO_INERTIA:
        raise inertia_failure(analysis, t)
    names = arrays.equations
    dependencies, _ = sparse_basis(left[:, rank:].T)
    groups = [tuple(names[k] for k in involved(row)) for row in dependencies]
    motions, pivots = sparse_basis(right[rank:])
    return Mobility(
        equations=len(names),
        coordinates=arrays.speeds,
        rank=found,
        smallest=float(values[-1] / values[0]) if values.size else 1.0,
        redundant=tuple(group for group in groups if not _of_one_attitude(group)),
        free=tuple(tuple(arrays.speed_name(k) for k in involved(row)) for row in motions),
        motions=motions,
        pivots=pivots,
    )


def _of_one_attitude(group: tuple[Equation, ...]) -> bool:
    """Return whether a dependency is that of one body's Euler parameters, which is no redundancy."""
    parts = {equation.part for equation in group}
    return "e0" in parts and parts <= {"e0", "e1", "e2", "e3"}


def inertia_failure(analysis: "ConstrainedMotion", t: float) -> AnalysisError:
    """Some motion that the constraints leave free has no mass or inertia to resist it."""
    work, scale = analysis.work, analysis.arrays.speed_scale
    free = work.motions.shape[0] - int(work.rank[0])
    Z = work.motions[:, :free] * scale[:, None]
    MZ = np.empty_like(Z)
    for k in range(free):
        product = np.empty(len(Z))
        mass_times(analysis.system, work, Z[:, k].copy(), product)
        MZ[:, k] = product
    values, vectors = np.linalg.eigh(Z.T @ MZ)
    bodies = analysis.arrays.bodies
    motion = (Z @ vectors[:, 0])[: 6 * bodies].reshape(bodies, 6)
    size = np.max(np.abs(motion), axis=1)
    names = [analysis.arrays.body_names[b] for b in by_size(size) if size[b] > NAMED * size.max()]
    message = (
        f"at t = {t:.6g} s {', '.join(names[:3])} can move without any mass or inertia resisting "
        f"(smallest inertia {values[0]:.3g}); give masses and inertias to what can move"
    )
    return AnalysisError(Fault("error", message, id="SOLVE-007"), t)


def rate_equations(
    joints: Sequence[Joint], rates: tuple[JointRate, ...], q: np.ndarray, speeds: int
) -> tuple[np.ndarray, np.ndarray, tuple[Equation, ...]]:
    """Rows (r, n) on speeds, right-hand sides (r,) and names of the joint rates that a deck gives at q.

    For axes in line: the rate of the angle is s · (ω_j - ω_i), that of the stroke s · (v_Pj - v_Pi).
    """
    rows = np.zeros((len(rates), speeds))
    for row, item in zip(rows, rates, strict=True):
        joint = joints[item.joint]
        s_i = np.array(joint.s_i) / np.linalg.norm(joint.s_i)
        A_i, A_j = (_attitude(q, body) for body in (joint.i, joint.j))
        s = A_i @ s_i
        for body, A, P, sign in ((joint.i, A_i, joint.P_i, -1.0), (joint.j, A_j, joint.P_j, 1.0)):
            if body < 0:
                continue
            along, at = A.T @ s, 6 * body
            if item.coordinate == ANGLE:
                row[at + 3 : at + 6] += sign * along
            else:
                row[at : at + 3] += sign * s
                row[at + 3 : at + 6] += sign * np.cross(P, along)
    names = tuple(Equation(item.name, f"rate of the {item.coordinate}", item.place, 1.0) for item in rates)
    return rows, np.array([item.rate for item in rates]), names


def _attitude(q: np.ndarray, body: int) -> Any:
    """Rotation matrix of a body at q; the ground's is 1."""
    return rotation_matrix(q[7 * body + 3 : 7 * body + 7]) if body >= 0 else np.eye(3)
