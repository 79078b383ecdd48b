"""Characteristics, motors, stops, friction and couplings of rotors and slides, the same models in Exudyn.

In Exudyn each rotor or slide is one coordinate: by an explicit method of order 6, couplings by generalised-α.
"""

import warnings

import exudyn as exu
import numpy as np
import pytest
from exudyn import utilities as parts

from tests.solvers.constrained.element_decks import FREE, ROTOR, SLIDER, TWO_ROTORS, rows_of

pytestmark = [pytest.mark.long_motion, pytest.mark.filterwarnings("ignore::DeprecationWarning")]


class System:
    """Coordinates with inertias, connected to the ground and to each other."""

    def __init__(self, inertias, speeds):
        self.system = exu.SystemContainer().AddSystem()
        ground = self.system.AddNode(parts.NodePointGround())
        self.ground = self._marker(ground)
        self.nodes = [self._coordinate(*pair) for pair in zip(inertias, speeds, strict=True)]
        self.markers = [self._marker(node) for node in self.nodes]

    def _marker(self, node):
        return self.system.AddMarker(parts.MarkerNodeCoordinate(nodeNumber=node, coordinate=0))

    def _coordinate(self, inertia, speed):
        node = self.system.AddNode(parts.Node1D(initialVelocities=[speed]))
        self.system.AddObject(parts.ObjectMass1D(physicsMass=inertia, nodeNumber=node))
        return node

    def add(self, connector, on=0, **data):
        self.system.AddObject(connector(markerNumbers=[self.ground, self.markers[on]], **data))

    def load(self, force, on=0):
        load = parts.LoadCoordinate(
            markerNumber=self.markers[on], loadUserFunction=lambda _s, t, _l: force(t)
        )
        self.system.AddLoad(load)

    def couple(self, one, other, ratio):
        """Make coordinate `one` the ratio times the `other`."""
        pair = [self.markers[one], self.markers[other]]
        self.system.AddObject(parts.ObjectConnectorCoordinate(markerNumbers=pair, factorValue1=ratio))

    def solve(self, end, steps, method=None, radius=1):
        """Coordinates at the end."""
        self.system.Assemble()
        settings = exu.SimulationSettings()
        settings.timeIntegration.numberOfSteps, settings.timeIntegration.endTime = steps, end
        settings.timeIntegration.generalizedAlpha.spectralRadius = radius
        settings.timeIntegration.newton.relativeTolerance = 1e-10
        settings.timeIntegration.newton.absoluteTolerance = 1e-12
        settings.solutionSettings.writeSolutionToFile = False
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            self.system.SolveDynamic(settings, solverType=method or exu.DynamicSolverType.RK67)
        kind = exu.OutputVariableType.Coordinates
        return [float(self.system.GetNodeOutput(node, kind)) for node in self.nodes]


ALPHA = exu.DynamicSolverType.GeneralizedAlpha
ROTATES = (ROTOR, "MASS 2 1 0 0 0 1 1 0.5\n", 0.5, "angle")
SLIDES = (SLIDER, "MASS 2 2 0 0 0 1 1 1\n", 2.0, "stroke")
either = pytest.mark.parametrize(
    ("deck", "mass", "inertia", "coordinate"), [ROTATES, SLIDES], ids=["angle", "stroke"]
)


@either
def test_springs_and_dampers_by_functions_with_preload_and_a_motor_move_as_in_exudyn(
    deck, mass, inertia, coordinate
):
    one = System([inertia], [0.4])
    points, forces = [-2.0, -0.1, 0.2, 2.0], [-6.0, -0.5, 0.4, 9.0]

    def spring(_system, _t, _item, x, v, stiffness, damping, rest):
        s = x - rest
        return 1.6 + stiffness * s + np.interp(s, points, forces) + damping * v + 0.3 * v**3

    one.add(
        parts.ObjectConnectorCoordinateSpringDamper,
        stiffness=8, damping=0.4, offset=0.1, springForceUserFunction=spring,
    )  # fmt: skip
    one.load(lambda t: 2 + 5 * np.sin(9 * t))
    table = " ".join(f"{x} {f}" for x, f in zip(points, forces, strict=True))
    cards = (
        f"{mass}ELEMENTS\n"
        f"  FUNCTION 1 table {table}\n"
        "  FUNCTION 2 polynomial 0 0 0 0.3\n"
        "  FUNCTION 3 sine 2 5 9\n"
        f"  MOTOR motor at=1.{coordinate} effort=3\n"
    )
    cards += (
        f"  SPRING s at=1.{coordinate} stiffness=8 rest=0.1 damping=0.4 preload=1.6 curve=1 damper=2\n"
        f"  START at=1.{coordinate} rate=0.4\nTOLERANCE 1e-11\n"
    )
    rows = rows_of(deck, "0 2 2", cards)
    assert rows.joint_coordinate[-1] == pytest.approx(one.solve(2.0, 4000), abs=1e-7)


@either
def test_two_stops_throw_a_body_to_and_fro_as_in_exudyn(deck, mass, inertia, coordinate):
    """Undamped: the damping of Exudyn's stops is that of Kelvin and Voigt, and pulls when a body leaves."""
    one = System([inertia], [2.0])
    data = parts.NodeGenericData(initialCoordinates=[0.0] * 3, numberOfDataCoordinates=3)
    one.add(
        parts.ObjectConnectorCoordinateSpringDamperExt, nodeNumber=one.system.AddNode(data), stiffness=3.0,
        offset=0.05, useLimitStops=True,
        limitStopsLower=-0.1, limitStopsUpper=0.2, limitStopsStiffness=500.0,
    )  # fmt: skip
    cards = (
        f"{mass}ELEMENTS\n"
        f"  STOP stop at=1.{coordinate} lower=-0.1 upper=0.2 stiffness=500\n"
        f"  SPRING middle at=1.{coordinate} stiffness=3 rest=0.05\n"
        f"  START at=1.{coordinate} rate=2\n"
    )
    rows = rows_of(deck, "0 1 1", f"{cards}TOLERANCE 1e-11\n")
    assert rows.joint_coordinate[-1] == pytest.approx(one.solve(1.0, 80_000), abs=1e-6)


def test_a_slide_with_friction_and_a_spring_slows_down_as_in_exudyn():
    """μ N = 0.3 (2 · 9.81 + 5) N while it slides; where it sticks the two smooth curves differ."""
    one = System([2.0], [1.5])
    one.add(
        parts.ObjectConnectorCoordinateSpringDamperExt, stiffness=10.0,
        dynamicFrictionForce=0.3 * (2 * 9.81 + 5), frictionProportionalZone=1e-6,
    )  # fmt: skip
    cards = (
        "MASS 2 2 0 0 0 1 1 1\n"
        "GRAVITY 0 -9.81 0\n"
        "ELEMENTS\n"
        "  SPRING aspring-1 at=1.stroke stiffness=10\n"
        "  FRICTION friction-1 joint=1 dynamic=0.3 static=0.3 stribeck=1 creep=1e-6 "
        "preload=5\n"
        "  START at=1.stroke rate=1.5\n"
    )
    rows = rows_of(SLIDER, "0 0.3 0.3", cards + "TOLERANCE 1e-11\n")
    assert rows.joint_rate[-1, 0] > 0.1
    assert rows.joint_coordinate[-1] == pytest.approx(one.solve(0.3, 1000), abs=1e-9)


RACK = (
    "3 0 0 0 0 1 0 1 0 0 0 1\n" + "0 0 0 1 0 0 0\n" * 3 + "1 2 0 0 0 0 0 0 0 0 1 0 0 1\n"
    "1 3 0 0 0 0 0 0 1 0 0 1 0 0 0 1 0 0 0 1\n1 0 0 0 0 0 0\n"
)


@pytest.mark.parametrize(
    ("deck", "terms", "ratio", "second"),
    [(TWO_ROTORS, "1.angle=2 2.angle=1", -2.0, "2.angle"),
     (TWO_ROTORS, "1.angle=0.1 2.angle=-0.25", 0.4, "2.angle"),
     (RACK, "1.angle=-0.2 2.stroke=1", 0.2, "2.stroke")],
    ids=["gears", "belt", "rack and pinion"],
)  # fmt: skip
def test_coupled_joints_with_springs_swing_as_in_exudyn(deck, terms, ratio, second):
    """The first coordinate x, the second ratio · x."""
    two = System([0.5, 0.3], [1.5, 1.5 * ratio])
    two.couple(1, 0, ratio)
    for on, (stiffness, damping, rest) in enumerate(((20.0, 0.2, 0.3), (7.0, 0.1, -0.4))):
        two.add(
            parts.ObjectConnectorCoordinateSpringDamper, on, stiffness=stiffness, damping=damping, offset=rest
        )
    cards = (
        "MASS 2 1 0 0 0 1 1 0.5\n"
        "MASS 3 0.3 0 0 0 1 1 0.3\n"
        "ELEMENTS\n"
        f"  COUPLING coupling-1 {terms}\n"
        "  SPRING tspring-1 at=1.angle stiffness=20 rest=0.3 damping=0.2\n"
    )
    cards += f"  SPRING second at={second} stiffness=7 rest=-0.4 damping=0.1\n"
    cards += "  START at=1.angle rate=1.5\nTOLERANCE 1e-11\n"
    rows = rows_of(deck, "0 1 1", cards)
    assert rows.joint_coordinate[-1] == pytest.approx(two.solve(1.0, 10_000, ALPHA), abs=1e-7)


def test_a_differential_turns_as_in_exudyn():
    """2 θ1 = θ2 + θ3 of three rotors, a spring at each, one of them braked."""
    deck = "4 0 0 0 0 3 0 0 0 0 0 1\n" + "0 0 0 1 0 0 0\n" * 4
    deck += "".join(f"1 {k} 0 0 0 0 0 0 0 0 1 0 0 1\n" for k in (2, 3, 4)) + "1 0 0 0 0 0 0\n"
    inertias, springs = (0.4, 0.5, 0.7), (0.0, 6.0, 9.0)
    three = exu.SystemContainer().AddSystem()
    node = three.AddNode(
        parts.NodeGenericODE2(referenceCoordinates=[0.0] * 3, initialCoordinates=[0.0] * 3,
                              initialCoordinates_t=[0.0] * 3, numberOfODE2Coordinates=3)
    )  # fmt: skip
    three.AddObject(
        parts.ObjectGenericODE2(
            nodeNumbers=[node], massMatrix=np.diag(inertias), stiffnessMatrix=np.diag(springs),
            dampingMatrix=np.diag([0.0, 0.2, 0.0]), forceVector=[6.0, 0.0, 0.0],
        )
    )  # fmt: skip
    ground = three.AddNode(parts.NodePointGround())
    markers = [three.AddMarker(parts.MarkerNodeCoordinates(nodeNumber=number)) for number in (node, ground)]
    three.AddObject(
        parts.ObjectConnectorCoordinateVector(
            markerNumbers=markers, scalingMarker0=np.array([[2.0, -1.0, -1.0]]),
            scalingMarker1=np.zeros((1, 0)), offset=[0.0],
        )
    )  # fmt: skip
    system = System([], [])
    system.system = three
    system.solve(1.0, 10_000, ALPHA, 0.9)
    wanted = three.GetNodeOutput(node, exu.OutputVariableType.Coordinates)
    rates = three.GetNodeOutput(node, exu.OutputVariableType.Coordinates_t)
    seconds = three.GetNodeOutput(node, exu.OutputVariableType.Coordinates_tt)
    cards = "".join(f"MASS {k + 2} 1 0 0 0 1 1 {inertia}\n" for k, inertia in enumerate(inertias))
    cards += (
        "TORQUE 2 0 0 6\n"
        "ELEMENTS\n"
        "  SPRING tspring-1 at=2.angle stiffness=6 damping=0.2\n"
        "  SPRING tspring-2 at=3.angle stiffness=9\n"
        "  COUPLING coupling-1 1.angle=2 2.angle=-1 3.angle=-1\n"
        "TOLERANCE 1e-11\n"
    )
    rows = rows_of(deck, "0 1 1", cards)
    assert rows.joint_coordinate[-1] == pytest.approx(wanted, abs=1e-7)
    # By the balance of the second rotor, whose factor is -1.
    effort = -(0.5 * seconds[1] + 6.0 * wanted[1] + 0.2 * rates[1])
    assert rows.coupling_effort[-1, 0] == pytest.approx(effort, abs=1e-5)


def test_a_body_on_a_link_with_two_spheres_swings_as_in_exudyn():
    """CreateDistanceConstraint between a point of the ground and one off the centre of mass."""
    system = System([], [])
    ground = system.system.CreateGround()
    inertia = parts.RigidBodyInertia(mass=2.0, inertiaTensor=np.diag([0.2, 0.3, 0.4]))
    body = system.system.CreateRigidBody(
        inertia=inertia, referencePosition=[0, 0, 0], gravity=[0.3, -9.81, 0.2]
    )
    system.system.CreateDistanceConstraint(
        bodyNumbers=[ground, body], localPosition0=[0, 1, 0], localPosition1=[0.3, 0.1, 0.0]
    )
    system.solve(0.5, 10_000, ALPHA, 0.9)
    wanted = system.system.GetObjectOutputBody(body, exu.OutputVariableType.Position, [0, 0, 0])
    a = system.system.GetObjectOutputBody(body, exu.OutputVariableType.Acceleration, [0, 0, 0])
    cards = "MASS 2 2 0 0 0 0.2 0.3 0.4\nGRAVITY 0.3 -9.81 0.2\nTOLERANCE 1e-11\n"
    rows = rows_of(
        FREE,
        "0 0.5 0.5",
        f"{cards}ELEMENTS\n  JOINT sphsph-1 sphsph from=0(0,1,0) to=2(0.3,0.1,0) length={0.9**0.5!r}\n",
    )
    assert rows.position[-1, 1] == pytest.approx(wanted, abs=1e-6)
    assert rows.composite_force[-1, 0] == pytest.approx(2.0 * (a - (0.3, -9.81, 0.2)), abs=1e-4)
