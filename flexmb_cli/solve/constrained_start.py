"""The start of a forward run: an assembled position, independent equations, speeds that fit the joints."""

import numpy as np

from ..errors import AnalysisError, Fault, ModelError
from ..kernels.constrained_solve import choose_order, evaluate_jacobian
from ..kernels.constrained_system import GAMMA, NO_INERTIA
from ..kernels.constraint_projection import fill_nu, project_position
from ..kernels.mass_matrix import inertia_of, mass_times
from ..kernels.speeds import move, normalise
from .assembly import assemble_by_search, assembly_failure
from .diagnosis import CLOSED, NAMED, Mobility, about, involved, sparse_basis
from .dynamic_rows import body_axes, global_axes

SINGULAR_VALUE = 1e-9  # of the largest
MOST_STEPS = 60
MET = 1e-14  # scaled gaps
HOPELESS = 1e6
FITS = 1e-6  # of the largest speed: what initial velocities may be changed without a warning


def assembled(analysis, t: float) -> np.ndarray:
    """Coordinates that meet all equations, near the deck's estimates; raises AnalysisError.

    The nearest position first; where that leaves a gap, whole Newton steps from the estimates, which may
    widen gaps on their way to a position that closes.
    """
    arrays = analysis.arrays.kinematic
    q, near = arrays.q.copy(), arrays.screw_angles
    normalise(analysis.arrays.bodies, q)
    if not len(arrays.equations):
        return q
    found, gap = assemble_by_search(analysis.evaluator, q, t, near)
    for start in (found, q):
        closed = _by_newton(analysis, start.copy(), t, near)
        if closed is not None:
            return closed
    raise assembly_failure(analysis.evaluator, gap, t)


def _by_newton(analysis, q, t, near):
    """The position after whole Newton steps, the shortest ones, or None when they do not close all gaps."""
    bodies, evaluator = analysis.arrays.bodies, analysis.evaluator
    normalise(bodies, q)
    for _ in range(MOST_STEPS):
        gap = evaluator.residual(q, t, near)
        largest = np.max(np.abs(gap))
        if largest <= MET or not largest < HOPELESS:
            break
        evaluate_jacobian(analysis.system, analysis.work, q)
        step = np.linalg.lstsq(analysis.work.jacobian, gap, rcond=SINGULAR_VALUE)[0]
        move(bodies, q, -step * analysis.arrays.speed_scale)
    return q if np.max(np.abs(evaluator.residual(q, t, near))) <= CLOSED else None


def order_of_elimination(analysis, q, t: float) -> Mobility:
    """Choose the independent equations at q, and tell which repeat others.

    Improves q to round-off on the way.
    """
    system, work, arrays = analysis.system, analysis.work, analysis.arrays
    evaluate_jacobian(system, work, q)
    left, values, right = np.linalg.svd(work.jacobian)
    rank = int(np.sum(values > SINGULAR_VALUE * values[0])) if values.size else 0
    found = choose_order(work, rank)
    if project_position(system, work, q, t, analysis.march.turns[2]) == NO_INERTIA:
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


def _of_one_attitude(group):
    """Whether a dependency is that of the four Euler parameters of one body, which is no redundancy."""
    parts = {equation.part for equation in group}
    return "e0" in parts and parts <= {"e0", "e1", "e2", "e3"}


def start_speeds(analysis, q, t: float) -> np.ndarray:
    """Speeds (n,) that fit the constraints: those given as nearly as can be, the others smallest.

    Raises ModelError when the drivers ask for speeds that the joints forbid.
    """
    system, work, scale = analysis.system, analysis.work, analysis.arrays.speed_scale
    evaluate_jacobian(system, work, q)
    J = work.jacobian.copy()
    nu = work.rows[GAMMA]
    fill_nu(system, t, nu)
    nu = nu / analysis.arrays.row_scale
    particular = np.linalg.lstsq(J, nu, rcond=SINGULAR_VALUE)[0] if len(nu) else np.zeros(scale.size)
    _refuse_contradiction(analysis, J @ particular - nu, t)
    given, wanted = analysis.given_speeds(q)
    motions = np.linalg.svd(J)[2][work.rank[0] :].T
    rest = (wanted / scale - particular)[given]
    free = np.linalg.lstsq(motions[given], rest, rcond=1e-12)[0]
    u = (particular + motions @ free) * scale
    _doubt_change(analysis, u, wanted, given)
    return u


def given_speeds(velocities, bodies: int, q):
    """Which of the speeds (6 bodies,) `velocities` give, and their values."""
    given, wanted = np.zeros((bodies, 6), dtype=bool), np.zeros((bodies, 6))
    p = q[: 7 * bodies].reshape(bodies, 7)[:, 3:]
    for item in velocities:
        given[item.body] = True
        wanted[item.body, :3] = item.velocity
        wanted[item.body, 3:] = body_axes(p[item.body], np.array(item.angular))
    return given.ravel(), wanted.ravel()


def _refuse_contradiction(analysis, rest, t):
    if rest.size and np.max(np.abs(rest)) > CLOSED:
        worst = analysis.arrays.equations[int(np.argmax(np.abs(rest)))]
        message = (
            f"at t = {t:.6g} s the drivers ask for velocities that the joints forbid ({worst.name}); "
            "remove a driver or free a joint"
        )
        raise ModelError([about("error", message, worst)])


def _doubt_change(analysis, u, wanted, given):
    scale = analysis.arrays.speed_scale
    change = np.abs(u - wanted) / scale * given
    largest = max(np.max(np.abs(u) / scale, initial=0.0), np.max(np.abs(wanted) / scale, initial=0.0))
    for item in analysis.velocities:
        own = slice(6 * item.body, 6 * item.body + 6)
        if np.max(change[own]) > FITS * max(largest, FITS):
            message = f"does not fit the joints and is changed to {_shown(analysis, u[own], item)}"
            analysis.warnings.append(Fault("warning", message, item.place, item.name))


def _shown(analysis, u, item):
    p = analysis.march.z[7 * item.body + 3 : 7 * item.body + 7]
    angular = u[3:] if analysis.turns_in_body_axes else global_axes(p, u[3:])
    return "velocity ({:.6g}, {:.6g}, {:.6g}) m/s, angular ({:.6g}, {:.6g}, {:.6g}) rad/s".format(
        *(u[:3] + 0.0), *(angular + 0.0)
    )


def inertia_failure(analysis, t: float) -> AnalysisError:
    """Some motion that the constraints leave free has no mass or inertia to resist it."""
    work, scale = analysis.work, analysis.arrays.speed_scale
    free = work.jacobian.shape[1] - int(work.rank[0])
    Z = work.motions[:, :free] * scale[:, None]
    MZ = np.empty_like(Z)
    for k in range(free):
        product = np.empty(len(Z))
        mass_times(inertia_of(analysis.system, work), Z[:, k].copy(), product)
        MZ[:, k] = product
    values, vectors = np.linalg.eigh(Z.T @ MZ)
    bodies = analysis.arrays.bodies
    motion = (Z @ vectors[:, 0])[: 6 * bodies].reshape(bodies, 6)
    size = np.max(np.abs(motion), axis=1)
    names = [analysis.arrays.body_names[b] for b in np.argsort(-size) if size[b] > NAMED * size.max()]
    message = (
        f"at t = {t:.6g} s {', '.join(names[:3])} can move without any mass or inertia resisting "
        f"(smallest inertia {values[0]:.3g}); give masses and inertias to what can move"
    )
    return AnalysisError(Fault("error", message), t)
