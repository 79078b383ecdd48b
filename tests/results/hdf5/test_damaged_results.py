"""A result that somebody's program cut: every command that reads it ends with 2 and names the place."""

import sys

import h5py
import pytest

from flexmb_cli.cli import main
from tests.results.results import write_result

COMMANDS = (
    ["table", "{path}", "energy.total"],
    ["plot", "{path}", "energy.total", "-o", "made.png"],
    ["report", "{path}", "-o", "made.html"],
    ["export", "{path}", "--to", "vtkhdf", "-o", "made.vtkhdf"],
    ["export", "{path}", "--to", "mat", "-o", "made.mat"],
    ["export", "{path}", "--to", "csv", "-o", "made.csv"],
)


@pytest.fixture
def short(tmp_path, monkeypatch):
    """A result of 40 rows whose total energy has 7."""
    monkeypatch.chdir(tmp_path)
    path = write_result(tmp_path / "r.h5", 40)
    with h5py.File(path, "a") as file:
        file["energy/total"].resize(7, axis=0)
    return path


@pytest.mark.parametrize("command", COMMANDS, ids=lambda c: " ".join([c[0], *c[2:4]]))
def test_a_short_series_is_told_with_its_file_and_nothing_is_written(short, command, monkeypatch, capsys):
    monkeypatch.setattr(sys, "argv", ["flexmb", *(word.format(path=short) for word in command)])
    with pytest.raises(SystemExit) as ended:
        main()
    assert ended.value.code == 2
    reported = "r.h5: error: a damaged result: /energy/total has 7 rows and /time 40; run the deck again"
    assert reported in capsys.readouterr().err
    assert not list(short.parent.glob("made*"))


@pytest.mark.parametrize("command", [*COMMANDS[:1], ["diff", "{path}", "{path}"]], ids=lambda c: c[0])
def test_a_result_of_a_later_layout_is_refused_and_not_read_by_guess(tmp_path, monkeypatch, capsys, command):
    path = write_result(tmp_path / "r.h5", 4)
    with h5py.File(path, "a") as file:
        file.attrs["Conventions"], file.attrs["flexmb_version"] = "flexmb-3", "0.9.0"
    monkeypatch.setattr(sys, "argv", ["flexmb", *(word.format(path=path) for word in command)])
    with pytest.raises(SystemExit) as ended:
        main()
    assert ended.value.code == 2
    reported = "written by flexmb 0.9.0 in the layout flexmb-3; this flexmb reads layouts up to 2"
    assert reported in capsys.readouterr().err
