"""Time for balls that fall on a floor and on each other, against Exudyn at equal error, MuJoCo beside them.

    pip install -e '.[bench]' && python scripts/bench/contacts.py [BALLS...]

Balls of 0.5 kg and 50 mm stand in a loose block above a plane and fall for 0.1 s.  flexmb and Exudyn have the
same law, an elastic force K d along the normal without friction (Exudyn takes two such shapes as springs in
series, so each has 2 K there); the error is the largest of all coordinates against flexmb's at a tolerance
of 1e-11.  Times are of the processor, in a warm process, of one thread.  MuJoCo's contacts are constraints:
what is stated is its largest penetration, and the static one of the bottom layer by this law.  Then the time
of an evaluation by the number of balls, whose exponent is the slope of log(time) over log(balls).
"""

import sys
import time

import numpy as np

from flexmb_cli.model.flexible_mechanism import NodePoint
from flexmb_cli.model.joint_elements import JointElements
from flexmb_cli.model.laws import CONTACT, Element, Touch
from flexmb_cli.model.mechanism import TimeGrid
from flexmb_cli.model.tree import Body, Hinge, Integration, Tree
from flexmb_cli.solvers.tree.analysis import TreeAnalysis

RADIUS, MASS, K = 0.05, 0.5, 1e5
GRAVITY = (0.0, 0.0, -9.81)
INERTIA = 0.4 * MASS * RADIUS**2 * np.eye(3)
END = 0.1  # s
TOLERANCES = (1e-3, 1e-7, 1e-9, 1e-11)
EXUDYN = {
    "RK44": (2e-4, 1e-4, 5e-5, 2.5e-5),
    "RK67": (1e-4, 5e-5),
    "VelocityVerlet": (1e-4, 2.5e-5, 1e-5, 5e-6),
}
SCALED = (64, 216, 512, 1000)


def places(balls):
    """Centres (balls, 3), m."""
    side = int(np.ceil(balls ** (1.0 / 3.0)))
    cells = np.array(
        [(x, y, z) for z in range(side) for y in range(side) for x in range(side)][:balls], float
    )
    moved = np.random.default_rng(1).uniform(-0.02, 0.02, (balls, 3))
    return (2.05 * cells + (0.0, 0.0, 1.05) + moved) * RADIUS


def analysis(balls, tolerance, end=END):
    """A TreeAnalysis of free balls."""
    hinges = tuple(Hinge(-1, rotations=(1, 2, 3), translations=(1, 2, 3)) for _ in range(balls))
    bodies = tuple(Body(f"ball {k}", MASS, INERTIA) for k in range(balls))
    ends = [(k, NodePoint("", k, np.zeros(3), np.zeros((3, 0)))) for k in range(-1, balls)]
    more, first = tuple(ends[2:]), (*ends[1],)
    floor = Touch(-1, 0, ends[0][1], first[1], "plane", "sphere", axis_i=(0.0, 0.0, 1.0), radius_j=RADIUS,
                  more_j=more)  # fmt: skip
    pile = Touch(0, 0, first[1], first[1], "sphere", "sphere", radius_i=RADIUS, radius_j=RADIUS,
                 more_i=more, more_j=more, mutual=True)  # fmt: skip
    law = CONTACT.values(stiffness=K)
    forces = tuple(Element(name, CONTACT, touch, law) for name, touch in (("floor", floor), ("pile", pile)))
    q, y = np.zeros(6 * balls), np.zeros(6 * balls)
    tree = Tree(bodies, hinges, q, y, TimeGrid(0.0, end, end), GRAVITY, elements=JointElements(forces=forces),
                integration=Integration("dop853", tolerance, tolerance))  # fmt: skip
    r = places(balls)
    for k, c in enumerate(tree.coordinates):
        q[k] = r[c.body, c.axis - 1] if c.motion == "translation" else 0.0
    return TreeAnalysis(tree)


def flexmb(balls, tolerance, end=END):
    """Processor time, s, last positions (balls, 3), m, evaluations, and contacts that began."""
    one = analysis(balls, tolerance, end)
    start = time.process_time()
    rows = list(one.rows())
    took = time.process_time() - start
    return (
        took,
        rows[-1].position[-1],
        int(one.clock["evaluations"][0]),
        int(rows[-1].contact_touches[-1].sum()),
    )


def exudyn(balls, method, step):
    """Processor time, s, and last positions (balls, 3), m."""
    import exudyn as exu
    from exudyn import utilities as of

    system = exu.SystemContainer().AddSystem()
    ground = system.AddMarker(of.MarkerBodyRigid(bodyNumber=system.AddObject(of.ObjectGround())))
    contact = system.AddGeneralContact()
    contact.SetFrictionPairings(np.zeros((1, 1)))
    contact.SetSearchTreeCellSize(numberOfCells=[8, 8, 8])
    nodes = []
    for r in places(balls):
        inertia = of.RigidBodyInertia(mass=MASS, inertiaTensor=INERTIA)
        kind = exu.NodeType.RotationRotationVector
        body = system.CreateRigidBody(referencePosition=list(r), inertia=inertia, gravity=list(GRAVITY),
                                      nodeType=kind, returnDict=True)  # fmt: skip
        nodes.append(body["nodeNumber"])
        marker = system.AddMarker(of.MarkerNodeRigid(nodeNumber=nodes[-1]))
        contact.AddSphereWithMarker(marker, RADIUS, 2.0 * K, 0.0, 0)
    corners = [[-5, -5, 0], [5, -5, 0], [5, 5, 0], [-5, 5, 0]]
    contact.AddTrianglesRigidBodyBased(ground, 2.0 * K, 0.0, 0, corners, [[0, 1, 2], [0, 2, 3]])
    system.Assemble()
    settings = exu.SimulationSettings()
    settings.timeIntegration.numberOfSteps, settings.timeIntegration.endTime = round(END / step), END
    settings.solutionSettings.writeSolutionToFile = False
    settings.parallel.numberOfThreads = 1
    start = time.process_time()
    system.SolveDynamic(settings, solverType=getattr(exu.DynamicSolverType, method))
    took = time.process_time() - start
    return took, np.array([system.GetNodeOutput(node, exu.OutputVariableType.Position) for node in nodes])


def mujoco(balls, step):
    """Processor time, s, and largest penetration, m."""
    import mujoco as mj

    spec = mj.MjSpec()
    spec.option.timestep, spec.option.gravity = step, GRAVITY
    spec.worldbody.add_geom(type=mj.mjtGeom.mjGEOM_PLANE, size=[5, 5, 0.1], condim=1)
    for r in places(balls):
        body = spec.worldbody.add_body(pos=r)
        body.add_freejoint()
        body.add_geom(type=mj.mjtGeom.mjGEOM_SPHERE, size=[RADIUS, 0, 0], mass=MASS, condim=1)
    model = spec.compile()
    data, deepest, start = mj.MjData(model), 0.0, time.process_time()
    for _ in range(round(END / step)):
        mj.mj_step(model, data)
        deepest = min(deepest, data.contact.dist.min(initial=0.0))
    return time.process_time() - start, -deepest


def compare(balls):
    """Print times and errors of all programs."""
    flexmb(8, 1e-3, 0.01)
    exact = flexmb(balls, TOLERANCES[-1])[1]
    print(f"{balls} balls for {END} s")
    for tolerance in TOLERANCES[:-1]:
        took, r, evaluations, touches = flexmb(balls, tolerance)
        error = abs(r - exact).max()
        print(f"  flexmb  {tolerance:g}: {took:.2f} s, error {error:.1e} m, {evaluations} evaluations, "
              f"{touches} contacts began")  # fmt: skip
    for method, steps in EXUDYN.items():
        for step in steps:
            took, r = exudyn(balls, method, step)
            print(f"  Exudyn  {method} {step:g}: {took:.2f} s, error {abs(r - exact).max():.1e} m")
    for step in (1e-3, 1e-4):
        took, depth = mujoco(balls, step)
        print(f"  MuJoCo  {step:g}: {took:.2f} s, penetration {depth:.1e} m")


def scale():
    """Print the time of an evaluation by the number of balls."""
    times = []
    for balls in SCALED:
        took, _, evaluations, _ = min(flexmb(balls, 1e-3, 0.02) for _ in range(2))
        times.append(took / evaluations)
        print(f"  {balls} balls: {1e6 * times[-1]:.0f} us an evaluation, steps and events included")
    print(f"  exponent {np.polyfit(np.log(SCALED), np.log(times), 1)[0]:.2f}")


if __name__ == "__main__":
    for count in map(int, sys.argv[1:] or ["100"]):
        compare(count)
    scale()
