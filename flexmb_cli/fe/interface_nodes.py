"""Interface nodes: matrices with rigidly carried nodes, and the mean motion of a set of nodes.

RBE2: u_j = u_i + theta_i x (r_j - r_i), theta_j = theta_i, d = B d', K' = B' K B, M' = B' M B; rigid motions
stay without strain.  RBE3: the rigid motion of least weighted squares, MSC Nastran Linear Static Analysis
User's Guide, "RBE3"; forces and moments are spread by the transpose, which gives the same resultant.
"""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from ..model.diagnostics import Findings
from ..model.flexible_body import FlexibleBody, FlexibleInput, InterfaceNode
from .formats.matrix_file import MODAL, FEFileFault, MatrixFile
from .linear_algebra import summed, without_diagonal

# Smallest moment of inertia of a mean's nodes, relative to the largest, that has a rotation.
LEAST_SPREAD = 1e-9


def carried_by(interfaces: Sequence[InterfaceNode]) -> dict[int, InterfaceNode]:
    """Return the rigid interface node of every node that one carries."""
    return {member: one for one in interfaces if one.rigid for member in one.members}


def own_input(given: FlexibleInput) -> FlexibleInput:
    """Return `given` with the nodes whose rows the body has: no carried ones, but those that carry them."""
    if not given.interfaces:
        return given
    carried, known = carried_by(given.interfaces), set(given.numbers.tolist())
    added = [one for one in given.interfaces if one.rigid and one.node not in known]
    gone = [*carried, *(one.node for one in given.interfaces if not one.rigid)]
    stays = ~np.isin(given.numbers, gone)
    numbers = np.append(given.numbers[stays], [one.node for one in added]).astype(np.int64)
    positions = np.vstack([given.positions[stays], *(one.position for one in added)])
    axes = given.axes
    if axes is not None:
        axes = np.concatenate([axes[stays], np.tile(np.eye(3), (len(added), 1, 1))])
    return replace(given, numbers=numbers, positions=positions, axes=axes, whole=given)


def with_interface_nodes(
    body: FlexibleBody | None, given: FlexibleInput, findings: Findings
) -> FlexibleBody | None:
    """Return the body with the mean interface nodes of `given`, faults of which go to `findings`."""
    for one in given.interfaces if body else ():
        if one.rigid or body is None:
            continue
        try:
            body = _with_mean(body, one)
        except FEFileFault as fault:
            findings.error(given.name, str(fault), one.place, id=fault.id)
    return body


def _with_mean(body: FlexibleBody, one: InterfaceNode) -> FlexibleBody:
    """Return the body with the mean interface node as its last node."""
    missing = sorted(set(one.members) - set(body.numbers.tolist()))
    if missing:
        message = f"the matrices have no three displacements of node {missing[0]}, whose mean {one.node} has"
        raise FEFileFault(message, id="FE-304")
    places = np.array([body.position(member) for member in one.members])
    place = (one.position - body.origin) @ body.axes
    motion = mean_motion(replace(one, position=place), places)
    moved = motion @ np.concatenate([body.shape(member) for member in one.members])
    turns = body.Psi if body.Psi.size else np.full(body.Phi.shape, np.nan)
    return replace(
        body,
        numbers=np.append(body.numbers, one.node),
        r0=np.vstack([body.r0, place]),
        Phi=np.vstack([body.Phi, moved[:3]]),
        Psi=np.vstack([turns, moved[3:]]),
    )


def tied(file: MatrixFile, given: FlexibleInput) -> MatrixFile:
    """Return the matrix without the nodes that rigid interface nodes of `given` carry, and with their rows.

    Raises FEFileFault.
    """
    carried = carried_by(given.interfaces)
    if not carried or not len(file.values):
        return file
    labels = labels_of(file, given)
    order, independent = _order(labels, carried, given)
    row_of = {label: i for i, label in enumerate(order)}
    entries = [(i, row_of[labels[i]], 1.0) for i in independent]
    place = {number: i for i, number in enumerate(given.numbers.tolist())}
    for i, (node, component) in enumerate(labels):
        if node in carried:
            one = carried[node]
            axes = [_axes(given, place, number) for number in (node, one.node)]
            arm = given.positions[place[node]] - one.position
            row = rigid_row(component, arm, *axes)
            entries += [(i, row_of[one.node, c + 1], value) for c, value in enumerate(row)]
    size = max(len(labels), len(order))  # B is square, with zeros
    rows, columns, values = (np.array(part) for part in zip(*entries, strict=True))
    B = summed(values, rows, columns, size)
    A = summed(file.values, file.rows, file.columns, size)
    product = B.T @ (A + without_diagonal(A).T if file.one_triangle else A) @ B
    i, j = product.nonzero()
    equations = np.array(order, dtype=np.int64).reshape(-1, 2)
    filled = np.asarray(product[i, j]).ravel()
    return MatrixFile(len(order), i, j, filled, False, equations, file.digits)


def rigid_row(component: int, arm: np.ndarray, axes: np.ndarray, axes_of_interface: np.ndarray) -> np.ndarray:
    """Return a carried node's displacement or rotation (6,) per component of the interface node.

    `arm` (3,) leads from the interface node to the node; both have displacement axes in columns.
    """
    direction = axes[:, (component - 1) % 3]
    turning = direction if component > 3 else np.cross(arm, direction)
    along = np.zeros(3) if component > 3 else direction
    return np.concatenate([along @ axes_of_interface, turning @ axes_of_interface])


def mean_motion(one: InterfaceNode, positions: np.ndarray) -> np.ndarray:
    """Return translation and rotation (6, 3 k) of a mean interface node per displacement of its k members.

    `positions` (k, 3), m; all in the same axes.  Raises FEFileFault if the nodes lie on one line.
    """
    if not min(one.weights) > 0.0:
        message = f"a weight of interface node {one.node} is {min(one.weights):g}; it must be above zero"
        raise FEFileFault(message, id="FE-270")
    weights = np.array(one.weights) / np.sum(one.weights)
    centre = weights @ positions
    arms = positions - centre
    inertia = np.einsum("j,jab->ab", weights, [a @ a * np.eye(3) - np.outer(a, a) for a in arms])
    principal = np.linalg.eigvalsh(inertia)
    if not principal[0] > LEAST_SPREAD * principal[-1]:
        message = (
            f"the nodes of interface node {one.node} lie on one line, or at one place: they have no rotation"
        )
        raise FEFileFault(message, id="FE-266")
    motion = np.zeros((6, 3 * len(arms)))
    for j, (weight, arm) in enumerate(zip(weights, arms, strict=True)):
        turning = np.linalg.solve(inertia, weight * np.cross(arm, np.eye(3)).T)
        offset = np.cross(turning.T, one.position - centre).T
        motion[:, 3 * j : 3 * j + 3] = np.vstack([weight * np.eye(3) + offset, turning])
    return motion


def labels_of(file: MatrixFile, given: FlexibleInput) -> list[tuple[int, int]]:
    """Return node and component of every row.  Raises FEFileFault."""
    if file.equations is not None:
        return [(node, component) for node, component in file.equations.tolist()]
    each, rest = divmod(file.size, len(given.numbers))
    if rest or each not in (3, 6):
        message = f"{file.size} rows are not three or six of each of the {len(given.numbers)} nodes"
        raise FEFileFault(message, id="FE-267")
    return [(node, component) for node in given.numbers.tolist() for component in range(1, each + 1)]


def _order(
    labels: list[tuple[int, int]], carried: dict[int, InterfaceNode], given: FlexibleInput
) -> tuple[list[tuple[int, int]], list[int]]:
    """Return the rows of the result, and the rows of the file that stay."""
    present = set(labels)
    for node, component in labels:
        if node in carried and not (1 <= component <= 3 or (component != MODAL and carried[node].turns)):
            message = f"node {node} has rotations, which interface node {carried[node].node} must carry, too"
            raise FEFileFault(f"{message} (components 123456)", id="FE-268")
    independent = [i for i, (node, _) in enumerate(labels) if node not in carried]
    order = [labels[i] for i in independent]
    for one in given.interfaces:
        rows = [(one.node, component) for component in range(1, 7)]
        if one.rigid and 0 < sum(row in present for row in rows) < 6:
            message = f"interface node {one.node} has some rows of its own, and needs all six or none"
            raise FEFileFault(message, id="FE-269")
        order += [row for row in rows if one.rigid and row not in present]
    return order, independent


def _axes(given: FlexibleInput, place: dict[int, int], number: int) -> np.ndarray:
    """Return the displacement axes (3, 3) of a node."""
    return given.axes[place[number]] if given.axes is not None and number in place else np.eye(3)
