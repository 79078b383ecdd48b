"""Random trees with every number nonzero and different, so that swapped terms cannot hide."""

import numpy as np

from flexmb_cli.model.joint_elements import JointElements
from flexmb_cli.model.laws import MOTOR, At, Element
from flexmb_cli.model.laws import spring as spring_of
from flexmb_cli.model.mechanism import TimeGrid
from flexmb_cli.model.time_functions import HELD_TABLE, MotionFunction
from flexmb_cli.model.tree import (
    INERTIAL,
    ROTATION,
    TRANSLATION,
    Body,
    Elasticity,
    Hinge,
    Tree,
    generalized_coordinates,
)

AXES = (1, 2, 3)


def subset(rng, least=0):
    """A random subset of the three axes."""
    return tuple(sorted(int(i) for i in rng.choice(AXES, rng.integers(least, 4), replace=False)))


def attitude(rng):
    """Random Euler parameters."""
    e = rng.normal(size=4)
    return tuple(e / np.linalg.norm(e))


def spd(rng, n, scale=1.0):
    """A random symmetric positive definite matrix."""
    a = rng.normal(size=(n, n))
    return scale * (a @ a.T / n + 0.3 * np.eye(n))


def rigid_body(rng, name):
    """A rigid body whose inertia about O_k is possible for its mass centre."""
    mass = rng.uniform(0.5, 2.0)
    c = rng.normal(size=3) * 0.3
    points = rng.normal(size=(6, 3)) * 0.2
    points += c - points.mean(axis=0)
    inertia = sum(mass / 6 * (x @ x * np.eye(3) - np.outer(x, x)) for x in points) + 0.05 * np.eye(3)
    return Body(name, mass, inertia, tuple(c), None, tuple(rng.normal(size=3)), tuple(rng.normal(size=3)))


def flexible_body(rng, name, nodes, axes):
    """A flexible body with a hub at its root."""
    x = rng.normal(size=(nodes, 3)) * 0.5
    m = rng.uniform(0.2, 0.6, nodes)
    inertia = spd(rng, 3, 0.1) + sum(
        mi * (xi @ xi * np.eye(3) - np.outer(xi, xi)) for mi, xi in zip(m, x, strict=True)
    )
    n = nodes * len(axes)
    elastic = Elasticity(x, m, axes, spd(rng, n, 50.0), rng.normal(size=(nodes, 3)), spd(rng, n, 0.5))
    return Body(
        name, m.sum() + 0.4, inertia, (0, 0, 0), elastic, tuple(rng.normal(size=3)), tuple(rng.normal(size=3))
    )


def random_tree(seed, bodies=5, flexible=0.5, tilted=False, **options):
    """A tree of rigid and flexible bodies with hinges of all kinds; options go to Tree."""
    rng = np.random.default_rng(seed)
    parts, hinges = [], []
    for k in range(bodies):
        name = f"body {k + 1}"
        if rng.random() < flexible:
            parts.append(flexible_body(rng, name, int(rng.integers(1, 4)), subset(rng, 1)))
        else:
            parts.append(rigid_body(rng, name))
        hinges.append(random_hinge(rng, parts, k, tilted))
    n = len(generalized_coordinates(parts, hinges))
    springs = random_springs(rng, hinges)
    options.setdefault("elements", JointElements(forces=options.pop("springs", springs)))
    options.setdefault("time", TimeGrid(0.0, 1.0, 0.1))
    return Tree(
        tuple(parts),
        tuple(hinges),
        rng.uniform(-0.5, 0.5, n),
        rng.uniform(-2, 2, n),
        gravity=options.pop("gravity", tuple(rng.normal(size=3) * 5)),
        **options,
    )


def random_hinge(rng, parts, k, tilted):
    """A hinge on a random earlier body, on a node when it has any."""
    parent = int(rng.integers(0, k)) if k else INERTIAL
    elastic = parts[parent].elastic if k else None
    node = int(rng.integers(0, len(elastic.masses))) if elastic and rng.random() < 0.8 else None
    point = rng.normal(size=3) * 0.4 if node is None else elastic.positions[node]
    tilt = None
    if tilted and node is not None:
        tilt = rng.normal(size=(3, elastic.coordinates)) * 0.5
    return Hinge(
        parent,
        tuple(point),
        node,
        attitude(rng),
        attitude(rng),
        subset(rng),
        subset(rng) if rng.random() < 0.5 else (),
        tilt,
    )


def spring(body, motion, axis, stiffness=0.0, damping=0.0, rest=0.0):
    """A spring and damper in a hinge coordinate."""
    return spring_of("spring", At(body, f"{motion} {axis}"), stiffness, rest, damping)


def sprung(*springs):
    """The elements of a tree that has such springs."""
    return JointElements(forces=tuple(spring(*each) for each in springs))


def motored(body, motion, axis, *points):
    """The elements of a tree that has one motor, whose effort is linear between points (t, effort)."""
    times, values = zip(*points, (points[-1][0] + 1.0, points[-1][1]), strict=True)
    held = MotionFunction(HELD_TABLE, times=times, values=values, curvature=(0.0,) * len(times))
    return JointElements(forces=(Element("motor", MOTOR, At(body, f"{motion} {axis}"), (held,)),))


def where(element):
    """Body, motion and axis of an element in a hinge coordinate."""
    motion, axis = element.measure.coordinate.split()
    return element.measure.joint, motion, int(axis)


def random_springs(rng, hinges):
    """A spring and damper on the first rotation or translation of every second hinge."""
    springs = []
    for k, hinge in enumerate(hinges[::2]):
        if hinge.translations:
            springs.append(spring(2 * k, TRANSLATION, hinge.translations[0], 3.0, 0.4, 0.1))
        elif len(hinge.rotations) in (1, 2):
            springs.append(spring(2 * k, ROTATION, hinge.rotations[-1], 2.0, 0.3, -0.2))
    return tuple(springs)
