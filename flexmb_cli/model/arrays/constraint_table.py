"""Equations between points and directions of moving, deformable bodies, and the body vectors they stand on.

Every joint, pin, motion and joint spring is a list of primitives (`records.PRIMITIVE`).  Directions that
a joint's nodes define move with the nodes: a body vector B (r2 - r1) for a constant matrix B is linear in the
modal coordinates, as its points are.
"""

from collections.abc import Iterable, Sequence
from typing import Any

import numpy as np

from ...errors import Place
from ..flexible_mechanism import FloatingBody, NodePoint
from ..general_joints import GeneralJoint
from ..joints import Equation
from ..mechanism import Body
from ..vectors import rotation_matrix
from .contacts import ContactTable
from .function_table import FunctionTable
from .records import GROUP, NONE, PRIMITIVE, BodyVectorTable, blank_primitive


def tilde(v: np.ndarray) -> np.ndarray:
    """The matrix (3, 3) of v ×."""
    return np.array([[0.0, -v[2], v[1]], [v[2], 0.0, -v[0]], [-v[1], v[0], 0.0]])


class PrimitiveTable(FunctionTable):
    """Collects body vectors, functions, equations and the primitives of springs; `length` is the unit of
    lengths, m.

    `first_row`: equations that stand before these; `angles`: angles that do.
    """

    def __init__(
        self,
        bodies: Sequence[FloatingBody | Body],
        length: float,
        first_row: int = 0,
        angles: Iterable[float] = (),
    ):
        super().__init__()
        self.first_row = first_row
        self.bodies = bodies
        self.length = length
        self.first = np.cumsum([0, *(body.modes for body in bodies)])
        self.body_vectors = BodyVectorTable()
        self.names: list[Equation] = []
        self.measured: list[np.ndarray] = []
        self.springs: list[np.ndarray] = []  # PRIMITIVE records, one or an array of several
        self._sprung = 0  # how many
        self._turned: dict[int, np.ndarray] = {}
        self.groups: list[tuple[int, int, int, int]] = []
        self.angles: list[float] = list(angles)
        self._known: dict[tuple[int, bytes, bytes | None, bytes], int] = {}
        self._next = NONE
        self.tracks: list[list[np.ndarray]] = []  # three primitives of the parameter of each curve
        self._reported: PrimitiveTable | None = None
        self.contacts = ContactTable()

    def reported(self) -> "PrimitiveTable":
        """Return the table of the joint coordinates that report rows alone hold, its `springs`."""
        self._reported = self._reported or PrimitiveTable(self.bodies, self.length)
        return self._reported

    def A(self, body: int) -> np.ndarray:
        """Rotation matrix of a body at t = 0; the ground's is 1."""
        if body not in self._turned:
            self._turned[body] = np.eye(3) if body < 0 else rotation_matrix(self.bodies[body].p)
        return self._turned[body]

    def position(self, point: NodePoint) -> np.ndarray:
        """Return where a point is at t = 0, global axes."""
        origin = np.zeros(3) if point.body < 0 else self.bodies[point.body].r
        return origin + self.A(point.body) @ point.r0

    def place_of(self, body_vector: int) -> np.ndarray:
        """Return where the point at the end of a body vector is at t = 0, undeformed, global axes."""
        record = self.body_vectors.records[body_vector]
        return self.position(NodePoint("", int(record["body"]), record["c"], np.zeros((3, 0))))

    def body_vector(
        self,
        body: int,
        c: np.ndarray | tuple[float, float, float],
        shape: np.ndarray | None = None,
        turn: np.ndarray | None = None,
        arm: np.ndarray | tuple[float, float, float] = (0.0, 0.0, 0.0),
    ) -> int:
        """Number of the body vector c + shape η, of which a part `arm` may turn with a node; see `records`.

        The same for the same body vector.
        """
        c, arm = np.asarray(c, float), np.asarray(arm, float)
        turning = b"" if turn is None else turn.tobytes() + arm.tobytes()
        key = body, c.tobytes(), None if shape is None else shape.tobytes(), turning
        if key not in self._known:
            first = 0 if body < 0 else int(self.first[body])
            self._known[key] = self.body_vectors.add(body, c, shape, first, turn, arm)
        return self._known[key]

    def point(self, point: NodePoint) -> int:
        """The body vector of a point."""
        if not point.is_arm:
            return self.body_vector(point.body, point.r0, point.shape)
        return self.body_vector(point.body, point.r0, point.shape, point.turn, point.arm)

    def direction(self, point: NodePoint, v: np.ndarray) -> int:
        """The direction v (3,), body axes, that turns with a node that has rotations, else with its body."""
        return self.body_vector(point.body, v, None, point.turn, v)

    def between(self, tail: NodePoint, head: NodePoint, B: np.ndarray | None = None) -> int:
        """The free vector B (head - tail) of two points of one body; arms are of one node."""
        B = np.eye(3) if B is None else B
        if tail.is_arm or head.is_arm:
            return self.direction(head, B @ (head.r0 - tail.r0))
        return self.body_vector(tail.body, B @ (head.r0 - tail.r0), B @ (head.shape - tail.shape))

    def axis(self, k: int) -> int:
        """The global direction x, y or z."""
        return self.body_vector(NONE, np.eye(3)[k])

    def product(
        self, v: int | tuple[int, int], w: int | tuple[int, int], alpha: float = 1.0, constant: float = 0.0
    ) -> np.ndarray:
        """The primitive α V · W - constant of V and W, each a body vector or a pair (head, tail) of
        points.
        """
        record = blank_primitive()
        record["ends"] = [span if isinstance(span, tuple) else (span, NONE) for span in (v, w)]
        record["alpha"], record["constant"] = alpha, constant
        return record

    def add_angle(
        self, record: np.ndarray, beta: float, f: int, g: int, h: int, expected: float = 0.0
    ) -> np.ndarray:
        """Add β times the angle from F to H, positive towards G, to a primitive; `expected`: it at the
        start.
        """
        record["beta"], record["f"], record["g"], record["h"] = beta, f, g, h
        record["turn"] = len(self.angles)
        self.angles.append(expected)
        return record

    def angle(self, f: int, g: int, h: int, expected: float = 0.0) -> np.ndarray:
        """The primitive of an angle."""
        return self.add_angle(self.product(NONE, NONE, 0.0), 1.0, f, g, h, expected)

    def equations(
        self, owner: str, place: Place | None, i: int, j: int, parts: list[tuple[str, bool, np.ndarray]]
    ) -> None:
        """Add a group of equations between bodies i and j; parts: (name, whether a length, primitive)."""
        first = self.first_row + len(self.names)
        for name, is_length, record in parts:
            scale = self.length if is_length else 1.0
            self.names.append(Equation(owner, name, place, scale, is_length=is_length))
            self.measured.append(record)
        self.groups.append((first, self.first_row + len(self.names), i, j))

    def general_joint(self, joint: GeneralJoint, gap: tuple[int, int], turned: np.ndarray) -> None:
        """The equations of a general joint; `gap`: points of j and i, `turned` as of `GeneralJoint.turns`."""
        parts = [(name, True, self.product(gap, self.body_vector(joint.i, v))) for name, v in joint.slides]
        for name, v, w, value in joint.turns(turned):
            record = self.product(self.body_vector(joint.j, w), self.body_vector(joint.i, v), 1.0, value)
            parts.append((name, False, record))
        self.equations(joint.name, joint.place, joint.i, joint.j, parts)

    def spring(self, record: np.ndarray) -> int:
        """Number of the (first) primitive a spring acts in; all equations must have been added."""
        self.springs.append(record)
        self._sprung += record.size
        return len(self.measured) + self._sprung - record.size

    def chained(self, records: Sequence[np.ndarray]) -> np.ndarray:
        """The first of the primitives `records`, to which an equation adds all others."""
        for record in reversed(records[1:]):
            record["next"] = self._next
            self._next = self.spring(record) - len(self.measured)
        records[0]["next"], self._next = self._next, NONE
        return records[0]

    def _primitives(self) -> np.ndarray:
        """All primitives; those that are added to others are counted after the equations."""
        records = np.concatenate(
            [np.zeros(0, PRIMITIVE), *map(np.atleast_1d, (*self.measured, *self.springs))]
        )
        records["next"] += np.where(records["next"] >= 0, len(self.measured), 0)
        return records

    def arrays(self) -> dict[str, Any]:
        """The arrays of `SystemArrays` that are collected here."""
        body_vectors, shapes = self.body_vectors.arrays()
        reported = self.reported()
        of_joints, more_shapes = reported.body_vectors.arrays()
        coordinates = reported._primitives()
        of_joints["shape"] += shapes.size
        of_joints["turn"] += np.where(of_joints["turn"] >= 0, shapes.size, 0)
        coordinates["turn"] += np.where(coordinates["turn"] >= 0, len(self.angles), 0)
        return {
            "equations": tuple(self.names),
            "angles": np.array([*self.angles, *reported.angles], dtype=float),
            "joint_vectors": of_joints,
            "joint_coordinates": coordinates,
            "row_scale": np.array([equation.scale for equation in self.names]),
            "groups": np.array(self.groups, dtype=GROUP).reshape(-1),
            "body_vectors": body_vectors,
            "shapes": np.concatenate([shapes, more_shapes]),
            "primitives": self._primitives(),
            "contacts": self.contacts.arrays(),
            **self.function_arrays(),
        }
