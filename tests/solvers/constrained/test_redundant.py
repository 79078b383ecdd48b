"""Linkages with more equations than they need: the motion is one and the same whichever are in charge."""

import sys
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

sys.path.insert(0, str(Path(__file__).parents[3] / "scripts/bench"))
from four_bars import deck_of

from flexmb_cli.deck.text import decode, read_text
from flexmb_cli.dialects.recognise import read_deck
from flexmb_cli.dialects.young.build_dynamics import build_young_dynamics
from flexmb_cli.errors import AnalysisError
from flexmb_cli.model.mechanism import TimeGrid
from flexmb_cli.solvers.constrained.young_dynamics import ForwardDynamics
from tests.solvers.constrained.body_balances import worst_balance
from tests.solvers.constrained.dynamic_runs import DECKS, joined


@pytest.fixture(scope="module")
def bricard():
    deck = read_deck(read_text(str(DECKS / "dynamics/IN-BRICARD.dat")))
    model = build_young_dynamics(deck)[0]
    return replace(model, mechanism=replace(model.mechanism, time=TimeGrid(0.0, 0.4, 0.1)))


@pytest.fixture(scope="module")
def analysis(bricard):
    found = ForwardDynamics(bricard)
    return found, joined(list(found.rows()))


def test_bricards_linkage_falls_and_keeps_its_energy(analysis):
    _, rows = analysis
    assert rows.kinetic[-1] > 1.0
    assert rows.total == pytest.approx(np.full(5, rows.total[0]), abs=1e-7)
    assert rows.constraint_residual.max() < 1e-12


def test_the_one_repeated_equation_is_told(analysis):
    found, _ = analysis
    assert [fault.message.split(",")[0] for fault in found.warnings] == ["1 equation repeats others"]


def test_reactions_of_least_norm_move_every_body_as_newton_and_euler_ask(bricard, analysis):
    assert worst_balance(bricard, analysis[1]) < 1e-10


def test_reactions_balance_a_planar_loop_whose_three_equations_repeat_others():
    """The four-bar of the IFToMM library (A08) with parallel revolute joints; gravity across its plane."""
    text = deck_of(1, "DOP853", 1e-8, 0.02).replace("GRAVITY 0 -9.81 0", "GRAVITY 0 -9.81 3")
    model = build_young_dynamics(read_deck(decode("IN.dat", text.encode())))[0]
    found = ForwardDynamics(model)
    rows = joined(list(found.rows()))
    assert "3 of 27 equations repeat others" in found.warnings[0].message
    assert worst_balance(model, rows) < 1e-10


def test_the_motion_does_not_depend_on_the_order_of_the_joints(bricard, analysis):
    joints = tuple(reversed(bricard.mechanism.joints))
    model = replace(bricard, mechanism=replace(bricard.mechanism, joints=joints))
    rows = joined(list(ForwardDynamics(model).rows()))
    assert rows.position == pytest.approx(analysis[1].position, abs=1e-7)
    assert rows.reaction_force[:, ::-1] == pytest.approx(analysis[1].reaction_force, abs=1e-4)


def test_a_linkage_whose_bars_do_not_fit_is_refused(bricard):
    """A sixth joint 5 mm off leaves no way to close the loop."""
    *others, last = bricard.mechanism.joints
    moved = replace(last, P_j=tuple(np.add(last.P_j, (0.005, 0.0, 0.0))))
    model = replace(bricard, mechanism=replace(bricard.mechanism, joints=(*others, moved)))
    with pytest.raises(AnalysisError, match="cannot be assembled"):
        next(ForwardDynamics(model).rows())
