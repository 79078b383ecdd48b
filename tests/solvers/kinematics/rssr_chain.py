"""A serial chain of RSSR stages of any length, three bodies a stage, with its closed form stage by stage.

Each stage has a crank, a rod and a rocker.  Forward stages turn x into y, and backward ones, the same
linkage with its ends exchanged, y into x: two of them undo each other, so that a chain of any length
moves through the same range.  The rocker of a stage carries the next crank along by a distance
constraint between their Euler parameters (an equation as of gears, one to one).

As a program it prints the deck of a chain:  python rssr_chain.py STAGES > chain.dat
"""

import sys

import numpy as np

from flexmb_cli.model.mechanism import Body, Distance, Driver, Ground, Joint, Mechanism, Point, TimeGrid
from tests.solvers.kinematics.rssr import Rssr, carried

X, Y = np.array([1.0, 0.0, 0.0]), np.array([0.0, 1.0, 0.0])
UPRIGHT = (1.0, 0.0, 0.0, 0.0)
FUNCTION = (
    0.0,
    -0.8,
    0.4,
)  # angle of the first crank C + B t + A t²/2, rad: out to -0.8 rad at 2 s, and back
TIME = TimeGrid(0.0, 4.0, 0.25)


def stage(number: int) -> Rssr:
    """Linkage of the stage `number`, from 0, with the crank's axis through the origin."""
    end, pivot = np.array([0.0, 0.0, 1.0]), np.array([1.6, 1.6, 0.0])
    ends = (np.zeros(3), X, end), (pivot, Y, pivot + end)
    start, finish = ends if number % 2 == 0 else ends[::-1]
    return Rssr(*start, *finish)


def closed_form(stages: int, t) -> list[tuple]:
    """(crank, rocker) of every stage, each (angle, rate, second) of shape (T,), at times t."""
    C, B, A = FUNCTION
    angle = C + B * t + 0.5 * A * t * t, B + A * t, A + 0.0 * t
    motions = []
    for number in range(stages):
        rocker = stage(number).rocker(*angle)
        motions.append((angle, rocker))
        angle = rocker
    return motions


def rod_ends(stages: int, t) -> np.ndarray:
    """Position, velocity and acceleration (3, T, 2 stages, 3) of both ends of every rod."""
    ends = []
    for number, (crank, rocker) in enumerate(closed_form(stages, t)):
        s = stage(number)
        ends += [carried(s.O_in, s.u_in, s.A, *crank), carried(s.O_out, s.u_out, s.B, *rocker)]
    return np.stack([np.stack(kind, axis=1) for kind in zip(*ends, strict=True)])


def chain(stages: int, time: TimeGrid = TIME) -> Mechanism:
    """The mechanism: body 1 is the ground, stage k has bodies 3k - 1, 3k, 3k + 1; points are the rod ends."""
    bodies, joints, distances, points = [Body("body 1", (0.0, 0.0, 0.0), UPRIGHT)], [], [], []
    for number in range(stages):
        s, crank = stage(number), len(bodies)
        bodies += [
            Body(f"body {crank + k + 1}", tuple(map(float, r)), UPRIGHT)
            for k, r in enumerate((s.O_in, s.A, s.O_out))
        ]
        joints += _joints(s, crank, number)
        if number > 0:
            direction = 4 if s.u_in is X else 5
            distances.append(Distance(f"distance {number}", crank, crank - 1, direction, 0.0))
        points += [
            Point(f"point {2 * number + 1}", crank + 1, (0.0, 0.0, 0.0)),
            Point(f"point {2 * number + 2}", crank + 2, tuple(map(float, s.B - s.O_out))),
        ]
    order = ("spherical", "universal", "revolute")
    joints.sort(key=lambda joint: order.index(joint.kind))
    return Mechanism(
        tuple(bodies),
        time,
        tuple(joints),
        distances=tuple(distances),
        drivers=(Driver("driver 1", 1, 4, *FUNCTION),),
        grounds=(Ground("ground 1", 0, (0.0,) * 6),),
        points=tuple(points),
    )


def _joints(s: Rssr, crank, number):
    """Ball at the crank, cross at the rocker (it keeps the rod from spinning), two axles on the ground."""
    rod, rocker = crank + 1, crank + 2
    u_in, u_out = tuple(map(float, s.u_in)), tuple(map(float, s.u_out))
    across = tuple(map(float, np.cross(s.B - s.A, s.u_out)))
    arm_A, arm_B, along = (tuple(map(float, v)) for v in (s.A - s.O_in, s.B - s.O_out, s.B - s.A))
    origin = (0.0, 0.0, 0.0)
    return [
        Joint("spherical", f"spherical {number + 1}", crank, rod, arm_A, origin),
        Joint("universal", f"universal {number + 1}", rod, rocker, along, arm_B, across, u_out),
        _axle(2 * number + 1, crank, s.O_in, u_in),
        _axle(2 * number + 2, rocker, s.O_out, u_out),
    ]


def _axle(number, body, O, u):
    return Joint("revolute", f"revolute {number}", 0, body, tuple(map(float, O)), (0.0, 0.0, 0.0), u, u)


def deck_text(mechanism: Mechanism) -> str:
    """The YOUNG deck of a mechanism without screws and simplified constraints."""
    m = mechanism
    kinds = [j.kind for j in m.joints]
    counts = [len(m.bodies), len(m.drivers), len(m.points)]
    counts += [kinds.count(kind) for kind in ("spherical", "universal", "revolute")]
    counts += [0, 0, 0, 0, len(m.distances), len(m.grounds)]
    lines = [counts, *((*b.r, *b.p) for b in m.bodies)]
    lines += [(d.body + 1, d.direction, d.C, d.B, d.A) for d in m.drivers]
    lines += [(p.body + 1, *p.s) for p in m.points]
    for joint in m.joints:
        lines += [(joint.i + 1, joint.j + 1), _joint_points(joint)]
    lines += [(d.i + 1, d.j + 1, d.direction, d.value) for d in m.distances]
    lines += [(g.body + 1, *g.values) for g in m.grounds]
    lines.append((m.time.start, m.time.end, m.time.step))
    return "\n".join(" ".join(f"{x:.17g}" for x in line) for line in lines) + "\n"


def _joint_points(joint):
    if joint.kind == "spherical":
        return (*joint.P_i, *joint.P_j)
    return (*joint.P_i, *joint.P_j, *np.add(joint.P_i, joint.s_i), *np.add(joint.P_j, joint.s_j))


if __name__ == "__main__":
    sys.stdout.write(deck_text(chain(int(sys.argv[1]))))
