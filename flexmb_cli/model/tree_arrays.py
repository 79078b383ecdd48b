"""Tree → structured arrays: what the kernels of tree dynamics read.

A *frame* is a body or a node that carries a hinge or closure: such a node is a point mass on
translational hinges along the axes of its body, so that one recursion serves both.  The other nodes
are *lumps*, which end the tree and are cheaper.  Frames stand in the order of the bodies, a body's
carrying nodes right behind it: a parent always comes before its children.  Frame 0 is the inertial
frame.  Hinges that turn with the slope of their node hang on *riders* instead, see `tree_riders`.
"""

from dataclasses import dataclass, field
from typing import NamedTuple

import numpy as np

from .geometric_stiffness import across, beam_direction, geometric_stiffness
from .tree import ELASTIC, INERTIAL, ROTATION, TRANSLATION, UNTURNED, Tree
from .tree_riders import Riders, empty_riders

FRAME = np.dtype(
    [
        ("parent", np.int64),  # frame
        ("body", np.int64),  # number of the body it is, or belongs to
        ("rotations", np.int64),  # free rotations, 0-3
        ("rotation_axes", np.int64, 3),  # 0, 1, 2 in the P_k frame; the first `rotations` count
        ("first_rotation", np.int64),  # coordinate of the first rotation, the others follow
        ("ball", np.int64),  # number among the hinges with three rotations, -1 otherwise
        ("translations", np.int64),
        ("translation_axes", np.int64, 3),
        ("first_translation", np.int64),
        ("point", np.float64, 3),  # P_k from the parent's origin, parent's axes, m
        ("framed", np.int64),  # whether `frame` turns anything
        ("frame", np.float64, 9),  # P_k axes -> parent's axes, row by row
        ("turned", np.int64),  # whether `attitude` turns anything
        ("attitude", np.float64, 9),  # O_k axes -> P_k axes when no rotation is free
        ("mass", np.float64),  # without lumps and carrying nodes, kg
        ("moment", np.float64, 3),  # mass times centre of mass, own axes, kg m
        ("inertia", np.float64, 6),  # xx xy xz yy yz zz about the origin, without lumps, own axes
        ("force", np.float64, 3),  # at the origin, inertial axes, N
        ("torque", np.float64, 3),  # inertial axes, N m
        ("first_lump", np.int64),
        ("lumps", np.int64),
        ("rider", np.int64),  # number among the riders, -1 otherwise
        ("ridden", np.int64),  # number among the ridden bodies, -1 otherwise
    ]
)

LUMP = np.dtype(
    [
        ("position", np.float64, 3),  # undeformed, in the axes of its body, m
        ("mass", np.float64),  # kg
        ("force", np.float64, 3),  # constant, inertial axes, N
        ("coordinate", np.int64, 3),  # of the displacement along axis 1, 2, 3; -1 where held
    ]
)

ELASTIC_BODY = np.dtype(
    [
        ("first", np.int64),  # its first elastic coordinate
        ("count", np.int64),  # NM
        ("stiffness", np.int64),  # where its NM x NM matrix begins in `stiffness`
        ("damping", np.int64),  # where it begins in `damping`; -1 for none
        ("frame", np.int64),
        ("stiffening", np.int64),  # where its two matrices begin in `stiffening`; -1 for none
        ("beam", np.float64, 3),  # unit vector along a stiffened beam, own axes
    ]
)

SPRING = np.dtype(
    [("coordinate", np.int64), ("stiffness", np.float64), ("damping", np.float64), ("rest", np.float64)]
)

PRESCRIBED = np.dtype([("coordinate", np.int64), ("C", np.float64), ("B", np.float64), ("A", np.float64)])

# A law has the value c0 + c1 t between two breakpoints of its table; `solve` fills it in for each interval.
LAW = np.dtype(
    [
        ("frame", np.int64),  # body torque on this frame, or 0
        ("axis", np.int64),  # 0, 1, 2, inertial
        ("coordinate", np.int64),  # effort on this hinge coordinate, or -1
        ("c0", np.float64),
        ("c1", np.float64),
    ]
)

# One closed direction of a closure: what it is, then what the kernels found for it last.
CLOSURE_ROW = np.dtype(
    [
        ("frame_a", np.int64),
        ("frame_b", np.int64),
        ("point_a", np.float64, 3),  # axes of frame a, m
        ("point_b", np.float64, 3),
        ("axis", np.int64),  # 0, 1, 2 of frame b
        ("direction", np.float64, 3),  # of that axis, inertial axes
        ("place", np.float64, 3),  # of point a, inertial axes, m
        ("gap", np.float64),  # (p_a - p_b) . direction, m
        ("rate", np.float64),  # its rate, m/s
        ("force", np.float64),  # along the direction on body a, and opposite on body b, N
        ("own", np.float64),  # acceleration per unit force, 1/kg, before elimination
        ("order", np.int64),  # the row that is eliminated in this place
    ]
)


class TreeArrays(NamedTuple):
    """A tree in numbers.  NS coordinates; `elastic`, `given` (NS,) mark elastic and prescribed ones."""

    frames: np.ndarray
    lumps: np.ndarray
    elastic_bodies: np.ndarray
    stiffness: np.ndarray  # all matrices, flat
    damping: np.ndarray  # all matrices, flat
    stiffening: np.ndarray  # by turning, N/m per rad²/s², then by weight, N/m per m/s², flat
    springs: np.ndarray
    prescribed: np.ndarray
    laws: np.ndarray
    closures: np.ndarray  # one record a closed direction
    closure_matrix: np.ndarray  # (rows, rows), scratch
    gravity: np.ndarray  # (3,)
    elastic: np.ndarray  # (NS,) bool
    given: np.ndarray  # (NS,) bool
    inertia_scale: np.ndarray  # (NS,) inertia against which a pivot of the mass matrix counts as zero
    riders: Riders
    one_way: bool


def tree_arrays(tree: Tree) -> TreeArrays:
    """The arrays of a tree; laws get their values later, interval by interval."""
    index = {(c.body, c.motion, c.axis, c.node): m for m, c in enumerate(tree.coordinates)}
    parts = _frames(tree, index)
    closures = _closure_rows(tree, parts.of_body, parts.of_node)
    elastic_bodies, stiffness, damping, stiffening = _elastic_bodies(tree, index, parts.of_body)
    prescribed = [(_rigid(index, p), p.C, p.B, p.A) for p in tree.prescribed]
    given = np.zeros(len(index), bool)
    given[[row[0] for row in prescribed]] = True
    return TreeArrays(
        frames=np.concatenate(parts.frames),
        lumps=_records(LUMP, parts.lumps),
        elastic_bodies=elastic_bodies,
        stiffness=stiffness,
        damping=damping,
        stiffening=stiffening,
        springs=_records(SPRING, [(_rigid(index, s), s.stiffness, s.damping, s.rest) for s in tree.springs]),
        prescribed=_records(PRESCRIBED, prescribed),
        laws=_laws(tree, index, parts.of_body),
        closures=closures,
        closure_matrix=np.zeros((closures.size, closures.size)),
        gravity=np.array(tree.gravity, float),
        elastic=np.array([c.motion == ELASTIC for c in tree.coordinates], bool),
        given=given,
        inertia_scale=_inertia_scale(tree),
        riders=empty_riders(parts.riders, parts.ridden, parts.slopes),
        one_way=tree.one_way,
    )


def body_frames(arrays: TreeArrays) -> np.ndarray:
    """Frame of every body (N,): the first of those that belong to it."""
    return 1 + np.unique(arrays.frames["body"][1:], return_index=True)[1]


def initial_attitudes(tree: Tree) -> np.ndarray:
    """Euler parameters (balls, 4) of the hinges with three rotations, in the order of their bodies."""
    balls = [hinge.attitude for hinge in tree.hinges if len(hinge.rotations) == 3]
    attitudes = np.array(balls, float).reshape(-1, 4)
    return attitudes / np.linalg.norm(attitudes, axis=1, keepdims=True)


def rotation_matrix(attitude) -> np.ndarray:
    """Rotation matrix (3, 3) of Euler parameters e0..e3, which need not be normalised."""
    e0, *e = np.array(attitude, float) / np.linalg.norm(attitude)
    e = np.array(e)
    cross = np.array([[0, -e[2], e[1]], [e[2], 0, -e[0]], [-e[1], e[0], 0]])
    return 2 * np.outer(e, e) + (2 * e0 * e0 - 1) * np.eye(3) + 2 * e0 * cross


def _records(dtype, rows):
    return np.array(rows, dtype) if rows else np.zeros(0, dtype)


def _rigid(index, item):
    return index[item.body, item.motion, item.axis, None]


@dataclass(frozen=True, eq=False)
class _Parts:
    """Records on their way into arrays, and which frame is whose."""

    frames: list
    lumps: list = field(default_factory=list)
    of_body: list = field(default_factory=list)
    of_node: dict = field(default_factory=dict)  # (body, node, hinge that turns with the slope or None)
    riders: list = field(default_factory=list)
    ridden: list = field(default_factory=list)
    slopes: list = field(default_factory=list)


def _frames(tree, index):
    """Frames, lumps and riders of all bodies."""
    parts = _Parts([_blank_frame(0, INERTIAL)])
    carriers = _carriers(tree)
    balls = 0
    for k, body in enumerate(tree.bodies):
        frame = _body_frame(tree, k, index, parts)
        if frame["rotations"] == 3:
            frame["ball"] = balls
            balls += 1
        parts.of_body.append(len(parts.frames))
        parts.frames.append(frame)
        own = [carrier for carrier in carriers if carrier[0] == k]
        if any(hinge is not None for _, _, hinge in own):
            _add_riders(tree, k, own, index, parts)
            own = []
        for _, node, _ in own:
            parts.of_node[k, node, None] = len(parts.frames)
            parts.frames.append(_node_frame(body, k, node, parts.of_body[k], index))
        _add_lumps(body, k, {node for _, node, _ in own}, index, parts)
    return parts


def _add_riders(tree, k, carriers, index, parts):
    """Riders at all carrying nodes of a body; they have no slope where nothing turns."""
    elastic, frame = tree.bodies[k].elastic, parts.of_body[k]
    first, count = index[k, ELASTIC, elastic.axes[0], 0], elastic.coordinates
    parts.frames[frame]["ridden"] = len(parts.ridden)
    parts.ridden.append((frame, len(parts.riders), len(carriers), first, count))
    for _, node, hinge in carriers:
        rider = _blank_frame(frame, k)
        rider["point"], rider["rider"] = elastic.positions[node], len(parts.riders)
        parts.of_node[k, node, hinge] = len(parts.frames)
        own = tuple(_node_coordinates(tree.bodies[k], k, node, index))
        parts.riders.append((len(parts.frames), own, first, count, sum(map(np.size, parts.slopes))))
        parts.frames.append(rider)
        still = np.zeros((3, count))
        parts.slopes.append(still if hinge is None else tree.hinges[hinge].elastic_rotation)


def _add_lumps(body, k, carrying, index, parts):
    """Lumps for the nodes that have no frame of their own."""
    nodes = range(len(body.elastic.masses) if body.elastic else 0)
    frame = parts.frames[parts.of_body[k]]
    frame["first_lump"] = len(parts.lumps)
    parts.lumps.extend(_lump(body, k, node, index) for node in nodes if node not in carrying)
    frame["lumps"] = len(parts.lumps) - frame["first_lump"]


def _carriers(tree):
    """(body, node, hinge) of all nodes that carry something, the hinge when it turns with the slope."""
    carriers = {
        (hinge.parent, hinge.node, k if hinge.elastic_rotation is not None else None)
        for k, hinge in enumerate(tree.hinges)
        if hinge.node is not None
    }
    for c in tree.closures:
        carriers |= {
            (body, node, None) for body, node in ((c.a, c.a_node), (c.b, c.b_node)) if node is not None
        }
    return sorted(carriers, key=lambda carrier: (*carrier[:2], -1 if carrier[2] is None else carrier[2]))


def _blank_frame(parent, body):
    frame = np.zeros(1, FRAME)
    frame["parent"], frame["body"] = parent, body
    for number in ("ball", "rider", "ridden"):
        frame[number] = -1
    return frame


def _body_frame(tree, k, index, parts):
    body, hinge = tree.bodies[k], tree.hinges[k]
    parent, point = _attachment(tree, k, parts)
    frame = _blank_frame(parent, k)
    frame["point"] = point
    _set_axes(frame, "rotation", hinge.rotations, index, k, ROTATION)
    _set_axes(frame, "translation", hinge.translations, index, k, TRANSLATION)
    frame["framed"] = tuple(hinge.frame) != UNTURNED
    frame["frame"] = rotation_matrix(hinge.frame).ravel()
    frame["turned"] = not hinge.rotations and tuple(hinge.attitude) != UNTURNED
    frame["attitude"] = rotation_matrix(hinge.attitude).ravel()
    frame["force"], frame["torque"] = body.force, body.torque
    _set_mass(frame, body)
    return frame


def _attachment(tree, k, parts):
    """Parent frame of hinge k, and P_k in it: a carrying node has its origin at P_k."""
    hinge = tree.hinges[k]
    if hinge.parent == INERTIAL:
        return 0, hinge.point
    if hinge.node is None:
        return parts.of_body[hinge.parent], hinge.point
    node = tree.bodies[hinge.parent].elastic.positions[hinge.node]
    turning = k if hinge.elastic_rotation is not None else None
    return parts.of_node[hinge.parent, hinge.node, turning], np.subtract(hinge.point, node)


def _set_axes(frame, kind, axes, index, body, motion):
    frame[f"{kind}s"] = len(axes)
    frame[f"{kind}_axes"][0, : len(axes)] = np.array(axes, int) - 1
    frame[f"first_{kind}"] = index[body, motion, axes[0], None] if axes else 0


def _set_mass(frame, body):
    """Own mass and inertia: what the nodes leave of the body's."""
    inertia, mass = np.array(body.inertia, float), body.mass
    if body.elastic is not None:
        mass -= float(np.sum(body.elastic.masses))
        for m, x in zip(body.elastic.masses, body.elastic.positions, strict=True):
            inertia -= m * (x @ x * np.eye(3) - np.outer(x, x))
    else:
        frame["moment"] = body.mass * np.array(body.centre)
    frame["mass"] = mass
    frame["inertia"] = inertia[np.triu_indices(3)]


def _node_coordinates(body, k, node, index):
    return [index.get((k, ELASTIC, axis, node), -1) for axis in (1, 2, 3)]


def _node_frame(body, k, node, parent, index):
    frame = _blank_frame(parent, k)
    elastic = body.elastic
    frame["point"] = elastic.positions[node]
    frame["translations"] = len(elastic.axes)
    frame["translation_axes"][0, : len(elastic.axes)] = np.array(elastic.axes) - 1
    frame["first_translation"] = index[k, ELASTIC, elastic.axes[0], node]
    frame["mass"] = elastic.masses[node]
    frame["force"] = elastic.forces[node]
    return frame


def _lump(body, k, node, index):
    elastic = body.elastic
    return (
        tuple(elastic.positions[node]),
        elastic.masses[node],
        tuple(elastic.forces[node]),
        tuple(_node_coordinates(body, k, node, index)),
    )


def _elastic_bodies(tree, index, of_body):
    """Records of the flexible bodies, and their stiffness, damping and stiffening matrices, flat."""
    records, matrices = [], {"stiffness": [], "damping": [], "stiffening": []}
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
        records.append(record)
    flat = [np.concatenate([np.zeros(0), *parts]) for parts in matrices.values()]
    return np.concatenate(records) if records else np.zeros(0, ELASTIC_BODY), *flat


def _stiffening(tree, k):
    """(2, NM, NM): by turning and by weight, what hangs on the nodes pulling as if it sat there."""
    elastic = tree.bodies[k].elastic
    masses = elastic.masses + _hanging_masses(tree, k)
    direction = beam_direction(elastic.positions, elastic.stiffened_from)
    return np.array(
        [
            across(
                geometric_stiffness(elastic.positions, elastic.stiffened_from, pulls), direction, elastic.axes
            )
            for pulls in (masses * (elastic.positions @ direction), masses)
        ]
    )


def _hanging_masses(tree, k):
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


def _laws(tree, index, of_body):
    laws = [(of_body[t.body], t.axis - 1, -1, 0.0, 0.0) for t in tree.torques]
    laws += [(0, 0, _rigid(index, m), 0.0, 0.0) for m in tree.motors]
    return _records(LAW, laws)


def _closure_rows(tree, of_body, of_node):
    rows = []
    for c in tree.closures:
        a = of_body[c.a] if c.a_node is None else of_node[c.a, c.a_node, None]
        b = 0 if c.b == INERTIAL else of_body[c.b] if c.b_node is None else of_node[c.b, c.b_node, None]
        # A node's own frame has its origin at the node.
        point_a = c.a_point if c.a_node is None else (0.0, 0.0, 0.0)
        point_b = c.b_point if c.b_node is None else (0.0, 0.0, 0.0)
        for axis in c.directions:
            row = np.zeros(1, CLOSURE_ROW)
            row["frame_a"], row["frame_b"], row["axis"] = a, b, axis - 1
            row["point_a"], row["point_b"] = point_a, point_b
            rows.append(row)
    return np.concatenate(rows) if rows else np.zeros(0, CLOSURE_ROW)


def _inertia_scale(tree):
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
