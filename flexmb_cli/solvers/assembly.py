"""The first position of a model: the assembly nearest to the estimates of its deck.

Newton's method may jump to a far assembly; damped least squares reduce the gaps in every step.  Lengths are
measured in the size of the mechanism, so that a gap of a joint and an angle between its axes weigh alike, and
so do translations and rotations of bodies.  Where the estimates are far from closing, searches from several
starts find several assemblies, of which the nearest is taken.

A position near the estimates that a quicker method finds is kept:

- kinematics (`kinematics.assembly`): Newton's method of the continuation, as its step of length 0;
- dynamics (`constrained.first_position`): shortest corrections, by rigid motion, then by deformation too;
- trees (`tree.assembly`): the projection of the kernels, with most coordinates kept, then all free.
"""

from collections.abc import Callable, Iterator
from typing import TYPE_CHECKING, Any, Protocol

import numpy as np

from .projection import RESIDUAL_MET, Equations, Instant, Position, largest

if TYPE_CHECKING:
    from scipy.sparse import csr_matrix

    from ..model.arrays.kinematic import KinematicArrays
    from ..model.arrays.system import SystemArrays

FIRST_DAMPING = 1e-3  # of the largest squared column of the Jacobian
LEAST_DAMPING = 1e-16  # of the same: with repeated equations the Jacobian itself has no inverse
LEAST_SPARSE = 1e-12  # the same where J.T J has lost half the digits
SMALLEST_MOVE = 1e-15  # of the size of x
SMALLEST_GAIN = 1e-15  # of the sum of squares
MOST_TRIALS = 200


def least_squares(
    residual: Callable[..., Any],
    jacobian: Callable[..., Any],
    x: np.ndarray,
    moved: Callable[..., Any] = np.add,
    first: float = FIRST_DAMPING,
    met: float = 0.0,
) -> tuple[np.ndarray, np.ndarray]:
    """The x (N,) with the least sum of squares of residual(x) (m,) near the given one, and its residual.

    `jacobian` gives the derivative (m, n), dense or sparse, at the x of the last call of `residual`; `moved`
    gives the x after a step (n,).  `first`: damping of the first step, which keeps it short; `met`: the
    largest residual that ends the search.
    """
    r = residual(x)
    J = jacobian(x)
    is_dense = isinstance(J, np.ndarray)
    size = np.max(np.sum(J**2, axis=0)) if is_dense else J.power(2).sum(axis=0).max()
    least = (LEAST_DAMPING if is_dense else LEAST_SPARSE) * size
    damping, growth = first * size, 2.0
    for _ in range(MOST_TRIALS):
        step = (damped_step if is_dense else _sparse_step)(J, r, damping)
        if np.max(np.abs(r)) <= met or np.linalg.norm(step) <= SMALLEST_MOVE * (1.0 + np.linalg.norm(x)):
            break
        tried_x = moved(x, step)
        tried = residual(tried_x)
        gain = r @ r - tried @ tried
        if not gain > 0.0:
            damping, growth = damping * growth, 2.0 * growth
            continue
        expected = step @ (damping * step - J.T @ r)
        last = gain <= SMALLEST_GAIN * (r @ r)
        x, r = tried_x, tried
        if last:
            break
        J = jacobian(x)
        damping *= max(1.0 / 3.0, 1.0 - (2.0 * gain / expected - 1.0) ** 3)
        damping, growth = max(damping, least), 2.0
    return x, r


def damped_step(J: np.ndarray, r: np.ndarray, damping: float) -> np.ndarray:
    """The h (n,) with the least |J h + r|² + damping |h|², by orthogonal factors.

    J.T J would lose half the digits.
    """
    n = J.shape[1]
    Q, R = np.linalg.qr(np.vstack([J, np.sqrt(damping) * np.eye(n)]))
    return np.linalg.solve(R, -Q[: len(r)].T @ r)


def _sparse_step(J: "csr_matrix", r: np.ndarray, damping: float) -> np.ndarray:
    """As `damped_step` for a sparse Jacobian, by normal equations, which lose half the digits."""
    from scipy.sparse import identity
    from scipy.sparse.linalg import splu

    normal = (J.T @ J + damping * identity(J.shape[1])).tocsc()
    return splu(normal, "MMD_AT_PLUS_A", options={"SymmetricMode": True}).solve(-J.T @ r)


NEAR = 0.1  # of the size, or rad: a body moved less is where its estimate means
# First dampings of the searches: the first is quick, the others keep nearer to the estimates.
DAMPINGS = (1e-3, 1.0)
OTHER_STARTS = 6
MOST_SEARCHED = 600  # speeds: above, other starts would take minutes
ASIDE = 0.3  # of the size, and rad: the largest distance of other starts from the estimates
LOOSEST = 0.03  # gap of what can be called a loop that nearly closes; singular value, of the largest
TO_GAP = 30.0  # singular values, of the largest, to the gap left: below it equations repeat others
NEARER = 1e-6  # of the distance of another assembly: what counts as nearer


class PoseEquations(Equations, Protocol):
    """Equations whose steps are translations and rotations of bodies, then deformations."""

    @property
    def arrays(self) -> "KinematicArrays | SystemArrays":
        """Return the arrays of the mechanism."""


class Sized:
    """Equations at a time, lengths in the size of the mechanism: its longest lever arm at q (N,)."""

    def __init__(self, instant: Instant, equations: PoseEquations, q: np.ndarray, bodies: int):
        self.equations, self.instant, self.bodies = equations, instant, bodies
        equations.residual(q, instant.t, instant.expected)
        J = abs(equations.jacobian(q))
        is_length = np.array([equation.is_length for equation in equations.arrays.equations], dtype=bool)
        turns = np.arange(J.shape[1])[: 6 * bodies].reshape(-1, 6)[:, 3:].ravel()
        arms = J[is_length][:, turns]
        self.size = float(arms.max()) if is_length.any() and arms.max() > 0.0 else 1.0
        self.rows, self.columns = np.where(is_length, 1.0 / self.size, 1.0), np.ones(J.shape[1])
        self.met = 0.0  # scaled gap at which searches end
        self.columns[: 6 * bodies].reshape(-1, 6)[:, :3] = self.size

    def search(
        self, q: np.ndarray, damping: float, free: np.ndarray | None = None, weights: Any = 1.0
    ) -> np.ndarray:
        """Return the position with the least residual that a search from q finds.

        `free` (n,): the changes that are allowed, all by default; `weights` (m,): those of the equations.
        """
        rows = self.rows * weights
        columns = self.columns if free is None else self.columns * free
        t, expected = self.instant.t, self.instant.expected

        def jacobian(x: np.ndarray) -> Any:
            J = self.equations.jacobian(x)
            if isinstance(J, np.ndarray):
                return rows[:, None] * J * columns
            return J.multiply(rows[:, None]).multiply(columns).tocsr()

        return least_squares(
            lambda x: rows * self.equations.residual(x, t, expected),
            jacobian,
            q,
            lambda x, step: self.equations.moved(x, columns * step),
            damping,
            self.met,
        )[0]

    def aside(self, q: np.ndarray, trial: int) -> np.ndarray:
        """Return q with its bodies moved at random."""
        step = np.random.default_rng(trial).uniform(-ASIDE, ASIDE, self.columns.size)
        step[6 * self.bodies :] = 0.0
        return self.equations.moved(q, step * self.columns)

    def distance(self, before: np.ndarray, after: np.ndarray) -> float:
        """Return the sum of the translations, in the size, and of the rotation angles of all bodies."""
        way, turn = displacements(before, after, self.bodies)
        return float(np.sum(way) / (self.size * self.length) + np.sum(turn))

    def is_near(self, before: np.ndarray, after: np.ndarray, most: float = NEAR) -> bool:
        """Return whether no body is moved by more than `most`, of the size or rad."""
        way, turn = displacements(before, after, self.bodies)
        return float(max(np.max(way) / (self.size * self.length), np.max(turn))) <= most

    @property
    def length(self) -> float:
        """The length scale of the equations, m."""
        return float(max((e.scale for e in self.equations.arrays.equations if e.is_length), default=1.0))


def nearest_of(
    sized: Sized,
    q: np.ndarray,
    finish: Callable[[np.ndarray], Position],
    free: np.ndarray | None = None,
    met: float = RESIDUAL_MET,
) -> Position:
    """Return the nearest position to q that searches close, else that with the least gap.

    `finish` corrects what a search finds to round-off; `met`: scaled gap that counts as closed.
    """
    positions: list[Position] = []
    for start, damping in _starts(sized, q, positions, met):
        positions.append(finish(sized.search(start, damping, free)))
    closed = [one for one in positions if is_closed(one[1], met)]
    if closed:
        return min(closed, key=lambda one: sized.distance(q, one[0]))
    return min(positions, key=lambda one: largest(one[1]))


def _starts(
    sized: Sized, q: np.ndarray, positions: list[Position], met: float
) -> Iterator[tuple[np.ndarray, float]]:
    """Yield starts and dampings; none after a position that is found near."""
    for damping in DAMPINGS:
        yield q, damping
        if is_closed(positions[-1][1], met) and sized.is_near(q, positions[-1][0]):
            return
    for trial in range(1, OTHER_STARTS + 1 if sized.columns.size <= MOST_SEARCHED else 1):
        yield sized.aside(q, trial), DAMPINGS[0]


def is_closed(gap: np.ndarray, closed: float = RESIDUAL_MET) -> bool:
    """Return whether a residual (m,) is nowhere more than counts as met; one that is no number is."""
    return largest(gap) <= closed


def displacements(before: np.ndarray, after: np.ndarray, bodies: int) -> tuple[np.ndarray, np.ndarray]:
    """Return how far each body moves, m (bodies,), and turns, rad (bodies,), between positions (N,)."""
    a, b = (x[: 7 * bodies].reshape(-1, 7) for x in (before, after))
    way = np.linalg.norm(b[:, :3] - a[:, :3], axis=1)
    p, r = a[:, 3:], b[:, 3:]
    # Of p⁻¹ r: an angle below 1e-8 is lost in its cosine.
    (_, x, y, z), (_, u, v, w) = p.T, r.T
    product = np.stack([y * w - z * v, z * u - x * w, x * v - y * u], axis=1)
    sine = p[:, :1] * r[:, 1:] - r[:, :1] * p[:, 1:] - product
    return way, 2.0 * np.arctan2(np.linalg.norm(sine, axis=1), np.abs(np.sum(p * r, axis=1)))
