"""One cantilever of 2 L as two beams of L welded end to end: right only when the slope is carried."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.linalg import eigh

from flexmb_cli.dialects.dafms.beam import Beam
from flexmb_cli.model.mechanism import TimeGrid
from flexmb_cli.model.tree import INERTIAL, Body, Elasticity, Hinge, Tree
from tests.kernels.tree.test_kane_forward_dynamics import Recursion
from tests.solvers.tree.tree_runs import deck_tree, run

L, EI, RHO = 0.8, 12.0, 0.6
# First root of 1 + cos x cosh x = 0.
ROOT = 1.8751040687


def beam_body(name, nodes):
    """A flexible body along axis 2 that bends along axis 3."""
    beam = Beam(L, nodes, EI, RHO)
    positions = np.zeros((nodes, 3))
    positions[:, 1] = beam.positions
    elastic = Elasticity(positions, beam.masses, (3,), beam.stiffness, np.zeros((nodes, 3)))
    return Body(name, beam.mass, np.diag([beam.inertia, 1e-3, beam.inertia]), elastic=elastic)


def welded(nodes, slope=True):
    """Two beams of `nodes` elements each, the second welded to the last node of the first."""
    n = 2 * nodes
    rotation = Beam(L, nodes, EI, RHO).nodal_rotation(nodes) if slope else None
    hinges = (Hinge(INERTIAL), Hinge(0, (0.0, L, 0.0), nodes - 1, elastic_rotation=rotation))
    bodies = (beam_body("inner", nodes), beam_body("outer", nodes))
    return Tree(bodies, hinges, np.zeros(n), np.zeros(n), TimeGrid(0.0, 1.0, 0.1), (0.0, 0.0, 0.0))


def stiffness(tree):
    """(NS, NS) of all bodies."""
    n = tree.bodies[0].elastic.coordinates
    K = np.zeros((2 * n, 2 * n))
    for first, body in zip((0, n), tree.bodies, strict=True):
        K[first : first + n, first : first + n] = body.elastic.stiffness
    return K


def tip_deflection(tree, force):
    """Deflection of the free end under a force there, divided by force: b = 0 solved for the efforts."""
    loads = np.zeros(tree.bodies[1].elastic.forces.shape)
    loads[-1, 2] = force
    outer = replace(tree.bodies[1], elastic=replace(tree.bodies[1].elastic, forces=loads))
    recursion = Recursion(replace(tree, bodies=(tree.bodies[0], outer)))
    share = -recursion.inverse(np.zeros(len(tree.q))) / force
    return share @ np.linalg.solve(stiffness(tree), share)


def lowest_frequency(tree):
    """rad/s, from the mass matrix that inverse dynamics gives column by column."""
    recursion = Recursion(tree)
    mass = np.array([recursion.inverse(column) for column in np.eye(len(tree.q))])
    return np.sqrt(eigh(stiffness(tree), mass, eigvals_only=True)[0])


def test_deflection_and_frequency_converge_to_those_of_the_whole_beam():
    """Euler-Bernoulli: P (2L)^3 / (3 EI) and (root / 2L)^2 sqrt(EI / rho).

    The condensed inner beam bends under the moment of the outer one but for a share of its last
    element: the errors halve with the element.
    """
    deflection = (2 * L) ** 3 / (3 * EI)
    frequency = (ROOT / (2 * L)) ** 2 * np.sqrt(EI / RHO)
    trees = [welded(nodes) for nodes in (8, 16, 32)]
    errors = np.abs([tip_deflection(tree, 1.0) / deflection - 1 for tree in trees])
    assert errors[:-1] / errors[1:] == pytest.approx([2.0, 2.0], rel=0.01)
    assert errors[-1] < 0.004
    errors = np.abs([lowest_frequency(tree) / frequency - 1 for tree in trees])
    assert errors[0] > errors[1] > errors[2]
    assert errors[2] < 0.001


def test_without_the_slope_each_beam_bends_as_if_alone():
    """2 P L^3 / (3 EI): a quarter of the deflection of the whole beam."""
    assert tip_deflection(welded(16, slope=False), 1.0) == pytest.approx(2 * L**3 / (3 * EI), rel=1e-9)


@pytest.mark.long_motion
def test_slope_at_a_free_planar_hinge_only_counts_its_angle_from_another_line():
    """Two-link manipulator of thesis 4.4: the bodies move alike, the angles differ by the slope."""
    tree = deck_tree("two_link_n2", 1e-10)
    tree = replace(tree, time=TimeGrid(0.0, 0.2, 0.02))
    # EI and mass per length of the deck's links, 1 m in two elements.
    C = Beam(1.0, 2, 1000.0, 5.0).nodal_rotation(2)
    turning = replace(tree.hinges[1], elastic_rotation=C)
    plain, carried = run(tree), run(replace(tree, hinges=(tree.hinges[0], turning)))
    assert carried.node_position == pytest.approx(plain.node_position, abs=1e-8)
    slope = plain.q[:, 2:4] @ C[0]
    assert np.max(np.abs(slope)) > 2e-4
    assert plain.q[:, 1] - carried.q[:, 1] == pytest.approx(slope, abs=1e-8)
