"""`flexmb new` of VSDF and DAFMS decks."""

from pathlib import Path

import pytest
from click.testing import CliRunner

from flexmb_cli.cli import cli
from flexmb_cli.deck.text import read_text
from flexmb_cli.dialects.recognise import read_deck
from flexmb_cli.dialects.vsdf.build import build_vsdf
from flexmb_cli.dialects.vsdf.form import COUNTED
from flexmb_cli.run.check.check import CheckReport
from flexmb_cli.run.outcome import Outcome
from tests.cli.test_new_at_a_terminal import Terminal
from tests.cli.test_new_command import TOP, numbers_of, piped

pytestmark = pytest.mark.processes


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
    counts = " ".join("1" if card.word in ("BODY", "FEMM", "FEMK") else "0" for card in COUNTED)
    files = ["TXT fe/pendulum_nodes.txt", "1 MM fe/pendulum_M.mtx", "1 MM fe/pendulum_K.mtx"]
    lines = ["rod", counts, "FLEX 9 1 13 9", *files, "0 0 -9.81", "1 0.1 0", "", "", "", ""]
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
    counts = " ".join("1" if card.word in once else "0" for card in COUNTED)
    lines = ["rod", counts, "FLEX 9 1 13 9", "TXT fe/pendulum_nodes.txt", "1 MM fe/pendulum_M.mtx"]
    lines += ["1 MM fe/pendulum_K.mtx", "REVO 0 0 0 1 1 5", "", "", "", "1 51"]
    lines += ["0 0 -9.81", "0.5 5e-4 5e-5", "GALF 0.9", "", ""]
    done = piped("-o", "rod.vsdf", lines=lines, cwd=tmp_path, dialect="vsdf")
    assert (done.returncode, done.stderr) == (0, "rod.vsdf: written; flexmb check rod.vsdf accepts it\n")
    supplied = dict(numbers_of(TOP / "decks" / "vsdf" / "pendulum.vsdf"))
    asked = dict(numbers_of(tmp_path / "rod.vsdf"))
    assert {name: asked[name] for name in supplied if name != "title.title"} == {
        name: value for name, value in supplied.items() if name != "title.title"
    }


# Twenty counts, those of the cards that FMBD.DAT had: the pipe ends before shapes and elements.
ROD = ["a rod", "1 2 1" + 17 * " 0", "10 0.01", "0 0 0 0 1 0 0", "RIGID", "2.5", "0.8333333 0 0.8333333"]
ROD += [*5 * [""], "0 0.5 0", "1.25", "", "0 0 -9.81"]


def test_a_dafms_deck_through_a_pipe_passes_the_real_check(tmp_path):
    """A rod of 1 m, 2.5 kg about its end: 2.5 kg m^2 / 3; refused before without the lines of elements."""
    done = piped(lines=ROD, cwd=tmp_path, dialect="dafms")
    assert (done.returncode, done.stderr) == (0, "NEW.DAT: written; flexmb check NEW.DAT accepts it\n")
    deck = read_deck(read_text(tmp_path / "NEW.DAT"))
    assert (deck.dialect, deck.section("coordinate")[0]["q"]) == ("dafms", 1.25)


def test_what_proves_wrong_behind_it_is_asked_for_again(tmp_path):
    """The inertia of a rod about its mass centre, 2.5 kg m^2 / 12, where that about O_k belongs."""
    terminal = Terminal("dafms", cwd=tmp_path)
    wrong = ["0.2083333 0 0.2083333" if line.startswith("0.83") else line for line in ROD]
    for line in wrong[:13]:
        terminal.say(": ", line)
    terminal.expect("INER is about O_k, not about the mass centre")
    terminal.expect("INER 1\r\n")
    terminal.expect("[0.2083333 0 0.2083333] > ")
    terminal.type("0.8333333 0 0.8333333\n")
    terminal.expect("[0 0 0] > ")
    terminal.type(">\n")
    for line in [*wrong[13:], "0", ""]:
        terminal.say(": ", line)
    terminal.expect("NEW.DAT: written")
    assert terminal.exit_code() == 0
    assert [path.name for path in tmp_path.iterdir()] == ["NEW.DAT"]
