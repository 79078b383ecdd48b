"""The recursive solution of b y' = F - f* against the whole matrix, made from particles."""

from dataclasses import replace

import numpy as np
import pytest

from flexmb_cli.kernels.tree.elements import answer_elements
from flexmb_cli.kernels.tree.kane import SOLVED, accelerations, solve_tree
from flexmb_cli.kernels.tree.kinematics import place_frames
from flexmb_cli.kernels.tree.loads import coordinate_efforts
from flexmb_cli.kernels.tree.work import tree_work
from flexmb_cli.model.arrays.tree import initial_attitudes, tree_arrays
from flexmb_cli.model.piecewise_polynomials import linear_table
from flexmb_cli.model.time_functions import piecewise
from flexmb_cli.model.tree import ROTATION, BodyTorque, Prescribed
from flexmb_cli.solvers.tree.analysis import hold_functions
from tests.naive.particle_tree import equations
from tests.naive.random_trees import motored, random_tree

SEEDS = range(12)


class Recursion:
    """A tree at its initial state with arrays and work space."""

    def __init__(self, tree):
        self.tree, self.arrays = tree, tree_arrays(tree)
        hold_functions(self.arrays, 1.0)
        self.work, self.coordinates = tree_work(len(self.arrays.frames), len(tree.q))
        self.attitudes = initial_attitudes(tree)
        self.state = (0.0, tree.q, tree.y, self.attitudes)

    def forward(self):
        """y', or the coordinate without inertia."""
        fault = accelerations(self.arrays, self.work, self.coordinates, *self.state)
        return self.coordinates["rate"].copy() if fault == SOLVED else fault

    def inverse(self, rates, extra=0.0):
        """Efforts that are missing for the accelerations `rates` when `extra` efforts act as well."""
        place_frames(self.arrays, self.work, self.coordinates, *self.state[1:])
        coordinate_efforts(self.arrays, self.work, *self.state[1:3], self.coordinates)
        answer_elements(self.arrays, self.work, *self.state[:3], self.coordinates)
        self.coordinates["effort"] += extra
        self.coordinates["locked"], self.coordinates["rate"] = 1, rates
        solve_tree(self.arrays, self.work, self.coordinates, *self.state[:3])
        return self.coordinates["drive"].copy()

    def dense(self):
        """b, f*, F from particles."""
        return equations(self.tree, self.tree.q, self.tree.y, self.attitudes)


def close(found, expected, tolerance):
    assert np.max(np.abs(found - expected)) <= tolerance * max(1.0, np.max(np.abs(expected)))


@pytest.mark.parametrize("seed", SEEDS)
def test_accelerations_of_rigid_and_flexible_trees_are_those_of_their_particles(seed):
    recursion = Recursion(random_tree(seed))
    b, remainder, force = recursion.dense()
    close(recursion.forward(), np.linalg.solve(b, force - remainder), 1e-11)


@pytest.mark.parametrize("seed", SEEDS)
def test_efforts_of_a_given_motion_are_those_of_the_particles(seed):
    recursion = Recursion(random_tree(seed))
    rates = np.random.default_rng(seed).normal(size=len(recursion.tree.q))
    b, remainder, force = recursion.dense()
    close(recursion.inverse(rates), b @ rates + remainder - force, 1e-11)


@pytest.mark.parametrize("seed", SEEDS)
def test_inverse_dynamics_of_the_forward_motion_asks_for_no_effort(seed):
    recursion = Recursion(random_tree(seed, bodies=8))
    efforts = recursion.inverse(np.zeros(len(recursion.tree.q)))
    left = recursion.inverse(recursion.forward())
    close(left / np.max(np.abs(efforts)), 0.0, 1e-10)


@pytest.mark.parametrize("seed", range(6))
def test_one_way_motion_leaves_elastic_inertia_out_of_the_rigid_rows_only(seed):
    """listing_notes on DAFMS: b_mn = 0 for m rigid, n elastic; the rest of b, F and f* as they are."""
    recursion = Recursion(random_tree(seed, flexible=0.8, one_way=True))
    b, remainder, force = recursion.dense()
    elastic = recursion.arrays.elastic
    b[np.ix_(~elastic, elastic)] = 0.0
    close(recursion.forward(), np.linalg.solve(b, force - remainder), 1e-11)


def hinged_angle(tree):
    """Body of a tree with a single or double rotation, and the axis of the first."""
    return next((k, h.rotations[0]) for k, h in enumerate(tree.hinges) if len(h.rotations) in (1, 2))


def test_prescribed_coordinate_keeps_its_acceleration_and_the_others_answer_to_it():
    free = random_tree(5)
    body, axis = hinged_angle(free)
    m = next(
        i for i, c in enumerate(free.coordinates) if (c.body, c.motion, c.axis) == (body, ROTATION, axis)
    )
    driven = random_tree(5, prescribed=(Prescribed(body, ROTATION, axis, 0.0, 0.0, 3.0),))
    recursion = Recursion(driven)
    b, remainder, force = recursion.dense()
    recursion.coordinates["held"], recursion.coordinates["rate"][m] = recursion.arrays.given, 3.0
    others = np.arange(len(driven.q)) != m
    expected = np.linalg.solve(b[np.ix_(others, others)], (force - remainder - 3.0 * b[:, m])[others])
    rates = recursion.forward()
    assert rates[m] == 3.0
    close(rates[others], expected, 1e-11)
    effort = recursion.coordinates["drive"][m]
    assert effort == pytest.approx(b[m] @ rates + remainder[m] - force[m], rel=1e-10)


def test_motor_acts_on_its_coordinate_alone_and_body_torque_on_the_body_from_outside():
    """A motor adds tau to F of its coordinate; a torque about axis i adds tau Omega_m . e_i (3.13)."""
    plain = random_tree(5)
    body, axis = hinged_angle(plain)
    m = next(
        i for i, c in enumerate(plain.coordinates) if (c.body, c.motion, c.axis) == (body, ROTATION, axis)
    )
    b, remainder, force = Recursion(plain).dense()
    motor = motored(body, ROTATION, axis, (0.0, 7.0)).forces
    driven = Recursion(
        replace(plain, elements=replace(plain.elements, forces=(*plain.elements.forces, *motor)))
    )
    force[m] += 7.0
    close(driven.forward(), np.linalg.solve(b, force - remainder), 1e-11)


def test_tabulated_body_torque_equals_the_constant_torque_of_the_same_size():
    tree = random_tree(2)
    last = tree.bodies[-1]
    stronger = replace(last, torque=(last.torque[0], last.torque[1] + 4.0, last.torque[2]))
    constant_torque = replace(tree, bodies=(*tree.bodies[:-1], stronger))
    tabulated = replace(
        tree, torques=(BodyTorque(len(tree.bodies) - 1, 2, piecewise(linear_table((0.0,), (4.0,)))),)
    )
    close(Recursion(tabulated).forward(), Recursion(constant_torque).forward(), 1e-13)


def test_body_without_inertia_about_its_hinge_is_named_by_its_coordinate():
    """Nodes that account for the whole inertia leave nothing that resists the angle."""
    tree = random_tree(0)
    k = next(
        i for i, body in enumerate(tree.bodies) if body.elastic and 1 <= len(tree.hinges[i].rotations) < 3
    )
    body = tree.bodies[k]
    x, masses = body.elastic.positions, body.elastic.masses
    nodes = sum(m * (r @ r * np.eye(3) - np.outer(r, r)) for m, r in zip(masses, x, strict=True))
    hollow = replace(body, inertia=nodes - 5.0 * np.eye(3))
    bodies = tuple(hollow if i == k else b for i, b in enumerate(tree.bodies))
    fault = Recursion(replace(tree, bodies=bodies)).forward()
    assert tree.coordinates[fault].body == k
