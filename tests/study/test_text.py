"""The table of a study on a narrow terminal: blocks of whole columns."""

import sys

import pytest

from flexmb_cli.cli.table import table
from flexmb_cli.study.text import fitting_heads, open_study, study_columns, study_text
from tests.cli.terminal.test_terminal import at_a_terminal
from tests.study.test_study_figures import GRID, called, study


def blocks(path, width):
    with open_study(path) as file:
        columns = study_columns(file)
        groups = fitting_heads(columns, width)
        return groups, ["".join(study_text(file, columns, 1, "text", group)).splitlines() for group in groups]


@pytest.mark.parametrize("width", [10, 30, 45, 60, 200])
def test_blocks_hold_every_number_once_and_fit(width, tmp_path):
    """Case, two parameters, path.1 to path.3, top, exit code, rows and message, by heads written out here."""
    groups, texts = blocks(study(tmp_path / "s.h5", GRID), width)
    assert [group[0] for group in groups] == [0] * len(groups)
    assert [k for group in groups for k in group[1:]] == list(range(1, 10))
    for group, lines in zip(groups, texts, strict=True):
        assert len(lines) == 1 + len(GRID)
        assert [line.split()[0] for line in lines] == ["case", *map(str, range(1, 1 + len(GRID)))]
        assert len(group) == 2 or max(map(len, lines)) <= width
    assert len(groups) == {10: 9, 200: 2}.get(width, len(groups))
    whole = [line for lines in texts for line in lines if "path.3" in line]
    assert len(whole) == 1


@pytest.mark.processes
@pytest.mark.skipif(sys.platform == "win32", reason="pseudo-terminals are Unix's")
def test_the_table_of_a_study_at_a_terminal_fits_and_in_a_pipe_is_whole(tmp_path, monkeypatch):
    path = study(tmp_path / "s.h5", GRID)
    monkeypatch.setenv("COLUMNS", "40")
    lines = at_a_terminal("table", "s.h5", "-f", "text", cwd=tmp_path).splitlines()
    assert max(map(len, lines)) <= 40
    assert not any("…" in line for line in lines)
    heads = [word for line in lines if "case" in line for word in line.split() if "." in word]
    assert heads == ["parameter.length", "parameter.rate", "result.top"]
    piped = called(table, path, "-f", "text").stdout.splitlines()
    assert len(piped) == 1 + len(GRID)
    assert piped[1].split() == ["1", "0.1", "1", "2", "0"]  # top = 10 · 0.1 + 1
