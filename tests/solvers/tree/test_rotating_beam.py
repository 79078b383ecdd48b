"""Geometric stiffening of rotating beams, against Ritz solutions of the differential equation."""

from dataclasses import replace

import numpy as np
import pytest
from numpy.polynomial import Polynomial
from scipy.linalg import eigh

from flexmb_cli.dialects.dafms.beam import Beam
from flexmb_cli.model.geometric_stiffness import geometric_stiffness
from flexmb_cli.model.mechanism import TimeGrid
from flexmb_cli.model.tree import INERTIAL, ROTATION, Body, Elasticity, Hinge, Integration, Prescribed, Tree
from tests.kernels.tree.test_kane_forward_dynamics import Recursion
from tests.solvers.tree.tree_runs import run

pytestmark = pytest.mark.long_motion

L, EI, RHO = 2.0, 3.0, 0.4
UNIT = np.sqrt(EI / RHO) / L**2  # frequency with which the dimensionless ones count, rad/s
FLAPWISE, CHORDWISE = 3, 1  # axis of the spin; deflections go along axis 3


def rotating(nodes, spin_axis, stiffened=True, hub=0.0, gravity=(0.0, 0.0, 0.0)):
    """A cantilever along axis 2, clamped `hub` from O_k, on a hinge about one axis."""
    beam = Beam(L, nodes, EI, RHO, offset=hub)
    positions = np.zeros((nodes, 3))
    positions[:, 1] = beam.positions
    elastic = Elasticity(
        positions,
        beam.masses,
        (3,),
        beam.stiffness,
        np.zeros((nodes, 3)),
        stiffened_from=hub if stiffened else None,
    )
    body = Body("beam", beam.mass, np.diag([beam.inertia, 1e-2, beam.inertia]), elastic=elastic)
    start = np.zeros(nodes + 1)
    return Tree(
        (body,), (Hinge(INERTIAL, rotations=(spin_axis,)),), start, start, TimeGrid(0.0, 1.0, 0.1), gravity
    )


def squared_frequency(tree, spin):
    """Lowest eigenvalue of -u''/u while the hinge turns with `spin`, from the tree's accelerations."""
    n = len(tree.q)
    columns = []
    for column in np.eye(n)[1:]:
        recursion = Recursion(replace(tree, q=1e-6 * column, y=spin * np.eye(n)[0]))
        recursion.coordinates["held"][0] = 1
        columns.append(-1e6 * recursion.forward()[1:])
    return np.min(np.linalg.eigvals(np.array(columns).T).real)


def ritz(eta, hub=0.0, terms=10):
    """Lowest flapwise w² of w'''' - eta² (((1 - x²)/2 + hub (1 - x)) w')' = w² w on a clamped unit beam."""
    x = Polynomial([0, 1])
    shapes = [x ** (k + 2) for k in range(terms)]
    pull = eta**2 * ((1 - x**2) / 2 + hub * (1 - x))

    def over_beam(a, b):
        return (a * b).integ()(1.0)

    K = [
        [over_beam(a.deriv(2), b.deriv(2)) + over_beam(pull * a.deriv(), b.deriv()) for b in shapes]
        for a in shapes
    ]
    M = [[over_beam(a, b) for b in shapes] for a in shapes]
    return eigh(K, M, eigvals_only=True)[0]


def test_first_mode_of_a_cantilever_gains_1193_of_the_squared_spin():
    """phi' KG phi / w² = 1.193 for unit modal mass: first mode without hub (Southwell's coefficient)."""
    beam = Beam(L, 60, EI, RHO)
    positions = np.zeros((60, 3))
    positions[:, 1] = beam.positions
    KG = geometric_stiffness(positions, 0.0, beam.masses * beam.positions)
    _, shapes = eigh(beam.stiffness, np.diag(beam.masses))
    assert shapes[:, 0] @ KG @ shapes[:, 0] == pytest.approx(1.193, abs=0.001)


@pytest.mark.parametrize("eta", [1.0, 4.0, 8.0])
@pytest.mark.parametrize("hub", [0.0, 1.0])
def test_flapwise_frequency_is_that_of_the_differential_equation(eta, hub):
    """40 nodal masses are good to 1e-3."""
    found = squared_frequency(rotating(40, FLAPWISE, hub=hub * L), eta * UNIT)
    assert found / UNIT**2 == pytest.approx(ritz(eta, hub), rel=2e-3)


def test_ritz_solution_agrees_with_the_cantilever_at_rest():
    """First root of 1 + cos x cosh x = 0: w = 3.51602."""
    assert np.sqrt(ritz(0.0)) == pytest.approx(3.51602, abs=1e-5)


def test_chordwise_the_square_of_the_spin_goes_off_the_flapwise_one():
    """w_c² = w_f² - w²; without stiffening w_0² - w², here negative: the beam diverges."""
    eta = 5.0
    found = squared_frequency(rotating(40, CHORDWISE), eta * UNIT)
    assert found / UNIT**2 == pytest.approx(ritz(eta) - eta**2, rel=5e-3)
    soft = squared_frequency(rotating(40, CHORDWISE, stiffened=False), eta * UNIT)
    assert soft / UNIT**2 == pytest.approx(ritz(0.0) - eta**2, rel=5e-3)


def test_hanging_beam_is_stiffened_by_its_weight_and_a_standing_one_softened():
    """Energy of the weight in the first mode: pull m g (1 - x)."""
    g = 0.2
    hanging = squared_frequency(rotating(40, FLAPWISE, gravity=(0.0, g, 0.0)), 0.0)
    standing = squared_frequency(rotating(40, FLAPWISE, gravity=(0.0, -g, 0.0)), 0.0)
    x = Polynomial([0, 1])
    shapes = [x ** (k + 2) for k in range(10)]
    M = [[(a * b).integ()(1.0) for b in shapes] for a in shapes]
    K = [[(a.deriv(2) * b.deriv(2)).integ()(1.0) for b in shapes] for a in shapes]
    G = np.array([[((1 - x) * a.deriv() * b.deriv()).integ()(1.0) for b in shapes] for a in shapes])
    load = g * RHO * L**3 / EI
    for found, sign in ((hanging, 1), (standing, -1)):
        exact = eigh(np.array(K) + sign * load * G, M, eigvals_only=True)[0]
        assert found / UNIT**2 == pytest.approx(exact, rel=2e-3)


def spun_up(stiffened):
    """Rows while the spin rises to twice the first frequency within eight seconds."""
    tree = rotating(6, CHORDWISE, stiffened)
    spin = 2.0 * 3.516 * UNIT
    return run(
        replace(
            tree,
            time=TimeGrid(0.0, 8.0, 0.1),
            prescribed=(Prescribed(0, ROTATION, CHORDWISE, 0.0, 0.0, spin / 8.0),),
            integration=Integration("dop853", 1e-7, 1e-7),
        )
    )


def test_beam_that_spins_up_bends_back_with_stiffening_and_runs_away_without():
    stiff, soft = spun_up(True), spun_up(False)
    assert np.max(np.abs(stiff.q[:, -1])) < 0.5 * L
    assert np.max(np.abs(soft.q[:, -1])) > 5 * L
    # The work of the stiffening is counted.
    assert np.ptp(stiff.total) <= 1e-5 * np.max(stiff.kinetic)


def test_what_hangs_on_the_tip_pulls_with_its_mass():
    """A tip mass as a body of its own, welded to the last node, stiffens as the same mass in the beam."""
    alone = rotating(8, FLAPWISE)
    elastic = alone.bodies[0].elastic
    heavier = elastic.masses + 0.3 * np.eye(8)[-1]
    tip = Body("tip", 0.3, 1e-12 * np.eye(3))
    welded = replace(
        alone, bodies=(*alone.bodies, tip), hinges=(*alone.hinges, Hinge(0, (0.0, L, 0.0), node=7))
    )
    body = replace(alone.bodies[0], mass=alone.bodies[0].mass + 0.3, elastic=replace(elastic, masses=heavier))
    one = replace(alone, bodies=(body,))
    assert squared_frequency(welded, 4.0) == pytest.approx(squared_frequency(one, 4.0), rel=1e-6)
