"""Friction of bearings by flexmb's law, given to Exudyn as a function of its generic equations.

Without weight and with the centre of mass on the axis the normal force is the preload. Exudyn integrates
by an explicit method of order 6; parts come to rest, stick and turn back.
"""

import math
import warnings

import exudyn as exu
import numpy as np
import pytest
from exudyn import utilities as parts

from tests.solvers.constrained.element_decks import ROTOR, rows_of
from tests.solvers.constrained.elements.element_cases import SLEEVE

pytestmark = [pytest.mark.long_motion, pytest.mark.filterwarnings("ignore::DeprecationWarning")]
SLIDING, STICKING, STRIBECK, CREEP, RADIUS, PRELOAD = 0.3, 0.4, 0.2, 0.02, 0.05, 30.0
FRICTION = (
    "ELEMENTS\n"
    f"  FRICTION friction-1 joint=1 dynamic={SLIDING} static={STICKING} "
    f"stribeck={STRIBECK} creep={CREEP}\n"
    f"      radius={RADIUS} preload={PRELOAD}\n"
)
STIFFNESS, INERTIA, MASS = 4.0, 0.5, 2.0


def friction(speed: float) -> float:
    """The coefficient of friction times the preload, N."""
    coefficient = SLIDING + (STICKING - SLIDING) * math.exp(-((speed / STRIBECK) ** 2))
    return coefficient * math.tanh(speed / CREEP) * PRELOAD


def solved(inertias, speeds, force, end, steps):
    """Coordinates and rates at the end of M q'' = force(t, q, q')."""
    system, size = exu.SystemContainer().AddSystem(), len(inertias)
    node = system.AddNode(
        parts.NodeGenericODE2(referenceCoordinates=[0.0] * size, initialCoordinates=[0.0] * size,
                              initialCoordinates_t=speeds, numberOfODE2Coordinates=size)
    )  # fmt: skip
    system.AddObject(
        parts.ObjectGenericODE2(
            nodeNumbers=[node], massMatrix=np.diag(inertias),
            forceUserFunction=lambda _s, t, _item, q, rate: force(t, q, rate),
        )
    )  # fmt: skip
    system.Assemble()
    settings = exu.SimulationSettings()
    settings.timeIntegration.numberOfSteps, settings.timeIntegration.endTime = steps, end
    settings.solutionSettings.writeSolutionToFile = False
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        system.SolveDynamic(settings, solverType=exu.DynamicSolverType.RK67)
    kinds = exu.OutputVariableType.Coordinates, exu.OutputVariableType.Coordinates_t
    return [np.atleast_1d(system.GetNodeOutput(node, kind)) for kind in kinds]


def test_a_bearing_with_friction_stops_sticks_and_turns_back_as_in_exudyn():
    def force(t, q, rate):
        return [2 * math.sin(5 * t) - STIFFNESS * q[0] - RADIUS * friction(RADIUS * rate[0])]

    angle, rate = solved([INERTIA], [1.5], force, 2.0, 4000)
    cards = (
        f"MASS 2 1 0 0 0 1 1 {INERTIA}\n"
        "ELEMENTS\n"
        "  FUNCTION 1 sine 0 2 5\n"
        "  MOTOR tmotor-1 at=1.angle effort=1\n"
        f"  SPRING tspring-1 at=1.angle stiffness={STIFFNESS}\n"
        f"{FRICTION}"
    )
    rows = rows_of(ROTOR, "0 2 0.01", f"{cards}ELEMENTS\n  START at=1.angle rate=1.5\nTOLERANCE 1e-11\n")
    assert np.sum(np.diff(np.sign(rows.joint_rate[:, 0])) != 0) >= 2  # it turns back
    assert rows.joint_coordinate[-1] == pytest.approx(angle, abs=1e-8)
    assert rows.joint_rate[-1] == pytest.approx(rate, abs=1e-7)


def test_a_sleeve_that_turns_and_slides_is_braked_against_its_screwing_motion_as_in_exudyn():
    """Force and torque share the friction as the parts of the sliding speed do."""

    def force(_t, q, rate):
        around, along = RADIUS * rate[0], rate[1]
        speed = max(math.hypot(around, along), 1e-12)
        braking = friction(speed) / speed
        return [-STIFFNESS * q[0] - RADIUS * braking * around, -20 * q[1] - braking * along]

    place, rate = solved([INERTIA, MASS], [6.0, 0.8], force, 1.5, 6000)
    cards = (
        f"MASS 2 {MASS} 0 0 0 1 1 {INERTIA}\n"
        "ELEMENTS\n"
        f"  SPRING tspring-1 at=1.angle stiffness={STIFFNESS}\n"
        "  SPRING aspring-1 at=1.stroke stiffness=20\n"
        f"{FRICTION}"
    )
    cards += "ELEMENTS\n  START at=1.angle rate=6\n  START at=1.stroke rate=0.8\nTOLERANCE 1e-11\n"
    rows = rows_of(SLEEVE.format(1, 0, ""), "0 1.5 0.01", cards)
    assert np.min(rows.joint_rate[:, 1]) < 0  # it slides back
    assert rows.joint_coordinate[-1] == pytest.approx(place, abs=1e-8)
    assert rows.joint_rate[-1] == pytest.approx(rate, abs=1e-7)
