"""Equations between points and directions of moving, deformable bodies, and the arms they stand on.

Every joint, pin, motion and joint spring is a list of measures (`records.MEASURE`).  Directions that
a joint's nodes define move with the nodes: an arm B (r2 - r1) for a constant matrix B is linear in the
modal coordinates, as its points are.
"""

import numpy as np

from ...errors import Place
from ..equations import Equation
from ..flexible_mechanism import FloatingBody, NodePoint
from ..time_functions import HELD_TABLE, TABLE, MotionLaw
from ..vectors import rotation_matrix
from .records import GROUP, LAW, MEASURE, NONE, ArmTable, blank_measure, law_record


def tilde(v) -> np.ndarray:
    """The matrix (3, 3) of v ×."""
    return np.array([[0.0, -v[2], v[1]], [v[2], 0.0, -v[0]], [-v[1], v[0], 0.0]])


class MeasureTable:
    """Collects arms, laws, equations and the measures of springs; `length` is the unit of lengths, m."""

    def __init__(self, bodies: tuple[FloatingBody, ...], length: float):
        self.bodies = bodies
        self.length = length
        self.first = np.cumsum([0, *(body.modes for body in bodies)])
        self.arms = ArmTable()
        self.names: list[Equation] = []
        self.measured: list[np.ndarray] = []
        self.springs: list[np.ndarray] = []
        self.groups: list[tuple[int, int, int, int]] = []
        self.turns: list[float] = []
        self.laws: list[np.ndarray] = []
        self.knots: list[np.ndarray] = [np.zeros((0, 3))]
        self._known: dict = {}

    def A(self, body: int) -> np.ndarray:
        """Rotation matrix of a body at t = 0; the ground's is 1."""
        return np.eye(3) if body < 0 else rotation_matrix(self.bodies[body].p)

    def position(self, point: NodePoint) -> np.ndarray:
        """Return where a point is at t = 0, global axes."""
        origin = np.zeros(3) if point.body < 0 else self.bodies[point.body].r
        return origin + self.A(point.body) @ point.r0

    def arm(self, body: int, c, shape=None) -> int:
        """Number of the arm c + shape η, the same for the same arm."""
        c = np.asarray(c, float)
        key = body, c.tobytes(), None if shape is None else shape.tobytes()
        if key not in self._known:
            first = 0 if body < 0 else int(self.first[body])
            self._known[key] = self.arms.add(body, c, shape, first)
        return self._known[key]

    def point(self, point: NodePoint) -> int:
        """The arm of a point."""
        return self.arm(point.body, point.r0, point.shape)

    def between(self, tail: NodePoint, head: NodePoint, B=None) -> int:
        """The free vector B (head - tail) of two points of one body."""
        B = np.eye(3) if B is None else B
        return self.arm(tail.body, B @ (head.r0 - tail.r0), B @ (head.shape - tail.shape))

    def axis(self, k: int) -> int:
        """The global direction x, y or z."""
        return self.arm(NONE, np.eye(3)[k])

    def product(self, v, w, alpha: float = 1.0, constant: float = 0.0) -> np.ndarray:
        """The measure α V · W - constant of V and W, each an arm or a pair (head, tail) of points."""
        record = blank_measure()
        record["ends"] = [span if isinstance(span, tuple) else (span, NONE) for span in (v, w)]
        record["alpha"], record["constant"] = alpha, constant
        return record

    def add_angle(self, record, beta: float, f: int, g: int, h: int, near: float = 0.0) -> np.ndarray:
        """Add β times the angle from F to H, positive towards G, to a measure; `near`: it at the start."""
        record["beta"], record["f"], record["g"], record["h"] = beta, f, g, h
        record["turn"] = len(self.turns)
        self.turns.append(near)
        return record

    def angle(self, f: int, g: int, h: int, near: float = 0.0) -> np.ndarray:
        """The measure of an angle."""
        return self.add_angle(self.product(NONE, NONE, 0.0), 1.0, f, g, h, near)

    def law(self, law: MotionLaw) -> int:
        """Number of a law."""
        first = sum(map(len, self.knots))
        if law.kind in (TABLE, HELD_TABLE):
            self.knots.append(np.column_stack([law.times, law.values, law.curvature]))
            self.laws.append(law_record(law.kind, first=first, last=first + len(law.times) - 1))
        else:
            self.laws.append(law_record(law.kind, law.c))
        return len(self.laws) - 1

    def equations(self, owner: str, place: Place | None, i: int, j: int, parts) -> None:
        """Add a group of equations between bodies i and j; parts: (name, whether a length, measure)."""
        first = len(self.names)
        for name, is_length, record in parts:
            scale = self.length if is_length else 1.0
            self.names.append(Equation(owner, name, place, scale, is_length=is_length))
            self.measured.append(record)
        self.groups.append((first, len(self.names), i, j))

    def spring(self, record) -> int:
        """Number of the measure a spring acts in; all equations must have been added."""
        self.springs.append(record)
        return len(self.measured) + len(self.springs) - 1

    def arrays(self) -> dict:
        """The arrays of `SystemArrays` that are collected here."""
        arms, shapes = self.arms.arrays()
        return {
            "equations": tuple(self.names),
            "turns": np.array(self.turns, dtype=float),
            "row_scale": np.array([equation.scale for equation in self.names]),
            "groups": np.array(self.groups, dtype=GROUP).reshape(-1),
            "arms": arms,
            "shapes": shapes,
            "measures": np.array([*self.measured, *self.springs], dtype=MEASURE).reshape(-1),
            "laws": np.array(self.laws, dtype=LAW).reshape(-1),
            "knots": np.concatenate(self.knots),
        }
