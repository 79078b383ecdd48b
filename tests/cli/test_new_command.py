"""`flexmb new` at a terminal (a pseudo-terminal of the standard library) and through pipes."""

import json
import os
import pty
import re
import select
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest
from click.testing import CliRunner

from flexmb_cli.cli import cli
from flexmb_cli.deck.text import read_text
from flexmb_cli.dialects.dafms.deck_writer import ADDED
from flexmb_cli.dialects.recognise import read_deck
from flexmb_cli.dialects.vsdf.build import build_vsdf
from flexmb_cli.dialects.vsdf.cards import CARDS
from flexmb_cli.dialects.vsdf.elements.cards import ELEMENT_CARDS
from flexmb_cli.run.check.check import CheckReport
from flexmb_cli.run.outcome import Outcome

pytestmark = pytest.mark.processes

# Cards that the dialogue does not count, and those that it counts at the end.
LATER = ("FEMN", "RIGI", "GRAV", "TIME", "INTG", "GEOM", "GSTL", *(card.word for card in ELEMENT_CARDS))
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


class Terminal:
    """A process at a pseudo-terminal, of which all that it prints is kept."""

    def __init__(self, *arguments, cwd):
        self.text = ""
        self.pid, self.descriptor = pty.fork()
        if self.pid == 0:  # the child: nothing of the test may run on here
            try:
                os.chdir(cwd)
                signal.signal(signal.SIGINT, signal.SIG_DFL)
                os.environ["TERM"] = "dumb"  # no escape sequences between what is compared
                os.execv(NEW[0], [*NEW, *arguments])
            finally:
                os._exit(127)

    def expect(self, words, seconds=60):
        """Read on until `words` appear behind what was expected before."""
        end = time.monotonic() + seconds
        while words not in self.text:
            ready, _, _ = select.select([self.descriptor], [], [], max(0.0, end - time.monotonic()))
            assert ready, f"no {words!r} in {self.text!r}"
            try:
                read = os.read(self.descriptor, 4096)
            except OSError:  # Linux tells the end of a terminal so
                read = b""
            assert read, f"the end without {words!r} in {self.text!r}"
            self.text += read.decode()
        self.text = self.text.partition(words)[2]

    def type(self, text):
        os.write(self.descriptor, text.encode())

    def say(self, prompt, line):
        """Answer the question that holds `prompt`."""
        self.expect(prompt)
        self.expect("> ")
        self.type(f"{line}\n")

    def exit_code(self):
        code = os.waitstatus_to_exitcode(os.waitpid(self.pid, 0)[1])
        os.close(self.descriptor)
        return code


def test_a_dialogue_at_a_terminal_with_a_slip_help_and_a_way_back(tmp_path):
    terminal = Terminal("young", "-o", "IN-T.dat", cwd=tmp_path)
    title, counts, *bodies = answers()
    terminal.say("text: one line on the mechanism", title)
    terminal.say("NBODY: number of bodies", "vier")
    terminal.expect("error: counts: NBODY must be an integer; read 'vier'")
    terminal.say("NBODY: number of bodies", counts)
    terminal.expect("body 1")
    terminal.say("x y z: estimate of x, y, z", "?")
    terminal.expect("z: estimate of z of the body's origin at the start, m; a number; Enter gives 0")
    terminal.say("x y z: estimate of x, y, z", "9 9 9")
    terminal.say("e0 e1 e2 e3:", "<")
    terminal.expect("[9 9 9] > ")
    terminal.type(f"{bodies[0]}\n")
    for line, subject in zip(bodies[1:], ["body 2", "body 3", "body 4", "driver 1"], strict=False):
        terminal.expect(subject)
        terminal.say(": ", line)
    for line, subject in zip(
        bodies[5:],
        ["point of interest 1", "spherical joint 1", "universal joint 1", "revolute joint 1"]
        + ["revolute joint 2", "ground 1", "time"],
        strict=True,
    ):
        terminal.expect(subject)
        terminal.say(": ", line)
    terminal.say("GEOM: number of shapes", "")
    terminal.expect("IN-T.dat: written")
    assert terminal.exit_code() == 0
    assert numbers_of(tmp_path / "IN-T.dat") == numbers_of(FOUR_BAR)
    assert [path.name for path in tmp_path.iterdir()] == ["IN-T.dat"]


ENDINGS = [("\x03", 130, "interrupted"), ("\x04", 1, "end of input"), ("!\n", 1, "stopped")]


@pytest.mark.parametrize(("key", "code", "why"), ENDINGS)
def test_ctrl_c_ctrl_d_and_a_mark_keep_a_draft_and_the_next_call_goes_on(tmp_path, key, code, why):
    terminal = Terminal("young", cwd=tmp_path)
    title, counts, body, *rest = answers()
    terminal.say("text", title)
    terminal.say("NBODY", counts)
    terminal.say("x y z", body)
    terminal.expect("body 2")
    terminal.expect("> ")
    # Python's readline waits for the next key after a signal that comes between prompt and select(): no hand
    # is as fast as this.
    time.sleep(0.5)
    terminal.type(key)
    terminal.expect(f"flexmb: {why}; no deck is written, the answers so far are in IN-NEW.dat.draft")
    assert terminal.exit_code() == code
    assert len(json.loads((tmp_path / "IN-NEW.dat.draft").read_text())["answers"]) == 1 + 12 + 7
    done = piped("--draft", lines=rest, cwd=tmp_path)
    assert done.returncode == 0
    assert "going on with 20 answers" in done.stderr
    assert numbers_of(tmp_path / "IN-NEW.dat") == numbers_of(FOUR_BAR)


def test_what_cannot_be_assembled_is_asked_for_again(tmp_path):
    terminal = Terminal("young", cwd=tmp_path)
    lines = answers()
    far = "2 3 0 -600.10 0 0 -3.70 0"  # a coupler of 600 m between links of some metres
    wrong = [far if line.startswith("2 3 0 -6.10") else line for line in lines]
    for line in [*wrong, ""]:
        terminal.say(": ", line)
    terminal.expect("error: ")
    terminal.expect("joint 1\r\n")
    terminal.expect("> ")
    terminal.type("< spherical.1\n")
    terminal.expect("spherical joint 1\r\n")
    terminal.expect("> ")
    terminal.type(next(line for line in lines if line.startswith("2 3 0 -6.10")) + "\n")
    terminal.expect("universal joint 1")
    terminal.expect("> ")
    terminal.type(">\n")
    terminal.expect("IN-NEW.dat: written")
    assert terminal.exit_code() == 0
    assert numbers_of(tmp_path / "IN-NEW.dat") == numbers_of(FOUR_BAR)


def test_a_deck_at_a_terminal_is_replaced_only_when_asked(tmp_path):
    (tmp_path / "IN-NEW.dat").write_text("mine\n")
    terminal = Terminal("young", cwd=tmp_path)
    terminal.expect("IN-NEW.dat is there already; replace it? [y/N]")
    terminal.type("\n")
    assert terminal.exit_code() == 2
    assert (tmp_path / "IN-NEW.dat").read_text() == "mine\n"


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
    assert "IN-NEW.dat.draft: error: this is no draft of a deck" in done.stderr
    assert (tmp_path / "IN-NEW.dat.draft").read_text() == "my own notes\n"


@pytest.mark.parametrize(
    "place, reason", [("none/IN.dat", "its folder does not exist"), ("IN.dat/", "it is a folder")]
)
def test_a_place_that_cannot_be_written_is_told_before_the_first_question(place, reason, tmp_path):
    done = piped("-o", place, lines=answers()[:1], cwd=tmp_path)
    assert done.returncode == 2
    assert f"{place}: cannot be written: {reason}" in done.stderr
    assert list(tmp_path.iterdir()) == []


def test_a_vsdf_deck_finds_its_files_beside_itself(tmp_path, monkeypatch):
    """What is checked must stand where the deck will: the node table is named relative to it.

    Only the model is built here, which reads the node table; motion is the business of tests/dialects/vsdf.
    """
    looked_at = []

    def build_only(path, options):
        deck = read_deck(read_text(path), options.dialect)
        looked_at.append(build_vsdf(deck, Path(path).parent)[0])
        return CheckReport(Outcome(path, source=deck.source), deck)

    monkeypatch.setattr("flexmb_cli.run.check.check.check_deck", build_only)
    (tmp_path / "fe").symlink_to(TOP / "decks" / "vsdf" / "fe")
    counts = " ".join(
        "1" if card.word in ("BODY", "FEMM", "FEMK") else "0" for card in CARDS if card.word not in LATER
    )
    files = ["TXT fe/pendulum_nodes.txt", "1 MM fe/pendulum_M.mtx", "1 MM fe/pendulum_K.mtx"]
    lines = ["rod", counts, "FLEX 9 1 13 9", *files, "0 0 -9.81", "1 0.1 0", "", "", ""]
    done = CliRunner().invoke(
        cli, ["new", "vsdf", "-o", str(tmp_path / "rod.vsdf")], input="".join(f"{line}\n" for line in lines)
    )
    assert (done.exit_code, len(looked_at)) == (0, 1), done.output
    assert sorted(path.name for path in tmp_path.iterdir()) == ["fe", "rod.vsdf"]
    assert (tmp_path / "rod.vsdf").read_text().startswith("VSDF rod\n")


def test_a_flexible_vsdf_deck_through_a_pipe_passes_the_real_check(tmp_path):
    """The supplied pendulum of 9 modes; its numbers are those of decks/vsdf/pendulum.vsdf."""
    (tmp_path / "fe").symlink_to(TOP / "decks" / "vsdf" / "fe")
    once = ("BODY", "FEMM", "FEMK", "JOIN", "OUTN")
    counts = " ".join("1" if card.word in once else "0" for card in CARDS if card.word not in LATER)
    lines = ["rod", counts, "FLEX 9 1 13 9", "TXT fe/pendulum_nodes.txt", "1 MM fe/pendulum_M.mtx"]
    lines += ["1 MM fe/pendulum_K.mtx", "REVO 0 0 0 1 1 5", "", "", "", "1 51"]
    lines += ["0 0 -9.81", "0.5 5e-4 5e-5", "GALF 0.9", ""]
    done = piped("-o", "rod.vsdf", lines=lines, cwd=tmp_path, dialect="vsdf")
    assert (done.returncode, done.stderr) == (
        0,
        "rod.vsdf: written; flexmb check rod.vsdf accepts it\n",
    )
    supplied = dict(numbers_of(TOP / "decks" / "vsdf" / "pendulum.vsdf"))
    asked = dict(numbers_of(tmp_path / "rod.vsdf"))
    assert {name: asked[name] for name in supplied if name != "title.title"} == {
        name: value for name, value in supplied.items() if name != "title.title"
    }


# Twenty counts, those of the cards that FMBD.DAT had: the pipe ends before those of elements.
ROD = ["a rod", "1 2 1" + 17 * " 0", "10 0.01", "0 0 0 0 1 0 0", "RIGID", "2.5", "0.8333333 0 0.8333333"]
ROD += [*5 * [""], "0 0.5 0", "1.25", "", "0 0 -9.81"]


def test_a_dafms_deck_through_a_pipe_passes_the_real_check(tmp_path):
    """A rod of 1 m, 2.5 kg about its end: 2.5 kg m^2 / 3; refused before without the counts of elements."""
    done = piped(lines=ROD, cwd=tmp_path, dialect="dafms")
    assert (done.returncode, done.stderr) == (0, "NEW.DAT: written; flexmb check NEW.DAT accepts it\n")
    deck = read_deck(read_text(tmp_path / "NEW.DAT"))
    assert (deck.dialect, deck.section("coordinate")[0]["q"]) == ("dafms", 1.25)


def test_what_check_refuses_of_a_dafms_deck_is_asked_for_again(tmp_path):
    """The inertia of a rod about its mass centre, 2.5 kg m^2 / 12, where that about O_k belongs."""
    terminal = Terminal("dafms", cwd=tmp_path)
    wrong = ["0.2083333 0 0.2083333" if line.startswith("0.83") else line for line in ROD]
    for line in [*wrong, " ".join("0" * len(ADDED))]:
        terminal.say(": ", line)
    terminal.expect("INER is about O_k, not about the mass centre")
    terminal.expect("INER 1\r\n")
    terminal.expect("[0.2083333 0 0.2083333] > ")
    terminal.type("0.8333333 0 0.8333333\n")
    terminal.expect("[0 0 0] > ")
    terminal.type(">\n")
    terminal.expect("NEW.DAT: written")
    assert terminal.exit_code() == 0
    assert [path.name for path in tmp_path.iterdir()] == ["NEW.DAT"]
