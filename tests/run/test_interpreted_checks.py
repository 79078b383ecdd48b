"""Whoever builds a system decides whether its kernels are compiled, not what the process did before."""

from pathlib import Path

import pytest

from flexmb_cli import check, solve
from flexmb_cli.kernels import _jit, _objects

DECKS = Path(__file__).resolve().parents[2] / "decks"

pytestmark = pytest.mark.skipif(_jit.interpreted(), reason="nothing is compiled")


@pytest.fixture
def compiled_calls(monkeypatch):
    """The arguments of all calls of compiled code."""
    calls, call = [], _objects.Compiled.call

    def counted(self, values):
        calls.append(values)
        return call(self, values)

    monkeypatch.setattr(_objects.Compiled, "call", counted)
    return calls


@pytest.mark.parametrize("deck", ["young/IN4-BAR.dat", "dafms/pendulum.DAT"])
def test_a_check_is_interpreted_and_a_run_in_the_same_process_is_not(deck, compiled_calls):
    for _ in ("first", "after a run"):
        compiled_calls.clear()
        assert check(DECKS / deck).outcome.exit_code == 0
        assert not compiled_calls
        solve(DECKS / deck)
        assert compiled_calls


def test_a_failing_block_leaves_nothing_behind():
    with pytest.raises(KeyError), _jit.interpreting():
        assert _jit.interpreted()
        raise KeyError
    assert not _jit.interpreted()
