"""Inputs and outputs of the linearised motion of a mechanism in absolute coordinates."""

from collections.abc import Callable, Iterator
from typing import TYPE_CHECKING, Any

import numpy as np

from ...kernels.constrained.angle_unwrapping import EXPECTED
from ...kernels.constrained.report import observe_rows
from ...kernels.constrained.system import NO_INERTIA, SOLVED, System
from ...model.arrays.constraint_table import tilde
from ...model.arrays.contacts import columns_of_answers
from ...model.arrays.function_table import fill_law
from ...model.arrays.records import FORCE, FRICTION, TORQUE
from ...model.flexible_mechanism import NodePoint
from ...model.laws import SPRING
from ...model.vectors import rotation_matrix
from ..constrained.rows import DynamicRows
from ..constrained.system import blank_report
from .constrained import ConstrainedLinearised
from .motion import DIFFERENCE_STEP, differentiated
from .state_space import ADMISSIBLE, MOVED_POINT, Input, Responses, Signal, state_signals
from .terms import Terms

if TYPE_CHECKING:
    from ..constrained.flexible_rows import FlexibleRows


AXES = "xyz"
JOINT_DISPLACEMENT = (("displacement", "m"), ("rotation", "rad"))
JOINT_REACTION = (("force", "N"), ("torque", "N m"))


class ConstrainedResponses(Responses):
    """Responses about a ConstrainedLinearised, whose analysis gives `terms` and `driven_system`."""

    motion: ConstrainedLinearised

    def __init__(self, motion: ConstrainedLinearised):
        self.motion, self.analysis = motion, motion.analysis
        self.terms: Terms = self.analysis.terms
        self.signals, self.shift = self.analysis.elements.signals, 0.0 * motion.states
        self.rotations = [rotation_matrix(p) for p in self._poses(motion.q)[:, 3:]]
        self.relative = [
            Signal(f"{name} {what} {axis}", unit)
            for name, _, _ in self.terms.joints
            for what, unit in JOINT_DISPLACEMENT
            for axis in AXES
        ]
        self.observed = self._observed()
        self.inputs = [*self._load_inputs(), *self._driver_inputs()]

    def _poses(self, q: np.ndarray) -> np.ndarray:
        return q[: 7 * self.analysis.arrays.bodies].reshape(-1, 7)

    def _observed(self) -> list[Signal]:
        points = [(name, *what) for name, _ in self.terms.points for what in MOVED_POINT]
        joints = [(name, *what) for name, _, _ in self.terms.joints for what in JOINT_REACTION]
        signals = [
            Signal(f"{name} {what} {axis}", unit) for name, what, unit in points + joints for axis in AXES
        ]
        return signals + [
            Signal(f"{name} effort", "N" if is_length else "N m") for name, is_length in self.terms.drivers
        ]

    def respond(self, d: np.ndarray, w: np.ndarray, model: System | None = None) -> np.ndarray:
        """Return u' (n,) and then the observed outputs where d, w and the model are changed."""
        motion, analysis = self.motion, self.analysis
        report = blank_report(analysis.arrays, np.array([motion.t]))
        report.states[0, :-1] = np.concatenate([*motion.changed(d, w), motion.states + self.shift])
        expected = analysis.integration.angles[EXPECTED][None].copy()
        system, work = model or motion.system, analysis.work
        # A kernel writes a row for every load, and a model may have one more.
        answers = np.zeros((len(system.loads), columns_of_answers(system.loads)))
        work, report = work._replace(responses=answers), report._replace(responses=answers[None].copy())
        filled = observe_rows(system, work, expected, report)
        motion.refuse(SOLVED if filled else NO_INERTIA)
        rows = analysis.block(report)
        return np.concatenate([report.rates[0], self._outputs(rows)])

    def _outputs(self, rows: "FlexibleRows | DynamicRows") -> np.ndarray:
        """Observed outputs of a row: of points and joints along axes that turn with their bodies."""
        moved = [getattr(rows, f"point_{what}")[0] for what, _ in MOVED_POINT]
        outputs = [
            self._along(body, part[k]) for k, (_, body) in enumerate(self.terms.points) for part in moved
        ]
        reactions = rows.reaction_force[0], rows.reaction_torque[0]
        for k, (_, a, b) in enumerate(self.terms.joints):
            outputs += [self._along(b.body if b.body >= 0 else a.body, part[k]) for part in reactions]
        efforts = rows.driver_effort[0]
        return np.concatenate(
            [*outputs, efforts if self.terms.efforts is None else efforts[[*self.terms.efforts]]]
        )

    def _along(self, body: int, vector: np.ndarray) -> np.ndarray:
        return vector if body < 0 else self.rotations[body].T @ vector

    def displacements(self) -> tuple[np.ndarray, np.ndarray]:
        """Return P (6 joints, n) of displacement and rotation of body b against a, its axes, and its rate."""
        motion = self.motion
        at = motion.q, motion.u
        return self._functionals(at), motion.along_motion(self._functionals, at)

    def _functionals(self, state: Any) -> np.ndarray:
        blocks = [self._of_joint(state[0], a, b) for _, a, b in self.terms.joints]
        return np.concatenate(blocks) if blocks else np.zeros((0, self.motion.scale.size))

    def _of_joint(self, q: np.ndarray, a: NodePoint, b: NodePoint) -> np.ndarray:
        place, carried = self._carried(q, b, None)
        block = carried - self._carried(q, a, place)[1]
        if a.body < 0:
            return block
        across = rotation_matrix(self._poses(q)[a.body, 3:]).T
        return np.concatenate([across @ block[:3], across @ block[3:]])

    def _carried(
        self, q: np.ndarray, point: NodePoint, place: np.ndarray | None
    ) -> tuple[np.ndarray, np.ndarray]:
        """Return the position of a point and the displacement (6, n) of its body there or at `place`."""
        arrays, block = self.analysis.arrays, np.zeros((6, self.motion.scale.size))
        if point.body < 0:
            return point.r0, block
        pose, first = self._poses(q)[point.body], self._first_mode(point.body)
        modes = slice(first, first + point.shape.shape[1])
        R = rotation_matrix(pose[3:])
        body_vector = R @ (point.r0 + point.shape @ q[arrays.bodies :][modes])
        own = 6 * point.body
        reach = body_vector if place is None else place - pose[:3]
        block[:3, own : own + 3], block[3:, own + 3 : own + 6] = np.eye(3), R
        block[:3, own + 3 : own + 6], block[:3, modes] = -tilde(reach) @ R, R @ point.shape
        return pose[:3] + body_vector, block

    def _first_mode(self, body: int) -> int:
        """Number of the first modal speed of a body."""
        arrays = self.analysis.arrays
        own = [int(f["first"]) for f in arrays.flexible if f["body"] == body]
        return 6 * arrays.bodies + (own[0] if own else 0)

    def _load_inputs(self) -> Iterator[Input]:
        still, loads = np.zeros(self.motion.scale.size), self.motion.system.loads
        # Elements at joints stand behind the loads that have names, and are no inputs.
        for (name, is_force), load in zip(self.terms.loads, loads, strict=False):
            for signal, records in _unit_loads(name, is_force, load) if name else ():
                yield Input(signal, still, still, self._loaded(records), 1.0)
        for name, is_force, number in self.terms.motors:
            signal = Signal(f"{name} effort", "N" if is_force else "N m")
            yield Input(signal, still, still, self._loaded(_constant_load(loads[number])), 1.0)

    def _loaded(self, records: Callable[..., Any]) -> Callable[..., Any]:
        system = self.motion.system

        def change(amount: float) -> System:
            # Friction stays behind all others.
            rubs = system.loads["kind"] == FRICTION
            return system._replace(
                loads=np.concatenate([system.loads[~rubs], records(amount), system.loads[rubs]])
            )

        return change

    def _driver_inputs(self) -> Iterator[Any]:
        for k, (name, is_length) in enumerate(self.terms.drivers):
            yield from self._inputs_of_driver(k, name, "m" if is_length else "rad")

    def _inputs_of_driver(self, k: int, name: str, unit: str) -> Iterator[Input]:
        """Inputs of a driver, its rate and its acceleration; none where other drivers forbid the change."""
        motion, still = self.motion, np.zeros(self.motion.scale.size)
        changes = [self._driven(k, order) for order in range(3)]
        asked = differentiated(lambda x: motion.rate_gaps(still, still, changes[1](x)), DIFFERENCE_STEP)
        d = motion.projected(asked)
        if np.max(np.abs(motion.rate_gaps(still, d) - motion.rate_gaps(still, still) + asked)) > ADMISSIBLE:
            return
        turned = differentiated(lambda x: motion.rate_gaps(x * d, still, changes[0](x)), DIFFERENCE_STEP)
        yield from self.inputs_of_driver(name, unit, d, motion.projected(turned), changes)

    def _driven(self, k: int, order: int) -> Callable[..., Any]:
        def change(amount: float) -> System:
            additions = [0.0, 0.0, 0.0]
            additions[order] = amount
            return self.analysis.driven_system(k, additions, self.motion.t)

        return change


def _unit_loads(name: str, is_force: bool, load: np.void) -> Iterator[tuple[Signal, Callable[..., Any]]]:
    """Signals of a load, each with the records that add so much of it."""
    if load["kind"] in (FORCE, TORQUE):
        unit = "N" if load["kind"] == FORCE else "N m"
        for k, axis in enumerate(AXES):
            yield Signal(f"{name} {axis}", unit), _vector_load(load, k)
    elif load["in_line"] == 1:
        pull = _constant_load(load)
        yield Signal(f"{name} tension", "N"), lambda amount: pull(-amount)
    else:
        yield Signal(f"{name} effort", "N" if is_force else "N m"), _constant_load(load)


def _vector_load(load: np.void, axis: int) -> Callable[..., Any]:
    def records(amount: float) -> np.ndarray:
        record = np.array([load])
        record["function"], record["vector"] = -1, amount * np.eye(3)[axis]
        return record

    return records


def _constant_load(load: np.void) -> Callable[..., Any]:
    """The record of a load that acts with a constant effort along the coordinate of an element."""

    def records(amount: float) -> np.ndarray:
        record = np.array([load])
        # A spring without stiffness has its preload only.
        fill_law(record, SPRING, SPRING.values(preload=-amount))
        return record

    return records


def constrained_signals(motion: ConstrainedLinearised) -> tuple[Signal, ...]:
    """Return the signals of the states of a ConstrainedLinearised."""
    arrays, names, units = motion.analysis.arrays, [], []
    for k in motion.free:
        if k >= 6 * arrays.bodies:
            names.append(arrays.speed_name(k))
            units.append("m or 1")
        else:
            what, unit = JOINT_DISPLACEMENT[k % 6 // 3]
            names.append(f"{arrays.body_names[k // 6]} {what} {AXES[k % 3]}")
            units.append(unit)
    return state_signals(names, units, [motion.coordinates.parent_name(k) for k in motion.free])
