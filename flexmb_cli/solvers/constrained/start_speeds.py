"""Speeds at the start of a forward run that fit the constraints and the speeds that the deck gives."""

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from ...errors import Fault, ModelError
from ...kernels.constrained.accelerations import evaluate_jacobian
from ...kernels.constrained.mass_matrix import mass_matrices, mass_times
from ...kernels.constrained.projection import fill_nu
from ...kernels.constrained.system import GAMMA
from ...model.equations import DEPENDENT, Equation
from ...model.loads import InitialVelocity
from ..projection import RESIDUAL_MET
from ..singular.mobility import about
from .large_start import sparse_jacobian, speeds_of_many
from .rows import body_axes, global_axes
from .system import dense_jacobian

if TYPE_CHECKING:
    from .analysis import ConstrainedMotion
    from .flexible_dynamics import FlexibleDynamics


FITS = 1e-6  # of the largest speed: what given speeds may be changed without a warning
MASSLESS = 1e-13  # eigenvalue of the scaled mass matrix, of the largest
WEIGHTLESS = 1e-7  # singular value, of the largest: the root of a mass matrix keeps no smaller one


def start_speeds(analysis: "ConstrainedMotion", q: np.ndarray, t: float) -> np.ndarray:
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
    given, wanted = analysis.given_speeds(q)
    if analysis.starts_sparse:
        u = _of_many(analysis, q, rates * scale, nu, names, t)
        _warn_of_change(analysis, u, wanted, given)
        return u
    J = np.concatenate([dense_jacobian(work), rates * scale])
    if analysis.dependent > DEPENDENT:  # What the loops leave out is no part of the equations.
        kept = np.sort(work.order[: work.rank[0]])
        equations = tuple(equations[k] for k in kept)
        kept = np.append(kept, np.arange(len(work.jacobian), len(J)))
        J, nu = J[kept], nu[kept]
    particular = np.linalg.lstsq(J, nu, rcond=DEPENDENT)[0] if len(nu) else np.zeros(scale.size)
    _refuse_contradiction(equations, names, J @ particular - nu, t)
    rank = np.linalg.matrix_rank(J, DEPENDENT * np.linalg.norm(J, 2)) if names else work.rank[0]
    motions = np.linalg.svd(J)[2][rank:].T
    rest = (wanted / scale - particular)[given]
    free = _nearest(motions[given], rest)
    u = (particular + motions @ free) * scale
    if np.max(_changes(analysis, u, wanted, given), initial=0.0) > 0.0:
        u = _after_impulse(analysis, q, particular, motions, wanted, given)
    _warn_of_change(analysis, u, wanted, given)
    found: np.ndarray = u
    return found


def _of_many(
    analysis: "ConstrainedMotion",
    q: np.ndarray,
    rates: np.ndarray,
    nu: np.ndarray,
    names: tuple[Any, ...],
    t: float,
) -> np.ndarray:
    """Return the speeds (n,) of a large mechanism; rates (r, n), scaled, follow its equations."""
    from scipy.sparse import csr_matrix, vstack

    J = vstack([sparse_jacobian(analysis.work), csr_matrix(rates)], "csr")
    u = speeds_of_many(analysis, q, J, nu)
    _refuse_contradiction(analysis.arrays.equations, names, J @ u - nu, t)
    found: np.ndarray = u * analysis.arrays.speed_scale
    return found


def _nearest(motions: np.ndarray, rest: np.ndarray) -> Any:
    """Return the smallest shares of `motions`, columns of which some speeds are known, that give `rest`."""
    # What moves none of the known speeds but by round-off has no share in them.
    if np.linalg.norm(motions) <= DEPENDENT:
        return np.zeros(motions.shape[1])
    return np.linalg.lstsq(motions, rest, rcond=1e-12)[0]


def _after_impulse(
    analysis: Any,
    q: np.ndarray,
    particular: np.ndarray,
    motions: np.ndarray,
    wanted: np.ndarray,
    given: np.ndarray,
) -> np.ndarray:
    """Return the mass-weighted projection of the given speeds, then the nearest, then the smallest speeds."""
    scale = analysis.arrays.speed_scale
    root = _root(_mass_matrix(analysis, q)[np.ix_(given, given)])
    some = np.eye(scale.size)[given]
    stages = (root @ some, WEIGHTLESS), (some, DEPENDENT), (np.eye(scale.size), DEPENDENT)
    aims = wanted / scale, wanted / scale, np.zeros(scale.size)
    u = particular.copy()
    for (weights, smallest), aim in zip(stages, aims, strict=True):
        left, values, right = np.linalg.svd(weights @ motions)
        # Against the weights: where they do not feel the motions left, the largest value is round-off.
        rank = int(np.sum(values > smallest * np.linalg.norm(weights, 2))) if values.size else 0
        shares = left[:, :rank].T @ (weights @ (aim - u)) / values[:rank]
        u += motions @ (right[:rank].T @ shares)
        motions = motions @ right[rank:].T
    found: np.ndarray = u * scale
    return found


def _mass_matrix(analysis: "FlexibleDynamics", q: np.ndarray) -> np.ndarray:
    """Return the mass matrix (n, n) of scaled speeds at q."""
    mass_matrices(analysis.system, analysis.work, q)
    scale = np.diag(analysis.arrays.speed_scale)
    M = np.empty_like(scale)
    for k, column in enumerate(scale):
        mass_times(analysis.system, analysis.work, column, M[k])
    return scale @ M.T


def _root(M: Any) -> np.ndarray:
    """Return a matrix R with Rᵀ R = M; what has no mass has no weight."""
    values, vectors = np.linalg.eigh(M)
    values[values <= MASSLESS * values.max(initial=0.0)] = 0.0
    found: np.ndarray = np.sqrt(values)[:, None] * vectors.T
    return found


def given_speeds(
    velocities: Sequence[InitialVelocity], bodies: int, q: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """Return which of the speeds (6 bodies,) `velocities` give, and their values."""
    given, wanted = np.zeros((bodies, 6), dtype=bool), np.zeros((bodies, 6))
    p = q[: 7 * bodies].reshape(bodies, 7)[:, 3:]
    if velocities:
        moved = [item.body for item in velocities]
        given[moved] = True
        wanted[moved, :3] = [item.velocity for item in velocities]
        wanted[moved, 3:] = body_axes(p[moved], np.array([item.angular for item in velocities]))
    return given.ravel(), wanted.ravel()


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
            f"drivers allow ({worst.name}); give fewer rates, or such as fit"
        )
        raise ModelError([about("error", message, worst, id="SOLVE-050")])
    worst = equations[int(np.argmax(np.abs(rest[: len(equations)])))]
    message = (
        f"at t = {t:.6g} s the drivers ask for velocities that the joints forbid ({worst.name}); "
        "remove a driver or free a joint"
    )
    raise ModelError([about("error", message, worst, id="SOLVE-051")])


def _changes(
    analysis: "ConstrainedMotion", u: np.ndarray, wanted: np.ndarray, given: np.ndarray
) -> np.ndarray:
    """Return by how much the given speeds are changed, scaled (n,); 0 where they are kept."""
    scale = analysis.arrays.speed_scale
    change = np.abs(u - wanted) / scale * given
    largest = max(np.max(np.abs(u) / scale, initial=0.0), np.max(np.abs(wanted) / scale, initial=0.0))
    return np.where(change > FITS * max(largest, FITS), change, 0.0)


def _warn_of_change(
    analysis: "ConstrainedMotion", u: np.ndarray, wanted: np.ndarray, given: np.ndarray
) -> None:
    change = _changes(analysis, u, wanted, given)
    for item in analysis.velocities:
        own = slice(6 * item.body, 6 * item.body + 6)
        if np.max(change[own]) > 0.0:
            message = f"does not fit the joints and is changed to {_shown(analysis, u[own], item)}"
            analysis.warnings.append(Fault("warning", message, item.place, item.name, id="SOLVE-008"))


def _shown(analysis: "ConstrainedMotion", u: np.ndarray, item: InitialVelocity) -> str:
    p = analysis.integration.z[7 * item.body + 3 : 7 * item.body + 7]
    angular = u[3:] if analysis.omega_in_body_axes else global_axes(p, u[3:])
    return "velocity ({:.6g}, {:.6g}, {:.6g}) m/s, angular ({:.6g}, {:.6g}, {:.6g}) rad/s".format(
        *(u[:3] + 0.0), *(angular + 0.0)
    )
