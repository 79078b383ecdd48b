"""Forces and moments through the hinges of trees: closed forms, and Lagrange multipliers."""

import h5py
import numpy as np
import pytest

from flexmb_cli.model.mechanism import TimeGrid
from flexmb_cli.model.tree import INERTIAL, ROTATION, Body, Hinge, Tree
from flexmb_cli.results.quantities.quantity_names import families
from flexmb_cli.solvers.constrained.tree import AbsoluteTree
from flexmb_cli.solvers.tree.analysis import TreeAnalysis
from tests.dialects.dafms.test_dafms_elements import CASES, deck
from tests.naive.random_trees import random_tree, sprung
from tests.run.dafms_runs import run as run_deck

START = TimeGrid(0.0, 0.0, 0.1)


class Multipliers(AbsoluteTree):
    """Keeps the wrenches of the equations."""

    def block(self, report):
        self.wrenches = report.wrenches.copy()
        return super().block(report)


def reactions_by_multipliers(tree):
    """Force and moment about O_k of the equations of each hinge on its body (N, 3), global axes."""
    analysis = Multipliers(tree)
    rows = next(analysis.rows())
    axes = analysis.arrays.q[: 7 * len(tree.bodies)].reshape(-1, 7)[:, 3:]
    found = np.zeros((2, len(tree.bodies), 3))
    for group, wrench in zip(analysis.arrays.groups, analysis.wrenches[0], strict=True):
        k = group["body_j"]
        if 0 <= k < len(tree.bodies):
            e0, e = axes[k, 0], axes[k, 1:]
            turned = wrench[1, 3:] + 2 * np.cross(e, e0 * wrench[1, 3:] + np.cross(e, wrench[1, 3:]))
            found[:, k] += wrench[1, :3], turned
    return rows, *found


@pytest.mark.parametrize("seed", range(5))
def test_reactions_are_those_of_lagrange_multipliers(seed):
    """Rigid and flexible bodies on nodes and points, at speed, under loads; no effort along a coordinate."""
    tree = random_tree(seed, bodies=4, time=START, springs=())
    rows = next(TreeAnalysis(tree).rows())
    _, force, moment = reactions_by_multipliers(tree)
    assert np.abs(force).max() > 1.0
    assert rows.hinge_force[0] == pytest.approx(force, abs=1e-9 * np.abs(force).max())
    assert rows.hinge_torque[0] == pytest.approx(moment, abs=1e-9 * np.abs(moment).max())


def test_a_spring_and_a_weld_bear_the_weight_and_what_turns():
    """m (a - g) at the centre, and its moment; about the free axis the torque of the spring alone."""
    inertia, c, g = np.diag([0.3, 0.4, 0.9]), np.array([0.3, 0.1, 0.0]), np.array([0.0, -9.81, 0.0])
    bodies = (Body("arm", 2.0, inertia, tuple(c)), Body("tip", 0.5, inertia / 10, (0.2, 0.0, 0.0)))
    hinges = (Hinge(INERTIAL, rotations=(3,)), Hinge(0, (0.6, 0.0, 0.0)))
    springs = sprung((0, ROTATION, 3, 40.0, 0.0, 0.5))
    tree = Tree(bodies, hinges, np.zeros(1), np.array([3.0]), START, tuple(g), elements=springs)
    rows = next(TreeAnalysis(tree).rows())
    alpha, w = rows.y_rate[0, 0], 3.0
    tip = np.array([0.8, 0.0, 0.0])
    needed = [m * (alpha * np.array([-r[1], r[0], 0]) - w * w * r - g) for m, r in ((2.0, c), (0.5, tip))]
    assert rows.hinge_force[0] == pytest.approx(np.array([needed[0] + needed[1], needed[1]]), rel=1e-12)
    assert rows.hinge_torque[0, 0] == pytest.approx([0.0, 0.0, 20.0], abs=1e-12)
    moment = np.cross([0.2, 0.0, 0.0], needed[1])[2] + (0.09 - 0.5 * 0.04) * alpha
    assert rows.hinge_torque[0, 1, 2] == pytest.approx(moment, rel=1e-12)


def test_reactions_have_names_and_units_in_results(tmp_path):
    (tmp_path / "x.DAT").write_text(deck(CASES["friction"][1]))
    assert run_deck(tmp_path / "x.DAT", tmp_path).exit_code == 0
    with h5py.File(tmp_path / "x.h5") as result:
        named = {
            family.name((1, 0)): family.unit((1, 0)) for family in families(result) if len(family.shape) == 2
        }
        assert result["hinge/force"].shape == (6, 2, 3)
    assert (named["hinge.2.force.x"], named["hinge.2.torque.x"]) == ("N", "N m")
