"""`convert`, `export`, `table`, `plot` and `report` print one JSON object: faults, and what was written."""

import json
import os
import sys
from pathlib import Path

import pytest

from flexmb_cli import cli as package
from flexmb_cli.cli import main
from flexmb_cli.interface import read_deck, solve

DECKS = Path(__file__).resolve().parents[2] / "decks"
FOUR_BAR = str(DECKS / "young" / "IN4-BAR.dat")
RIGID = str(DECKS / "dafms" / "spatial_rigid.DAT")


@pytest.fixture
def flexmb(monkeypatch, capsys, tmp_path):
    """Run the program here with --json: exit code, the object, and standard error."""
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr(package.signal, "signal", lambda number, action: None)
    monkeypatch.setattr(package.os, "environ", dict(os.environ))

    def run(*arguments):
        monkeypatch.setattr(sys, "argv", ["flexmb", *arguments, "--json"])
        code = 0
        try:
            main()
        except SystemExit as ended:
            code = ended.code or 0
        printed, reported = capsys.readouterr()
        return code, json.loads(printed), reported

    return run


@pytest.fixture
def result(tmp_path):
    """A result of three rows whose deck was changed by --set."""
    path = tmp_path / "four-bar.h5"
    deck = read_deck(FOUR_BAR, {"time.end": 0.02, "time.step": 0.01})
    solve(deck).save(path)
    return str(path)


def test_convert_names_the_file_that_it_wrote(flexmb):
    code, record, _ = flexmb("convert", RIGID, "--to", "mjcf", "-o", "new.xml")
    assert code == 0
    assert record == {
        "deck": RIGID, "status": "complete", "exit_code": 0, "faults": [], "file": "new.xml",
    }  # fmt: skip


def test_convert_shows_the_warnings_about_the_deck_with_their_places(flexmb):
    quaternion = "       0.0       0.0       0.0       1.0"
    text = Path(RIGID).read_text().replace(quaternion, quaternion.replace("1.0", "2.0"))
    Path("long.DAT").write_text(text)
    code, record, reported = flexmb("convert", "long.DAT", "--to", "mjcf", "-o", "new.xml")
    assert (code, [(fault["id"], fault["line"]) for fault in record["faults"]]) == (
        0, [("DAFMS-040", 30), ("DAFMS-040", 32)],
    )  # fmt: skip
    assert "long.DAT:30:13: warning: EULT of body 2: the Euler parameters have length 2" in reported


def test_what_convert_refuses_has_identifier_place_and_deck(flexmb):
    code, record, reported = flexmb("convert", FOUR_BAR, "--to", "mjcf")
    (fault,) = record["faults"]
    assert (code, record["deck"], record["status"], record["exit_code"]) == (2, FOUR_BAR, "bad input", 2)
    assert (fault["id"], fault["severity"], fault["file"]) == ("YOUNG-150", "error", FOUR_BAR)
    assert fault["message"] in reported


@pytest.mark.parametrize("command", [["export", "--to", "csv"], ["table"], ["plot"], ["report"]])
def test_a_result_that_is_missing_has_an_identifier(flexmb, command):
    code, record, _ = flexmb(command[0], "none.h5", *command[1:])
    (fault,) = record["faults"]
    assert (code, record["result"], record["exit_code"]) == (2, "none.h5", 2)
    assert (fault["id"], fault["message"], fault["file"]) == ("RESULT-015", "no such file", "none.h5")


def test_export_names_the_file_that_it_wrote(flexmb, result):
    code, record, _ = flexmb("export", result, "--to", "csv", "-o", "new.csv")
    assert (code, record["status"], record["file"], record["faults"]) == (0, "complete", "new.csv", [])
    assert Path("new.csv").read_text().startswith("time [s],")


def test_a_table_has_its_rows_in_the_object(flexmb, result):
    code, record, _ = flexmb("table", result, "body.1.x")
    assert (code, record["status"], record["faults"]) == (0, "complete", [])
    assert [row["time [s]"] for row in record["rows"]] == [0.0, 0.01, 0.02]


def test_notes_of_a_table_are_faults_with_identifiers_and_words(flexmb, result):
    code, record, reported = flexmb("table", result, "body.1.x", "--from", "9")
    (note,) = record["faults"]
    assert (code, record["rows"]) == (0, [])
    assert (note["id"], note["severity"], note["file"]) == ("RESULT-080", "note", result)
    assert f"{result}: note: {note['message']}" in reported
    _, record, _ = flexmb("table", result, "--list")
    assert [note["id"] for note in record["faults"]] == ["RESULT-079"]
    assert "time" in [row["name"] for row in record["rows"]]


@pytest.mark.parametrize(
    "command", [["table", "--format", "csv", "time"], ["table", "--as-table", "1", "time"]]
)
def test_a_table_has_one_form_in_the_object(flexmb, result, command):
    code, record, _ = flexmb(command[0], result, *command[1:])
    assert (code, record["status"]) == (2, "bad input")
    assert "--json has rows of its own" in record["faults"][0]["message"]


@pytest.mark.parametrize(
    "command", [["convert", RIGID, "--to", "mjcf"], ["export", "{}", "--to", "csv"], ["report", "{}"]]
)
def test_the_object_shares_standard_output_with_nothing(flexmb, result, command):
    code, record, _ = flexmb(*(word.format(result) for word in command), "-o", "-")
    assert (code, record["status"]) == (2, "bad input")
    assert "both take standard output" in record["faults"][0]["message"]


def test_a_page_is_named_with_the_result(flexmb, result):
    code, record, _ = flexmb("report", result, "-o", "page.html")
    assert (code, record["result"], record["file"], record["faults"]) == (0, result, "page.html", [])
