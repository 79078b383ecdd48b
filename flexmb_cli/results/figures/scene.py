"""Scene of a result: bodies as lines between their joints, points and nodes, over time.

Everything comes from the result file alone: its motion, and where joints, points and nodes sit on their
bodies (`result_geometry`).  Lengths in m, global axes; T rows of time.
"""

from dataclasses import dataclass, replace
from itertools import product
from typing import TYPE_CHECKING, Any

import h5py
import numpy as np

from ..hdf5.stored_result import Damaged, check_shapes, texts
from ..quantities.quantities import ResultError
from .body_shapes import BodyShape, body_shapes
from .gabriel_graph import different, gabriel_edges

if TYPE_CHECKING:
    from collections.abc import Iterator


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
    extent = _extent([scene.places, *(marks.reshape(-1, 3) for _, marks in numbered)])
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
        found: np.ndarray = self.position[:, None, body - 1] + np.matmul(places, np.swapaxes(turn, -1, -2))
        return found

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
    found: np.ndarray = 2 * e[..., :, None] * e[..., None, :] + (2 * e0 * e0 - 1) * np.eye(3) + 2 * e0 * skew
    return found


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


def _extent(parts: list[np.ndarray]) -> float:
    places = np.concatenate(parts)
    return float(np.ptp(places, axis=0).max()) or 1.0


def _series(result: h5py.File, path: str, rows: slice) -> Any:
    return result[path][rows] if path in result else None


def _names(result: h5py.File, kind: str) -> tuple[str, ...]:
    return tuple(texts(result[f"{kind}/name"])) if f"{kind}/name" in result else ()


def _nodes(
    result: h5py.File,
    names: tuple[str, ...],
    rows: slice,
    ends: tuple[np.ndarray, np.ndarray] | None,
) -> "Iterator[tuple[int, tuple[np.ndarray, np.ndarray]]]":
    """Number of a flexible body, its undeformed nodes (n, 3) and their places in body axes (T, n, 3).

    Given the `ends` of joints, their bodies (j, 2) and points (j, 2, 3), nodes of elements are thinned.
    """
    for number, name in enumerate(names, start=1):
        group, amplitude = result.get(f"elastic/{name}", {}), f"modal/{name}/amplitude"
        if "node_position" not in group:
            continue
        undeformed, kept = group["node_position"][:], slice(None)
        if ends and "cell" in group:
            kept = _outermost(undeformed, ends[1][ends[0] == number])
            undeformed = undeformed[kept]
        if "displacement" in group:
            yield number, (undeformed, undeformed + group["displacement"][rows][:, kept])
        elif "shape" in group and amplitude in result:
            moved = np.einsum("nxm,tm->tnx", group["shape"][:][kept], result[amplitude][rows])
            yield number, (undeformed, undeformed + moved)


def _outermost(nodes: np.ndarray, ends: np.ndarray) -> Any:
    """Return the rows of `nodes` (n, 3) farthest along axes and diagonals, and of those at `ends` (m, 3)."""
    along = nodes @ np.array(list(product((-1, 0, 1), repeat=3)), float).T
    at_ends = np.all(nodes[:, None] == ends, axis=-1).any(axis=1)
    return np.union1d(along.argmax(axis=0), np.flatnonzero(at_ends))
