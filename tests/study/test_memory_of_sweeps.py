"""What cases leave after is given back: a sweep in one process does not grow with its cases."""

import gc

import pytest

from flexmb_cli.__main__ import OBJECTS_UNTIL_COLLECTED
from flexmb_cli.study.sweep import Sweep
from flexmb_cli.study.workers import solve_here
from tests.study.studies import SAMPLED, written


@pytest.fixture
def collector_of_the_command():
    before = gc.get_threshold()
    gc.set_threshold(OBJECTS_UNTIL_COLLECTED)
    yield
    gc.set_threshold(*before)


def test_cases_leave_no_cycles_to_the_next_block(tmp_path, collector_of_the_command):
    """Garbage is none of the objects that stay: thirty cases leave as many as ten (17 kB each before)."""
    sweep = Sweep.of(str(written(tmp_path, SAMPLED, count=30)), str(tmp_path / "parts"))
    counts = []
    for blocks in (range(10), range(10, 30)):
        solve_here(sweep, blocks, lambda cases: None)
        counts.append(len(gc.get_objects()))
    sweep.lock.leave()
    assert counts[1] - counts[0] < 20 * 10
