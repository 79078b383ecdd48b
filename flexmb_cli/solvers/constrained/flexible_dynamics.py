"""Forward dynamics of a mechanism of rigid and flexible bodies (VSDF decks)."""

from collections.abc import Iterator
from dataclasses import replace
from typing import Any

import numpy as np

from ...kernels.constrained.report import Report
from ...kernels.constrained.system import System
from ...model.arrays.flexible import flexible_arrays
from ...model.arrays.system import SystemArrays
from ...model.flexible_mechanism import FlexibleMechanism, PointJoint
from ...model.joint_elements import JointDriver
from ...model.loads import InitialVelocity
from ...model.mechanism import Joint
from ...model.planar_loops import OUT_OF_PLANE, repeated_in_plane
from ...model.vectors import global_axes
from ..linearisation.terms import Terms, motors_of
from ..start_attitudes import refuse_half_turns, start_attitudes, turn_warnings, turned_right
from .analysis import LinearisableMotion
from .first_position import gap_warnings
from .flexible_rows import FlexibleRows, flexible_rows
from .start import given_speeds, rate_equations
from .system import with_driven


class FlexibleDynamics(LinearisableMotion):
    """One run over the report times of a mechanism."""

    omega_in_body_axes = True

    def __init__(self, mechanism: FlexibleMechanism):
        arrays = flexible_arrays(mechanism)
        super().__init__(arrays, mechanism.time, mechanism.integrator, mechanism.elements)
        self.mechanism = mechanism
        self.velocities, self.springs = tuple(_velocities(mechanism)), mechanism.springs

    def assembled(self, t: float) -> np.ndarray:
        """Coordinates near the deck's that meet all equations; raises AnalysisError."""
        attitudes = start_attitudes(self.mechanism)
        start = turned_right(self.gaps, attitudes, t)
        gaps, q = self.first_position(t, self.mechanism.loop_tolerance, start)
        refuse_half_turns(q, attitudes, t)
        self.warnings += turn_warnings(self.arrays.q, attitudes)
        self.warnings += gap_warnings(self.mechanism, gaps, q, t)
        return self.led(q, t, self.mechanism.loop_tolerance)

    def driven_arrays(self, drivers: tuple[JointDriver, ...]) -> SystemArrays:
        """Return the arrays with drivers of joint coordinates, whose equations are the last."""
        elements = replace(self.mechanism.elements, drivers=drivers)
        return flexible_arrays(replace(self.mechanism, elements=elements))

    def given_speeds(self, q: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Return the given speeds and their values: those of the deck, and no rate of deformation."""
        bodies = self.arrays.bodies
        given, speeds = given_speeds(self.velocities, bodies, q)
        modes = self.arrays.speeds - 6 * bodies
        return np.append(given, np.ones(modes, bool)), np.append(speeds, np.zeros(modes))

    @property
    def terms(self) -> Terms:
        """Names of loads, drivers, joints and points."""
        m = self.mechanism
        loads = [
            *((force.name, True) for force in m.forces),
            *((torque.name, True) for torque in m.torques),
            *((spring.name, not spring.turning) for spring in m.springs),
        ]
        return Terms(
            tuple(loads),
            tuple((motion.name, motion.is_length) for motion in m.motions),
            tuple((joint.name, joint.a[0], joint.b[0]) for joint in m.joints),
            tuple((point.name, point.body) for point in m.outputs),
            motors=motors_of(m.elements, len(loads)),
        )

    def given_rates(self, q: np.ndarray) -> Any:
        """Rows, right-hand sides and names of the joint rates that the deck gives."""
        starts = self.mechanism.elements.starts
        if not starts:
            return super().given_rates(q)
        joints = [_body_joint(joint) for joint in self.mechanism.joints]
        return rate_equations(joints, starts, q, self.arrays.speeds)

    def usual_repetitions(self, q: np.ndarray) -> int | None:
        """Those of a planar mechanism, None of any other."""
        bodies = len(self.mechanism.bodies)
        joints = [_body_joint(joint) for joint in self.mechanism.joints]
        links = [joint for joint in joints if joint.kind in OUT_OF_PLANE]
        joints = [joint for joint in joints if joint.kind not in OUT_OF_PLANE]
        attitudes = q[: 7 * bodies].reshape(bodies, 7)[:, 3:]
        return None if self.mechanism.pins else repeated_in_plane(joints, (), attitudes, links)

    def driven_system(self, k: int, additions: list[float], t: float) -> System:
        """Return the system with additions to the value, rate and second rate of motion k at t."""
        group = self.arrays.groups[len(self.mechanism.joints) + len(self.mechanism.pins) + k]
        function = self.mechanism.motions[k].function
        return with_driven(self.system, int(group["first_row"]), np.add(function.at(t), additions), t)

    def block(self, report: Report) -> FlexibleRows:
        """The rows of a report in the terms of the model."""
        if self.mechanism.elements:
            from .element_rows import flexible_element_rows

            return flexible_element_rows(self.mechanism, self.arrays, report)
        return flexible_rows(self.mechanism, self.arrays, report)


NO_AXIS = (0.0, 0.0, 0.0)


def _body_joint(joint: PointJoint) -> Joint:
    """A joint between bodies that do not deform, as they begin."""
    a, b = joint.a, joint.b
    s_i, s_j = (tuple(side[1].r0 - side[0].r0) if len(side) > 1 else NO_AXIS for side in (a, b))
    return Joint(joint.kind, joint.name, a[0].body, b[0].body, tuple(a[0].r0), tuple(b[0].r0), s_i, s_j)


def _velocities(mechanism: FlexibleMechanism) -> Iterator[InitialVelocity]:
    """Velocities of the bodies that the deck moves; those at rest follow the others."""
    for k, body in enumerate(mechanism.bodies):
        if np.any(body.velocity) or np.any(body.omega):
            angular = tuple(global_axes(body.p, body.omega))
            name, place = f"VELO of {body.name}", body.velocity_place
            yield InitialVelocity(name, k, tuple(body.velocity), angular, place)
