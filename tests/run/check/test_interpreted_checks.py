"""Whoever builds a system decides whether its kernels are compiled, not what the process did before."""

from pathlib import Path

import pytest

from flexmb_cli import check, solve
from flexmb_cli.kernels import _jit, _library

DECKS = Path(__file__).resolve().parents[3] / "decks"

pytestmark = pytest.mark.skipif(_jit.interpreted(), reason="nothing is compiled")


@pytest.fixture
def compiled_calls(monkeypatch):
    """The arguments of all calls of compiled code."""
    calls, call = [], _library.Compiled.call

    def counted(self, values):
        calls.append(values)
        return call(self, values)

    monkeypatch.setattr(_library.Compiled, "call", counted)
    return calls


@pytest.mark.parametrize("deck", ["young/IN4-BAR.dat", "dafms/pendulum.DAT"])
def test_a_check_is_interpreted_and_a_run_in_the_same_process_is_not(deck, compiled_calls):
    for _ in ("first", "after a run"):
        compiled_calls.clear()
        assert check(DECKS / deck).outcome.exit_code == 0
        assert not compiled_calls
        solve(DECKS / deck)
        assert compiled_calls


@pytest.mark.parametrize("analysis", ["inverse", "forward"])
def test_a_check_of_hundreds_of_elements_is_compiled(analysis, compiled_calls, tmp_path):
    """Interpreted kernels took 3 ms a bushing: an hour for the 62 MB that a deck may have."""
    deck = (DECKS / "young/dynamics/IN4-BAR-MASS.dat").read_text()
    head = deck[: deck.upper().rindex("END")].replace("DYNAMICS inverse", f"DYNAMICS {analysis}")
    path = tmp_path / "springs.dat"
    path.write_text(
        head
        + "ELEMENTS\n"
        + "".join(f"  SPRING s{k} from=1(0,0,0) to=2(1,0,0) stiffness=10 rest=1\n" for k in range(400))
        + "END\n"
    )
    assert check(path).outcome.exit_code == 0
    assert compiled_calls


def test_a_failing_block_leaves_nothing_behind():
    with pytest.raises(KeyError), _jit.interpreting():
        assert _jit.interpreted()
        raise KeyError
    assert not _jit.interpreted()
