"""Closed loops over time: assembly, drift, energy, and the same motion from other equations."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from flexmb_cli.errors import AnalysisError, ModelError
from flexmb_cli.model.mechanism import TimeGrid
from flexmb_cli.solvers.tree import steps
from flexmb_cli.solvers.tree.analysis import TreeAnalysis
from tests.solvers.tree.tree_runs import deck_tree, joined, run

LOOPS = ("fourbar_rigid", "fourbar_flex", "slider_crank_flex")


@pytest.mark.long_motion
@pytest.mark.parametrize("deck", LOOPS)
def test_loops_stay_closed_and_the_energy_constant(deck):
    rows = run(deck_tree(deck, 1e-9))
    assert np.max(rows.constraint_residual) < 2e-13
    assert np.max(rows.velocity_residual) < 1e-13
    assert np.ptp(rows.total) < 1e-7 * np.ptp(rows.kinetic)


GROUND = (0.0, 0.6)


class FourBar:
    """Deck fourbar_rigid in its crank angle alone: 2 T = m(q) y², potential V(q).

    Crank 0.2 m, coupler 0.6 m, rocker 0.5 m on the second ground pivot (0, 0.6); links lie along
    axis 2 at angle 0, gravity 9.8 along +axis 2.  Points are pairs (axis 2, axis 3).
    """

    def __init__(self, tree):
        self.J = [body.inertia[0, 0] for body in tree.bodies]
        self.mass = [body.mass for body in tree.bodies]
        self.centre = [body.centre[1] for body in tree.bodies]

    def slope(self, t, z):
        """d/dt of angle and speed: m y' = -m' y²/2 - V', derivatives by a complex step."""
        m, V = self.inertia_and_potential(z[0] + 1e-30j)
        return [z[1], -(0.5 * m.imag * z[1] ** 2 + V.imag) * 1e30 / m.real]

    def inertia_and_potential(self, angle):
        B, C = joints(angle)
        a, b = (C[0] - B[0], C[1] - B[1]), (C[0] - GROUND[0], C[1] - GROUND[1])
        vB = -B[1], B[0]
        # vB + w2 (-a1, a0) = w3 (-b1, b0)
        det = a[0] * b[1] - a[1] * b[0]
        w2, w3 = -(vB[0] * b[0] + vB[1] * b[1]) / det, -(vB[0] * a[0] + vB[1] * a[1]) / det
        u, d = (a[0] / 0.6, a[1] / 0.6), (-b[0] / 0.5, -b[1] / 0.5)
        m = self.J[0] + self.twice_energy(1, vB, w2, u) + self.twice_energy(2, (-w3 * b[1], w3 * b[0]), w3, d)
        heights = np.cos(angle) * self.centre[0], B[0] + self.centre[1] * u[0], C[0] + self.centre[2] * d[0]
        return m, -9.8 * sum(mass * x for mass, x in zip(self.mass, heights, strict=True))

    def twice_energy(self, k, v, w, u):
        """2 T of a link with the velocity v of its origin, spin w and direction u."""
        static = self.mass[k] * self.centre[k] * (v[1] * u[0] - v[0] * u[1])
        return self.mass[k] * (v[0] ** 2 + v[1] ** 2) + self.J[k] * w**2 + 2 * static * w


def joints(angle):
    """Ends of crank and coupler, on the deck's side of the line from the crank to the ground pivot."""
    B = 0.2 * np.cos(angle), 0.2 * np.sin(angle)
    dx, dy = GROUND[0] - B[0], GROUND[1] - B[1]
    square = dx * dx + dy * dy
    along = (square + 0.6**2 - 0.5**2) / (2 * square)
    across = np.sqrt(0.6**2 / square - along**2)
    return B, (B[0] + along * dx + across * dy, B[1] + along * dy - across * dx)


@pytest.mark.long_motion
def test_four_bar_moves_as_the_equation_of_its_crank_angle_says():
    tree = deck_tree("fourbar_rigid", 1e-11)
    rows = run(tree)
    exact = solve_ivp(
        FourBar(tree).slope,
        (0, rows.time[-1]),
        [rows.q[0, 0], rows.y[0, 0]],
        method="DOP853",
        t_eval=rows.time,
        rtol=1e-11,
        atol=1e-11,
    ).y
    assert np.max(np.abs(rows.q[:, 0] - exact[0])) <= 1e-7


@pytest.mark.long_motion
def test_assembly_keeps_crank_and_deflections_and_closes_the_loop():
    tree = deck_tree("fourbar_flex")
    off = replace(tree, q=tree.q + np.array([0, 0.2, -0.1, 0, 0, 0, 0]), time=TimeGrid(0.0, 0.01, 0.01))
    rows = run(off)
    assert rows.q[0, [0, 3, 4, 5, 6]] == pytest.approx(tree.q[[0, 3, 4, 5, 6]], abs=1e-14)
    assert rows.q[0] == pytest.approx(tree.q, abs=1e-7)  # the deck gives nine digits
    assert rows.y[0] == pytest.approx(tree.y, abs=1e-6)


@pytest.mark.parametrize("seed", range(6))
def test_a_four_bar_far_from_closed_closes_on_the_side_of_its_coordinates(seed):
    """Coupler and rocker off by up to 0.8 rad; the coordinates of the deck close, to nine digits.

    The other way to close mirrors coupler and rocker at the line from the crank to the pivot.
    """
    tree = deck_tree("fourbar_rigid")
    off = np.random.default_rng(seed).uniform(-0.8, 0.8, 3) * [0.0, 1.0, 1.0]
    moved = replace(tree, q=tree.q + off, time=TimeGrid(0.0, 0.01, 0.01))
    assert run(moved).q[0] == pytest.approx(tree.q, abs=1e-7)


@pytest.mark.long_motion
def test_planar_loop_closed_in_three_directions_drops_the_one_that_cannot_open():
    tree = deck_tree("fourbar_rigid")
    closure = replace(tree.closures[0], directions=(1, 2, 3))
    three, two = run(replace(tree, closures=(closure,))), run(tree)
    assert np.max(np.abs(three.q - two.q)) < 1e-7
    assert np.max(np.abs(three.closure_force[:, 0, 0])) == 0.0


def test_loop_that_cannot_be_closed_is_named_with_the_gap_that_stays():
    """A ground pivot 3 m away: crank, coupler and rocker reach 1.3 m."""
    tree = deck_tree("fourbar_rigid")
    far = replace(tree.closures[0], b_point=(0.0, 0.0, 3.0))
    with pytest.raises(AnalysisError, match=r"cannot be closed: the two points stay \d") as caught:
        run(replace(tree, closures=(far,)))
    assert caught.value.faults[0].subject == tree.closures[0].name


def test_one_way_model_with_a_loop_is_refused():
    with pytest.raises(ModelError, match="UNCO"):
        run(replace(deck_tree("fourbar_flex"), one_way=True))


@pytest.mark.long_motion
def test_resumed_run_of_a_loop_gives_the_numbers_of_an_uninterrupted_one(monkeypatch):
    tree = replace(deck_tree("slider_crank_flex", 1e-8), time=TimeGrid(0.0, 0.3, 0.005))
    whole = run(tree)
    monkeypatch.setattr(steps, "LARGEST_BLOCK", 17)
    stopped = TreeAnalysis(tree)
    rows = stopped.rows()
    first = [next(rows), next(rows)]
    again = joined(first + list(TreeAnalysis(tree, stopped.checkpoint).rows()))
    assert np.array_equal(again.q, whole.q)
    assert np.array_equal(again.closure_force, whole.closure_force)
