"""One assembler for all searches: what it returns, on equations whose solutions are known by hand."""

import math

import numpy as np
import pytest

from flexmb_cli.solvers.assembly import NUDGE, assemble, is_closed, nudged
from flexmb_cli.solvers.projection import Corrections, Instant, project
from tests.solvers.test_projection import NO_ANGLES, Sphere

SHORTEST = Corrections(met=1e-14, most=60, dependent=1e-9)


def test_a_start_without_a_direction_is_left_by_a_nudge():
    """At the centre of a sphere the gradient vanishes: no correction leads away from it."""
    sphere, tried = Sphere(), []

    def search(start):
        tried.append(start)
        yield project(Instant(sphere, 0.0, NO_ANGLES), start, SHORTEST)

    q, gap = assemble(nudged(sphere, np.zeros(3), np.array([1.0, 1.0, 0.0]), 4), search)
    assert is_closed(gap)
    assert q @ q == pytest.approx(1.0, abs=1e-14)
    assert len(tried) == 2
    assert not tried[0].any()
    assert 0.0 < np.abs(tried[1]).max() <= NUDGE
    assert tried[1][2] == q[2] == 0.0


def gaps(*sizes):
    return [(np.array([float(k)]), np.array([size])) for k, size in enumerate(sizes)]


@pytest.mark.parametrize(
    ("sizes", "better", "place"),
    [
        ((0.4, 0.3, 0.1), 1.0, 2),
        ((0.4, 0.3, 0.25), 0.5, 0),
        ((0.4, -0.1, 0.3), 0.5, 1),
        ((0.4, 1e-10, 0.0), 1.0, 1),
        ((math.nan, 0.2), 1.0, 1),
    ],
)
def test_the_first_closed_position_is_taken_and_else_the_best(sizes, better, place):
    assert assemble([None], lambda _: gaps(*sizes), better)[0] == place


def test_nothing_is_sought_behind_a_closed_position():
    def search(start):
        yield from gaps(0.0)
        raise AssertionError("sought on")

    assert assemble([1, 2], search)[0] == 0.0
