"""Report rows of a tree: what a dynamic analysis delivers, block by block, to the writers."""

from dataclasses import dataclass

import numpy as np

from ...kernels.tree.report import Report
from ...model.arrays.tree import TreeArrays, body_frames
from ...model.arrays.tree_elements import TURN_ROW
from ...model.tree import ELASTIC, Tree


@dataclass(frozen=True, eq=False)
class TreeRows:
    """A block of T consecutive report rows of a tree with NS coordinates, N bodies and n nodes.

    SI units; body data are of the origin O_k, global axes.  Where a load jumps at a report time, the
    accelerations are those just before it.  `displacement` holds one array (T, nodes, 3) for each
    flexible body, in the body's axes; `node_position` the nodes of all flexible bodies in their
    order.  Without losses total = kinetic + potential + strain - applied_work stays constant.
    """

    time: np.ndarray  # (T,)
    q: np.ndarray  # (T, NS) coordinates
    y: np.ndarray  # (T, NS) speeds
    y_rate: np.ndarray  # (T, NS)
    position: np.ndarray  # (T, N, 3)
    euler_parameters: np.ndarray  # (T, N, 4)
    velocity: np.ndarray  # (T, N, 3)
    acceleration: np.ndarray  # (T, N, 3)
    angular_velocity: np.ndarray  # (T, N, 3)
    angular_acceleration: np.ndarray  # (T, N, 3)
    displacement: tuple[np.ndarray, ...]
    node_position: np.ndarray  # (T, n, 3)
    kinetic: np.ndarray  # (T,) J
    potential: np.ndarray  # (T,) gravity and springs, J
    strain: np.ndarray  # (T,) J
    applied_work: np.ndarray  # (T,) of all other loads since the start, J
    closure_force: np.ndarray  # (T, C, 3) on body a of each closure, opposite on body b, global axes, N
    constraint_residual: np.ndarray  # (T,) largest gap of a closure, m
    velocity_residual: np.ndarray  # (T,) its largest rate, m/s
    hinge_force: np.ndarray  # (T, N, 3) of the hinge on its body K, global axes, N; (T, 0, 3) where not known
    hinge_torque: np.ndarray  # (T, N, 3) of the hinge on its body K about O_k, global axes, N m

    @property
    def total(self) -> np.ndarray:
        """Energy that nothing changes but errors (T,), J."""
        return self.kinetic + self.potential + self.strain - self.applied_work

    @property
    def euler_parameter_rates(self) -> np.ndarray:
        """First derivative p' = G(omega) p / 2 (T, N, 4) by the angular velocity in global axes, 1/s."""
        return 0.5 * _turned(self.angular_velocity, self.euler_parameters)

    @property
    def euler_parameter_accelerations(self) -> np.ndarray:
        """Second derivative (T, N, 4), 1/s²: G(alpha) p / 2 - omega² p / 4.

        G is antisymmetric, and G G p = -omega² p.
        """
        p, omega = self.euler_parameters, self.angular_velocity
        square = np.sum(omega * omega, axis=-1, keepdims=True)
        return 0.5 * _turned(self.angular_acceleration, p) - 0.25 * square * p

    @property
    def reaction_force(self) -> np.ndarray:
        """Force of each closure on its body b (T, C, 3), global axes, N."""
        # 0 - x, unlike -x, leaves no negative zeros.
        return 0.0 - self.closure_force


def _turned(omega: np.ndarray, p: np.ndarray) -> np.ndarray:
    """Product (..., 4) of the pure quaternion (0, omega) with p."""
    scalar = -np.sum(omega * p[..., 1:], axis=-1, keepdims=True)
    return np.concatenate([scalar, p[..., :1] * omega + np.cross(omega, p[..., 1:])], axis=-1)


def rows_of_tree(
    tree: Tree,
    last: np.ndarray | None,
    axes: np.ndarray,
    audit: np.ndarray,
    reactions: np.ndarray,
    **motion: np.ndarray,
) -> TreeRows:
    """Return the report rows of a motion of `tree`; those of both formulations are made here.

    `last` (N, 4): Euler parameters of the row before, whose signs these continue with.  `axes` (T, N, 3, 3):
    rotation matrices, body axes to global axes; `audit` (T, 5): kinetic, potential, strain energy, J, largest
    gap, m, and its rate, m/s; `reactions` (T, N, 6): force and moment about O_k of its hinge on each body, N,
    N m; `motion`: fields of the rows, Euler parameters of any sign.
    """
    displacement = displacements(tree, motion["q"])
    motion["euler_parameters"] = continued_signs(motion["euler_parameters"], last)
    return TreeRows(
        **motion,
        displacement=displacement,
        node_position=node_positions(tree, motion["position"], axes, displacement),
        kinetic=audit[:, 0].copy(),
        potential=audit[:, 1].copy(),
        strain=audit[:, 2].copy(),
        constraint_residual=audit[:, 3].copy(),
        velocity_residual=audit[:, 4].copy(),
        hinge_force=reactions[..., :3] + 0.0,
        hinge_torque=reactions[..., 3:] + 0.0,
    )


def rows_by_recursion(tree: Tree, arrays: TreeArrays, observed: Report, last: np.ndarray | None) -> TreeRows:
    """Return the rows of a report by Kane's equations; `last` as in `rows_of_tree`."""
    n, own = len(tree.coordinates), body_frames(arrays)
    bodies = observed.frames[:, own]
    axes = bodies["axes"].reshape(len(observed.rows), -1, 3, 3)
    return rows_of_tree(
        tree,
        last,
        time=observed.times,
        q=observed.rows[:, n : 2 * n],
        y=observed.rows[:, :n],
        y_rate=observed.rates,
        position=bodies["position"],
        axes=axes,
        euler_parameters=euler_parameters(axes),
        velocity=bodies["velocity"],
        acceleration=bodies["acceleration"][..., 3:],
        angular_velocity=bodies["angular"],
        angular_acceleration=bodies["acceleration"][..., :3],
        closure_force=_closure_forces(tree, observed.closures),
        applied_work=observed.rows[:, -1].copy(),
        audit=observed.audit,
        reactions=observed.reactions[:, own],
    )


def _closure_forces(tree: Tree, rows: np.ndarray) -> np.ndarray:
    """Sum of the forces along the closed directions of each closure (T, C, 3)."""
    along = np.where(rows["type"] == TURN_ROW, 0.0, rows["force"])[..., None] * rows["direction"]
    ends = np.cumsum([len(closure.directions) for closure in tree.closures], dtype=int)
    # Rows of couplings follow.
    parts = np.split(along, ends, axis=1)[: len(ends)]
    sums = [part.sum(axis=1) for part in parts]
    return np.stack(sums, axis=1) if sums else np.zeros((len(rows), 0, 3))


def displacements(tree: Tree, q: np.ndarray) -> tuple[np.ndarray, ...]:
    """Nodal displacements (T, nodes, 3) of each flexible body, 0 along held axes; q (T, NS)."""
    return tuple(nodal(tree, q).values())


def nodal(tree: Tree, values: np.ndarray) -> dict[int, np.ndarray]:
    """Values (T, NS) of the elastic coordinates as {body: (T, nodes, 3)}, 0 along held axes."""
    out = {
        k: np.zeros((len(values), len(body.elastic.masses), 3))
        for k, body in enumerate(tree.bodies)
        if body.elastic is not None
    }
    for m, c in enumerate(tree.coordinates):
        if c.motion == ELASTIC:
            out[c.body][:, c.node, c.axis - 1] = values[:, m]
    return out


def node_positions(
    tree: Tree, position: np.ndarray, axes: np.ndarray, displacement: tuple[np.ndarray, ...]
) -> np.ndarray:
    """Places (T, n, 3) of the nodes of all flexible bodies; position (T, N, 3), axes (T, N, 3, 3)."""
    flexible = [(k, body.elastic) for k, body in enumerate(tree.bodies) if body.elastic is not None]
    places = [
        position[:, None, k] + np.einsum("tij,tnj->tni", axes[:, k], elastic.positions + u)
        for (k, elastic), u in zip(flexible, displacement, strict=True)
    ]
    return np.concatenate(places, axis=1) if places else np.zeros((len(position), 0, 3))


def euler_parameters(axes: np.ndarray) -> np.ndarray:
    """Euler parameters (..., 4) of rotation matrices (..., 3, 3), from the largest of the four.

    With a = 4 p pᵀ, read off the matrix, any column of a is p up to a factor.
    """
    A = np.moveaxis(axes, (-2, -1), (0, 1))
    trace = A[0, 0] + A[1, 1] + A[2, 2]
    four = np.empty((4, 4, *trace.shape))
    four[0, 0] = 1 + trace
    for i in range(3):
        j, k = (i + 1) % 3, (i + 2) % 3
        four[1 + i, 1 + i] = 1 + 2 * A[i, i] - trace
        four[0, 1 + i] = four[1 + i, 0] = A[k, j] - A[j, k]
        four[1 + i, 1 + j] = four[1 + j, 1 + i] = A[i, j] + A[j, i]
    largest = np.argmax(np.diagonal(four), axis=-1)
    column = np.take_along_axis(np.moveaxis(four, (0, 1), (-2, -1)), largest[..., None, None], axis=-1)[
        ..., 0
    ]
    return column / np.linalg.norm(column, axis=-1, keepdims=True)


def continued_signs(parameters: np.ndarray, last: np.ndarray | None) -> np.ndarray:
    """The same attitudes (T, N, 4) with signs that continue from row to row, the first from `last`."""
    last = unturned(parameters.shape[1]) if last is None else last
    chain = np.concatenate([last[None], parameters])
    signs = np.sign(np.sum(chain[1:] * chain[:-1], axis=-1))
    signs[signs == 0] = 1.0
    return parameters * np.cumprod(signs, axis=0)[..., None]


def unturned(bodies: int) -> np.ndarray:
    """Euler parameters (N, 4) of so many bodies that are not turned."""
    return np.tile([1.0, 0.0, 0.0, 0.0], (bodies, 1))
