"""Chains of RSSR stages, dense and sparse, against the closed form stage by stage (rssr.py)."""

from dataclasses import replace

import numpy as np
import pytest

from flexmb_cli.deck.text import decode
from flexmb_cli.dialects.recognise import read_deck
from flexmb_cli.dialects.young.build import build_young
from flexmb_cli.model.mechanism import TimeGrid
from flexmb_cli.solvers.kinematics import position, state
from flexmb_cli.solvers.kinematics.analysis import KinematicAnalysis
from flexmb_cli.solvers.kinematics.position import KinematicSettings
from tests.solvers.kinematics.geometry import Gaps
from tests.solvers.kinematics.rssr import carried
from tests.solvers.kinematics.rssr_chain import chain, deck_text, rod_ends, stage
from tests.solvers.kinematics.solved import coordinates, solved, until_failure

DENSE, SPARSE = 32, 34  # stages; 679 and 721 equations


def largest_difference(found, expected):
    return float(np.max(np.abs(found - expected)) / np.max(np.abs(expected)))


@pytest.mark.long_motion
@pytest.mark.parametrize("stages", [1, 2, DENSE, SPARSE, 60])
def test_rod_ends_of_every_stage_are_those_of_the_closed_form(stages):
    """To 1e-12 of the largest value: round-off, which a serial chain passes on from stage to stage."""
    rows = solved(chain(stages))
    expected = rod_ends(stages, rows.time)
    found = rows.point_position, rows.point_velocity, rows.point_acceleration
    for series, values in zip(found, expected, strict=True):
        assert largest_difference(series, values) <= 1e-12


@pytest.mark.long_motion
@pytest.mark.parametrize("stages", [DENSE, SPARSE])
def test_constraints_and_their_rates_are_met_on_both_sides_of_the_dense_limit(stages):
    mechanism = chain(stages)
    rows, gaps = solved(mechanism), Gaps(mechanism)
    assert gaps.largest(coordinates(rows), rows.time) <= 1e-12
    assert gaps.largest_rate(coordinates(rows), coordinates(rows, 1), rows.time) <= 1e-12


def test_the_test_chains_lie_on_both_sides_of_the_dense_limit():
    is_large = [KinematicAnalysis(chain(stages)).evaluator.is_large for stages in (DENSE, SPARSE)]
    assert is_large == [False, True]


@pytest.mark.parametrize("derivative", [0, 1, 2])
def test_dense_and_sparse_factors_give_the_same_motion(derivative, monkeypatch):
    """The same chain by both paths, its steps of one second divided on the way."""
    mechanism = chain(4, TimeGrid(0.0, 4.0, 1.0))
    dense = solved(mechanism)
    monkeypatch.setattr(position, "DENSE_LIMIT", 10)
    monkeypatch.setattr(state, "DENSE_ELIMINATION", 10)
    sparse = solved(mechanism)
    assert largest_difference(coordinates(sparse, derivative), coordinates(dense, derivative)) <= 1e-12
    assert np.all(sparse.newton_iterations == dense.newton_iterations)


def test_a_tolerance_ends_newton_as_early_with_sparse_factors_as_with_dense_ones(monkeypatch):
    """Newton's error squares at each iteration: 1e-4 is met one iteration before round-off, at least once."""
    mechanism, early = chain(2, TimeGrid(0.0, 2.0, 1.0)), KinematicSettings(tolerance=1e-4)
    exact, dense = (iterations(mechanism, settings) for settings in (KinematicSettings(), early))
    monkeypatch.setattr(position, "DENSE_LIMIT", 10)
    monkeypatch.setattr(state, "DENSE_ELIMINATION", 10)
    assert iterations(mechanism, early) == dense < exact


def iterations(mechanism, settings):
    return sum(int(rows.newton_iterations.sum()) for rows in KinematicAnalysis(mechanism, settings).rows())


@pytest.mark.long_motion
@pytest.mark.parametrize("limit", [10, 10_000])
def test_a_chain_that_locks_says_so_and_keeps_the_rows_before(limit, monkeypatch):
    """Turned the other way a forward stage locks at a crank angle of 0.535 rad, at t = 0.85 s.

    Beyond it |k| > R in the closed form, and the arc cosine is not defined.
    """
    monkeypatch.setattr(position, "DENSE_LIMIT", limit)
    monkeypatch.setattr(state, "DENSE_ELIMINATION", limit)
    mechanism = chain(6)
    backward = replace(mechanism.drivers[0], B=0.8, A=-0.4)
    rows, failure = until_failure(replace(mechanism, drivers=(backward,)))
    assert failure.time == 1.0
    assert failure.norms["gap"] > 1e-4
    assert rows.time.tolist() == [0.0, 0.25, 0.5, 0.75]
    early = closed_form_ends(rows.time)
    assert largest_difference(rows.point_position[:, :4], early) <= 1e-13


def closed_form_ends(t):
    """Rod ends of the first two stages turned the other way: the closed form for the mirrored time law."""
    crank = 0.8 * t - 0.2 * t * t
    rocker = stage(0).rocker(crank, 0.0 * t, 0.0 * t)[0]
    last = stage(1).rocker(rocker, 0.0 * t, 0.0 * t)[0]
    still = 0.0 * t, 0.0 * t
    ends = []
    for s, angles in ((stage(0), (crank, rocker)), (stage(1), (rocker, last))):
        ends.append(carried(s.O_in, s.u_in, s.A, angles[0], *still)[0])
        ends.append(carried(s.O_out, s.u_out, s.B, angles[1], *still)[0])
    return np.stack(ends, axis=1)


def test_the_deck_of_a_chain_describes_the_same_mechanism():
    """The text goes through reader and builder; the numbers of a double survive seventeen digits."""
    mechanism = chain(3)
    read, warnings = build_young(read_deck(decode("chain.dat", deck_text(mechanism).encode())))
    assert warnings == []
    assert largest_difference(solved(read).point_position, solved(mechanism).point_position) <= 1e-14
