"""What a run says of compiled kernels that it cannot use."""

from pathlib import Path

import pytest

from flexmb_cli.kernels import _cache, _entry, _jit, _objects
from flexmb_cli.run.deck import run_deck
from flexmb_cli.run.outcome import Listener, RunOptions
from flexmb_cli.solvers import compilation

DECK = Path(__file__).resolve().parents[2] / "decks" / "young" / "IN1-1-1.dat"


@pytest.mark.skipif(_jit.interpreted(), reason="nothing is compiled")
def test_a_run_tells_of_a_damaged_object_once(tmp_path, monkeypatch):
    """Before the run that it concerns; a second run of the same process is silent."""
    path = tmp_path / str(_objects.target()) / f"kinematics{_cache.ENDING}"
    path.parent.mkdir()
    path.write_bytes(b"no object")
    for module, name, value in (
        (_objects, "PACKAGED", tmp_path),
        (_entry, "_loaded", set()),
        (_entry, "damaged", []),
        (compilation, "_shown", set()),
        (compilation, "_reported", set()),
    ):
        monkeypatch.setattr(module, name, value)
    notices = []
    for _ in range(2):
        outcome = run_deck(str(DECK), RunOptions(folder=str(tmp_path)), Listener(notice=notices.append))
        assert outcome.exit_code == 0
    sentence = "kernels are compiled in its place; install flexmb anew"
    assert [notice.sentence for notice in notices] == [f"{path} is damaged: {sentence}"]


def test_damage_that_is_found_on_the_way_is_told_at_the_end(tmp_path, monkeypatch):
    """Kernels of a second unit are loaded where a run first calls one."""
    monkeypatch.setattr(_entry, "damaged", [])
    monkeypatch.setattr(compilation, "_shown", set())
    notices = []
    listener = Listener(begin=lambda rows: _entry.damaged.append("one file"), notice=notices.append)
    run_deck(str(DECK), RunOptions(folder=str(tmp_path)), listener)
    assert [(notice.severity, notice.sentence) for notice in notices] == [("warning", "one file")]
