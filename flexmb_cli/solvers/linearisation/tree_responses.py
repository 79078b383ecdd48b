"""Inputs and outputs of the linearised motion of a tree."""

from collections.abc import Callable, Iterator
from typing import Any

import numpy as np

from ...model.arrays.tree import TreeArrays, body_frames
from ...model.joint_elements import parts_in_arrays
from ...model.laws import DRIVING
from ...model.tree import ELASTIC, INERTIAL, ROTATION, Coordinate
from ..constrained.tree_element_rows import TreeElementRows
from ..tree.loop_assembly import gap_rates
from ..tree.points import point_motion, point_names, rotation_matrices
from .state_space import ADMISSIBLE, MOVED_POINT, Input, Responses, Signal, state_signals
from .tree import TreeLinearised

AXES = "xyz"
EFFORT_OF = {"rad": "N m", "m": "N"}


class TreeResponses(Responses):
    """Responses about a TreeLinearised."""

    motion: TreeLinearised

    def __init__(self, motion: TreeLinearised):
        self.motion, self.analysis = motion, motion.analysis
        self.tree, self.arrays = self.analysis.tree, motion.arrays
        self.n = motion.scale.size
        self.signals, self.shift = self.tree.elements.signals, 0.0 * motion.signals.states
        self.relative = [Signal(c.name, _unit(c)) for c in self.tree.coordinates if c.motion != ELASTIC]
        self._axes = self._point_axes()
        prescribed = self.arrays.prescribed["coordinate"][: len(self.tree.prescribed)]
        self._drivers = [self.tree.coordinates[m].name for m in prescribed]
        self._drivers += [item.name for item in self.tree.elements.drivers]
        self.observed = self._observed()
        self.inputs = [
            *self._function_inputs(),
            *self._body_inputs(),
            *self._node_inputs(),
            *self._driver_inputs(),
        ]

    def _observed(self) -> list[Signal]:
        names = [
            name for name, axes in zip(point_names(self.tree), self._axes, strict=True) if axes is not None
        ]
        points = [(name, *what) for name in names for what in MOVED_POINT]
        closures = [(closure.name, "force", "N") for closure in self.tree.closures]
        vectors = [Signal(f"{n} {what} {axis}", unit) for n, what, unit in points + closures for axis in AXES]
        drivers = zip(self._drivers, self.arrays.prescribed["coordinate"], strict=True)
        efforts = [
            Signal(f"{name} effort", EFFORT_OF[_unit(self.tree.coordinates[m])]) for name, m in drivers
        ]
        return vectors + efforts * bool(self.tree.elements)

    def _rows(self, z: np.ndarray, arrays: TreeArrays) -> Any:
        """The report row of a state, of the tree with other `arrays`."""
        analysis = self.analysis
        before = analysis.arrays, analysis.row, analysis.attitude, analysis.clock.copy()
        analysis.arrays, analysis.clock["t"] = arrays, self.motion.t
        try:
            return analysis.observe(lambda t: z, [self.motion.t])
        finally:
            analysis.arrays, analysis.row, analysis.attitude, analysis.clock[:] = before

    def _point_axes(self) -> list[np.ndarray | None]:
        """Axes (3, 3) of the bodies whose points they are; None for hinges at rest on the inertial frame."""
        rows = self._rows(self.motion.z, self.arrays)
        axes = rotation_matrices(rows.euler_parameters[0])
        bodies = [hinge.parent for hinge in self.tree.hinges]
        for k, body in enumerate(self.tree.bodies):
            bodies += [k] * (len(body.elastic.masses) if body.elastic else 0)
        return [None if body == INERTIAL else axes[body] for body in bodies]

    def respond(self, d: np.ndarray, w: np.ndarray, model: TreeArrays | None = None) -> np.ndarray:
        """Return u' (n,) and then the observed outputs where d, w and the arrays are changed."""
        arrays = model or self.arrays
        z = self.motion.changed(d, w) + (self.motion.state_with(self.shift) - self.motion.z)
        rows = self._rows(z, arrays)
        motion = point_motion(self.tree, rows)
        moving = [(k, axes) for k, axes in enumerate(self._axes) if axes is not None]
        parts = [axes.T @ part[0, k] for k, axes in moving for part in motion]
        efforts = rows.driver_effort[0] if isinstance(rows, TreeElementRows) else np.zeros(0)
        return np.concatenate([rows.y_rate[0], *parts, rows.closure_force[0].ravel(), efforts])

    def displacements(self) -> tuple[np.ndarray, np.ndarray]:
        """Return P (hinge coordinates, n), and its rate, zero."""
        rigid = [m for m, c in enumerate(self.tree.coordinates) if c.motion != ELASTIC]
        P = np.eye(self.n)[rigid]
        return P, np.zeros_like(P)

    def _function_inputs(self) -> Iterator[Input]:
        """Torques on bodies and motors."""
        still = np.zeros(self.n)
        signals = [
            Signal(f"{self.tree.bodies[torque.body].name} torque {AXES[torque.axis - 1]}", "N m")
            for torque in self.tree.torques
        ]
        for k, signal in enumerate(signals):
            yield Input(signal, still, still, self._changed("torques", "constant", k), 1.0)
        for item, k in parts_in_arrays(self.tree.elements.forces):
            if item.law in DRIVING:
                signal = Signal(f"{item.name} effort", "N m" if item.turning else "N")
                yield Input(signal, still, still, self._changed("elements", "c", (k, 0)), 1.0)

    def _body_inputs(self) -> Iterator[Any]:
        """Constant forces and torques of bodies that have some, inertial axes."""
        still = np.zeros(self.n)
        for body, frame in zip(self.tree.bodies, body_frames(self.arrays), strict=True):
            for what, unit in (("force", "N"), ("torque", "N m")):
                for axis in range(3) if any(getattr(body, what)) else ():
                    signal = Signal(f"{body.name} constant {what} {AXES[axis]}", unit)
                    yield Input(signal, still, still, self._changed("frames", what, (frame, axis)), 1.0)

    def _node_inputs(self) -> Iterator[Any]:
        """Constant forces of nodes that have some, inertial axes."""
        still, coordinates = np.zeros(self.n), self.tree.coordinates
        nodal_masses = [
            ("nodal_masses", k, max(nodal_mass["coordinate"]))
            for k, nodal_mass in enumerate(self.arrays.nodal_masses)
        ]
        frames = [
            ("frames", k, f["first_translation"])
            for k, f in enumerate(self.arrays.frames)
            if f["translations"]
        ]
        for records, k, m in nodal_masses + frames:
            node = coordinates[m]
            if node.motion != ELASTIC or not np.any(getattr(self.arrays, records)["force"][k]):
                continue
            for axis in range(3):
                name = f"{self.tree.bodies[node.body].name} node {node.node + 1} force {AXES[axis]}"
                yield Input(Signal(name, "N"), still, still, self._changed(records, "force", (k, axis)), 1.0)

    def _changed(self, records: str, field: str, place: Any) -> Callable[..., Any]:
        def change(amount: float) -> TreeArrays:
            array = getattr(self.arrays, records).copy()
            array[field][place] += amount
            return self.arrays._replace(**{records: array})

        return change

    def _driver_inputs(self) -> Iterator[Any]:
        for k, record in enumerate(self.arrays.prescribed):
            yield from self._inputs_of_driver(k, int(record["coordinate"]))

    def _inputs_of_driver(self, k: int, m: Any) -> Iterator[Any]:
        """Inputs of a prescribed coordinate, its rate and its acceleration; none where loops forbid it."""
        motion, one = self.motion, np.eye(self.n)[m]
        gaps = gap_rates(self.analysis, motion.z, one)
        d = one + motion.projected(-gaps)
        if np.max(np.abs(gap_rates(self.analysis, motion.z, d)), initial=0.0) > ADMISSIBLE:
            return
        name, unit = self._drivers[k], _unit(self.tree.coordinates[m])
        changes = [self._prescribed(k, order) for order in range(3)]
        yield from self.inputs_of_driver(name, unit, d, motion.companion(d), changes)

    def _prescribed(self, k: int, order: Any) -> Any:
        def change(amount: float) -> Any:
            prescribed, t = self.arrays.prescribed.copy(), self.motion.t
            value, rate, second = amount * np.eye(3)[order]
            prescribed["C"][k] += value - rate * t + 0.5 * second * t * t
            prescribed["B"][k] += rate - second * t
            prescribed["A"][k] += second
            return self.arrays._replace(prescribed=prescribed)

        return change


def _unit(coordinate: Coordinate) -> str:
    return "rad" if coordinate.motion == ROTATION else "m"


def tree_signals(motion: TreeLinearised) -> Any:
    """Return the signals of the states of a TreeLinearised."""
    coordinates = [motion.analysis.tree.coordinates[m] for m in motion.free]
    return state_signals([c.name for c in coordinates], map(_unit, coordinates), [""] * len(coordinates))
