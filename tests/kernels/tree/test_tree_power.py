"""Power and energies of a tree against the generalized forces of its particles."""

from dataclasses import replace

import numpy as np
import pytest

from flexmb_cli.kernels.laws import POWER
from flexmb_cli.kernels.tree.energy import applied_power, energies
from flexmb_cli.kernels.tree.kinematics import place_frames
from flexmb_cli.kernels.tree.loads import coordinate_efforts
from flexmb_cli.model.joint_elements import JointElements
from flexmb_cli.model.laws import SPRING
from flexmb_cli.model.mechanism import TimeGrid
from flexmb_cli.model.piecewise_polynomials import linear_table
from flexmb_cli.model.time_functions import piecewise
from flexmb_cli.model.tree import INERTIAL, ROTATION, Body, BodyTorque, Elasticity, Hinge, Prescribed, Tree
from tests.kernels.tree.test_implicit_matrix import dense_parts
from tests.kernels.tree.test_kane_forward_dynamics import Recursion, close, hinged_angle
from tests.naive.particle_tree import Particles
from tests.naive.random_trees import motored, random_tree, where

T = 0.3  # s
MOTOR = (0.0, 2.0), (1.0, 5.0)  # N m: 2.9 at T
TORQUE = piecewise(linear_table((0.0, 1.0), (-3.0, 1.0)))  # N m: -1.8 at T


def power_of(recursion):
    """Power of all loads and elements."""
    power = applied_power(recursion.arrays, recursion.work, recursion.coordinates, *recursion.state[1:3])
    return power + recursion.arrays.answers[:, POWER].sum()


@pytest.mark.parametrize("seed", range(6))
def test_applied_power_is_that_of_all_forces_but_weight_and_elasticity(seed):
    """F · y of the particles without weight and springs, less that of elastic forces, -q · K y."""
    tree = random_tree(seed, gravity=(0.0, 0.0, 0.0))
    damped = tuple(spring.with_values(stiffness=0.0) for spring in tree.elements.of(SPRING))
    tree = replace(tree, elements=JointElements(forces=damped))
    recursion = Recursion(tree)
    assert isinstance(recursion.forward(), np.ndarray)
    _, _, force = recursion.dense()
    _, D, K = dense_parts(recursion)
    assert tree.y @ D @ tree.y > 0.01
    power = power_of(recursion)
    assert power == pytest.approx(force @ tree.y + tree.q @ K @ tree.y, rel=1e-10)


@pytest.mark.parametrize("seed", range(6))
def test_kinetic_and_stored_energies_are_those_of_the_matrices(seed):
    """y · b y / 2 of the particles, u · K u / 2, and k (q - rest)² / 2 of the springs."""
    recursion = Recursion(random_tree(seed, gravity=(0.0, 0.0, 0.0)))
    tree = recursion.tree
    recursion.forward()
    place = {(c.body, c.motion, c.axis): tree.q[m] for m, c in enumerate(tree.coordinates)}
    in_springs = [s["stiffness"] * (place[where(s)] - s["rest"]) ** 2 / 2 for s in tree.elements.of(SPRING)]
    _, _, K = dense_parts(Recursion(replace(tree, elements=JointElements())))
    expected = tree.y @ recursion.dense()[0] @ tree.y / 2, sum(in_springs), tree.q @ K @ tree.q / 2
    found = energies(recursion.arrays, recursion.work, tree.q, tree.y)
    assert found == pytest.approx(expected, rel=1e-10, abs=1e-12)


def test_motors_and_torques_that_grow_with_time_act_and_work_with_their_value_at_the_time():
    """A motor's torque on its coordinate, and that on the last body as a constant one of the same size."""
    plain = random_tree(5, gravity=(0.0, 0.0, 0.0), springs=())
    body, axis = next((k, h.rotations[0]) for k, h in enumerate(plain.hinges) if len(h.rotations) in (1, 2))
    last = plain.bodies[-1]
    stronger = replace(last, torque=(last.torque[0], last.torque[1] - 1.8, last.torque[2]))
    mass, remainder, force = Recursion(replace(plain, bodies=(*plain.bodies[:-1], stronger))).dense()
    place = {(c.body, c.motion, c.axis): m for m, c in enumerate(plain.coordinates)}
    force[place[body, ROTATION, axis]] += 2.9
    torques = (BodyTorque(len(plain.bodies) - 1, 2, TORQUE),)
    recursion = Recursion(replace(plain, elements=motored(body, ROTATION, axis, *MOTOR), torques=torques))
    recursion.state = (T, *recursion.state[1:])
    close(recursion.forward(), np.linalg.solve(mass, force - remainder), 1e-11)
    elastic = plain.q @ dense_parts(recursion)[2] @ plain.y
    power = power_of(recursion)
    assert power == pytest.approx(force @ plain.y + elastic, rel=1e-10)


@pytest.mark.parametrize("seed", range(6))
def test_the_potential_of_weights_is_that_of_the_particles(seed):
    """- sum of m g · r over the particles."""
    tree = random_tree(seed, springs=())
    recursion = Recursion(tree)
    recursion.forward()
    particles = Particles(tree, recursion.attitudes)
    places = particles.positions(tree.q + 0j, np.zeros(len(tree.q))).real
    expected = -particles.weights @ places @ np.array(tree.gravity)
    assert abs(expected) > 0.1
    assert energies(recursion.arrays, recursion.work, tree.q, tree.y)[1] == pytest.approx(expected, rel=1e-10)


def test_a_driven_coordinate_takes_the_power_of_its_effort():
    """F · y of the particles, less that of elastic forces, and effort times speed."""
    quiet = {"gravity": (0.0, 0.0, 0.0), "springs": ()}
    body, axis = hinged_angle(random_tree(5))
    driver = Prescribed(body, ROTATION, axis, 0.0, 0.0, 3.0)
    recursion = Recursion(random_tree(5, prescribed=(driver,), **quiet))
    tree, driven = recursion.tree, (body, ROTATION, axis)
    m = next(i for i, c in enumerate(tree.coordinates) if (c.body, c.motion, c.axis) == driven)
    recursion.coordinates["held"], recursion.coordinates["rate"][m] = recursion.arrays.given, 3.0
    rates = recursion.forward()
    b, remainder, force = recursion.dense()
    effort = b[m] @ rates + remainder[m] - force[m]
    assert abs(effort) > 1.0
    assert abs(tree.y[m] ** 2 - 1.0) > 0.01
    elastic = tree.q @ dense_parts(recursion)[2] @ tree.y
    power = power_of(recursion)
    assert power == pytest.approx(force @ tree.y + elastic + effort * tree.y[m], rel=1e-10)


def test_weight_along_a_beam_stiffens_it_as_a_pull_at_its_tip():
    """A massless beam with a mass m at its tip bends as w = u (3 s² - s³)/2, s = x/L, and its tip sinks by
    6/5 u²/2L: a pull m g adds 6 m g/5L to the stiffness."""
    m, g, length, stiffness, u = 0.4, 9.81, 0.8, 30.0, 0.02
    elastic = Elasticity(
        np.array([[length, 0.0, 0.0]]), np.array([m]), (3,), np.array([[stiffness]]), np.zeros((1, 3)),
        stiffened_from=0.0,
    )  # fmt: skip
    tree = Tree(
        (Body("body 1", m, np.diag([0.0, m * length**2, m * length**2]), elastic=elastic),),
        (Hinge(INERTIAL),),
        np.array([u]),
        np.array([0.0]),
        TimeGrid(0.0, 1.0, 0.1),
        gravity=(g, 0.0, 0.0),
    )
    recursion = Recursion(tree)
    place_frames(recursion.arrays, recursion.work, recursion.coordinates, *recursion.state[1:])
    coordinate_efforts(recursion.arrays, recursion.work, *recursion.state[1:3], recursion.coordinates)
    expected = -(stiffness + 1.2 * m * g / length) * u
    assert recursion.coordinates["effort"][0] == pytest.approx(expected, rel=1e-10)


def test_the_pull_of_turning_on_a_tip_takes_power_from_its_bending():
    """The pull m w² L of a tip that turns at w adds 6 m w²/5 to the stiffness: power -6/5 m w² u u'."""
    m, length, u, w, v = 0.4, 0.8, 0.02, 5.0, 0.3
    elastic = Elasticity(
        np.array([[length, 0.0, 0.0]]), np.array([m]), (3,), np.array([[30.0]]), np.zeros((1, 3)),
        stiffened_from=0.0,
    )  # fmt: skip
    tree = Tree(
        (Body("body 1", m, np.diag([0.0, m * length**2, m * length**2]), elastic=elastic),),
        (Hinge(INERTIAL, rotations=(2,)),),
        np.array([0.0, u]),
        np.array([w, v]),
        TimeGrid(0.0, 1.0, 0.1),
    )
    recursion = Recursion(tree)
    place_frames(recursion.arrays, recursion.work, recursion.coordinates, *recursion.state[1:])
    power = power_of(recursion)
    assert power == pytest.approx(-1.2 * m * w**2 * u * v, rel=1e-10)
