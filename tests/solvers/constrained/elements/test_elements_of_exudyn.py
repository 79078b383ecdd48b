"""Springs, dampers and bushings at joints, the same models in Exudyn (generalised-α, ρ = 1, h = 1e-4 s)."""

import warnings

import exudyn as exu
import numpy as np
import pytest
from exudyn.utilities import RigidBodyInertia

from tests.solvers.constrained.element_decks import ARM, rows_of

pytestmark = [pytest.mark.long_motion, pytest.mark.filterwarnings("ignore::DeprecationWarning")]
END = 1.0  # s


def body_of(system, mass, centre, inertia, place):
    """A rigid body with the inertia about its centre of mass along the axes."""
    found = RigidBodyInertia(mass=mass, inertiaTensor=np.diag(inertia)).Translated(centre)
    return system.CreateRigidBody(inertia=found, referencePosition=place, gravity=[0, -9.81, 0])


def solve(system, steps=10_000):
    system.Assemble()
    settings = exu.SimulationSettings()
    settings.timeIntegration.numberOfSteps, settings.timeIntegration.endTime = steps, END
    settings.timeIntegration.generalizedAlpha.spectralRadius = 1
    settings.timeIntegration.newton.relativeTolerance = 1e-10
    settings.timeIntegration.newton.absoluteTolerance = 1e-12
    settings.solutionSettings.writeSolutionToFile = False
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        system.SolveDynamic(settings)


def test_an_arm_with_torsional_springs_and_one_in_line_moves_as_in_exudyn():
    system = exu.SystemContainer().AddSystem()
    ground = system.CreateGround()
    first = body_of(system, 1.5, [0.4, 0, 0], [0.1, 0.2, 0.2], [0, 0, 0])
    second = body_of(system, 0.8, [0.3, 0, 0], [0.05, 0.1, 0.1], [1, 0, 0])
    for pair, place in (([ground, first], [0, 0, 0]), ([first, second], [1, 0, 0])):
        system.CreateRevoluteJoint(bodyNumbers=pair, position=place, axis=[0, 0, 1], useGlobalFrame=True)
    for pair, place, stiffness, damping, offset in (
        ([ground, first], [0, 0, 0], 20, 0.3, 0.2),
        ([first, second], [1, 0, 0], 5, 0.1, 0.0),
    ):
        system.CreateTorsionalSpringDamper(
            bodyNumbers=pair, position=place, axis=[0, 0, 1], useGlobalFrame=True,
            stiffness=stiffness, damping=damping, offset=offset,
        )  # fmt: skip
    system.CreateSpringDamper(
        bodyNumbers=[ground, second], localPosition0=[1, 2, 0], localPosition1=[0.6, 0, 0],
        referenceLength=1.2, stiffness=30, damping=0.5,
    )  # fmt: skip
    solve(system)
    wanted = [
        system.GetObjectOutputBody(body, exu.OutputVariableType.Position, place)
        for body, place in ((first, [1, 0, 0]), (second, [0.6, 0, 0]))
    ]
    cards = (
        "MASS 2 1.5 0.4 0 0 0.1 0.2 0.2\nMASS 3 0.8 0.3 0 0 0.05 0.1 0.1\nGRAVITY 0 -9.81 0\n"
        "ELEMENTS\n"
        "  SPRING tspring-1 at=1.angle stiffness=20 rest=0.2 damping=0.3\n"
        "  SPRING tspring-2 at=2.angle stiffness=5 damping=0.1\n"
        "  SPRING lspring-1 from=0(1,2,0) to=3(0.6,0,0) stiffness=30 rest=1.2 damping=0.5\n"
    )
    one, both = np.cumsum(rows_of(ARM, f"0 {END} {END}", cards).joint_coordinate[-1])
    tip = np.array([np.cos(one), np.sin(one), 0.0])
    found = [tip, tip + 0.6 * np.array([np.cos(both), np.sin(both), 0.0])]
    assert np.array(found) == pytest.approx(np.array(wanted), abs=1e-6)


def test_a_body_on_a_bushing_sags_and_swings_as_in_exudyn():
    """A point of action off the centre of mass couples all six; turns stay small, where angles agree."""
    stiffness = np.diag([900.0, 1600.0, 2500.0, 60.0, 90.0, 160.0])
    damping = np.diag([5.0, 6.0, 7.0, 0.2, 0.3, 0.4])
    system = exu.SystemContainer().AddSystem()
    ground = system.CreateGround()
    body = body_of(system, 0.5, [0.02, 0.01, -0.015], [0.04, 0.05, 0.06], [0, 0, 0])
    system.CreateRigidBodySpringDamper(
        bodyNumbers=[ground, body], localPosition0=[0, 0, 0], localPosition1=[0, 0, 0],
        stiffness=stiffness, damping=damping,
    )  # fmt: skip
    solve(system)
    wanted = system.GetObjectOutputBody(body, exu.OutputVariableType.Position, [0, 0, 0])
    free = "2 0 0 0 0 0 0 0 0 0 0 1\n0 0 0 1 0 0 0\n0 0 0 1 0 0 0\n1 0 0 0 0 0 0\n"
    cards = (
        "MASS 2 0.5 0.02 0.01 -0.015 0.04 0.05 0.06\nGRAVITY 0 -9.81 0\n"
        "ELEMENTS\n"
        "  BUSHING bushing-1 from=0(0,0,0) to=2(0,0,0) k=(900,1600,2500) kr=(60,90,160) "
        "c=(5,6,7) cr=(0.2,0.3,0.4)\n"
    )
    rows = rows_of(free, f"0 {END} {END}", cards)
    assert rows.position[-1, 1] == pytest.approx(wanted, abs=1e-6)
