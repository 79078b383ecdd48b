"""Tree → structured arrays: what the kernels of tree dynamics read.

A *frame* is a body or a node that carries a hinge or closure: such a node is a point mass on
translational hinges along the axes of its body, so that one recursion serves both.  The other nodes
are *lumps*, which end the tree and are cheaper.  Frames stand in the order of the bodies, a body's
carrying nodes right behind it: a parent always comes before its children.  Frame 0 is the inertial
frame.
"""

from typing import NamedTuple

import numpy as np

from .tree import ELASTIC, INERTIAL, ROTATION, TRANSLATION, UNTURNED, Tree

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
    springs: np.ndarray
    prescribed: np.ndarray
    laws: np.ndarray
    closures: np.ndarray  # one record a closed direction
    closure_matrix: np.ndarray  # (rows, rows), scratch
    gravity: np.ndarray  # (3,)
    elastic: np.ndarray  # (NS,) bool
    given: np.ndarray  # (NS,) bool
    inertia_scale: np.ndarray  # (NS,) inertia against which a pivot of the mass matrix counts as zero
    one_way: bool


def tree_arrays(tree: Tree) -> TreeArrays:
    """The arrays of a tree; laws get their values later, interval by interval."""
    index = {(c.body, c.motion, c.axis, c.node): m for m, c in enumerate(tree.coordinates)}
    frames, lumps, of_body, of_node = _frames(tree, index)
    closures = _closure_rows(tree, of_body, of_node)
    elastic_bodies, stiffness, damping = _elastic_bodies(tree, index)
    prescribed = [(_rigid(index, p), p.C, p.B, p.A) for p in tree.prescribed]
    given = np.zeros(len(index), bool)
    given[[row[0] for row in prescribed]] = True
    return TreeArrays(
        frames=frames,
        lumps=lumps,
        elastic_bodies=elastic_bodies,
        stiffness=stiffness,
        damping=damping,
        springs=_records(SPRING, [(_rigid(index, s), s.stiffness, s.damping, s.rest) for s in tree.springs]),
        prescribed=_records(PRESCRIBED, prescribed),
        laws=_laws(tree, index, of_body),
        closures=closures,
        closure_matrix=np.zeros((closures.size, closures.size)),
        gravity=np.array(tree.gravity, float),
        elastic=np.array([c.motion == ELASTIC for c in tree.coordinates], bool),
        given=given,
        inertia_scale=_inertia_scale(tree),
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


def _frames(tree, index):
    """Frame records, lump records, and the frames of all bodies and of the nodes that have one."""
    carriers = {(hinge.parent, hinge.node) for hinge in tree.hinges}
    carriers |= {(c.a, c.a_node) for c in tree.closures} | {(c.b, c.b_node) for c in tree.closures}
    frames, lumps, of_body, of_node = [_blank_frame(0, INERTIAL)], [], [], {}
    balls = 0
    for k, body in enumerate(tree.bodies):
        frame = _body_frame(tree, k, index, of_body, of_node)
        if frame["rotations"] == 3:
            frame["ball"] = balls
            balls += 1
        of_body.append(len(frames))
        frames.append(frame)
        frame["first_lump"] = len(lumps)
        for node in range(len(body.elastic.masses) if body.elastic else 0):
            if (k, node) in carriers:
                of_node[k, node] = len(frames)
                frames.append(_node_frame(body, k, node, of_body[k], index))
            else:
                lumps.append(_lump(body, k, node, index))
        frame["lumps"] = len(lumps) - frame["first_lump"]
    return np.concatenate(frames), _records(LUMP, lumps), of_body, of_node


def _blank_frame(parent, body):
    frame = np.zeros(1, FRAME)
    frame["parent"], frame["body"], frame["ball"] = parent, body, -1
    return frame


def _body_frame(tree, k, index, of_body, of_node):
    body, hinge = tree.bodies[k], tree.hinges[k]
    parent, point = _attachment(tree, hinge, of_body, of_node)
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


def _attachment(tree, hinge, of_body, of_node):
    """Parent frame of a hinge, and P_k in it: a carrying node has its origin at P_k."""
    if hinge.parent == INERTIAL:
        return 0, hinge.point
    if hinge.node is None:
        return of_body[hinge.parent], hinge.point
    node = tree.bodies[hinge.parent].elastic.positions[hinge.node]
    return of_node[hinge.parent, hinge.node], np.subtract(hinge.point, node)


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


def _elastic_bodies(tree, index):
    records, stiffness, damping = [], [np.zeros(0)], [np.zeros(0)]
    for k, body in enumerate(tree.bodies):
        elastic = body.elastic
        if elastic is None:
            continue
        first = index[k, ELASTIC, elastic.axes[0], 0]
        damped = elastic.damping is not None
        records.append(
            (first, elastic.coordinates, sum(map(len, stiffness)), sum(map(len, damping)) if damped else -1)
        )
        stiffness.append(np.ravel(elastic.stiffness))
        if damped:
            damping.append(np.ravel(elastic.damping))
    return _records(ELASTIC_BODY, records), np.concatenate(stiffness), np.concatenate(damping)


def _laws(tree, index, of_body):
    laws = [(of_body[t.body], t.axis - 1, -1, 0.0, 0.0) for t in tree.torques]
    laws += [(0, 0, _rigid(index, m), 0.0, 0.0) for m in tree.motors]
    return _records(LAW, laws)


def _closure_rows(tree, of_body, of_node):
    rows = []
    for c in tree.closures:
        a = of_body[c.a] if c.a_node is None else of_node[c.a, c.a_node]
        b = 0 if c.b == INERTIAL else of_body[c.b] if c.b_node is None else of_node[c.b, c.b_node]
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
