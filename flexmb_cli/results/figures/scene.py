"""Scene of a result: bodies as lines between their joints, points and nodes, over time.

Everything comes from the result file alone: its motion, and where joints, points and nodes sit on their
bodies (`result_geometry`).  Lengths in m, global axes; T rows of time.

Lines between a body's points when it is drawn.

Gabriel and Sokal, Systematic Zoology 18 (1969), 259-278: two points are neighbours when the sphere on the
line between them holds no third one.  Points in a row become a chain, three points of a link a triangle
or an angle, and the nodes of a regular finite-element mesh its edges.
"""

from collections.abc import Iterable, Iterator
from dataclasses import dataclass, replace
from itertools import product
from typing import Any

import h5py
import numpy as np

from ..hdf5.layout import BODY, CORNERS, POSITION
from ..hdf5.stored_result import Damaged, check_shapes, texts
from ..quantities.quantities import ResultError

_SHAPES = {POSITION: "v3", BODY: "v", CORNERS: "k3"}


@dataclass(frozen=True, eq=False)
class BodyShape:
    """All shapes of a body, 0 the ground: `vertices` (n, 3), m, body axes; `triangles` (m, 3) of their rows.

    `origin` (T, 3), `turn` (T, 3, 3): body to global axes.
    """

    number: int
    name: str
    vertices: np.ndarray
    triangles: np.ndarray
    origin: np.ndarray
    turn: np.ndarray

    def places(self, row: int, scale: float = 1.0) -> np.ndarray:
        """Positions (n, 3) of the vertices in a row, global axes; no deformation could be scaled."""
        return self.origin[row] + self.vertices @ self.turn[row].T

    @property
    def corners(self) -> np.ndarray:
        """Positions (T, 8, 3) of the corners of the box around the shapes, along the axes of the body."""
        ends = np.stack([self.vertices.min(axis=0), self.vertices.max(axis=0)])
        box = np.array([[ends[k, i] for i, k in enumerate(corner)] for corner in product((0, 1), repeat=3)])
        return self.origin[:, None] + np.matmul(box, np.swapaxes(self.turn, -1, -2))


def body_shapes(
    result: h5py.File, names: tuple[str, ...], origin: np.ndarray, turn: np.ndarray
) -> Iterator[BodyShape]:
    """The shapes of `result`, body by body, the ground first.

    `origin` (T, b, 3) and `turn` (T, b, 3, 3) of all bodies.  Raises `Damaged`.
    """
    if POSITION not in result:
        return
    check_shapes(result, _SHAPES, {})
    places, owner, triangles = (result[path][:] for path in _SHAPES)
    triangles = _checked(triangles, owner, len(names)) - 1
    still = np.zeros((len(origin), 3)), np.tile(np.eye(3), (len(origin), 1, 1))
    for number in np.unique(owner).tolist():
        own = owner == number
        row = np.cumsum(own) - 1
        faces = row[triangles[own[triangles[:, 0]]]]
        motion = (origin[:, number - 1], turn[:, number - 1]) if number else still
        yield BodyShape(number, names[number - 1] if number else "ground", places[own], faces, *motion)


def _checked(triangles: np.ndarray, owner: np.ndarray, bodies: int) -> Any:
    if triangles.dtype.kind not in "iu" or owner.dtype.kind not in "iu":
        raise Damaged(f"/{CORNERS} or /{BODY} holds no whole numbers")
    if not len(triangles) or triangles.min() < 1 or triangles.max() > len(owner):
        raise Damaged(f"/{CORNERS} names a vertex outside 1..{len(owner)}")
    if owner.min() < 0 or owner.max() > bodies:
        raise Damaged(f"/{BODY} names a body outside 0..{bodies}")
    if (owner[triangles - 1] != owner[triangles[:, :1] - 1]).any():
        raise Damaged(f"a triangle of /{CORNERS} joins two bodies")
    return triangles


# The sphere of an edge of a rectangle passes through no other corner, that of its diagonal through two,
# also when node tables give six digits.
TOUCH = 1e-5


def gabriel_edges(points: np.ndarray) -> np.ndarray:
    """Pairs (m, 2), i < j, of neighbours among different `points` (n, 3).

    A point on the sphere counts as inside, so that rectangles have no diagonals.
    """
    points = np.asarray(points, float)
    square = np.sum((points[:, None] - points) ** 2, axis=-1)
    pairs = []
    for i in range(len(points) - 1):
        later = np.arange(i + 1, len(points))
        # |ik|² + |kj|² <= |ij|²: k lies in the sphere on ij.
        inside = square[i] + square[later] <= square[i, later][:, None] * (1 + TOUCH)
        inside[:, i] = inside[np.arange(len(later)), later] = False
        pairs += [(i, int(j)) for j in later[~inside.any(axis=1)]]
    return np.array(pairs, int).reshape(-1, 2)


def different(points: np.ndarray, distance: float) -> list[int]:
    """Indices of `points` (n, 3) without those within `distance` of an earlier one."""
    chosen: list[int] = []
    for k, point in enumerate(points):
        if not chosen or np.min(np.linalg.norm(points[chosen] - point, axis=1)) > distance:
            chosen.append(k)
    return chosen


# A letter a dataset's axis: time, body, joint, point, node, mode, or its length.
SHAPES = {
    "time": "t",
    "body/position": "tb3", "body/velocity": "tb3", "body/angular_velocity": "tb3",
    "body/euler_parameters": "tb4", "body/name": "b", "body/centre": "b3",
    "joint/body": "j2", "joint/point": "j23", "joint/axis": "j23", "joint/name": "j",
    "point/position": "tp3", "point/body": "p", "point/name": "p", "gravity": "3",
}  # fmt: skip
ELASTIC_SHAPES = {"node_position": "n3", "displacement": "tn3", "shape": "n3m"}
# More nodes than these are drawn as points: the edges would take long to find and hide each other.
MOST_NODES = 1500
# Marks of a body that are nearer than this part of the whole picture are one.
ONE_MARK = 1e-7
GROUND_NUMBER = 0


@dataclass(frozen=True, eq=False)
class DrawnBody:
    """A body: `marks` (T, n, 3) and `edges` (m, 2) between them; `still` when it never moves.

    `number`: that of the deck, 0 for the ground.
    """

    number: int
    name: str
    marks: np.ndarray
    edges: np.ndarray
    still: bool
    flexible: bool = False


RESTING_SHARE = 1e-9  # of the size of a scene: what moves less is at rest
# The symbol of the ground, as lines from (x, y) to (x, y) below its joint, in radii of a tube of the scene.
GROUND_SYMBOL = (
    (0.0, 0.0, -2.6, 4.4), (0.0, 0.0, 2.6, 4.4), (-4.2, 4.4, 4.2, 4.4),
    *((x, 4.4, x - 1.4, 6.2) for x in (-2.6, -0.6, 1.4, 3.4)),
)  # fmt: skip


@dataclass(frozen=True, eq=False)
class Scene:
    """Bodies, joints (T, J, 3) with their axis vectors (T, J, 2, 3), points (T, P, 3), gravity (3,)."""

    time: np.ndarray
    bodies: tuple[DrawnBody, ...]
    joint_names: tuple[str, ...]
    joints: np.ndarray
    axes: np.ndarray
    point_names: tuple[str, ...]
    points: np.ndarray
    gravity: np.ndarray
    body_names: tuple[str, ...] = ()
    origin: np.ndarray | None = None  # (T, b, 3) of the body frames, and their motion where it is known
    velocity: np.ndarray | None = None  # (T, b, 3)
    spin: np.ndarray | None = None  # (T, b, 3)
    shapes: tuple[BodyShape, ...] = ()

    @property
    def places(self) -> np.ndarray:
        """All places (N, 3) at which anything is at any time."""
        parts = [*(body.marks for body in self.bodies), self.joints, self.points]
        parts += [shape.corners for shape in self.shapes]
        return np.concatenate([part.reshape(-1, 3) for part in parts])

    @property
    def supports(self) -> np.ndarray:
        """Numbers of the joints at rest, which get the symbol of the ground; none in a scene of one time."""
        moved = np.ptp(self.joints, axis=0).max(axis=1, initial=0.0)
        return np.flatnonzero(moved <= RESTING_SHARE * self.size) if len(self.time) > 1 else np.zeros(0, int)

    def lined(self, surfaces: Iterable[Any]) -> list[DrawnBody]:
        """Return the bodies that have neither elements, as those of `surfaces`, nor shapes to be drawn by."""
        shown = {one.number for one in (*surfaces, *self.shapes)}
        return [body for body in self.bodies if body.number not in shown]

    @property
    def size(self) -> float:
        """Diagonal, m, of the box around all places."""
        return float(np.linalg.norm(np.ptp(self.places, axis=0))) or 1.0


# Numbers too large for a picture are found at its end.
@np.errstate(all="ignore")
def read_scene(result: h5py.File, rows: slice = slice(None), every_node: bool = True) -> Scene:
    """The scene of `result` at `rows`.

    Without `every_node` a body that has elements keeps its outermost nodes and those at joints alone.
    Raises `ResultError` when it has no rows or no bodies, or places that are not finite.
    """
    _check_shapes(result)
    if "body/position" not in result or not len(range(*rows.indices(len(result["time"])))):
        raise ResultError(
            result.filename, "there are no bodies to draw: the result has no rows", id="RESULT-002"
        )
    motion = _Motion(result, rows, every_node)
    joints = [motion.joint(j) for j in range(len(motion.joint_body))]
    scene = Scene(
        time=result["time"][rows],
        bodies=(),
        joint_names=_names(result, "joint") if joints else (),
        joints=np.stack(joints, axis=1) if joints else np.zeros((motion.rows, 0, 3)),
        axes=motion.joint_axes(result["joint/axis"][:] if "joint/axis" in result else None),
        point_names=_names(result, "point"),
        points=motion.points,
        gravity=result["gravity"][:] if "gravity" in result else np.zeros(3),
        body_names=motion.names,
        origin=motion.position,
        velocity=_series(result, "body/velocity", rows),
        spin=_series(result, "body/angular_velocity", rows),
        shapes=tuple(body_shapes(result, motion.names, motion.position, motion.turn)),
    )
    numbered = [(number, motion.marks(number)) for number in range(len(motion.names) + 1)]
    every = np.concatenate([scene.places, *(marks.reshape(-1, 3) for _, marks in numbered)])
    extent = float(np.ptp(every, axis=0).max()) or 1.0
    drawn = [_drawn(motion, number, marks, extent) for number, marks in numbered if marks.shape[1]]
    scene = replace(scene, bodies=tuple(drawn))
    if not np.all(np.isfinite(scene.places)):
        raise ResultError(
            result.filename, "it cannot be drawn: there are positions that are not finite", id="RESULT-003"
        )
    return scene


def _check_shapes(result: h5py.File) -> None:
    """Raise `Damaged` unless the arrays of all that is drawn fit together."""
    sizes: dict[str, int] = {}
    check_shapes(result, SHAPES, sizes)
    bodies = sizes.get("b", 0)
    for path in ("joint/body", "point/body"):
        numbers = result[path][:] if path in result else np.zeros(0, int)
        if numbers.dtype.kind not in "iu":
            raise Damaged(f"/{path} holds no whole numbers")
        if numbers.size and not (numbers.min() >= 0 and numbers.max() <= bodies):
            raise Damaged(f"/{path} names a body outside 0..{bodies}")
    for name in _names(result, "body"):
        own = {f"elastic/{name}/{key}": letters for key, letters in ELASTIC_SHAPES.items()}
        lengths = {letter: sizes[letter] for letter in "t" if letter in sizes}
        check_shapes(result, own | {f"modal/{name}/amplitude": "tm"}, lengths)


class _Motion:
    """Positions of points of bodies; body 0 is the ground, flexible bodies carry their nodes along."""

    def __init__(self, result: h5py.File, rows: slice, every_node: bool = True):
        self.position = result["body/position"][rows]
        self.rows = len(self.position)
        self.turn = rotations(result["body/euler_parameters"][rows])
        self.names = _names(result, "body")
        self.relative = "coordinate/u_rate" in result  # of a tree
        have_joints, have_points = "joint/point" in result, "point/body" in result
        self.joint_body = result["joint/body"][:] if have_joints else np.zeros((0, 2), int)
        self.joint_point = result["joint/point"][:] if have_joints else np.zeros((0, 2, 3))
        ends = None if every_node else (self.joint_body, self.joint_point)
        self.nodes = dict(_nodes(result, self.names, rows, ends))
        self.points = result["point/position"][rows] if have_points else np.zeros((self.rows, 0, 3))
        self.point_body = result["point/body"][:] if have_points else np.zeros(0, int)
        self.centre = result["body/centre"][:] if "body/centre" in result else None

    def carried(self, body: int, places: np.ndarray) -> np.ndarray:
        """Global positions (T, n, 3) of `places` (T or 1, n, 3) in the axes of `body`."""
        if body == GROUND_NUMBER:
            return np.repeat(places, self.rows, axis=0)
        turn = self.turn[:, body - 1]
        return self.position[:, None, body - 1] + np.matmul(places, np.swapaxes(turn, -1, -2))

    def end_of_joint(self, joint: int, side: int) -> np.ndarray:
        """Path (T, 1, 3) of a joint's point on its first (0) or second body; a node moves with the body."""
        body, place = self.joint_body[joint, side], self.joint_point[joint, side]
        if body in self.nodes:
            undeformed, now = self.nodes[body]
            same = np.flatnonzero(np.all(undeformed == place, axis=1))
            if same.size:
                return self.carried(body, now[:, same[:1]])
        return self.carried(body, place[None, None])

    def joint(self, joint: int) -> np.ndarray:
        """Path (T, 3) of a joint, that of its point on the first body that moves."""
        return self.end_of_joint(joint, 0 if self.joint_body[joint, 0] else 1)[:, 0]

    def joint_axes(self, vectors: Any) -> np.ndarray:
        """Axis vectors (T, J, 2, 3) of the joints in global axes; without `vectors` all 0."""
        axes = np.zeros((self.rows, len(self.joint_body), 2, 3))
        for (j, side), body in np.ndenumerate(self.joint_body) if vectors is not None else ():
            turned = self.turn[:, body - 1] @ vectors[j, side]
            axes[:, j, side] = vectors[j, side] if body == GROUND_NUMBER else turned
        return axes

    def marks(self, body: int) -> np.ndarray:
        """Paths (T, n, 3) of all that a body is drawn through; some may coincide."""
        marks = [self.carried(body, self.nodes[body][1])] if body in self.nodes else []
        marks.append(self.points[:, self.point_body == body])
        marks += [self.end_of_joint(j, side) for j, side in np.argwhere(self.joint_body == body)]
        # The origin is a place of its own in a tree, where bodies hang at it, or when there is little else.
        if body != GROUND_NUMBER and (self.relative or sum(part.shape[1] for part in marks) < 2):
            marks.insert(0, self.carried(body, np.zeros((1, 1, 3))))
        # The last link of a chain is drawn to its centre of mass.
        if body != GROUND_NUMBER and self.centre is not None and sum(part.shape[1] for part in marks) < 2:
            marks.append(self.carried(body, self.centre[None, body - 1, None]))
        return np.concatenate(marks, axis=1)


def rotations(p: np.ndarray) -> np.ndarray:
    """Rotation matrices (..., 3, 3), body to global axes, of Euler parameters (..., 4)."""
    e0, e = p[..., 0, None, None], p[..., 1:]
    skew = np.zeros((*p.shape[:-1], 3, 3))
    skew[..., 2, 1], skew[..., 0, 2], skew[..., 1, 0] = e[..., 0], e[..., 1], e[..., 2]
    skew -= np.swapaxes(skew, -1, -2)
    return 2 * e[..., :, None] * e[..., None, :] + (2 * e0 * e0 - 1) * np.eye(3) + 2 * e0 * skew


def _drawn(motion: _Motion, number: int, marks: np.ndarray, extent: float) -> DrawnBody:
    """A body without marks that coincide; its edges are those of its shape in the first row."""
    marks = marks[:, different(marks[0], ONE_MARK * extent)]
    flexible, count = number in motion.nodes, marks.shape[1]
    edges = gabriel_edges(marks[0]) if count <= MOST_NODES else np.zeros((0, 2), int)
    if number != GROUND_NUMBER and count == 1:
        # A body of one mark shows its attitude by its axes.
        tips = motion.carried(number, np.eye(3)[None] * (0.1 * extent))
        origin = motion.carried(number, np.zeros((1, 1, 3)))
        marks, edges = (
            np.concatenate([marks, tips - origin + marks], axis=1),
            np.array([(0, 1), (0, 2), (0, 3)]),
        )
    name = motion.names[number - 1] if number else "ground"
    still = float(np.ptp(marks, axis=0).max()) <= ONE_MARK * extent
    return DrawnBody(number, name, marks, edges, still, flexible)


def _series(result: h5py.File, path: str, rows: slice) -> Any:
    return result[path][rows] if path in result else None


def _names(result: h5py.File, kind: str) -> tuple[str, ...]:
    return tuple(texts(result[f"{kind}/name"])) if f"{kind}/name" in result else ()


def _nodes(
    result: h5py.File, names: tuple[str, ...], rows: slice, ends: tuple[np.ndarray, np.ndarray] | None
) -> Iterator[tuple[int, tuple[np.ndarray, np.ndarray]]]:
    """Number of a flexible body, its undeformed nodes (n, 3) and their places in body axes (T, n, 3).

    Given the `ends` of joints, their bodies (j, 2) and points (j, 2, 3), nodes of elements are thinned.
    """
    for number, name in enumerate(names, start=1):
        group, amplitude = result.get(f"elastic/{name}", {}), f"modal/{name}/amplitude"
        if "node_position" not in group:
            continue
        undeformed, chosen = group["node_position"][:], slice(None)
        if ends and "cell" in group:
            chosen = _outermost(undeformed, ends[1][ends[0] == number])
            undeformed = undeformed[chosen]
        if "displacement" in group:
            yield number, (undeformed, undeformed + group["displacement"][rows][:, chosen])
        elif "shape" in group and amplitude in result:
            moved = np.einsum("nxm,tm->tnx", group["shape"][:][chosen], result[amplitude][rows])
            yield number, (undeformed, undeformed + moved)


def _outermost(nodes: np.ndarray, ends: np.ndarray) -> Any:
    """Return the rows of `nodes` (n, 3) farthest along axes and diagonals, and of those at `ends` (m, 3)."""
    along = nodes @ np.array(list(product((-1, 0, 1), repeat=3)), float).T
    at_ends = np.all(nodes[:, None] == ends, axis=-1).any(axis=1)
    return np.union1d(along.argmax(axis=0), np.flatnonzero(at_ends))


# A mechanism this much thinner than it is long counts as planar.
PLANAR = 1e-6


@dataclass(frozen=True)
class View:
    """`up` and the direction `eye` from the mechanism to the viewer, unit vectors."""

    up: tuple[float, float, float]
    eye: tuple[float, float, float]


def view_of(places: np.ndarray, gravity: np.ndarray) -> View:
    """The view of `places` (N, 3), everything at all times; up is against `gravity` (3,), else z.

    A planar mechanism is looked at along its normal, so that positive angles about it turn
    counter-clockwise; with no gravity in its plane, y is up where it can be.
    """
    up = -gravity / np.linalg.norm(gravity) if np.any(gravity) else np.array([0.0, 0.0, 1.0])
    normal = _normal(places)
    if normal is None:
        return View(_plain(up), _plain(_aside(up)))
    in_plane = up - (up @ normal) * normal
    if np.linalg.norm(in_plane) < 0.5:
        y = np.array([0.0, 1.0, 0.0])
        in_plane = y - (y @ normal) * normal
    if np.linalg.norm(in_plane) < 0.5:
        in_plane = np.array([1.0, 0.0, 0.0])
    return View(_plain(in_plane), _plain(normal))


def _normal(places: np.ndarray) -> np.ndarray | None:
    """Normal (3,) of the plane of all places; None when they fill space or only a line."""
    centred = places - places.mean(axis=0)
    if len(places) <= 2:
        return None
    _, size, axes = np.linalg.svd(centred, full_matrices=False)
    if size[2] > PLANAR * size[0] or size[1] <= PLANAR * size[0]:
        return None
    normal = axes[2]
    return normal * np.sign(normal[np.argmax(np.abs(normal))])


def _aside(up: np.ndarray) -> np.ndarray:
    """The direction to a viewer who stands to the side and a little above."""
    across = np.roll(np.abs(up).round(), 1) if np.count_nonzero(np.abs(up).round()) == 1 else np.eye(3)[0]
    side = np.cross(up, across)
    return 0.75 * side + 1.0 * across + 0.55 * up


def _plain(vector: np.ndarray) -> tuple[Any, ...]:
    return tuple(float(round(x, 9)) + 0.0 for x in vector / np.linalg.norm(vector))
