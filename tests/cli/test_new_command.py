"""`flexmb new` at a terminal (a pseudo-terminal of the standard library) and through pipes."""

import re
import subprocess
import sys
from pathlib import Path

import pytest

from flexmb_cli.deck.text import read_text
from flexmb_cli.dialects.recognise import read_deck

pytestmark = pytest.mark.processes
TOP = Path(__file__).resolve().parents[2]
FOUR_BAR = TOP / "decks" / "young" / "IN4-BAR.dat"
NEW = [sys.executable, "-m", "flexmb_cli", "new"]


def answers():
    """A title, and the four-bar's records a line each."""
    text = re.sub(r"\{[^}]*\}", "", FOUR_BAR.read_text(encoding="utf-8"))
    return ["four-bar", *(line for line in text.splitlines() if line.strip())]


def piped(*arguments, lines, cwd, dialect="young"):
    text = "".join(f"{line}\n" for line in lines)
    return subprocess.run(
        [*NEW, dialect, *arguments], cwd=cwd, input=text, capture_output=True, text=True, timeout=120
    )


def numbers_of(path):
    return [(name, number.value) for name, number in read_deck(read_text(path)).numbers()]


def test_a_pipe_of_answers_gives_a_deck_that_check_accepts(tmp_path):
    done = piped("-o", "-", lines=answers(), cwd=tmp_path)
    assert (done.returncode, done.stderr) == (0, "")
    assert done.stdout.startswith("{ four-bar }\n")
    assert list(tmp_path.iterdir()) == []
    check = [sys.executable, "-m", "flexmb_cli", "check", "-"]
    checked = subprocess.run(check, input=done.stdout, capture_output=True, text=True, timeout=120)
    assert (checked.returncode, checked.stderr) == (0, "")


def test_shapes_are_asked_for_behind_the_time_and_become_cards(tmp_path):
    """In a pipe they may be left out: the other tests end with the line of the time."""
    lines = [*answers(), "2", "2 3 0.25 12.2 0.2", *4 * [""], "0 6 1 2 3 0 0 -3 0 0 0.5"]
    done = piped(lines=lines, cwd=tmp_path)
    assert done.returncode == 2
    assert "shape 2: shape must be within 1..5, box, cylinder, tube, cone, sphere" in done.stderr
    lines[-1:] = ["0 1 1 2 3", "0 0 -3 0 0 0.5"]
    assert piped(lines=lines, cwd=tmp_path).returncode == 0
    text = (tmp_path / "IN-NEW.dat").read_text()
    assert text.endswith("GEOMETRY\nGEOM 2 3 0.25 12.2 0.2 0 0 0 0 0 0\nGEOM 0 1 1 2 3 0 0 -3 0 0 0.5\nEND\n")
    (tmp_path / "plain.dat").write_text(text[: text.index("GEOMETRY")])
    assert numbers_of(tmp_path / "plain.dat") == numbers_of(FOUR_BAR)


def test_a_title_in_another_character_code_does_not_end_the_dialogue(tmp_path):
    text = "\n".join(["Gef\xfchrt", *answers()[1:], ""]).encode("latin-1")
    done = subprocess.run([*NEW, "young"], cwd=tmp_path, input=text, capture_output=True, timeout=120)
    assert done.returncode == 0
    assert (tmp_path / "IN-NEW.dat").read_text(encoding="utf-8").startswith("{ Gef\ufffdhrt }\n")


def test_a_wrong_answer_in_a_pipe_is_shown_where_it_stands_and_leaves_nothing(tmp_path):
    lines = [line.replace("1 2 0 0 2 0 6.10", "1 9 0 0 2 0 6.10") for line in answers()]
    done = piped(lines=lines, cwd=tmp_path)
    assert done.returncode == 2
    assert done.stderr.splitlines()[:3] == [
        "-:10:3: error: universal joint 1: body number 9 is outside 1..4",
        "    1 9 0 0 2 0 6.10 0 0.75 -0.66 2 0 6.1 1",
        "      ^",
    ]
    assert list(tmp_path.iterdir()) == []


def test_answers_that_end_early_leave_nothing_and_the_next_pipe_begins_anew(tmp_path):
    done = piped(lines=answers()[:4], cwd=tmp_path)
    assert done.returncode == 1
    assert "the answers end before the deck is complete; no deck is written, and no draft kept" in done.stderr
    assert piped(lines=answers(), cwd=tmp_path).returncode == 0
    assert [path.name for path in tmp_path.iterdir()] == ["IN-NEW.dat"]
    assert numbers_of(tmp_path / "IN-NEW.dat") == numbers_of(FOUR_BAR)


def test_a_pipe_leaves_the_draft_of_a_terminal_alone_and_says_so(tmp_path):
    assert piped("--draft", lines=answers()[:4], cwd=tmp_path).returncode == 1
    kept = (tmp_path / "IN-NEW.dat.draft").read_bytes()
    done = piped(lines=answers(), cwd=tmp_path)
    assert done.returncode == 0
    assert (
        "IN-NEW.dat.draft: note: the draft of an earlier call is left alone: answers through a pipe"
        in done.stderr
    )
    assert (tmp_path / "IN-NEW.dat.draft").read_bytes() == kept
    assert numbers_of(tmp_path / "IN-NEW.dat") == numbers_of(FOUR_BAR)


def test_a_pipe_goes_on_with_a_draft_where_it_is_asked_to(tmp_path):
    assert piped("--draft", lines=answers()[:4], cwd=tmp_path).returncode == 1
    done = piped("--draft", lines=answers()[4:], cwd=tmp_path)
    assert done.returncode == 0
    assert [path.name for path in tmp_path.iterdir()] == ["IN-NEW.dat"]
    assert numbers_of(tmp_path / "IN-NEW.dat") == numbers_of(FOUR_BAR)


def test_what_a_killed_call_left_of_the_deck_that_is_tried_is_removed_by_the_next(tmp_path):
    kill = (
        "import os; from flexmb_cli.run.check import check; check.check_deck = lambda *_, **__: os._exit(9)"
    )
    killed = [sys.executable, "-c", f"{kill}; from flexmb_cli.cli import main; main()", *NEW[3:], "young"]
    typed, output = "".join(f"{line}\n" for line in answers()), ["-o", "IN-NEW.dat"]
    done = subprocess.run([*killed, *output], input=typed, cwd=tmp_path, text=True, capture_output=True)
    assert done.returncode == 9, done.stderr
    assert len(list(tmp_path.glob(".flexmb-*.tmp"))) == 1
    assert piped(lines=answers(), cwd=tmp_path).returncode == 0
    assert [path.name for path in tmp_path.iterdir()] == ["IN-NEW.dat"]


def test_a_deck_is_replaced_by_a_pipe_only_with_force(tmp_path):
    (tmp_path / "IN-NEW.dat").write_text("mine\n")
    done = piped(lines=answers(), cwd=tmp_path)
    assert done.returncode == 2
    assert "IN-NEW.dat is there already; --force replaces it" in done.stderr
    assert (tmp_path / "IN-NEW.dat").read_text() == "mine\n"
    assert piped("--force", lines=answers(), cwd=tmp_path).returncode == 0
    assert numbers_of(tmp_path / "IN-NEW.dat") == numbers_of(FOUR_BAR)


def test_what_is_no_draft_is_refused_and_left_alone(tmp_path):
    (tmp_path / "IN-NEW.dat.draft").write_text("my own notes\n")
    done = piped("--draft", lines=answers(), cwd=tmp_path)
    assert done.returncode == 2
    assert "IN-NEW.dat.draft: error: this is not a draft of a deck" in done.stderr
    assert (tmp_path / "IN-NEW.dat.draft").read_text() == "my own notes\n"


@pytest.mark.parametrize(
    "place, reason", [("none/IN.dat", "its folder does not exist"), ("IN.dat/", "it is a folder")]
)
def test_a_place_that_cannot_be_written_is_told_before_the_first_question(place, reason, tmp_path):
    done = piped("-o", place, lines=answers()[:1], cwd=tmp_path)
    assert done.returncode == 2
    assert f"{place}: cannot be written: {reason}" in done.stderr
    assert list(tmp_path.iterdir()) == []
