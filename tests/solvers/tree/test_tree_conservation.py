"""What a motion keeps: momentum and energy of free trees, energy under loads that are counted."""

from dataclasses import replace

import numpy as np
import pytest

from flexmb_cli.model.joint_elements import JointElements
from flexmb_cli.model.mechanism import TimeGrid
from flexmb_cli.model.tree import ROTATION, Prescribed, generalized_coordinates
from flexmb_cli.solvers.tree.analysis import TreeAnalysis
from flexmb_cli.solvers.tree.state import initial_state
from tests.naive.particle_tree import Particles
from tests.naive.random_trees import motored, random_tree
from tests.solvers.tree.tree_runs import run

GRID = TimeGrid(0.0, 2.0, 0.05)


def unloaded(body):
    """The body without forces and dampers."""
    none = (0.0, 0.0, 0.0)
    elastic = body.elastic and replace(body.elastic, forces=0 * body.elastic.forces, damping=None)
    return replace(body, force=none, torque=none, elastic=elastic)


def settled(seed, **options):
    """A random tree without losses, at moderate speeds."""
    tree = random_tree(seed, bodies=4, time=GRID, **options)
    elements = JointElements(forces=tuple(s.with_values(damping=0.0) for s in tree.elements.forces))
    settings = replace(tree.integration, rtol=1e-11, atol=1e-11)
    return replace(tree, elements=elements, bodies=tuple(map(unloaded, tree.bodies)), integration=settings)


def floating(seed, **options):
    """A tree that flies freely: its root has six freedoms, no gravity."""
    tree = settled(seed, gravity=(0.0, 0.0, 0.0), springs=(), **options)
    root = replace(tree.hinges[0], rotations=(1, 2, 3), translations=(1, 2, 3))
    hinges = (root, *tree.hinges[1:])
    rng = np.random.default_rng(seed)
    n = len(generalized_coordinates(tree.bodies, hinges))
    return replace(tree, hinges=hinges, q=rng.uniform(-0.2, 0.2, n), y=rng.uniform(-1, 1, n))


def momenta(tree, state):
    """Momentum and moment of momentum about the origin of all particles, by a complex step."""
    n = len(tree.coordinates)
    y, q, attitudes = state[:n], state[n : 2 * n], state[2 * n : -1].reshape(-1, 4)
    particles = Particles(tree, attitudes)
    moved = particles.positions(q + 1e-30j * y, 1e-30j * y)
    velocity = moved.imag * 1e30 * particles.weights[:, None]
    return np.concatenate([velocity.sum(axis=0), np.cross(moved.real, velocity).sum(axis=0)])


@pytest.mark.long_motion
@pytest.mark.parametrize("tilted", [False, True])
@pytest.mark.parametrize("seed", range(4))
def test_free_tree_keeps_momentum_moment_of_momentum_and_energy(seed, tilted):
    """`tilted`: hinges on nodes turn with the slope."""
    tree = floating(seed, tilted=tilted)
    analysis = TreeAnalysis(tree)
    energy = np.concatenate([block.total for block in analysis.rows()])
    before, after = momenta(tree, initial_state(tree)), momenta(tree, analysis.state)
    assert np.max(np.abs(after - before)) <= 1e-8 * np.max(np.abs(before))
    assert np.ptp(energy) <= 1e-8 * np.max(np.abs(energy))


@pytest.mark.long_motion
@pytest.mark.parametrize("seed", range(4))
def test_tree_under_gravity_with_springs_keeps_its_energy(seed):
    rows = run(settled(seed))
    assert np.ptp(rows.total) <= 1e-8 * np.max(np.abs(rows.potential))


@pytest.mark.long_motion
def test_energy_audit_counts_forces_dampers_motors_and_prescribed_motion():
    tree = random_tree(5, bodies=4, time=GRID)
    settings = replace(tree.integration, rtol=1e-11, atol=1e-11)
    hinged = [(k, h.rotations[0]) for k, h in enumerate(tree.hinges) if len(h.rotations) in (1, 2)]
    (driven, axis), (moved, other) = hinged[0], hinged[1]
    points = (0.0, 0.0), (0.3, 2.0), (0.7, -1.0), (0.7, 3.0), (1.5, 0.5)
    motor = motored(driven, ROTATION, axis, *points).forces
    tree = replace(
        tree,
        integration=settings,
        elements=replace(tree.elements, forces=(*tree.elements.forces, *motor)),
        prescribed=(Prescribed(moved, ROTATION, other, 0.1, 0.5, -0.4),),
    )
    rows = run(tree)
    assert np.max(np.abs(rows.applied_work)) > 1.0
    assert np.ptp(rows.total) <= 1e-8 * np.max(np.abs(rows.kinetic))
