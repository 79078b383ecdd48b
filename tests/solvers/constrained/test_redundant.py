"""Linkages with more equations than they need: the motion is one and the same whichever are in charge."""

from dataclasses import replace

import numpy as np
import pytest

from flexmb_cli.deck.text import read_text
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
