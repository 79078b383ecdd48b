"""Whole turns of hinges of trees in absolute coordinates, which rows far apart do not show."""

from pathlib import Path

import numpy as np
import pytest

import flexmb_cli
from flexmb_cli.model.mechanism import TimeGrid
from flexmb_cli.model.tree import Body, Hinge, Tree
from flexmb_cli.solvers.constrained.tree import AbsoluteTree

TURNING_ARM = Path(__file__).parent / "turns.DAT"
SPRING = "ELEMENTS\n  SPRING hspr-1 at=1.r3 stiffness=1e-15\n"


def test_hinge_with_a_spring_counts_the_turns_of_the_deck_without_it(tmp_path):
    """25 rad in five rows: the deck without the spring is solved by Kane's equations, whose states are the
    coordinates; np.unwrap of the rows gave -6.417 rad."""
    deck = TURNING_ARM.read_text()
    (tmp_path / "free.DAT").write_text(deck.replace(SPRING, ""))
    free = flexmb_cli.solve(tmp_path / "free.DAT")
    rows = flexmb_cli.solve(TURNING_ARM)
    assert rows["coordinate/q"][-1, 0] == pytest.approx(24.9993, abs=1e-3)
    assert rows["coordinate/q"] == pytest.approx(free["coordinate/q"], abs=1e-9)
    assert rows["element/coordinate"][:, 0] == pytest.approx(free["coordinate/q"][:, 0], abs=1e-9)


@pytest.mark.parametrize("rotations", [(3,), (1, 3), (3, 2)])
def test_turns_between_rows_are_those_of_a_constant_speed(rotations):
    """A balanced body turns about axis 3 alone: q = 20 rad + 40 rad/s t, rows 0.5 s apart."""
    own = [float(axis == 3) for axis in sorted(rotations)]
    tree = Tree(
        (Body("rotor", 1.0, np.diag([1.0, 1.0, 2.0])),),
        (Hinge(-1, rotations=tuple(sorted(rotations))),),
        20.0 * np.array(own),
        40.0 * np.array(own),
        TimeGrid(0.0, 2.0, 0.5),
        gravity=(0.0, 0.0, 0.0),
    )
    blocks = list(AbsoluteTree(tree).rows())
    q, t = (np.concatenate([getattr(block, name) for block in blocks]) for name in ("q", "time"))
    assert q == pytest.approx(np.outer(20.0 + 40.0 * t, own), abs=1e-7)
