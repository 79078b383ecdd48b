"""Tree → structured arrays: what the kernels of tree dynamics read.

Bandwidth of a flexible body's matrices: a condensed matrix is full, but falls off.

Condensing the rotations out of a beam leaves a stiffness between any two nodes, which falls by the
factor 2 - sqrt(3) from node to node: thirty nodes away it is below the round-off of the diagonal.
"""

from collections.abc import Iterator, Mapping, Sequence
from typing import Any, NamedTuple

import numpy as np

from ..geometric_stiffness import across, beam_direction, geometric_stiffness
from ..laws import FRICTION
from ..tree import ELASTIC, INERTIAL, ROTATION, TRANSLATION, Closure, Tree
from .contacts import Contacts
from .node_frames import NodeFrames, empty_node_frames
from .signals import Signals
from .tree_elements import CLOSURE_ROW, REPEATED, TURN_ROW, VECTOR_ROW, TreeElements
from .tree_frames import NODAL_MASS, tree_frames

NEGLIGIBLE = 1e-17  # of the geometric mean of the two diagonal places: a tenth of the unit round-off


def row_reach(matrices: Sequence[Any]) -> np.ndarray:
    """(NM, 2): where each row begins in any of the symmetric `matrices`, and one past its end.

    The first is (NM, NM), the others are one, several or None.
    """
    n = len(matrices[0])
    counts = np.eye(n, dtype=bool)
    for matrix in np.concatenate([np.reshape(m, (-1, n, n)) for m in matrices if m is not None]):
        size = np.sqrt(np.abs(np.diag(matrix)))
        counts |= np.abs(matrix) > NEGLIGIBLE * np.outer(size, size)
    counts |= counts.T
    return np.stack([np.argmax(counts, axis=1), n - np.argmax(counts[:, ::-1], axis=1)], axis=1)


ELASTIC_BODY = np.dtype(
    [
        ("first", np.int64),  # its first elastic coordinate
        ("count", np.int64),  # NM
        ("stiffness", np.int64),  # where its NM x NM matrix begins in `stiffness`
        ("damping", np.int64),  # where it begins in `damping`; -1 for none
        ("frame", np.int64),  # number of its FRAME
        ("stiffening", np.int64),  # where its two matrices begin in `stiffening`; -1 for none
        ("beam", np.float64, 3),  # unit vector along a stiffened beam, own axes
    ]
)

# A hinge coordinate that follows C + B t + A t²/2 and a function.
PRESCRIBED = np.dtype(
    [
        ("coordinate", np.int64),  # number of the coordinate
        ("C", np.float64),  # value at t = 0, m, rad
        ("B", np.float64),  # rate at t = 0, m/s, rad/s
        ("A", np.float64),  # acceleration, m/s², rad/s²
        ("function", np.int64),  # number among `curves`, -1: none
        ("until", np.float64),  # s: the function holds what it is just before it
    ]
)

TORQUE = np.dtype(
    [
        ("frame", np.int64),  # on which the torque acts
        ("axis", np.int64),  # 0, 1, 2, inertial
        ("function", np.int64),  # number among `curves`
        ("constant", np.float64),  # N m, besides its function
        ("until", np.float64),  # s: the function holds what it is just before it
        ("value", np.float64),  # N m, evaluated last
    ]
)


class TreeArrays(NamedTuple):
    """A tree in numbers.  NS coordinates; `elastic`, `given` (NS,) mark elastic and prescribed ones."""

    frames: np.ndarray  # FRAME records, parents before children
    nodal_masses: np.ndarray  # NODAL_MASS records
    elastic_bodies: np.ndarray  # ELASTIC_BODY records
    stiffness: np.ndarray  # all matrices (NM, NM), flat, N/m
    damping: np.ndarray  # all matrices (NM, NM), flat, N s/m
    stiffening: np.ndarray  # by turning, N/m per rad²/s², then by weight, N/m per m/s², flat
    reach: np.ndarray  # (NS, 2) first place and one past the last that counts in an elastic coordinate's rows
    prescribed: np.ndarray  # PRESCRIBED records
    torques: np.ndarray  # TORQUE records
    closures: np.ndarray  # CLOSURE_ROW records, one a closed direction
    closure_matrix: np.ndarray  # (rows, rows) work: J b^-1 Jᵀ, 1/kg
    couplings: np.ndarray  # (C, NS) factors of coordinates in couplings, whose rows follow the closures
    row_forces: np.ndarray  # (1 + m, rows) without friction, N or N m, and by unit normal forces
    reactions: np.ndarray  # (F, 6) force of its hinge on every frame, N, and moment about its origin, N m
    gravity: np.ndarray  # (3,) inertial axes, m/s²
    elastic: np.ndarray  # (NS,) bool
    given: np.ndarray  # (NS,) bool
    inertia_scale: np.ndarray  # (NS,) inertia against which a pivot of the mass matrix is zero, kg or kg m²
    node_frames: NodeFrames  # those of all flexible parents
    elements: np.ndarray  # (E,) TREE_ELEMENT records
    frictions: np.ndarray  # (m,) TREE_FRICTION records
    joint_forces: np.ndarray  # (1 + m, m, 5) as `dry_friction.fill_normal_forces` takes them, N
    normals: np.ndarray  # (m,) normal forces, N
    answers: np.ndarray  # (E + m, 8) what they answered last, SI units, columns of `kernels.laws`
    sensors: np.ndarray  # TREE_ELEMENT records of sensors
    signals: Signals  # what is made of them, and of elements
    curves: np.ndarray  # FUNCTION records of `records`: those of elements, drivers and torques
    knots: np.ndarray  # (k, 3) their knots, units of the functions
    contacts: Contacts  # of its elements
    balls: int  # hinges with three rotations
    one_way: bool  # whether the elastic motion does not act on the rigid motion (thesis 4.3)


def tree_arrays(tree: Tree) -> TreeArrays:
    """The arrays of a tree; where functions are held is set later, interval by interval."""
    index = {(c.body, c.motion, c.axis, c.node): m for m, c in enumerate(tree.coordinates)}
    parts = tree_frames(tree, index)
    elastic_bodies, reach, *matrices = _elastic_bodies(tree, index, parts.of_body)
    stiffness, damping, stiffening = matrices
    elements = TreeElements(tree, index, parts.of_body)
    couplings = elements.couplings()
    of_closures = list(_closure_rows(tree, parts.of_body, parts.of_node, elements))
    closures = np.concatenate([*of_closures, elements.coupling_rows()])
    prescribed = _prescribed(tree, elements)
    torques = [
        (parts.of_body[t.body], t.axis - 1, elements.table.function(t.function), 0.0, np.inf, 0.0)
        for t in tree.torques
    ]
    of_elements = elements.arrays()
    given = np.zeros(len(index), bool)
    given[prescribed["coordinate"]] = True
    return TreeArrays(
        frames=np.concatenate(parts.frames),
        nodal_masses=_records(NODAL_MASS, parts.nodal_masses),
        elastic_bodies=elastic_bodies,
        stiffness=stiffness,
        damping=damping,
        stiffening=stiffening,
        reach=reach,
        prescribed=prescribed,
        torques=_records(TORQUE, torques),
        closures=closures,
        closure_matrix=np.zeros((closures.size, closures.size)),
        couplings=couplings,
        row_forces=np.zeros((1 + len(tree.elements.of(FRICTION)), closures.size)),
        reactions=np.zeros((len(parts.frames), 6)),
        gravity=np.array(tree.gravity, float),
        elastic=np.array([c.motion == ELASTIC for c in tree.coordinates], bool),
        given=given,
        inertia_scale=_inertia_scale(tree),
        node_frames=empty_node_frames(parts.node_frames, parts.flexible_parent, parts.slopes),
        **of_elements,
        balls=sum(len(hinge.rotations) == 3 for hinge in tree.hinges),
        one_way=tree.one_way,
    )


def _prescribed(tree: Tree, elements: TreeElements) -> np.ndarray:
    """The PRESCRIBED records: of coordinates of the deck, then of drivers."""
    rows: list[Any] = [
        (elements.coordinate(p.body, f"{p.motion} {p.axis}"), p.C, p.B, p.A, -1, np.inf)
        for p in tree.prescribed
    ]
    for d in tree.elements.drivers:
        coordinate, function = elements.coordinate(d.joint, d.coordinate), elements.table.function(d.function)
        rows.append((coordinate, 0.0, 0.0, 0.0, function, np.inf))
    return _records(PRESCRIBED, rows)


def body_frames(arrays: TreeArrays) -> np.ndarray:
    """Frame of every body (N,): the first of those that belong to it."""
    return 1 + np.unique(arrays.frames["body"][1:], return_index=True)[1]


def initial_attitudes(tree: Tree) -> np.ndarray:
    """Euler parameters (balls, 4) of the hinges with three rotations, in the order of their bodies."""
    balls = [hinge.attitude for hinge in tree.hinges if len(hinge.rotations) == 3]
    attitudes = np.array(balls, float).reshape(-1, 4)
    return attitudes / np.linalg.norm(attitudes, axis=1, keepdims=True)


def _records(dtype: np.dtype, rows: list[Any]) -> np.ndarray:
    return np.array(rows, dtype) if rows else np.zeros(0, dtype)


def _elastic_bodies(tree: Tree, index: Mapping[Any, Any], of_body: Sequence[int]) -> tuple[np.ndarray, ...]:
    """Records of the flexible bodies, reach, and their stiffness, damping and stiffening matrices, flat."""
    reach = np.zeros((len(index), 2), np.int64)
    records: list[Any] = []
    matrices: dict[str, list[Any]] = {"stiffness": [], "damping": [], "stiffening": []}
    for k, body in enumerate(tree.bodies):
        elastic = body.elastic
        if elastic is None:
            continue
        record = np.zeros(1, ELASTIC_BODY)
        record["first"], record["count"] = index[k, ELASTIC, elastic.axes[0], 0], elastic.coordinates
        record["frame"] = of_body[k]
        stiffening = None
        if elastic.stiffened_from is not None:
            record["beam"] = beam_direction(elastic.positions, elastic.stiffened_from)
            stiffening = _stiffening(tree, k)
        own = (elastic.stiffness, elastic.damping, stiffening)
        for (name, flat), matrix in zip(matrices.items(), own, strict=True):
            record[name] = -1 if matrix is None else sum(map(np.size, flat))
            flat.extend([] if matrix is None else [np.ravel(matrix)])
        places = slice(record["first"][0], record["first"][0] + elastic.coordinates)
        reach[places] = row_reach(own)
        records.append(record)
    flat = [
        parts[0] if len(parts) == 1 else np.concatenate([np.zeros(0), *parts]) for parts in matrices.values()
    ]
    return np.concatenate(records) if records else np.zeros(0, ELASTIC_BODY), reach, *flat


def _stiffening(tree: Tree, k: int) -> np.ndarray:
    """(2, NM, NM): by turning and by weight, what hangs on the nodes pulling as if it sat there."""
    return np.array([stiffened_by(tree, k, power) for power in (1, 0)])


def stiffened_by(tree: Tree, k: int, power: int) -> np.ndarray:
    """(NM, NM): stiffness of a stiffened body by forces along it, a node's mass times its place^power."""
    elastic = tree.bodies[k].elastic
    assert elastic is not None and elastic.stiffened_from is not None, "a stiffened body"
    direction = beam_direction(elastic.positions, elastic.stiffened_from)
    assert direction is not None, "a stiffened body is straight"
    prestress = (elastic.masses + hanging_masses(tree, k)) * (elastic.positions @ direction) ** power
    return across(
        geometric_stiffness(elastic.positions, elastic.stiffened_from, prestress), direction, elastic.axes
    )


def hanging_masses(tree: Any, k: int) -> np.ndarray:
    """Mass of all bodies beyond each node of body k (NP,), kg."""
    carried = np.array([body.mass for body in tree.bodies])
    hanging = np.zeros(len(tree.bodies[k].elastic.masses))
    for child in range(len(tree.bodies) - 1, k, -1):
        hinge = tree.hinges[child]
        if hinge.parent == k and hinge.node is not None:
            hanging[hinge.node] += carried[child]
        elif hinge.parent != INERTIAL:
            carried[hinge.parent] += carried[child]
    return hanging


def _closure_rows(
    tree: Tree, of_body: list[int], of_node: dict[Any, Any], elements: TreeElements
) -> Iterator[np.ndarray]:
    """Rows of all closed directions."""
    for c in tree.closures:
        a = of_body[c.a] if c.a_node is None else of_node[c.a, c.a_node, None]
        b = 0 if c.b == INERTIAL else of_body[c.b] if c.b_node is None else of_node[c.b, c.b_node, None]
        # A node's own frame has its origin at the node.
        point_a = c.a_point if c.a_node is None else (0.0, 0.0, 0.0)
        point_b = c.b_point if c.b_node is None else (0.0, 0.0, 0.0)
        first = elements.table.in_a_row(c.curve.functions) if c.curve else -1
        general = _general_rows(c)
        for axis in c.directions:
            row = np.zeros(1, CLOSURE_ROW)
            row["frame_a"], row["frame_b"], row["axis"], row["repeated"] = a, b, axis - 1, REPEATED
            row["point_a"], row["point_b"], row["coupling"], row["curve"] = point_a, point_b, -1, first
            if c.curve:
                row["across"], row["parameter"] = c.curve.across, c.curve.begin
            elif c.roll:
                row["roll"], row["across"] = c.roll.code, c.roll.across
                row["axle"], row["normal"] = c.roll.axis_j, c.roll.axis_i
                row["radius"] = c.roll.radius_j, c.roll.radius_i
            if c.general:
                for field, value in general[axis - 1].items():
                    row[field] = value
            yield row


def _general_rows(c: Closure) -> list[dict[str, Any]]:
    """Fields of the CLOSURE_ROW records of a general joint."""
    if c.general is None:
        return []
    slides = [{"type": VECTOR_ROW, "across": v, "axis": 0} for _, v in c.general.slides]
    turns = [
        {"type": TURN_ROW, "across": v, "point_a": w, "value": value, "axis": 0}
        for _, v, w, value in c.general.turns(c.turned)
    ]
    return [*slides, *turns]


def _inertia_scale(tree: Any) -> np.ndarray:
    """Inertia of the own body about (or along) each coordinate, before anything is eliminated."""
    scale = []
    for c in tree.coordinates:
        body = tree.bodies[c.body]
        if c.motion == ROTATION:
            scale.append(np.trace(body.inertia))
        elif c.motion == TRANSLATION:
            scale.append(body.mass)
        else:
            scale.append(body.elastic.masses[c.node])
    return np.array(scale, float)
