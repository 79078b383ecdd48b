"""Time per forward-dynamics evaluation of chains, against Pinocchio's ABA and MuJoCo, in one run.

    pip install -e '.[bench]' && python scripts/bench/trees.py

A chain of n rigid links on revolute hinges about axes 1, 2, 3 in turn, random angles and speeds.  All
three are given the same masses and inertias, and their accelerations are compared before the clock
runs.  Each time is the best of several repeats, the three taken in turn; the exponent is the slope
of log(time) over log(links).  MuJoCo's time is that of mj_forward, contacts switched off.

Then the shaft and beam of the thesis, section 4.3: processor seconds per simulated second, by method
and number of nodes, the same stretch of time for all.  Then a chain of 48 with springs in its hinges against
the same without: an evaluation, and a whole run in a warm process, processor time, the runs in turn.  Parts
can be named: `trees.py chains beams elements`.
"""

import sys
import time
from dataclasses import replace

import numpy as np

from flexmb_cli.dialects.dafms.beam import Beam
from flexmb_cli.kernels._jit import kernel
from flexmb_cli.kernels.tree import kane
from flexmb_cli.kernels.tree.work import tree_work
from flexmb_cli.model.arrays.tree import initial_attitudes, tree_arrays
from flexmb_cli.model.joint_elements import JointElements
from flexmb_cli.model.laws import At, spring
from flexmb_cli.model.mechanism import TimeGrid
from flexmb_cli.model.time_functions import pulse
from flexmb_cli.model.tree import Body, BodyTorque, Elasticity, Hinge, Integration, Tree
from flexmb_cli.solvers.tree.analysis import TreeAnalysis

LINKS = (8, 16, 32, 64, 128, 256, 512, 1024)
REPEATS = 15
# Where a program stops, and why.
MOST_LINKS = {"mujoco": 512}
STOPPED = "mujoco stops at 512 links: it refuses bodies nested 1024 deep (depth limit exceeded)"
GRAVITY = (0.0, 9.8, 0.0)
# One link: 1 kg, mass centre half way down axis 2, inertia about the mass centre.
CENTRE = (0.0, 0.5, 0.0)
ABOUT_CENTRE = np.diag([0.1, 0.02, 0.1])


def chain(links):
    """A chain of rigid links as a Tree."""
    rng = np.random.default_rng(links)
    inertia = ABOUT_CENTRE + np.diag([0.25, 0.0, 0.25])
    bodies = tuple(Body(f"link {k}", 1.0, inertia, CENTRE) for k in range(links))
    hinges = tuple(Hinge(k - 1, (0, 1, 0) if k else (0, 0, 0), rotations=(k % 3 + 1,)) for k in range(links))
    q, y = rng.uniform(-1, 1, links), rng.uniform(-1, 1, links)
    return Tree(bodies, hinges, q, y, TimeGrid(0.0, 1.0, 0.1), GRAVITY)


@kernel
def repeat(count, arrays, work, coordinates, q, y, attitudes):
    """Evaluate so many times without leaving compiled code."""
    for _ in range(count):
        kane.accelerations(arrays, work, coordinates, 0.0, q, y, attitudes)


def flexmb_evaluator(tree):
    """(function that evaluates n times, function that gives the accelerations)."""
    arrays = tree_arrays(tree)
    work, coordinates = tree_work(len(arrays.frames), len(tree.q))
    rest = (arrays, work, coordinates, tree.q, tree.y, initial_attitudes(tree))
    return lambda count: repeat(count, *rest), lambda: coordinates["rate"]


def pinocchio_evaluator(tree):
    """Pinocchio's articulated-body algorithm; the loop over evaluations is Python's, 1 µs or less."""
    import pinocchio as pin

    model = pin.Model()
    model.gravity.linear = np.array(GRAVITY)
    joints = (pin.JointModelRX(), pin.JointModelRY(), pin.JointModelRZ())
    link = pin.Inertia(1.0, np.array(CENTRE), ABOUT_CENTRE)
    for k, hinge in enumerate(tree.hinges):
        place = pin.SE3(np.eye(3), np.array(hinge.point, float))
        joint = model.addJoint(k, joints[hinge.rotations[0] - 1], place, f"hinge {k}")
        model.appendBodyToJoint(joint, link, pin.SE3.Identity())
    data, torque = aba_data(model), np.zeros(len(tree.q))

    def evaluate(count):
        for _ in range(count):
            pin.aba(model, data, tree.q, tree.y, torque)

    return evaluate, lambda: data.ddq


def aba_data(model):
    """The part of Pinocchio's Data that its articulated-body algorithm uses.

    model.createData() makes room for second derivatives of all joint places as well, 48 n³ bytes: 52 GB
    for 1024 links.
    """
    import pinocchio as pin

    data = pin.Data()
    for joint in model.joints:
        data.joints.append(joint.createData())
    blanks = (
        (pin.SE3.Identity(), (data.liMi, data.oMi)),
        (pin.Motion.Zero(), (data.v, data.a, data.a_gf)),
        (pin.Force.Zero(), (data.f, data.h)),
        (np.zeros((6, 6)), (data.Yaba,)),
    )
    for blank, fields in blanks:
        for rows in fields:
            rows.extend([blank] * model.njoints)
    data.ddq = np.zeros(model.nv)
    return data


def mujoco_evaluator(tree):
    """MuJoCo's mj_forward."""
    import mujoco

    spec = mujoco.MjSpec()
    spec.option.gravity = GRAVITY
    spec.option.disableflags = mujoco.mjtDisableBit.mjDSBL_CONTACT
    body = spec.worldbody
    for hinge in tree.hinges:
        body = body.add_body(pos=hinge.point, mass=1.0, ipos=CENTRE, inertia=np.diag(ABOUT_CENTRE))
        body.explicitinertial = True
        body.add_joint(type=mujoco.mjtJoint.mjJNT_HINGE, axis=np.eye(3)[hinge.rotations[0] - 1])
    model = spec.compile()
    data = mujoco.MjData(model)
    data.qpos, data.qvel = tree.q, tree.y

    def evaluate(count):
        for _ in range(count):
            mujoco.mj_forward(model, data)

    return evaluate, lambda: data.qacc


PEERS = {"flexmb": flexmb_evaluator, "pinocchio": pinocchio_evaluator, "mujoco": mujoco_evaluator}


def measure(evaluators, count):
    """Best time per evaluation of each, µs."""
    best = dict.fromkeys(evaluators, np.inf)
    for _ in range(REPEATS):
        for name, (evaluate, _) in evaluators.items():
            begin = time.perf_counter()
            evaluate(count)
            best[name] = min(best[name], (time.perf_counter() - begin) / count * 1e6)
    return best


def agree(evaluators):
    """Stop when the programs do not compute the same accelerations."""
    results = {}
    for name, (evaluate, accelerations) in evaluators.items():
        evaluate(1)
        results[name] = np.array(accelerations())
    for name, found in results.items():
        gap = np.max(np.abs(found - results["flexmb"])) / np.max(np.abs(found))
        if gap > 1e-6:
            sys.exit(f"{name} computes other accelerations: relative difference {gap:.1e}")


def compare_chains():
    """Table of times over the number of links."""
    times = {name: {} for name in PEERS}
    print("links  " + "".join(f"{name:>12}" for name in PEERS) + "   µs per evaluation")
    for links in LINKS:
        tree = chain(links)
        fitting = {name: make for name, make in PEERS.items() if links <= MOST_LINKS.get(name, links)}
        evaluators = {name: make(tree) for name, make in fitting.items()}
        agree(evaluators)
        for name, value in measure(evaluators, max(5, 4000 // links)).items():
            times[name][links] = value
        row = "".join(f"{times[name].get(links, np.nan):12.2f}" for name in PEERS)
        print(f"{links:5d}  {row}", flush=True)
    for name, values in times.items():
        exponent = np.polyfit(np.log(list(values)), np.log(list(values.values())), 1)[0]
        print(f"exponent of growth, {name}: {exponent:.3f}")
    print(STOPPED)


def shaft_and_beam(nodes):
    """Section 4.3 of the DAFMS thesis with a mesh of so many nodes."""
    beam = Beam(0.5, nodes, 5.5, 0.0858, offset=0.05)
    positions = np.zeros((nodes, 3))
    positions[:, 1] = beam.positions
    elastic = Elasticity(positions, beam.masses, (3,), beam.stiffness, np.zeros((nodes, 3)))
    inertia = beam.inertia + 0.002377375
    body = Body("shaft", beam.mass, np.diag([inertia, 0.0, inertia]), elastic=elastic)
    start = np.zeros(nodes + 1)
    return Tree(
        (body,),
        (Hinge(-1, rotations=(1,)),),
        start,
        start,
        TimeGrid(0.0, 0.02, 0.001),
        gravity=(0.0, 0.0, 0.0),
        torques=(BodyTorque(0, 1, pulse(1.0, 0.05)),),
        integration=Integration("dop853", 1e-6, 1e-6),
    )


# Tolerances with which the methods come to about the same error of the tip.
EQUAL_ACCURACY = {"dop853": 1e-6, "sdirk4": 1e-5, "radau": 1e-5}
NODES = (10, 50, 200)
SPAN = 0.02  # s


def compare_methods(methods=tuple(EQUAL_ACCURACY)):
    """Table of the cost of the shaft and beam by method and nodes."""
    print("processor s per simulated s; evaluations are those of the equations")
    print("nodes  method  tolerance   s per s   s per s and node   evaluations   error of the tip, m")
    for nodes in NODES:
        tree = replace(shaft_and_beam(nodes), time=TimeGrid(0.0, SPAN, SPAN / 20))
        exact = integration(replace(tree, integration=Integration("dop853", 1e-9, 1e-9)))[2]
        for method in methods:
            tolerance = EQUAL_ACCURACY[method]
            chosen = replace(tree, integration=Integration(method, tolerance, tolerance))
            integration(replace(chosen, time=TimeGrid(0.0, 1e-6, 1e-6)))
            spent, count, tip = integration(chosen)
            error, cost = np.max(np.abs(tip - exact)), spent / SPAN
            print(
                f"{nodes:5d}  {method:6}  {tolerance:9.0e}   {cost:7.2f}   {cost / nodes:16.4f}"
                f"   {count:11d}   {error:.1e}",
                flush=True,
            )


def integration(tree):
    """Processor seconds, evaluations and tip deflections of a run."""
    analysis = TreeAnalysis(tree)
    begin = time.process_time()
    tip = np.concatenate([rows.q[:, -1] for rows in analysis.rows()])
    return time.process_time() - begin, int(analysis.clock["evaluations"][0]), tip


def sprung(links, count):
    """A chain of links with springs and dampers in so many of its hinges."""
    tree = chain(links)
    forces = tuple(
        spring(f"spring {k}", At(k, f"rotation {k % 3 + 1}"), 20.0, 0.1, 0.2) for k in range(count)
    )
    return replace(tree, elements=JointElements(forces=forces), time=TimeGrid(0.0, 0.5, 0.01))


def compare_elements(links=48, counts=(0, 1, 48)):
    """Table of the cost of springs: an evaluation, and a whole run of 51 rows."""
    trees = {count: sprung(links, count) for count in counts}
    names = "evaluation", "run", "per evaluation of the run"
    best = {name: dict.fromkeys(counts, np.inf) for name in names}
    evaluators = {count: flexmb_evaluator(tree)[0] for count, tree in trees.items()}
    for _ in range(REPEATS):
        for count, evaluate in evaluators.items():
            begin = time.process_time()
            evaluate(2000)
            spent = (time.process_time() - begin) / 2000
            best["evaluation"][count] = min(best["evaluation"][count], spent)
    for _ in range(5):
        for count, tree in trees.items():
            spent, evaluations, _tip = integration(tree)
            best["run"][count] = min(best["run"][count], spent)
            best[names[2]][count] = min(best[names[2]][count], spent / evaluations)
    print(f"chain of {links}: springs, processor time in µs, against none")
    for name, values in best.items():
        row = "   ".join(f"{n:2d}: {1e6 * t:10.2f} {t / values[0]:5.2f}" for n, t in values.items())
        print(f"{name:26} {row}")


PARTS = {"elements": compare_elements, "chains": compare_chains, "beams": compare_methods}

if __name__ == "__main__":
    for part in sys.argv[1:] or PARTS:
        PARTS[part]()
