"""Elements of a tree → records: what each measures, and its law.

A measure is a hinge coordinate, the distance of two points, or a displacement or turn between the frames of a
bushing; a point may be a node, which elastic coordinates displace along the axes of its body.
"""

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from ..joint_elements import parts_by_name
from ..laws import FRICTION, Along, At, Cam, Frames, Push, Touch
from ..tree import ELASTIC, INERTIAL, ROTATION, TRANSLATION, Tree
from .contacts import END, ContactTable, columns_of_answers, fill_contact
from .function_table import FunctionTable, fill_bushing, fill_law
from .records import LAW
from .signals import signal_arrays

if TYPE_CHECKING:
    from ..flexible_mechanism import NodePoint

# What an element measures.
IN_COORDINATE, IN_LINE, ALONG, ABOUT, BETWEEN, PUSHED, TWISTED = 0, 1, 2, 3, 4, 5, 6
OF_BUSHING = 6  # records: three displacements, three angles

TREE_ELEMENT = np.dtype(
    [
        ("measure", np.int64),  # IN_COORDINATE, IN_LINE, ALONG, ABOUT, BETWEEN shapes, PUSHED or TWISTED
        ("coordinate", np.int64),  # IN_COORDINATE: number of the hinge coordinate; BETWEEN: CONTACT_SET
        ("curve", np.int64),  # IN_COORDINATE: function of a cam that is taken off, among `curves`, -1: none
        ("cam", np.int64),  # number of the coordinate that `curve` is a function of
        ("slope", np.float64),  # of `curve`, as it was evaluated last, m or rad per m or rad
        ("frame_i", np.int64),  # FRAME of the first body, 0: inertial
        ("frame_j", np.int64),  # FRAME of the second body
        # Undeformed, axes of frame i, m; PUSHED, TWISTED: the direction, a unit vector.
        ("point_i", np.float64, 3),
        ("point_j", np.float64, 3),  # undeformed, axes of frame j, m
        ("node_i", np.int64, 3),  # elastic coordinates that displace it along axis 1, 2, 3; -1: none
        ("node_j", np.int64, 3),  # the same of the second
        ("axis", np.int64),  # ALONG, ABOUT: axis of frame i, 0 to 2; PUSHED, TWISTED: 1 if it follows frame j
        ("turned", np.float64, 9),  # ABOUT: axes of the bushing on frame j, in its axes, row by row
        ("resists", np.int64),  # ABOUT: whether there is a torque: then it must not overturn
        ("expected", np.float64),  # ABOUT: angle found last, from which whole turns continue, rad
        ("until", np.float64),  # s: functions of time hold what they are just before it
        ("force", np.float64, 3),  # on body j at `place` per unit effort, opposite on i, inertial axes
        ("torque", np.float64, 3),  # ABOUT: on body j per unit effort, opposite on i, inertial axes
        ("place", np.float64, 3),  # inertial axes, m
        *LAW.descr,
    ]
)

TREE_FRICTION = np.dtype(
    [
        ("frame", np.int64),  # FRAME of the body whose hinge it is
        ("turning", np.int64),  # coordinate of its rotation, -1: none
        ("sliding", np.int64),  # coordinate of its translation, -1: none
        ("turning_effort", np.float64),  # by the normal force 1 N, N m
        ("sliding_effort", np.float64),  # by the normal force 1 N, N
        *LAW.descr,
    ]
)


# A pivot below this part of the row's own response means that other rows close this direction too.
REPEATED = 1e-9
# One closed direction of a closure, or a coupling: what it is, then what the kernels found for it last.
# Types of rows that close a direction.
AXIS_ROW, VECTOR_ROW, TURN_ROW = 0, 1, 2
CLOSURE_ROW = np.dtype(
    [
        ("frame_a", np.int64),  # number of the first FRAME
        ("frame_b", np.int64),  # number of the second FRAME
        ("point_a", np.float64, 3),  # axes of frame a, m; of a turn the unit vector w of frame a
        ("point_b", np.float64, 3),  # axes of frame b, m
        ("type", np.int64),  # of a closed direction: AXIS_ROW, VECTOR_ROW or TURN_ROW
        ("axis", np.int64),  # 0, 1, 2 of frame b; of a point on a curve its normal, of rolling its direction
        ("coupling", np.int64),  # number of the coupling, -1: a closed direction
        ("value", np.float64),  # which the sum of a coupling keeps, m or rad, or w . v of a turn
        ("curve", np.int64),  # function of a cam, or first of three of a curve, among `curves`, -1: none
        ("cam", np.int64),  # coordinate that the function of a cam is of
        ("bend", np.float64),  # what cam, curve or rolling adds to the second rate, m/s² or rad/s²
        # Unit vector, axes of frame b: nowhere along a curve; the closed direction; v of a turn.
        ("across", np.float64, 3),
        ("roll", np.int64),  # rolling on a plane or a wheel, see `kernels.rolling`, 0: none
        ("axle", np.float64, 3),  # of the disc, axes of frame a, or zeros
        ("normal", np.float64, 3),  # of the plane, or axle of the wheel, axes of frame b
        ("radius", np.float64, 2),  # of the disc on frame a, of the wheel on frame b, m
        ("parameter", np.float64),  # of a curve at the point, found last, its own unit
        ("advance", np.float64),  # rate of the parameter, per s
        ("direction", np.float64, 3),  # of that axis, inertial axes
        ("place", np.float64, 3),  # of point a, inertial axes, m
        ("gap", np.float64),  # (p_a - p_b) . direction, m
        ("rate", np.float64),  # its rate, m/s
        ("force", np.float64),  # along the direction on body a, and opposite on body b, N
        ("repeated", np.float64),  # pivot, share of `own`, below which others close the direction
        ("own", np.float64),  # acceleration per unit force, 1/kg, before elimination
        ("order", np.int64),  # the row that is eliminated in this place
    ]
)


class TreeElements:
    """Arrays of the elements of a tree in the order of their results."""

    def __init__(self, tree: Tree, index: Mapping[Any, Any], of_body: Sequence[int]):
        self.tree, self.index, self.of_body = tree, index, of_body
        self.table = FunctionTable()
        self._contacts = ContactTable()
        self._contacts.joined |= {frozenset((k, hinge.parent)) for k, hinge in enumerate(tree.hinges)}

    def arrays(self) -> dict[str, Any]:
        """Fields of TreeArrays; drivers must have been added."""
        elements, frictions, sensors = self._elements(), self._frictions(), self._sensors()
        signals = signal_arrays(
            self.tree.elements.signals,
            self.table,
            parts_by_name(self.tree.elements.forces),
            self._contacts.bristles,
        )
        m, curves = frictions.size, self.table.function_arrays()
        return {
            "elements": elements,
            "frictions": frictions,
            "joint_forces": np.zeros((1 + m, m, 5)),
            "normals": np.zeros(m),
            "answers": np.zeros((elements.size + m, columns_of_answers(elements))),
            "sensors": sensors,
            "signals": signals,
            "curves": curves["functions"],
            "knots": curves["knots"],
            "contacts": self._contacts.arrays(),
        }

    def couplings(self) -> np.ndarray:
        """Factors (C, NS) of the coordinates in the couplings."""
        matrix = np.zeros((len(self.tree.elements.couplings), len(self.tree.coordinates)))
        for row, item in zip(matrix, self.tree.elements.couplings, strict=True):
            for joint, coordinate, factor in item.terms:
                row[self.coordinate(joint, coordinate)] += factor / item.scale
        return matrix

    def coupling_rows(self) -> np.ndarray:
        """The CLOSURE_ROW records of the couplings."""
        couplings = self.tree.elements.couplings
        records = np.zeros(len(couplings), CLOSURE_ROW)
        records["coupling"], records["repeated"], records["curve"] = np.arange(len(couplings)), REPEATED, -1
        for row, item in zip(records, couplings, strict=True):
            if item.function:
                row["curve"] = self.table.function(item.function, of_time=False)
                row["cam"] = self.coordinate(*item.terms[-1][:2])
        return records

    def _sensors(self) -> np.ndarray:
        """The TREE_ELEMENT records that the sensors of signals measure by."""
        signals = [signal for signal in self.tree.elements.signals if signal.measure is not None]
        sensors = np.zeros(len(signals), TREE_ELEMENT)
        for k, signal in enumerate(signals):
            self._measure(sensors[k : k + 1], signal.measure)
        return sensors

    def _measure(self, records: Any, measure: Any) -> None:
        records["curve"] = -1
        if isinstance(measure, At | Cam):
            records["measure"], records["coordinate"] = IN_COORDINATE, self.coordinate(*measure[:2])
            if isinstance(measure, Cam):
                records["cam"] = self.coordinate(*measure[2:4])
                records["curve"] = self.table.function(measure.function, of_time=False)
        elif not isinstance(measure, Touch):
            self._place(records, measure)
        if isinstance(measure, Along):
            records["measure"], records["axis"] = ALONG, measure.axis

    def _elements(self) -> np.ndarray:
        """The TREE_ELEMENT records: those of `names_of` without friction."""
        forces = [item for item in self.tree.elements.forces if item.law is not FRICTION]
        elements, at = np.zeros(sum(len(item.parts) for item in forces), TREE_ELEMENT), 0
        for item in forces:
            records = elements[at : at + len(item.parts)]
            self._measure(records, item.measure)
            if isinstance(item.measure, Frames):
                records["measure"], records["axis"] = 3 * [ALONG] + 3 * [ABOUT], 2 * [0, 1, 2]
                fill_bushing(records, item)
                records["resists"] = records["c"].any(axis=1)
            elif isinstance(item.measure, Push):
                records["measure"] = TWISTED if item.measure.turning else PUSHED
                records["axis"], records["point_i"] = item.measure.follows, item.measure.direction
                fill_law(records, item.law, item.values, self.table)
            elif isinstance(item.measure, Touch):
                records["measure"], records["coordinate"] = BETWEEN, self._contacts.add(item, self._end)
                fill_contact(records, item)
            else:
                fill_law(records, item.law, item.values, self.table)
            at += len(item.parts)
        return elements

    def _frictions(self) -> np.ndarray:
        """The TREE_FRICTION records."""
        frictions = self.tree.elements.of(FRICTION)
        records = np.zeros(len(frictions), TREE_FRICTION)
        for record, item in zip(records, frictions, strict=True):
            joint = item.measure.joint
            hinge = self.tree.hinges[joint]
            record["frame"] = self.of_body[joint]
            record["turning"], record["sliding"] = (
                self.index[joint, motion, axes[0], None] if axes else -1
                for motion, axes in ((ROTATION, hinge.rotations), (TRANSLATION, hinge.translations))
            )
            fill_law(record, item.law, item.values)
            if item.sticks:
                record["bristle"] = self._contacts.new_bristles(2)
        return records

    def coordinate(self, joint: int, coordinate: str) -> int:
        """Number of a hinge coordinate such as "rotation 1"."""
        motion, axis = coordinate.split()
        return int(self.index[joint, motion, int(axis), None])

    def _place(self, record: Any, ends: Any) -> None:
        """Fill the ends of a line, or of the six records of a bushing, which are attached at the start."""
        record["measure"] = IN_LINE
        for side, body, point in (("i", ends.i, ends.P_i), ("j", ends.j, ends.P_j)):
            end = self._end(body, point)
            for field in ("frame", "point", "node"):
                record[f"{field}_{side}"] = end[field]

    def _end(self, body: int, point: "NodePoint") -> np.ndarray:
        """The END record of a point of a body."""
        record = np.zeros((), END)
        record["frame"] = 0 if body == INERTIAL else self.of_body[body]
        record["point"], record["node"] = point.r0, self._node(point)
        return record

    def _node(self, point: "NodePoint") -> list[int]:
        """Elastic coordinates that move a node along the axes of its body, -1 where none does."""
        own = [m for m, c in enumerate(self.tree.coordinates) if (c.motion, c.body) == (ELASTIC, point.body)]
        rows = np.asarray(point.shape)
        return [own[int(np.argmax(row))] if row.size and np.any(row) else -1 for row in rows]
