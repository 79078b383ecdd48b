"""Forward dynamics of a YOUNG deck's mechanism: its motion under loads and drivers.

Inverse dynamics of a mechanism whose drivers at joints, couplings and supports prescribe its motion.

The equations leave no speed free: every row is found by projection, and the steps only lead from one to the
next.
"""

from dataclasses import replace
from typing import Any

import numpy as np

from ...kernels.constrained.report import Report
from ...kernels.constrained.system import System
from ...model.arrays.dynamic import DynamicArrays, dynamic_arrays, step_length_scale
from ...model.arrays.young_elements import rigid_point, without_driven
from ...model.joint_elements import Curve, JointDriver, Roll
from ...model.joints import DRIVER
from ...model.loads import DynamicModel
from ...model.planar_loops import repeated_in_plane
from ..kinematics.inverse_dynamics import undetermined
from ..linearisation.terms import Terms, motors_of
from ..singular.mobility import Mobility
from .analysis import LinearisableMotion
from .element_rows import element_rows
from .first_position import estimate_warnings
from .rows import DynamicRows, dynamic_rows
from .start import given_speeds, rate_equations


class ForwardDynamics(LinearisableMotion):
    """One run over the report times of a dynamic model."""

    arrays: DynamicArrays

    def __init__(self, model: DynamicModel):
        super().__init__(dynamic_arrays(model), model.mechanism.time, model.integrator, model.elements)
        self.model = model
        self.mechanism = model.mechanism
        self.velocities, self.springs = model.velocities, model.springs
        if model.elements.composites or model.elements.tracks:
            self.usual_words = self.usual_words[0], "those out of the plane"
        bodies, units = len(model.mechanism.bodies), self.integration.units
        for part in (units[: 7 * bodies].reshape(-1, 7), units[7 * bodies : 13 * bodies].reshape(-1, 6)):
            part[:, :3] = step_length_scale(model, self.arrays.kinematic.length)

    def assembled(self, t: float) -> np.ndarray:
        """Coordinates that meet all equations, near the deck's estimates; raises AnalysisError."""
        gaps, q = self.first_position(t, self.mechanism.loop_tolerance, self.arrays.q, estimates=True)
        self.warnings += estimate_warnings(self.model, gaps, q, t)
        return self.led(q, t, self.mechanism.loop_tolerance)

    def driven_arrays(self, drivers: tuple[JointDriver, ...]) -> DynamicArrays:
        """Return the arrays with further drivers, whose equations are the last."""
        elements = self.model.elements
        elements = replace(elements, drivers=(*elements.drivers, *drivers))
        return dynamic_arrays(replace(self.model, elements=elements))

    def usual_repetitions(self, q: np.ndarray) -> int | None:
        """Those of a planar mechanism, None of any other."""
        bodies = len(self.mechanism.bodies)
        grounds = [ground.body for ground in self.mechanism.grounds]
        attitudes = q[: 7 * bodies].reshape(bodies, 7)[:, 3:]
        elements = self.model.elements
        # Wheels on wheels have no equation out of the plane.
        rolls = [roll for roll in elements.rolls if len(roll.directions) == 3]
        tracks: list[Curve | Roll] = [*elements.curves, *rolls]
        return repeated_in_plane(self.mechanism.joints, grounds, attitudes, elements.composites, tracks)

    def given_rates(self, q: np.ndarray) -> tuple[np.ndarray, np.ndarray, tuple[Any, ...]]:
        """Rows, right-hand sides and names of the joint rates that the deck gives."""
        return rate_equations(self.mechanism.joints, self.model.elements.starts, q, self.arrays.speeds)

    def given_speeds(self, q: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Return which of the speeds the deck gives, and their values."""
        return given_speeds(self.velocities, self.arrays.bodies, q)

    @property
    def terms(self) -> Terms:
        """Names of loads, drivers, joints and points."""
        model, mechanism = self.model, self.mechanism
        drivers = without_driven(mechanism, model.elements).drivers
        loads = [
            *((force.name, True) for force in model.forces),
            *((torque.name, True) for torque in model.torques),
            *((spring.name, True) for spring in model.springs),
        ]
        joints = [(j.name, rigid_point(j.i, j.P_i), rigid_point(j.j, j.P_j)) for j in mechanism.joints]
        return Terms(
            tuple(loads),
            tuple((driver.name, driver.direction <= 3) for driver in drivers),
            tuple(joints),
            tuple((point.name, point.body) for point in mechanism.points),
            tuple(k for k, driver in enumerate(mechanism.drivers) if driver in drivers),
            motors_of(model.elements, len(loads)),
        )

    def driven_system(self, k: int, additions: list[float], t: float) -> System:
        """Return the system with additions to the value, rate and second rate of driver k at t."""
        value, rate, second = additions
        constraints = self.system.constraints.copy()
        record = constraints[np.flatnonzero(constraints["kind"] == DRIVER.code)[k] :][:1]
        record["C"] += value - rate * t + 0.5 * second * t * t
        record["B"] += rate - second * t
        record["A"] += second
        return self.system._replace(constraints=constraints)

    def block(self, report: Report) -> DynamicRows:
        """The rows of a report in the terms of the model."""
        if self.model.elements:
            return element_rows(self.model, self.arrays, report)
        return dynamic_rows(self.model, report, self.arrays.place_of_work)


class DrivenDynamics(ForwardDynamics):
    """One run over the report times of a model whose motion is prescribed."""

    def start_position(self) -> Mobility:
        """As `ForwardDynamics.start_position`; raises AnalysisError where something is free to move."""
        mobility = super().start_position()
        if mobility.free:
            raise undetermined(self.model.mechanism.time.start)
        return mobility
