"""What a study asks for and its deck lacks: told at the line of the study, all at once, nothing made."""

import subprocess
import sys
from pathlib import Path

import pytest

DECK = Path(__file__).resolve().parents[2] / "decks/young/IN-RSSR.dat"
STUDY = f"""deck = "{DECK}"

[parameters]
"driver.1.B" = [100.0, 150.0]

[results]
top = "max point.1.z"
spin = "last body.2.omega.x"
"""


@pytest.fixture
def swept(tmp_path):
    """Runs a study with a text exchanged: exit code, standard error, and what lies in the folder then."""

    def run(old, new, *arguments):
        (tmp_path / "study.toml").write_text(STUDY.replace(old, new))
        done = subprocess.run(
            [sys.executable, "-m", "flexmb_cli", "sweep", "study.toml", *arguments],
            cwd=tmp_path, capture_output=True, text=True,
        )  # fmt: skip
        return done.returncode, done.stderr, sorted(path.name for path in tmp_path.iterdir())

    return run


def test_unknown_quantities_are_told_at_their_lines(swept):
    code, told, left = swept("max point.1.z", "max point.1.q")
    assert (code, left) == (2, ["study.toml"])
    assert told.startswith("study.toml:7:1: error: result top: point.1.q: the result has no such quantity")
    assert '    top = "max point.1.q"\n    ^^^' in told


def test_all_of_them_are_told_at_once(swept):
    _, told, _ = swept("point.1.z", 'point.9.z"\nnone = "last elephant')
    assert [line.partition(" error")[0] for line in told.splitlines() if "error" in line] == [
        "study.toml:7:1:",
        "study.toml:8:1:",
    ]


def test_an_unknown_parameter_is_told_at_its_line(swept):
    code, told, left = swept("driver.1.B", "driver.9.B")
    assert (code, left) == (2, ["study.toml"])
    assert told.startswith("study.toml:4:2: error: the deck has no number 'driver.9.B'; the nearest are")


def test_a_table_in_a_missing_folder_is_refused_and_none_is_made(swept):
    code, told, left = swept("", "", "-o", "none/table.h5")
    assert (code, left) == (2, ["study.toml"])
    assert told == "flexmb: error: none/table.h5: cannot be written: its folder does not exist\n"
