"""The start of a forward run: independent equations, and speeds that fit the constraints and the deck.

Of many bodies both are found by sparse matrices.
"""

import math
from collections.abc import Sequence
from dataclasses import replace
from typing import Any

import numpy as np

from ...errors import AnalysisError, Fault, ModelError
from ...kernels.constrained.accelerations import choose_order, evaluate_jacobian
from ...kernels.constrained.mass_matrix import mass_matrices, mass_times
from ...kernels.constrained.projection import fill_nu, project_position
from ...kernels.constrained.system import GAMMA, NO_INERTIA
from ...model.arrays.system import SystemArrays
from ...model.by_size import by_size
from ...model.joint_elements import JointStart
from ...model.joints import ANGLES_OF_CROSS, DEPENDENT, Equation
from ...model.laws import is_angle
from ...model.loads import InitialVelocity
from ...model.mechanism import Joint
from ...model.vectors import global_axes, rotation_matrix
from ..projection import RESIDUAL_MET, shortest_correction
from ..singular.mobility import NAMED, Mobility, about, dense_mobility
from ..singular.overconstrained_loops import choose_far_apart
from ..singular.sparse_rank import order_of_pivots, sparse_mobility
from .rows import body_axes
from .state import ConstrainedState
from .system import dense_jacobian, sparse_jacobian


def order_of_elimination(analysis: ConstrainedState, q: np.ndarray, t: float) -> Mobility:
    """Choose the independent equations at q (n + b,), and which repeat others.

    Improves q to round-off on the way; of a large mechanism it leaves q as it is, and no factors.
    """
    system, work, arrays = analysis.system, analysis.work, analysis.arrays
    evaluate_jacobian(system, work, q)
    if analysis.starts_sparse:
        J = sparse_jacobian(work)
        work.order[:], work.rank[0] = order_of_pivots(J)
        return sparse_mobility(J, work.order, int(work.rank[0]), arrays.equations, arrays.speed_name)
    mobility = dense_mobility(dense_jacobian(work), arrays.equations, arrays.speed_name, analysis.dependent)
    rank = (choose_far_apart if analysis.dependent > DEPENDENT else choose_order)(work, mobility.rank)
    if project_position(system, work, q, t, analysis.integration.angles[2]) == NO_INERTIA:
        raise inertia_failure(analysis, t)
    redundant = tuple(group for group in mobility.redundant if not _of_one_attitude(group))
    return replace(mobility, rank=rank, redundant=redundant)


def _of_one_attitude(group: tuple[Equation, ...]) -> bool:
    """Return whether a dependency is that of one body's Euler parameters, which is no redundancy."""
    parts = {equation.part for equation in group}
    return "e0" in parts and parts <= {"e0", "e1", "e2", "e3"}


def inertia_failure(analysis: ConstrainedState, t: float) -> AnalysisError:
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
    joints: Sequence[Joint], starts: tuple[JointStart, ...], q: np.ndarray, speeds: int
) -> tuple[np.ndarray, np.ndarray, tuple[Equation, ...]]:
    """Rows (r, n) on speeds, right-hand sides (r,) and names of the joint rates that a deck gives at q.

    For axes in line, or at right angles: the rate of an angle is s · (ω_j - ω_i), that of the stroke
    s · (v_Pj - v_Pi).
    """
    rates = [item for item in starts if item.rate is not None]
    rows = np.zeros((len(rates), speeds))
    for row, item in zip(rows, rates, strict=True):
        joint = joints[item.joint]
        A_i, A_j = (_attitude(q, body) for body in (joint.i, joint.j))
        A, own = (A_j, joint.s_j) if item.coordinate == ANGLES_OF_CROSS[1] else (A_i, joint.s_i)
        s = _times(A, np.array(own) / math.hypot(*own))
        for body, A, P, sign in ((joint.i, A_i, joint.P_i, -1.0), (joint.j, A_j, joint.P_j, 1.0)):
            if body < 0:
                continue
            along, at = _times(A.T, s), 6 * body
            if is_angle(item.coordinate):
                row[at + 3 : at + 6] += sign * along
            else:
                row[at : at + 3] += sign * s
                row[at + 3 : at + 6] += sign * np.cross(P, along)
    names = tuple(Equation(item.name, f"rate of the {item.coordinate}", item.place, 1.0) for item in rates)
    return rows, np.array([item.rate for item in rates]), names


def _attitude(q: np.ndarray, body: int) -> Any:
    """Rotation matrix of a body at q; the ground's is 1."""
    return rotation_matrix(q[7 * body + 3 : 7 * body + 7]) if body >= 0 else np.eye(3)


# Weights of speeds that are not given, and of those given that no mass resists, of the smallest inertia:
# what is given is kept, then what has no mass, then the others are small.
OF_MASSLESS, OF_OTHERS = 1e-6, 1e-10
CLOSED_RATE = 1e-15  # of the largest speed: round-off


def _mass_matrix(analysis: Any, q: np.ndarray) -> tuple[np.ndarray, tuple[np.ndarray, np.ndarray]]:
    """Return the entries of the mass matrix (n, n) of scaled speeds at q, and their rows and columns.

    It has a block a body: one product serves a column of each.
    """
    mass_matrices(analysis.system, analysis.work, q)
    arrays = analysis.arrays
    owners, own = _places_in_bodies(arrays)
    rows, columns, values = [], [], []
    for place in range(int(own.max(initial=-1)) + 1):
        chosen = np.flatnonzero(own == place)
        x, product = np.zeros(arrays.speeds), np.empty(arrays.speeds)
        x[chosen] = arrays.speed_scale[chosen]
        mass_times(analysis.system, analysis.work, x, product)
        column = np.full(arrays.bodies, -1)
        column[owners[chosen]] = chosen
        free = np.flatnonzero(column[owners] >= 0)
        rows.append(free)
        columns.append(column[owners[free]])
        values.append(product[free] * arrays.speed_scale[free])
    return np.concatenate(values), (np.concatenate(rows), np.concatenate(columns))


def _places_in_bodies(arrays: SystemArrays) -> tuple[np.ndarray, np.ndarray]:
    """Return the body of each speed (n,), and the place of the speed among those of its body."""
    owners, own = np.repeat(np.arange(arrays.bodies), 6), np.tile(np.arange(6), arrays.bodies)
    modes = [(record["body"], record["modes"]) for record in arrays.flexible]
    owners = np.concatenate([owners, *(np.full(count, body) for body, count in modes)])
    own = np.concatenate([own, *(6 + np.arange(count) for _, count in modes)])
    return owners, own


KEPT_BITS = 36  # of the largest speed, with round-off of LAPACK beyond them
FITS = 1e-6  # of the largest speed: what given speeds may be changed without a warning
MASSLESS = 1e-13  # eigenvalue of the scaled mass matrix, of the largest
WEIGHTLESS = 1e-7  # singular value, of the largest: the root of a mass matrix keeps no smaller one


def start_speeds(analysis: ConstrainedState, q: np.ndarray, t: float) -> np.ndarray:
    """Return speeds (n,) that fit the constraints: those given as nearly as can be, the others smallest.

    Given speeds u* that fit are kept.  Otherwise the mass-weighted projection (u - u*)ᵀ M (u - u*) → min
    over the given speeds, under J u = ν, decides: it is what an impulse Jᵀ λ in the joints leaves of u*,
    since M (u - u*) = Jᵀ λ.  What M leaves open (massless bodies, speeds that are not given) is nearest to
    u*, then smallest, in the scaled norm: length scales of the mechanism for velocities, 1 for rad/s.
    Raises ModelError when drivers or initial joint rates ask for speeds that the joints forbid.
    """
    system, work, scale = analysis.system, analysis.work, analysis.arrays.speed_scale
    evaluate_jacobian(system, work, q)
    nu = work.rows[GAMMA]
    fill_nu(system, t, nu)
    nu, equations = nu / analysis.arrays.row_scale, analysis.arrays.equations
    rates, values, names = analysis.given_rates(q)
    nu = np.concatenate([nu, values])
    given, speeds = analysis.given_speeds(q)
    if analysis.starts_sparse:
        u = _speeds_of_many(analysis, q, rates * scale, nu, names, t)
        _warn_of_change(analysis, u, speeds, given)
        return u
    J = np.concatenate([dense_jacobian(work), rates * scale])
    if analysis.dependent > DEPENDENT:  # What the loops leave out is no part of the equations.
        independent = np.sort(work.order[: work.rank[0]])
        equations = tuple(equations[k] for k in independent)
        independent = np.append(independent, np.arange(len(work.jacobian), len(J)))
        J, nu = J[independent], nu[independent]
    particular = _shortest(J, nu)
    _refuse_contradiction(equations, names, J @ particular - nu, t)
    rank = np.linalg.matrix_rank(J, DEPENDENT * np.linalg.norm(J, 2)) if names else work.rank[0]
    motions = np.linalg.svd(J)[2][rank:].T
    x = _rounded(particular + _nearest(motions, given, speeds / scale - particular), KEPT_BITS)
    correction = _shortest(J, nu - _times(J, x))
    x += correction + _nearest(motions, given, speeds / scale - x - correction)
    u = _rounded(x, 2 * KEPT_BITS) * scale
    if np.max(_changes(analysis, u, speeds, given), initial=0.0) > 0.0:
        u = _after_impulse(analysis, q, particular, motions, speeds, given)
    _warn_of_change(analysis, u, speeds, given)
    return u


def struck_speeds(analysis: ConstrainedState, q: np.ndarray, u: np.ndarray, t: float) -> np.ndarray:
    """Return the speeds (n,) that an inelastic impulse in joints and drivers leaves of u (n,).

    Raises ModelError when drivers ask for speeds that the joints forbid.
    """
    evaluate_jacobian(analysis.system, analysis.work, q)
    nu = analysis.work.rows[GAMMA]
    fill_nu(analysis.system, t, nu)
    J, nu = dense_jacobian(analysis.work), nu / analysis.arrays.row_scale
    particular = _shortest(J, nu)
    _refuse_contradiction(analysis.arrays.equations, (), J @ particular - nu, t)
    motions = np.linalg.svd(J)[2][analysis.work.rank[0] :].T
    return _after_impulse(analysis, q, particular, motions, u, np.ones(u.size, bool))


def _speeds_of_many(
    analysis: ConstrainedState,
    q: np.ndarray,
    rates: np.ndarray,
    nu: np.ndarray,
    names: tuple[Any, ...],
    t: float,
) -> np.ndarray:
    """Return the speeds (n,) of a large mechanism; rates (r, n), scaled, follow its equations.

    What is found in three stages of others is one weighted least-squares problem here.
    """
    from scipy.sparse import csr_matrix, diags, vstack

    scale = analysis.arrays.speed_scale
    J = vstack([sparse_jacobian(analysis.work), csr_matrix(rates)], "csr")
    given, speeds = analysis.given_speeds(q)
    u = np.where(given, speeds / scale, 0.0)
    rest = nu - J @ u
    if np.max(np.abs(rest), initial=0.0) > CLOSED_RATE * np.max(np.abs(u), initial=0.0):
        M = csr_matrix(_mass_matrix(analysis, q), (u.size, u.size))
        inertias = M.diagonal()
        positive = inertias[inertias > 0.0] if inertias.any() else np.ones(1)
        largest, least = float(positive.max()), float(positive.min())
        chosen = diags(given.astype(float))
        light = np.where(given, OF_MASSLESS, OF_OTHERS) * least / largest
        u = u + shortest_correction(J, rest, chosen @ (M / largest) @ chosen + diags(light))
    _refuse_contradiction(analysis.arrays.equations, names, J @ u - nu, t)
    return u * scale


def _shortest(J: np.ndarray, nu: np.ndarray) -> Any:
    """Return the smallest scaled speeds (n,) with J x = nu."""
    return np.linalg.lstsq(J, nu, rcond=DEPENDENT)[0] if len(nu) else np.zeros(J.shape[1])


def _nearest(motions: np.ndarray, given: np.ndarray, rest: np.ndarray) -> Any:
    """Return the smallest sum (n,) of `motions`, columns, nearest to `rest` where speeds are given."""
    # What moves none of the given speeds but by round-off has no share in them.
    if np.linalg.norm(motions[given]) <= DEPENDENT:
        return np.zeros(len(motions))
    return motions @ np.linalg.lstsq(motions[given], rest[given], rcond=1e-12)[0]


def _rounded(x: np.ndarray, bits: int) -> np.ndarray:
    """Return x (n,) to so many bits of the largest: without the digits in which LAPACK differs by processor.

    A correction of an x rounded so differs by so little that twice as many bits have nothing of it.
    """
    least = 2.0 ** (math.frexp(np.max(np.abs(x), initial=0.0))[1] - bits)
    return np.round(x / least) * least


def _times(A: np.ndarray, x: np.ndarray) -> Any:
    """Return A x (m,) summed in order: BLAS chooses its order by the processor."""
    return np.cumsum(A * x, axis=1)[:, -1] if A.size else np.zeros(len(A))


def _after_impulse(
    analysis: Any,
    q: np.ndarray,
    particular: np.ndarray,
    motions: np.ndarray,
    speeds: np.ndarray,
    given: np.ndarray,
) -> np.ndarray:
    """Return the mass-weighted projection of the given speeds, then the nearest, then the smallest speeds."""
    scale = analysis.arrays.speed_scale
    M = np.zeros((scale.size, scale.size))
    values, places = _mass_matrix(analysis, q)
    M[places] = values
    root = _root(M[np.ix_(given, given)])
    some = np.eye(scale.size)[given]
    stages = (root @ some, WEIGHTLESS), (some, DEPENDENT), (np.eye(scale.size), DEPENDENT)
    aims = speeds / scale, speeds / scale, np.zeros(scale.size)
    u = particular.copy()
    for (weights, smallest), aim in zip(stages, aims, strict=True):
        left, values, right = np.linalg.svd(weights @ motions)
        # Against the weights: where they do not feel the motions left, the largest value is round-off.
        rank = int(np.sum(values > smallest * np.linalg.norm(weights, 2))) if values.size else 0
        shares = left[:, :rank].T @ (weights @ (aim - u)) / values[:rank]
        u += motions @ (right[:rank].T @ shares)
        motions = motions @ right[rank:].T
    return u * scale


def _root(M: Any) -> np.ndarray:
    """Return a matrix R with Rᵀ R = M; what has no mass has no weight."""
    values, vectors = np.linalg.eigh(M)
    values[values <= MASSLESS * values.max(initial=0.0)] = 0.0
    return np.sqrt(values)[:, None] * vectors.T


def given_speeds(
    velocities: Sequence[InitialVelocity], bodies: int, q: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """Return which of the speeds (6 bodies,) `velocities` give, and their values."""
    given, speeds = np.zeros((bodies, 6), dtype=bool), np.zeros((bodies, 6))
    p = q[: 7 * bodies].reshape(bodies, 7)[:, 3:]
    if velocities:
        moved = [item.body for item in velocities]
        given[moved] = True
        speeds[moved, :3] = [item.velocity for item in velocities]
        speeds[moved, 3:] = body_axes(p[moved], np.array([item.angular for item in velocities]))
    return given.ravel(), speeds.ravel()


def _refuse_contradiction(
    equations: tuple[Equation, ...], rates: tuple[Equation, ...], rest: np.ndarray, t: float
) -> None:
    if not rest.size or np.max(np.abs(rest)) <= RESIDUAL_MET:
        return
    missed = np.abs(rest[len(equations) :])
    # Least squares spread a contradiction over all equations in it: the rates are what the deck may change.
    if np.max(missed, initial=0.0) > RESIDUAL_MET:
        worst = rates[int(np.argmax(missed))]
        message = (
            f"at t = {t:.6g} s the initial joint rates contradict each other, or what joints, couplings and "
            f"drivers allow ({worst.name}); give fewer rates, or rates that fit"
        )
        raise ModelError([about("error", message, worst, id="SOLVE-050")])
    worst = equations[int(np.argmax(np.abs(rest[: len(equations)])))]
    message = (
        f"at t = {t:.6g} s the drivers ask for velocities that the joints forbid ({worst.name}); "
        "remove a driver or free a joint"
    )
    raise ModelError([about("error", message, worst, id="SOLVE-051")])


def _changes(analysis: ConstrainedState, u: np.ndarray, speeds: np.ndarray, given: np.ndarray) -> np.ndarray:
    """Return by how much the given speeds are changed, scaled (n,); 0 where they are kept."""
    scale = analysis.arrays.speed_scale
    change = np.abs(u - speeds) / scale * given
    largest = max(np.max(np.abs(u) / scale, initial=0.0), np.max(np.abs(speeds) / scale, initial=0.0))
    return np.where(change > FITS * max(largest, FITS), change, 0.0)


def _warn_of_change(analysis: ConstrainedState, u: np.ndarray, speeds: np.ndarray, given: np.ndarray) -> None:
    change = _changes(analysis, u, speeds, given)
    for item in analysis.velocities:
        own = slice(6 * item.body, 6 * item.body + 6)
        if np.max(change[own]) > 0.0:
            message = f"does not fit the joints and is changed to {_shown(analysis, u[own], item)}"
            analysis.warnings.append(Fault("warning", message, item.place, item.name, id="SOLVE-008"))


def _shown(analysis: ConstrainedState, u: np.ndarray, item: InitialVelocity) -> str:
    p = analysis.integration.z[7 * item.body + 3 : 7 * item.body + 7]
    angular = u[3:] if analysis.omega_in_body_axes else global_axes(p, u[3:])
    return "velocity ({:.6g}, {:.6g}, {:.6g}) m/s, angular ({:.6g}, {:.6g}, {:.6g}) rad/s".format(
        *(u[:3] + 0.0), *(angular + 0.0)
    )
