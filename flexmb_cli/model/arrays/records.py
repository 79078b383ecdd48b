"""Records that the kernels of constrained dynamics read: masses, body vectors, primitives, loads, functions,
groups.

A body vector is c + S η in the axes of its body, and of what turns with a node + (exp(θ~) - 1) arm, θ = T η:
a point, taken with the body's origin, or a free vector.  Body -1 is the ground, whose axes are global.  The
first coordinates are r and p of every body, seven each, the first speeds v and ω, six each; after them stand
the modal coordinates of the flexible bodies and their rates.
"""

from typing import Any

import numpy as np

NONE = -1

LAW = np.dtype(
    [
        ("shape", np.int64),  # code of a law of `model.laws`
        ("c", np.float64, 11),  # its numbers in their order, SI units; of a motor a constant effort
        # Its functions in their order, -1: none; after one of the coordinate its integral.
        ("f", np.int64, 3),
        ("driven", np.int64),  # 1: by a signal, 0: by none
        ("bristle", np.int64),  # of friction: first state of its bristles, -1: none
    ]
)


FORCE, TORQUE, ELEMENT, FRICTION = 1, 2, 5, 6
ALONG_VECTOR, ABOUT_VECTOR = 2, 3  # ELEMENT, in `in_line`: a force, or torque, along its `vector`

MASS = np.dtype(
    [
        ("mass", np.float64),  # kg
        ("moment", np.float64, 3),  # mass times centre of mass, undeformed, body axes, kg m
        ("inertia", np.float64, (3, 3)),  # about the origin, undeformed, body axes, kg m²
        ("flexible", np.int64),  # its FLEXIBLE record, -1: rigid
    ]
)

FLEXIBLE = np.dtype(
    [
        ("body", np.int64),  # number of the body
        ("modes", np.int64),  # N
        ("first", np.int64),  # its first modal coordinate among all of them
        ("constants", np.int64),  # where S1 J1 J2 C0 C1 Mff Kr Dr KG begin in `modal`
        ("places", np.int64),  # where its numbers begin in the kernels' work
        ("stiffened", np.int64),  # 1: KG is there
    ]
)

BODY_VECTOR = np.dtype(
    [
        ("body", np.int64),  # number of the body, -1: ground
        ("modes", np.int64),  # N, 0 where the body vector does not deform
        ("first", np.int64),  # first modal coordinate of its body
        ("shape", np.int64),  # where S (3, N) begins in `shapes`
        ("c", np.float64, 3),  # undeformed, body axes, m or, of a direction, 1
        ("turn", np.int64),  # where T (3, N) of the rotation vector of a node begins in `shapes`, -1: none
        ("arm", np.float64, 3),  # part of c that turns with the node, body axes, m or 1
    ]
)

# α V · W + β θ - constant, θ the angle from F to H, positive towards G; V and W, the `ends`, are the point at
# the first body vector less that at the second, or the first body vector as a free vector where the second is
# -1.
PRIMITIVE = np.dtype(
    [
        ("alpha", np.float64),  # factor α of V · W
        ("ends", np.int64, (2, 2)),  # body vectors of V and W, a row each: head and tail, -1: none
        ("beta", np.float64),  # factor β of the angle
        ("f", np.int64),  # body vector F, a free vector, from which the angle counts
        ("g", np.int64),  # body vector G, a free vector at right angles to F, of its body
        ("h", np.int64),  # body vector H, a free vector, to which the angle counts
        ("turn", np.int64),  # running number of the angle, -1 where there is none
        ("function", np.int64),  # what the primitive follows, -1: 0
        ("constant", np.float64),  # that is taken off, m², m, rad or 1
        ("next", np.int64),  # primitive that is added to it in an equation, -1: none
        ("curve", np.int64),  # function of it that an equation subtracts in place of adding it, -1: none
        # Of the first of three components of a point: 0, 1: its gap along a normal of a curve; 2: the curve's
        # parameter, of which the angle `turn` is an estimate; `f`: a vector across the curve, `curve`: its
        # functions.
        ("track", np.int64),  # -1: none
        ("roll", np.int64),  # rolling on a plane or a wheel, see `kernels.rolling`, 0: none
        ("direction", np.int64),  # of its equation
        ("radius", np.float64, 2),  # of rolling: of the disc on body a, of the wheel on body b, m
    ]
)

LOAD = np.dtype(
    [
        ("kind", np.int64),  # FORCE, TORQUE, ELEMENT or FRICTION
        # Point of action of a force; of a torque any body vector of its body; of friction the axis.
        # Of a bushing's turn about an axis of one body that axis.
        ("body_vector", np.int64),
        ("tilted", np.int64),  # ELEMENT: the other body's axis within a right angle of it, -1: none
        ("primitive", np.int64),  # ELEMENT: the angle or stroke that it acts in, or the V in whose length
        ("following", np.int64),  # 1: the vector is in body axes
        ("vector", np.float64, 3),  # N or N m
        # ELEMENT: 1: it acts in the length of V; ALONG_VECTOR, ABOUT_VECTOR: along or about `vector`.
        ("in_line", np.int64),
        ("stroke", np.int64),  # FRICTION: primitive of the stroke, -1: none; `primitive` is the angle
        ("group", np.int64),  # FRICTION: joint among the groups; of bushings and contacts their own
        ("thread", np.float64),  # FRICTION: ratio of force on the flanks of a screw to that along its axis
        ("function", np.int64),  # FORCE, TORQUE: function of time that it is multiplied by, -1: none
        *LAW.descr,
    ]
)

FUNCTION = np.dtype(
    [
        ("kind", np.int64),  # code of `time_functions`
        ("c", np.float64, 4),  # its constants, in SI units; of pieces see `FunctionTable`
        ("first", np.int64),  # first knot of a table
        ("last", np.int64),  # last knot of a table
    ]
)

# The equations that one joint, driver or pin consists of, and the two bodies they act on.
GROUP = np.dtype(
    [
        ("first_row", np.int64),  # first of the equations
        ("end_row", np.int64),  # one past the last
        ("body_i", np.int64),  # first body, -1: ground
        ("body_j", np.int64),  # second body, -1: ground
    ]
)


class BodyVectorTable:
    """Collects body vectors and their shapes."""

    def __init__(self) -> None:
        self.records: list[Any] = []
        self.shapes: list[Any] = []
        self._size = 0

    def add(
        self,
        body: int,
        c: np.ndarray,
        shape: np.ndarray | None = None,
        first: int = 0,
        turn: np.ndarray | None = None,
        arm: np.ndarray | tuple[float, float, float] = (0.0, 0.0, 0.0),
    ) -> int:
        """Number of a new body vector c + shape η; `first`: the first modal coordinate of its body.

        `turn` (3, N): rotation of a node per modal coordinate, which turns the part `arm` (3,) of c.
        """
        record = np.zeros((), BODY_VECTOR)
        record["body"], record["c"], record["first"], record["turn"] = body, c, first, NONE
        record["shape"] = self._size
        if shape is not None and shape.shape[1]:
            self._append(record, shape)
        if turn is not None:
            record["turn"], record["arm"] = self._size, arm
            self._append(record, turn)
            if shape is None:
                self._append(record, 0.0 * turn)
                record["shape"] = record["turn"] + turn.size
        self.records.append(record)
        return len(self.records) - 1

    def _append(self, record: np.ndarray, shape: np.ndarray) -> None:
        record["modes"] = shape.shape[1]
        self.shapes.append(np.ravel(shape))
        self._size += shape.size

    def arrays(self) -> tuple[np.ndarray, np.ndarray]:
        """BODY_VECTOR records, and the shapes one after the other."""
        flat = np.concatenate(self.shapes) if self.shapes else np.zeros(0)
        return np.array(self.records, dtype=BODY_VECTOR).reshape(-1), flat


def function_record(
    kind: int, c: tuple[float, float, float, float] = (0.0, 0.0, 0.0, 0.0), first: int = 0, last: int = 0
) -> np.ndarray:
    """A FUNCTION record."""
    record = np.zeros((), FUNCTION)
    record["kind"], record["c"], record["first"], record["last"] = kind, c, first, last
    return record


def blank_primitive() -> np.ndarray:
    """A PRIMITIVE record that refers to nothing."""
    record = np.zeros((), PRIMITIVE)
    record["ends"] = NONE
    for field in ("f", "g", "h", "turn", "function", "next", "curve", "track"):
        record[field] = NONE
    return record


def line_primitive(head: int, tail: int) -> np.ndarray:
    """The primitive whose V goes from the point at body vector `tail` to that at `head`."""
    record = blank_primitive()
    record["ends"][0] = head, tail
    return record


def blank_load(kind: int) -> np.ndarray:
    """A LOAD record of a type that refers to nothing."""
    record = np.zeros((), LOAD)
    record["kind"] = kind
    for field in ("body_vector", "tilted", "primitive", "function", "f", "stroke", "group"):
        record[field] = NONE
    return record


def vector_load(
    kind: int, body_vector: int, vector: Any, following: bool = False, function: int = NONE
) -> np.ndarray:
    """The LOAD record of a force at the end of a body vector, or of a torque on its body."""
    record = blank_load(kind)
    record["body_vector"], record["vector"] = body_vector, vector
    record["following"], record["function"] = following, function
    return record
