"""Kane's equations of a tree with elements at its hinges and between its bodies: the second formulation.

Generalised forces of the elements are found from their definitions and handed to the recursion as loads.
Couplings and friction, whose efforts depend on the accelerations, use that these are linear in the efforts:
the recursion answers a unit effort, and normal forces follow from the force that the bodies beyond a hinge
need by Newton's law.  Steps are those of scipy's DOP853, or of its Radau where the deck's method is implicit;
couplings and loops hold by their accelerations.
"""

import math
from collections.abc import Iterator
from typing import TYPE_CHECKING, Any

import numpy as np

from ...errors import AnalysisError, Fault
from ...kernels.constrained.dry_friction import COMPONENTS, PRELOAD, fill_normal_forces
from ...kernels.integrators.clock import NO_INERTIA
from ...kernels.integrators.tree_dop853 import GO_ON
from ...model.arrays.tree import FUNCTION, body_frames
from ...model.integrators import IMPLICIT_TREE_METHODS
from ...model.time_functions import MotionFunction
from ...model.tree import Prescribed, Tree
from ...model.tree_as_mechanism.frames import hinge_frames
from ...quick_dataclass import fields, replace
from ..compilation import interpreting
from ..constrained.coinciding_ends import refuse_undirected_lines
from ..constrained.failures import MOMENTS, bushing_failure, jam_failure
from ..constrained.tree_element_rows import TreeElementRows
from .analysis import TreeAnalysis, breakpoints, set_functions
from .element_forces import COORDINATE, EFFORT, ENERGY, KEPT, RATE, ElementForces, filled, stored_energy
from .friction_in_hinges import FrictionInHinges
from .loop_assembly import closed_tree
from .placed_bodies import PlacedBodies
from .rows import TreeRows
from .scipy_integrators import UNCOUNTED, jacobian_of

if TYPE_CHECKING:
    from collections.abc import Callable

    from scipy.integrate import DOP853, Radau


class TreeWithElements(TreeAnalysis):
    """One run over the report times of a tree with elements."""

    def __init__(self, tree: Tree):
        closed = closed_tree(tree, hinge_frames(tree))
        drives = [
            Prescribed(item.joint, *_motion_and_axis(item.coordinate), 0.0, 0.0, 0.0)
            for item in tree.elements.drivers
        ]
        super().__init__(replace(closed, prescribed=(*closed.prescribed, *drives)))
        self.model = closed
        self.n = len(tree.coordinates)
        efforts = np.zeros(self.n, FUNCTION)
        efforts["coordinate"] = np.arange(self.n)
        self.loads = self.arrays.functions.size
        self.arrays = self.arrays._replace(functions=np.concatenate([self.arrays.functions, efforts]))
        self.frames = body_frames(self.arrays)
        self.own = {name: self.arrays.frames[name][self.frames] for name in ("force", "torque")}
        self._place(tree.time.start, self.state.copy())
        self.forces = ElementForces(closed, self.work["axes"][self.frames].reshape(-1, 3, 3))
        self.friction = FrictionInHinges(closed, self.forces.number)
        self.terms = self._coupling_terms()
        self.answers = filled(0, ())
        self.multipliers = np.zeros(len(self.terms))  # of the couplings
        self.stop = math.inf  # s, end of the formulas in force
        self.jams = False  # no normal forces of friction agree with the motion of the last slope
        self.energy = self._energy_at(tree.time.start, self.state.copy())

    def _coupling_terms(self) -> np.ndarray:
        """Factors (couplings, NS) of the coordinates."""
        factors = np.zeros((len(self.model.elements.couplings), self.n))
        for row, item in zip(factors, self.model.elements.couplings, strict=True):
            for joint, coordinate, factor in item.terms:
                row[self.forces.number[joint, coordinate]] += factor / item.scale
        return factors

    def rows(self) -> Iterator[TreeElementRows]:
        """Yield the report rows; raises AnalysisError without inertia, or where steps vanish."""
        grid, z = self.tree.time, self.state.copy()
        t, end = grid.start, grid.time(grid.rows - 1)
        self.slope(t, z)
        refuse_undirected_lines(self.model.elements.lines, self.forces.lengths(self.answers), t)
        z = np.append(z, np.zeros(len(self.answers)))
        for stop in [*self._stops(t, end), end]:
            set_functions(self.tree, self._deck_functions, t, stop)
            self.stop = stop if stop > t else math.inf
            yield from self._observed(lambda _t, z=z: z, t)
            if stop > t:
                solver = self._solver(t, z, stop)
                while solver.status == "running":
                    self._step(solver)
                    yield from self._observed(solver.dense_output(), solver.t)
                t, z = stop, solver.y

    @property
    def _deck_functions(self) -> Any:
        """The arrays without the efforts of elements."""
        return self.arrays._replace(functions=self.arrays.functions[: self.loads])

    def _step(self, solver: "DOP853 | Radau") -> None:
        """Make one step; raises AnalysisError where none succeeds."""
        try:
            solver.step()
        except ValueError:  # Radau's method meets slopes that are no numbers in a matrix
            solver.status = "failed"
        if solver.status == "failed":
            raise self._force_failure(solver.t) or self._failure_ahead(solver) or _vanished(solver.t)

    def _failure_ahead(self, solver: "DOP853 | Radau") -> AnalysisError | None:
        """Return why elements have no force where the speeds lead the state in a moment, or None."""
        z, span = solver.y[: self.state.size], self.tree.time.end - self.tree.time.start
        slope = self.slope(solver.t, z)
        for share in MOMENTS:
            self.slope(solver.t, z + share * span * slope)
            if failure := self._force_failure(solver.t):
                return failure
        return None

    def _solver(self, t: float, z: np.ndarray, stop: float) -> "DOP853 | Radau":
        from scipy.integrate import DOP853, Radau  # half of the memory of `check`, which makes no step

        atol = np.full(z.size, self.tree.integration.atol)
        atol[self.state.size - 1 :] = UNCOUNTED
        rtol = max(self.tree.integration.rtol, 100 * np.finfo(float).eps)
        given: dict[str, Any] = {"rtol": rtol, "atol": atol, "max_step": self.tree.time.step}
        if self.tree.integration.method in IMPLICIT_TREE_METHODS:
            return Radau(self._slope_with_works, t, z, stop, jac=jacobian_of(self._slope_with_works), **given)
        return DOP853(self._slope_with_works, t, z, stop, **given)

    def _stops(self, start: float, end: float) -> list[float]:
        """Times at which a load of the deck or a function of an element changes its formula."""
        elements = self.model.elements
        functions = [item.function for item in elements.motors]
        functions += [item.function for item in elements.drivers]
        found = {t for function in functions for t in _corners(function)}
        found |= set(breakpoints(self.model, start, end))
        return sorted(t for t in found if start < t < end)

    def _observed(self, state_at: "Callable[..., Any]", t: float) -> Iterator[TreeElementRows]:
        for time in self.due_times(t):
            z, works = np.split(state_at(time), [self.state.size])
            # Rows show what a motor does behind a jump.
            stop, self.stop = self.stop, math.inf
            self.slope(time, z)
            self.stop = stop
            if failure := self._force_failure(time):
                raise failure
            self.clock["stop"] = np.inf
            rows = self.observe(lambda _t, z=z: z, [time])
            yield self._with_answers(rows, works)

    def _with_answers(self, rows: TreeRows, works: np.ndarray) -> TreeElementRows:
        """The row with what the elements answered last; energy of elements is no work of loads."""
        kept = {field.name: getattr(rows, field.name) for field in fields(TreeRows)}
        energy = stored_energy(self.answers)
        kept["potential"], kept["applied_work"] = (
            rows.potential + energy,
            rows.applied_work + energy - self.energy,
        )
        columns: dict[str, Any] = {
            "element_coordinate": self.answers[:, COORDINATE],
            "element_rate": self.answers[:, RATE],
            "element_effort": self.answers[:, EFFORT],
            "element_power": self._powers(),
            "element_energy": self.answers[:, ENERGY],
            "element_work": works,
            "coupling_effort": self.multipliers / [item.scale for item in self.model.elements.couplings],
            "driver_effort": self.coordinates["drive"][self.arrays.prescribed["coordinate"]],
        }
        dissipated = np.array([-works[: works.size - len(self.model.elements.motors)].sum()])
        arrays: dict[str, Any] = {name: np.array(row)[None] for name, row in columns.items()}
        return TreeElementRows(**kept, **arrays, dissipated=dissipated)

    def _powers(self) -> np.ndarray:
        """Return the power of each element, W, as it answered last; that of stored energy is left out."""
        found: np.ndarray = (self.answers[:, EFFORT] - self.answers[:, KEPT]) * self.answers[:, RATE]
        return found

    def _slope_with_works(self, t: float, z: np.ndarray) -> np.ndarray:
        """The slope of a state with the works of the elements behind it."""
        slope = self.slope(t, z[: self.state.size])
        known = np.isfinite(slope).all()
        return np.append(slope, self._powers() if known else np.full(z.size - slope.size, np.nan))

    def slope(self, t: float, z: np.ndarray) -> np.ndarray:
        """z' (n,); leaves the loads of the elements in the arrays and their answers in `answers`.

        Not numbers where an element has no force, see `_force_failure`, or the state none.
        """
        unknown = np.full(z.size, np.nan)
        if not np.isfinite(z).all():
            return unknown
        placed = self._place(t, z)
        motors = self.forces.add_motors(placed, self._within(t))
        self.answers = self.forces.add(placed)
        if self.forces.overturned is not None:
            return unknown
        normals = self._normals(t, z, placed)
        self.jams = not np.isfinite(normals).all()
        if self.jams:
            return unknown
        slope = self._moved(t, z, placed, placed.effort + self.friction.efforts(normals, placed.y))
        rubbed = [(0.0, v, effort, 0.0, 0.0) for v, effort in self.friction.answers(normals, placed.y)]
        self.answers = np.concatenate([self.answers, filled(len(rubbed), rubbed), motors])
        return slope

    def _within(self, t: float) -> float:
        """The time t, or the last one before the next stop: a motor's table may jump there."""
        return min(t, math.nextafter(self.stop, -math.inf))

    def _force_failure(self, t: float) -> AnalysisError | None:
        """Return why elements had no force in the last slope, or None."""
        if self.forces.overturned is not None:
            return bushing_failure(self.forces.overturned, float(t))
        return jam_failure(float(t)) if self.jams else None

    def _normals(self, t: float, z: np.ndarray, placed: PlacedBodies) -> np.ndarray:
        """Normal forces (frictions,) that agree with the forces in the hinges, which they change."""
        count = len(self.friction.items)
        forces, normals = np.zeros((1 + count, count, COMPONENTS)), np.zeros(count)
        size = 1.0
        for k in range(1 + count if count else 0):
            unit = size * (np.arange(1, 1 + count) == k)
            self._moved(t, z, placed, placed.effort + self.friction.efforts(unit, placed.y))
            forces[k, :, :PRELOAD] = self.friction.forces_across(self, placed)
            if k == 0:
                forces[0, :, PRELOAD] = self.friction.preloads
                # Differences are formed from changes of the forces' own size.
                size = float(np.max(np.abs(forces[0]))) or 1.0
        forces[1:, :, :PRELOAD] = (forces[1:, :, :PRELOAD] - forces[0, :, :PRELOAD]) / size
        with interpreting():
            fill_normal_forces(forces, normals)
        return normals

    def _energy_at(self, t: float, z: np.ndarray) -> float:
        return stored_energy(self.forces.add(self._place(t, z)))

    def _place(self, t: float, z: np.ndarray) -> PlacedBodies:
        """The bodies at a state, driven coordinates where their functions are."""
        for record, item in zip(
            self.arrays.prescribed[len(self.model.prescribed) :], self.model.elements.drivers, strict=True
        ):
            value, rate, second = item.function.at(t)
            record["C"], record["B"] = value - rate * t + 0.5 * second * t * t, rate - second * t
            record["A"] = second
        self._load(np.zeros((len(self.frames), 3)), np.zeros((len(self.frames), 3)), np.zeros(self.n))
        self._recursion(t, z)
        y, q = self.state[: self.n].copy(), self.state[self.n : 2 * self.n].copy()
        return PlacedBodies(self.model, self.work[self.frames].copy(), q, y)

    def _moved(self, t: float, z: np.ndarray, placed: PlacedBodies, effort: np.ndarray) -> np.ndarray:
        """z' under the forces of `placed` and generalised efforts, couplings kept by efforts of their own."""
        self._load(placed.force, placed.torque, effort)
        slope = self._recursion(t, z)
        if not len(self.terms):
            return slope
        gaps, answers = self.terms @ slope[: self.n], []
        for factors in self.terms:
            self._load(placed.force, placed.torque, effort + factors)
            answers.append(self.terms @ self._recursion(t, z)[: self.n] - gaps)
        self.multipliers = np.linalg.lstsq(np.array(answers).T, -gaps, rcond=1e-12)[0]
        self._load(placed.force, placed.torque, effort + self.multipliers @ self.terms)
        return self._recursion(t, z)

    def _load(self, force: np.ndarray, torque: np.ndarray, effort: np.ndarray) -> None:
        self.arrays.frames["force"][self.frames] = self.own["force"] + force
        self.arrays.frames["torque"][self.frames] = self.own["torque"] + torque
        self.arrays.functions["c0"][self.loads :] = effort

    def _recursion(self, t: float, z: np.ndarray) -> np.ndarray:
        self.clock["t"], self.state[:] = t, z
        if self.call(GO_ON) == NO_INERTIA:
            raise self.failure()
        found: np.ndarray = self.integration.slopes[0].copy()
        return found


def _motion_and_axis(coordinate: str) -> tuple[str, int]:
    motion, axis = coordinate.split()
    return motion, int(axis)


def _corners(function: MotionFunction) -> Iterator[float]:
    """Times at which a function changes its formula."""
    yield from function.times
    yield from (piece[0] for piece in function.pieces)
    for factors in function.terms:
        for factor in factors:
            yield from _corners(factor)


def _vanished(t: float) -> AnalysisError:
    message = (
        f"at t = {t:.6g} s Kane's equations with elements find no step that meets the tolerance; "
        "take a larger --rtol, or softer elements"
    )
    return AnalysisError(Fault("error", message, id="SOLVE-037"), float(t))
