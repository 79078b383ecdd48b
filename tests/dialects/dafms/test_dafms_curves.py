"""Points on curves in trees and VSDF decks: both formulations, implicit too, an arm of a YOUNG deck."""

from dataclasses import fields, replace

import numpy as np
import pytest

from flexmb_cli.solvers.constrained.tree import AbsoluteTree
from flexmb_cli.solvers.constrained.tree_element_rows import TreeElementRows
from flexmb_cli.solvers.tree.analysis import TreeAnalysis
from tests.dialects.dafms.dafms_decks import build
from tests.dialects.dafms.test_dafms_elements import MASSES, TWO_LINKS
from tests.dialects.vsdf.test_elements import TWO_LINKS as VSDF_ARM
from tests.dialects.vsdf.test_elements import rows_of as vsdf_rows
from tests.solvers.constrained.element_decks import ARM
from tests.solvers.constrained.element_decks import rows_of as young_rows

# A point beside the second link on a bent rail, down which the arm slides.
RAIL = (
    "ELEMENTS\n  FUNCTION x polynomial 1.3 -0.3 0.2\n  FUNCTION y polynomial 0.2 -1 -0.3\n"
    "  CURVE rail from=0(0,0,0) to={}(0.3,0.2,0) x=x y=y begin=-0.2 end=2\n"
)


def rows_of(analysis):
    blocks = list(analysis.rows())
    return {
        f.name: np.concatenate([getattr(b, f.name) for b in blocks])
        for f in fields(TreeElementRows)
        if f.name not in ("displacement", "node_position")
    }


@pytest.fixture(scope="module")
def tree():
    model = TWO_LINKS.replace("    5\n       0.1\n", "    9\n      0.05\n")
    return build(f"{model}{RAIL.format(2)}END \n")[0]


def test_a_tree_on_a_rail_moves_alike_in_both_formulations_and_in_a_young_deck(tree):
    kane, absolute = rows_of(TreeAnalysis(tree)), rows_of(AbsoluteTree(tree))
    other = young_rows(ARM, "0 0.45 0.05", MASSES + RAIL.format(3))
    count = len(kane["time"])
    assert np.ptp(kane["curve_position"]) > 0.3
    for name in ("curve_position", "curve_speed", "curve_force"):
        assert absolute[name] == pytest.approx(kane[name], abs=1e-8)
        assert getattr(other, name)[:count] == pytest.approx(kane[name], abs=1e-6)
    assert other.position[:count, 1:] == pytest.approx(kane["position"], abs=1e-8)
    total = kane["kinetic"] + kane["potential"]
    assert total == pytest.approx(np.full(count, total[0]), abs=1e-9)
    assert kane["constraint_residual"].max() < 1e-13


def test_the_implicit_method_follows_a_rail(tree):
    kane = rows_of(TreeAnalysis(tree))
    stiff = replace(tree, integration=replace(tree.integration, method="sdirk4", rtol=1e-8, atol=1e-9))
    found = rows_of(TreeAnalysis(stiff))
    for name in ("curve_position", "curve_speed"):
        assert found[name] == pytest.approx(kane[name], abs=1e-6)


ON_RAIL = VSDF_ARM.replace(" 2,3,0.6,0,0\n", " 2,3,0.6,0,0\n 2,4,0.3,0.2,0\n")


def test_an_arm_of_a_vsdf_deck_on_a_rail_moves_as_the_same_arm_in_a_young_deck():
    rail = RAIL.format(2).replace("to=2(0.3,0.2,0)", "to=2:4")
    found = vsdf_rows(ON_RAIL, 0.4, 0.05, rail)
    other = young_rows(ARM, "0 0.4 0.05", MASSES + RAIL.format(3))
    assert found.position[:, :2] == pytest.approx(other.position[:, 1:], abs=1e-7)
    for name in ("curve_position", "curve_speed", "curve_force"):
        assert getattr(found, name) == pytest.approx(getattr(other, name), abs=1e-6), name
