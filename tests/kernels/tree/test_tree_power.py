"""Power and energies of a tree against the generalized forces of its particles."""

from dataclasses import replace

import numpy as np
import pytest

from flexmb_cli.kernels.tree.energy import applied_power, energies
from flexmb_cli.model.tree import ROTATION, BodyTorque, Motor, Table
from tests.kernels.tree.test_implicit_matrix import dense_parts
from tests.kernels.tree.test_kane_forward_dynamics import Recursion, close
from tests.naive.random_trees import random_tree

T = 0.3  # s
MOTOR, TORQUE = Table((0.0, 1.0), (2.0, 5.0)), Table((0.0, 1.0), (-3.0, 1.0))  # N m: 2.9 and -1.8 at T


@pytest.mark.parametrize("seed", range(6))
def test_applied_power_is_that_of_all_forces_but_weight_and_elasticity(seed):
    """F · y of the particles without weight and springs, less that of elastic forces, -q · K y."""
    tree = random_tree(seed, gravity=(0.0, 0.0, 0.0))
    tree = replace(tree, springs=tuple(replace(spring, stiffness=0.0) for spring in tree.springs))
    recursion = Recursion(tree)
    assert isinstance(recursion.forward(), np.ndarray)
    _, _, force = recursion.dense()
    _, D, K = dense_parts(recursion)
    assert tree.y @ D @ tree.y > 0.01
    power = applied_power(recursion.arrays, recursion.work, recursion.coordinates, *recursion.state[:3])
    assert power == pytest.approx(force @ tree.y + tree.q @ K @ tree.y, rel=1e-10)


@pytest.mark.parametrize("seed", range(6))
def test_kinetic_and_stored_energies_are_those_of_the_matrices(seed):
    """y · b y / 2 of the particles, u · K u / 2, and k (q - rest)² / 2 of the springs."""
    recursion = Recursion(random_tree(seed, gravity=(0.0, 0.0, 0.0)))
    tree = recursion.tree
    recursion.forward()
    place = {(c.body, c.motion, c.axis): tree.q[m] for m, c in enumerate(tree.coordinates)}
    in_springs = [s.stiffness * (place[s.body, s.motion, s.axis] - s.rest) ** 2 / 2 for s in tree.springs]
    _, _, K = dense_parts(Recursion(replace(tree, springs=())))
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
    recursion = Recursion(replace(plain, motors=(Motor(body, ROTATION, axis, MOTOR),), torques=torques))
    recursion.state = (T, *recursion.state[1:])
    close(recursion.forward(), np.linalg.solve(mass, force - remainder), 1e-11)
    elastic = plain.q @ dense_parts(recursion)[2] @ plain.y
    power = applied_power(recursion.arrays, recursion.work, recursion.coordinates, *recursion.state[:3])
    assert power == pytest.approx(force @ plain.y + elastic, rel=1e-10)
