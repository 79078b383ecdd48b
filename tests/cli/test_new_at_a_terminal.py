"""`flexmb new` at a terminal: help, slips, drafts and ways back."""

import json
import os
import pty
import select
import signal
import time

import pytest

from tests.cli.test_new_command import FOUR_BAR, NEW, answers, numbers_of, piped

pytestmark = pytest.mark.processes


class Terminal:
    """A process at a pseudo-terminal, of which all that it prints is kept."""

    def __init__(self, *arguments, cwd):
        self.text = ""
        self.pid, self.descriptor = pty.fork()
        if self.pid == 0:  # the child: nothing of the test may run on here
            try:
                os.chdir(cwd)
                signal.signal(signal.SIGINT, signal.SIG_DFL)
                os.environ["COLUMNS"] = "200"  # sentences stay on one line
                os.environ["TERM"] = "dumb"  # no escape sequences between what is compared
                os.execv(NEW[0], [*NEW, *arguments])
            finally:
                os._exit(127)

    def expect(self, words, seconds=60):
        """Read on until `words` appear after what was expected before."""
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

    def exit_code(self, closed=False):
        """Wait for the end; `closed`: after the terminal was closed."""
        if closed:
            os.close(self.descriptor)
        code = os.waitstatus_to_exitcode(os.waitpid(self.pid, 0)[1])
        if not closed:
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
    assert "continuing with 20 answers" in done.stderr
    assert numbers_of(tmp_path / "IN-NEW.dat") == numbers_of(FOUR_BAR)


def test_a_closed_terminal_keeps_the_draft_and_the_next_call_goes_on(tmp_path):
    """Closing the pseudo-terminal sends SIGHUP, as a window does; nothing can be printed then."""
    terminal = Terminal("young", cwd=tmp_path)
    title, counts, body, *rest = answers()
    terminal.say("text", title)
    terminal.say("NBODY", counts)
    terminal.say("x y z", body)
    terminal.expect("body 2")
    terminal.expect("> ")
    assert terminal.exit_code(closed=True) in (1, 143)  # the end of input and the signal come at once
    assert len(json.loads((tmp_path / "IN-NEW.dat.draft").read_text())["answers"]) == 1 + 12 + 7
    done = piped("--draft", lines=rest, cwd=tmp_path)
    assert done.returncode == 0 and "continuing with 20 answers" in done.stderr
    assert numbers_of(tmp_path / "IN-NEW.dat") == numbers_of(FOUR_BAR)


def test_a_note_comes_while_its_record_can_be_changed(tmp_path):
    """A driver that starts at 30: beyond a turn, and likely meant in degrees; the way back leads to it."""
    terminal = Terminal("young", cwd=tmp_path)
    for line in answers()[:6]:
        terminal.say(": ", line)
    terminal.expect("driver 1")
    terminal.say("body", "1 4 30 3.14159265 0")
    terminal.expect("note: ")
    terminal.expect("(< leads back to this record)")
    terminal.expect("point of interest 1")
    terminal.expect("> ")
    terminal.type("< driver.1\n")
    terminal.expect("driver 1")
    terminal.expect("> ")
    terminal.type("!\n")
    assert terminal.exit_code() == 1


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
