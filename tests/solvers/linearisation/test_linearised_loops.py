"""Linearised motion of closed loops against the four-bar's own equation of motion, in one coordinate.

With the kinetic energy I(x) x'²/2 and the potential V(x), I x'' + I' x'²/2 + V' = 0 for the supplied
four-bar, x being the angle between its crank and its coupler.  Its geometry is written down anew here.
"""

import math
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from scipy.optimize import brentq, fsolve

from flexmb_cli.deck.text import read_text
from flexmb_cli.dialects.dafms.build import build_dafms
from flexmb_cli.dialects.recognise import read_deck
from flexmb_cli.model.tree import ROTATION
from flexmb_cli.solvers.linearisation.constrained import linearised, modes_of
from flexmb_cli.solvers.linearisation.equilibrium import find_equilibrium
from flexmb_cli.solvers.linearisation.state_space import matrices
from flexmb_cli.solvers.linearisation.tree import TreeLinearised, start_tree
from flexmb_cli.solvers.linearisation.tree_responses import TreeResponses
from flexmb_cli.solvers.tree.analysis import TreeAnalysis
from tests.naive.random_trees import motored

DECK = Path(__file__).parents[3] / "decks/dafms/fourbar_rigid.DAT"
G, BASE = 9.8, 0.6
# Of crank, coupler and rocker, each from the joint before it: length, mass, centre, inertia about that joint.
BARS = ((0.2, 0.4, 0.1, 0.005333333), (0.6, 0.3, 0.3, 0.036), (0.5, 0.5, 0.25, 0.041666667))
START = (1.5, 1.5 - 0.86704643, 1.5 - 0.86704643 + 2.41734481)


def direction(angle):
    return np.array([math.cos(angle), math.sin(angle)])


def angles(x, near=START):
    """Angles of the three bars from axis 2 towards axis 3, the coupler's being the crank's plus x."""

    def gap(unknown):
        first, last = unknown
        ends = (first, first + x, last)
        return sum(bar[0] * direction(a) for bar, a in zip(BARS, ends, strict=True)) - [0.0, BASE]

    first, last = fsolve(gap, (near[0], near[2]), xtol=1e-14)
    return np.array([first, first + x, last])


def slopes(a):
    """Derivatives of the three angles by x: those of the closed loop."""
    across = [bar[0] * direction(angle + math.pi / 2) for bar, angle in zip(BARS, a, strict=True)]
    first, last = np.linalg.solve(np.column_stack([across[0] + across[1], across[2]]), -across[1])
    return np.array([first, first + 1.0, last])


def energies(x):
    """I(x) and V(x); gravity pulls along axis 2."""
    a, inertia, weight = angles(x), 0.0, 0.0
    root, speed = np.zeros(2), np.zeros(2)
    for (length, mass, centre, about), angle, slope in zip(BARS, a, slopes(a), strict=True):
        moved = speed + slope * centre * direction(angle + math.pi / 2)
        inertia += mass * moved @ moved + (about - mass * centre**2) * slope**2
        weight -= mass * G * (root + centre * direction(angle))[0]
        root = root + length * direction(angle)
        speed = speed + slope * length * direction(angle + math.pi / 2)
    return np.array([inertia, weight])


def slope_of(function, x, h=1e-3):
    return sum(w / h * function(x + k * h) for k, w in ((-2, 1 / 12), (-1, -2 / 3), (1, 2 / 3), (2, -1 / 12)))


def acceleration(x, rate):
    (inertia, _), (bend, push) = energies(x), slope_of(energies, x)
    return -(0.5 * bend * rate * rate + push) / inertia


def analysis():
    tree, _ = build_dafms(read_deck(read_text(str(DECK))))
    found = TreeAnalysis(tree)
    start_tree(found, 0.0)
    return found


def coefficients(motion):
    """x'' by x and x' about the state of a linearised motion."""
    x, rate = motion.z[3 + 1], motion.u[1]
    by_rate = slope_of(lambda value: acceleration(x, value), rate)
    return [slope_of(lambda value: acceleration(value, rate), x), by_rate]


def test_a_moving_four_bar_is_linearised_on_its_loop():
    motion, A, is_constant = linearised(analysis(), TreeLinearised)
    assert [motion.analysis.tree.coordinates[m].name for m in motion.free] == ["body 2 rotation 1"]
    assert A[0] == pytest.approx([0.0, 1.0], abs=1e-9)
    assert A[1] == pytest.approx(coefficients(motion), rel=1e-6)
    assert not is_constant


def test_a_four_bar_settles_at_its_lowest_position():
    found = analysis()
    find_equilibrium(found, TreeLinearised)
    x = brentq(lambda value: slope_of(energies, value)[1], 0.8, 1.1)
    assert found.state[3 + 1] == pytest.approx(x, abs=1e-7)
    modes = modes_of(*linearised(found, TreeLinearised))
    stiffness = slope_of(lambda value: slope_of(energies, value)[1], x)
    expected = math.sqrt(stiffness / energies(x)[0])
    assert modes.frequency * math.tau == pytest.approx([expected], rel=1e-6)
    assert modes.constant


def test_an_input_of_a_loop_acts_through_it():
    """A motor of 1 N m between crank and coupler drives x itself: x'' = 1/I."""
    tree, _ = build_dafms(read_deck(read_text(str(DECK))))
    found = TreeAnalysis(replace(tree, elements=motored(1, ROTATION, 1, (0.0, 0.0))))
    start_tree(found, 0.0)
    motion, _, _ = linearised(found, TreeLinearised)
    B = matrices(TreeResponses(motion))[1]
    assert B[:, 0] == pytest.approx([0.0, 1.0 / energies(motion.z[3 + 1])[0]], rel=1e-8)
