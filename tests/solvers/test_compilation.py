"""What a run says of compiled kernels that it cannot use."""

import importlib
from pathlib import Path

import pytest

from flexmb_cli.kernels import _entry, _jit, _library
from flexmb_cli.run.outcome import Listener, RunOptions
from flexmb_cli.run.solution import run_deck
from flexmb_cli.solvers import compilation

DECK = Path(__file__).resolve().parents[2] / "decks" / "young" / "IN1-1-1.dat"


@pytest.mark.skipif(_jit.interpreted(), reason="nothing is compiled")
def test_a_run_tells_of_a_damaged_object_once(tmp_path, monkeypatch):
    """Before the run that it concerns; a second run of the same process is silent."""
    path = tmp_path / _library.library_name(_library.target())
    path.write_bytes(b"no library")
    _library.packaged.cache_clear()
    for module, name, value in (
        (_library, "PACKAGED", tmp_path),
        (_library, "unusable", []),
        (_entry, "_loaded", {}),
        (compilation, "_shown", set()),
        (compilation, "_reported", set()),
    ):
        monkeypatch.setattr(module, name, value)
    notices = []
    for kernel in vars(importlib.import_module("flexmb_cli.kernels.kinematics.continuation")).values():
        if isinstance(kernel, _entry.Entry):
            monkeypatch.setattr(kernel, "_compiled", [])
    for _ in range(2):
        outcome = run_deck(str(DECK), RunOptions(folder=str(tmp_path)), Listener(notice=notices.append))
        assert outcome.exit_code == 0
    _library.packaged.cache_clear()
    (notice,) = notices
    assert notice.sentence.startswith(f"{path} cannot be loaded (")
    assert notice.sentence.endswith("): kernels are compiled; reinstall flexmb")


def test_damage_that_is_found_on_the_way_is_told_at_the_end(tmp_path, monkeypatch):
    """Kernels of a second unit are loaded where a run first calls one."""
    monkeypatch.setattr(_library, "unusable", [])
    monkeypatch.setattr(compilation, "_shown", set())
    notices = []
    listener = Listener(begin=lambda rows: _library.unusable.append("one file"), notice=notices.append)
    run_deck(str(DECK), RunOptions(folder=str(tmp_path)), listener)
    assert [(notice.severity, notice.sentence) for notice in notices] == [("warning", "one file")]
