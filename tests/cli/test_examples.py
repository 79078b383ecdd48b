"""`flexmb examples` lists every supplied deck and copies those named, complete; `flexmb` alone helps."""

import errno
import os
import subprocess
import sys
from pathlib import Path

import pytest
from click.testing import CliRunner

from flexmb_cli.cli.examples import examples

pytestmark = pytest.mark.processes

DECKS = Path(__file__).resolve().parents[2] / "decks"


def flexmb(folder, *arguments):
    command = [sys.executable, "-m", "flexmb_cli", *map(str, arguments)]
    return subprocess.run(command, cwd=folder, capture_output=True, text=True, timeout=60)


def test_every_supplied_deck_is_listed(tmp_path):
    listed = [line.split()[0] for line in flexmb(tmp_path, "examples").stdout.splitlines()]
    supplied = [path for path in DECKS.rglob("*") if path.suffix in (".dat", ".DAT", ".vsdf", ".toml")]
    assert len(listed) == len(set(listed)) == len(supplied)
    assert {name.partition(".")[0] for name in listed} == {path.stem for path in supplied}


@pytest.mark.parametrize("name", ["IN-ANDREWS", "pendulum.DAT", "pendulum_ccx", "pendulum_op4", "spinup"])
def test_a_copied_deck_can_be_checked_where_it_lies(name, tmp_path):
    done = flexmb(tmp_path, "examples", name, "-q")
    assert done.returncode == 0 and not done.stdout
    (deck,) = [path for path in tmp_path.iterdir() if path.is_file()]
    assert flexmb(tmp_path, "check", "-q", deck.name).returncode == 0


def test_a_copied_study_finds_its_deck(tmp_path):
    flexmb(tmp_path, "examples", "rssr")
    assert {path.name for path in tmp_path.iterdir()} == {"rssr.toml", "IN-RSSR.dat"}
    assert 'deck = "IN-RSSR.dat"' in (tmp_path / "rssr.toml").read_text()


def test_all_examples_keep_their_folders(tmp_path):
    """The commands of README and tutorial name decks/young/IN4-BAR.dat."""
    done = CliRunner().invoke(examples, ["--all", "-o", str(tmp_path)])
    assert done.exit_code == 0, done.output
    copied = {path.relative_to(tmp_path / "decks") for path in tmp_path.rglob("*") if path.is_file()}
    assert copied == {path.relative_to(DECKS) for path in DECKS.rglob("*") if path.is_file()}
    assert (tmp_path / "decks/young/IN4-BAR.dat").read_bytes() == (DECKS / "young/IN4-BAR.dat").read_bytes()
    again = CliRunner().invoke(examples, ["--all", "-o", str(tmp_path)])
    assert again.exit_code == 2 and "--force replaces it" in again.stderr
    both = CliRunner().invoke(examples, ["--all", "IN4-BAR"])
    assert both.exit_code == 2 and "leave out the names" in both.stderr


def test_nothing_of_the_user_is_replaced(tmp_path):
    (tmp_path / "IN4-BAR.dat").write_text("mine")
    done = flexmb(tmp_path, "examples", "IN4-BAR")
    assert done.returncode == 2 and "--force replaces it" in done.stderr
    assert (tmp_path / "IN4-BAR.dat").read_text() == "mine"
    assert flexmb(tmp_path, "examples", "IN4-BAR", "--force").returncode == 0
    assert (tmp_path / "IN4-BAR.dat").read_bytes() == (DECKS / "young/IN4-BAR.dat").read_bytes()


@pytest.mark.parametrize("words, name", [(["IN4-BAR"], "IN4-BAR.dat"), (["--all"], "decks")])
def test_a_link_that_leads_nowhere_is_not_written_through(words, name, tmp_path):
    """`exists` is false of such a link: the deck was written where it leads."""
    (tmp_path / "here").mkdir()
    (tmp_path / "here" / name).symlink_to(tmp_path / "elsewhere")
    done = CliRunner().invoke(examples, [*words, "-o", str(tmp_path / "here")])
    assert done.exit_code == 2 and "--force replaces it" in done.stderr
    assert not (tmp_path / "elsewhere").exists()


def test_all_examples_lie_as_the_documentation_names_them(tmp_path):
    done = flexmb(tmp_path, "examples", "--all")
    assert done.stdout.endswith(" examples → decks\n")
    copied = {path.relative_to(tmp_path / "decks") for path in (tmp_path / "decks").rglob("*")}
    assert copied == {path.relative_to(DECKS) for path in DECKS.rglob("*")}
    assert "--force replaces it" in flexmb(tmp_path, "examples", "--all").stderr


def test_an_unknown_name_is_refused(tmp_path):
    done = flexmb(tmp_path, "examples", "IN9-9-9")
    assert done.returncode == 2 and "`flexmb examples` lists them" in done.stderr
    assert not list(tmp_path.iterdir())


def test_flexmb_alone_helps(tmp_path):
    done = flexmb(tmp_path)
    assert done.returncode == 0 and "flexmb examples IN4-BAR" in done.stdout and not done.stderr
    # Who has only a wheel finds manual, formats and lessons.
    for place in ("man flexmb", "decks/DIALECT/FORMAT.md", "flexmb docs"):
        assert place in done.stdout
    assert max(map(len, done.stdout.split("Read on:")[1].splitlines())) <= 80


def test_a_full_disk_leaves_no_empty_copies(tmp_path, monkeypatch):
    """It left 83 empty files of `--all`."""
    from flexmb_cli.results.files import replaced_file

    written = replaced_file.Replacement.open

    def full(self, mode, **how):
        if self.path.endswith("pendulum.vsdf"):
            raise OSError(errno.ENOSPC, "No space left on device")
        return written(self, mode, **how)

    monkeypatch.setattr(replaced_file.Replacement, "open", full)
    for words in (["--all"], ["pendulum.vsdf"]):
        done = CliRunner().invoke(examples, [*words, "-o", str(tmp_path)])
        assert "no space left" in str(done.exception).lower()
    assert [path for path in tmp_path.rglob("*") if path.is_file()] == []


def test_a_pipe_in_the_place_of_a_copy_is_refused_at_once(tmp_path):
    """`--force` waited for its reader for ever (POSIX, open)."""
    os.mkfifo(tmp_path / "IN4-BAR.dat")
    done = flexmb(tmp_path, "examples", "IN4-BAR", "--force")
    assert done.returncode == 2 and "not a regular file, but a pipe or a device" in done.stderr
