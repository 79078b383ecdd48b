"""The slider-crank of decks/vsdf with its flexible rod, in flexmb and Exudyn; part `slider` of flexible.py.

Both programs get the same M, K, damping and the six mode shapes of hinged ends, so that they describe the
same motion; flexible.py prints how far apart they are.  In Exudyn the crank and the slider are rigid bodies
with a revolute and a prismatic joint, as in the deck, or bodies of one coordinate each ("1D"), which is
cheaper and has no like in flexmb.  The law of the crank is a symbolic function, which is not interpreted.
The rod hangs on nodes 7 and 83, and its turn about its own axis is stopped.  The run is the spin-up of the
crank and three quarters of a second at full speed.
"""

import math
import time
from pathlib import Path

import numpy as np
from scipy import sparse

DECKS = Path(__file__).resolve().parents[2] / "decks" / "vsdf"
PIN, TURN, MIDDLE, SLIDER = 7, 11, 45, 83
CRANK, ROD, RATE, SPIN_UP, END = 0.15, 0.5, 20.0, 0.25, 1.0
OUTPUTS = slice(1, 3)  # of the deck's output nodes: the rod's middle and its end at the slider
STEPS = (5e-3, 2e-3, 1e-3, 5e-4, 2e-4, 1e-4)
REFERENCE = 1e-5
INERTIA = 1e-3  # kg m², of crank and slider about each axis
EQUAL_ERRORS = 1e-7, 1e-8, 1e-9  # m


def slider_crank():
    """The mechanism of the deck, and M and K of its rod."""
    from flexmb_cli.deck.record import DeckText
    from flexmb_cli.dialects.vsdf.build import build_vsdf
    from flexmb_cli.dialects.vsdf.reader import read_vsdf
    from flexmb_cli.fe.build_mechanism import flexible_mechanism
    from flexmb_cli.fe.formats.formats import read_matrix
    from flexmb_cli.fe.nodal_matrices import condensed, nodal_part

    text = (DECKS / "slider_crank_flex.vsdf").read_text()
    model = build_vsdf(read_vsdf(DeckText("slider_crank_flex", text, "")), DECKS)[0]
    rod = model.bodies[1].flexible
    M, K = (
        arrange(
            file.path.name,
            read_matrix(file.path, file.form, letter, rod.mapping.path, rod.mapping.form),
            rod.numbers,
        ).matrix
        for file, letter, arrange in ((rod.mass, "M", nodal_part), (rod.stiffness, "K", condensed))
    )
    return flexible_mechanism(model, cached=False)[0], sparse.csr_matrix(M), sparse.csr_matrix(K)


def angle(mbs, t, item, offset):
    """Spin-up of Kane, Ryan and Banerjee as the deck has it, and on at full speed."""
    import exudyn as exu

    up = exu.symbolic.min(t, SPIN_UP)
    cosine = exu.symbolic.cos(2 * math.pi / SPIN_UP * up) - 1
    return RATE / SPIN_UP * (0.5 * up * up + (SPIN_UP / (2 * math.pi)) ** 2 * cosine) + RATE * (t - up)


def angle_rate(mbs, t, item, offset):
    """Its derivative."""
    import exudyn as exu

    up = exu.symbolic.min(t, SPIN_UP)
    return RATE / SPIN_UP * (up - SPIN_UP / (2 * math.pi) * exu.symbolic.sin(2 * math.pi / SPIN_UP * up))


def exudyn_rod(mbs, rod, M, K):
    """The rod, its number."""
    import exudyn as exu
    from exudyn.FEM import FEMinterface, ObjectFFRFreducedOrderInterface

    fem = FEMinterface()
    fem.nodes = {"Position": rod.r0}
    fem.massMatrix, fem.stiffnessMatrix = M, K
    fem.modeBasis = {"matrix": np.array(rod.Phi), "type": "NormalModes"}
    fem.eigenValues = (2 * math.pi * rod.frequencies) ** 2
    added = ObjectFFRFreducedOrderInterface(fem).AddObjectFFRFreducedOrder(mbs, positionRef=[CRANK, 0, 0])
    damping = exu.MatrixContainer()
    damping.SetWithDenseMatrix(rod.Dr, useDenseMatrix=False)
    mbs.SetObjectParameter(added["oFFRFreducedOrder"], "dampingMatrixReduced", damping)
    return added["oFFRFreducedOrder"]


def single_coordinates(mbs, ground):
    """Crank and slider of one coordinate each: their numbers, the node and coordinate of the crank's turn."""
    import exudyn.itemInterface as item

    turn, slide = (mbs.AddNode(item.Node1D()) for _ in range(2))
    crank = mbs.AddObject(item.ObjectRotationalMass1D(inertia=INERTIA, nodeNumber=turn))
    place = [CRANK + ROD, 0, 0]
    slider = mbs.AddObject(item.ObjectMass1D(mass=1.0, nodeNumber=slide, referencePosition=place))
    return crank, slider, turn, 0


def whole_bodies(mbs, ground):
    """As `single_coordinates`, of six coordinates, with a revolute joint about z and a prismatic along x."""
    import exudyn.itemInterface as item

    # The turn must be a coordinate for the law: Tait-Bryan angles, of which only the third moves.
    bodies, nodes = [], []
    fits = ((0.5, CRANK / 2, 0, [1, 1, 1, 1, 1, 0]), (1.0, 0, CRANK + ROD, [0, 1, 1, 1, 1, 1]))
    for mass, centre, x, axes in fits:
        nodes.append(mbs.AddNode(item.NodeRigidBodyRxyz(referenceCoordinates=[x, 0, 0, 0, 0, 0])))
        about_origin = [INERTIA, *2 * [INERTIA + mass * centre**2], 0, 0, 0]
        rigid = {"mass": mass, "inertia": about_origin, "centerOfMass": [centre, 0, 0]}
        bodies.append(mbs.AddObject(item.ObjectRigidBody(nodeNumber=nodes[-1], **rigid)))
        places = ((ground, [x, 0, 0]), (bodies[-1], [0, 0, 0]))
        ends = [mbs.AddMarker(item.MarkerBodyRigid(bodyNumber=b, localPosition=p)) for b, p in places]
        mbs.AddObject(item.ObjectJointGeneric(markerNumbers=ends, constrainedAxes=axes))
    return *bodies, nodes[0], 5


def hang_rod(mbs, ground, rod, body, crank, slider):
    """Spherical joints at the rod's ends and, against its free turn, a node of its side kept in the plane."""
    import exudyn.itemInterface as item

    ends = (
        (PIN, crank, [CRANK, 0, 0], [1, 1, 1]),
        (SLIDER, slider, [0, 0, 0], [1, 1, 1]),
        (TURN, ground, [0, 0, 0], [0, 0, 1]),
    )
    for number, other, place, axes in ends:
        row = [int(np.flatnonzero(rod.numbers == number)[0])]
        shared = item.MarkerSuperElementPosition(bodyNumber=body, meshNodeNumbers=row, weightingFactors=[1.0])
        there = mbs.AddMarker(item.MarkerBodyPosition(bodyNumber=other, localPosition=place))
        joint = item.ObjectJointSpherical(markerNumbers=[there, mbs.AddMarker(shared)], constrainedAxes=axes)
        mbs.AddObject(joint)


def drive(mbs, node, coordinate):
    """The law on a coordinate; the symbolic functions, which must outlive the run."""
    import exudyn.itemInterface as item
    from exudyn.advancedUtilities import CreateSymbolicUserFunction

    ends = ((mbs.AddNode(item.NodePointGround()), 0), (node, coordinate))
    markers = [mbs.AddMarker(item.MarkerNodeCoordinate(nodeNumber=n, coordinate=c)) for n, c in ends]
    functions = {
        name: CreateSymbolicUserFunction(mbs, function, name, itemTypeName="ObjectConnectorCoordinate")
        for function, name in ((angle, "offsetUserFunction"), (angle_rate, "offsetUserFunction_t"))
    }
    mbs.AddObject(item.ObjectConnectorCoordinate(markerNumbers=markers, **functions))
    return functions


def exudyn_slider_crank(rod, M, K, rigid):
    """The system, the sensors of the rod's middle and of its end at the slider, and what must stay alive."""
    import exudyn as exu
    import exudyn.itemInterface as item

    mbs = exu.SystemContainer().AddSystem()
    ground, body = mbs.AddObject(item.ObjectGround()), exudyn_rod(mbs, rod, M, K)
    crank, slider, node, coordinate = rigid(mbs, ground)
    hang_rod(mbs, ground, rod, body, crank, slider)
    functions = drive(mbs, node, coordinate)
    place = {"outputVariableType": exu.OutputVariableType.Position, "storeInternal": True}
    rows = [int(np.flatnonzero(rod.numbers == number)[0]) for number in (MIDDLE, SLIDER)]
    watched = [item.SensorSuperElement(bodyNumber=body, meshNodeNumber=row, **place) for row in rows]
    sensors = [mbs.AddSensor(sensor) for sensor in watched]
    mbs.Assemble()
    return mbs, sensors, functions


def solve(mbs, sensors, step, end, rows, tolerance=1e-8):
    """Run by generalised-alpha: (places (rows, 3 sensors) at even times, processor seconds, steps).

    tolerance: relative, of Newton's iterations; 1e-8 is Exudyn's default.
    """
    import exudyn as exu

    settings = exu.SimulationSettings()
    stepping = settings.timeIntegration
    stepping.numberOfSteps, stepping.endTime, stepping.verboseMode = round(end / step), end, 0
    stepping.generalizedAlpha.spectralRadius = 0.9
    stepping.newton.useModifiedNewton, stepping.newton.relativeTolerance = True, tolerance
    settings.solution.file.write = False
    settings.solution.sensors.writePeriod = end / rows
    begin = time.process_time()
    mbs.SolveDynamic(settings)
    spent = time.process_time() - begin
    # A row is the time and a place; the first is the start.
    stored = [mbs.GetSensorStoredData(sensor)[-rows:, 1:] for sensor in sensors]
    return np.hstack(stored), spent, round(end / step)


def exudyn_integration(given, M, K, step, rigid, rows):
    """What `solve` says of the rod's middle and end."""
    mbs, sensors, _laws = exudyn_slider_crank(given.bodies[1].flexible, M, K, rigid)
    return solve(mbs, sensors, step, END, rows)


def deflection(places):
    """Distance, m, of the rod's middle from that of a rigid rod at the end of the run; closed form."""
    turned = RATE * (END - SPIN_UP / 2)
    pin = CRANK * np.array([math.cos(turned), math.sin(turned)])
    slider = np.array([pin[0] + math.sqrt(ROD**2 - pin[1] ** 2), 0.0])
    return np.linalg.norm(places[-1, :2] - (pin + slider) / 2)
