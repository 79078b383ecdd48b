"""Pipes and devices in the places of results: refused under names that the deck gives, never waited for."""

import os
import sys
import threading
from pathlib import Path

import pytest
from click.testing import CliRunner

from flexmb_cli.cli import cli
from flexmb_cli.errors import OutputError
from flexmb_cli.results.files import replaced_file
from flexmb_cli.results.files.replaced_file import ReplacedText
from tests.run.test_prepared_folders import STUDY, impatient

__all__ = ["impatient"]
pytestmark = pytest.mark.skipif(sys.platform == "win32", reason="pipes with names are Unix's")
DECKS = Path(__file__).resolve().parents[2] / "decks"
PIPE = "it is not a regular file, but a pipe or a device; remove it"


@pytest.mark.parametrize(
    ("deck", "name"),
    [
        ("young/IN1-3-1.dat", "OUT1-3-1.dat"),
        ("young/IN1-3-1.dat", "OUT1-3-1.h5"),
        ("dafms/pendulum.DAT", "pendulum.T2"),
    ],
)
def test_a_pipe_under_a_name_that_the_deck_gives_is_refused_at_once(tmp_path, deck, name):
    """It made `run` hang, deaf to SIGTERM."""
    os.mkfifo(tmp_path / name)
    done = CliRunner().invoke(cli, ["run", str(DECKS / deck), "-q", "-o", str(tmp_path)])
    assert done.exit_code == 2 and f"{tmp_path / name}: " in done.output
    assert os.listdir(tmp_path) == [name]


def test_a_device_under_a_name_that_the_deck_gives_is_not_written(tmp_path):
    os.symlink("/dev/full", tmp_path / "OUT1-3-1.dat")
    command = ["run", str(DECKS / "young/IN1-3-1.dat"), "--no-h5", "-q", "-o", str(tmp_path)]
    done = CliRunner().invoke(cli, command)
    assert done.exit_code == 2 and PIPE in done.output


def test_a_pipe_in_the_place_of_the_table_of_a_study_is_refused(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    Path("s.toml").write_text(STUDY)
    os.mkfifo("s.h5")
    done = CliRunner().invoke(cli, ["sweep", "s.toml"])
    assert isinstance(done.exception, OutputError) and PIPE in str(done.exception)
    assert sorted(os.listdir()) == ["s.h5", "s.toml"]


def test_a_named_pipe_that_nobody_reads_is_reported(tmp_path, monkeypatch):
    monkeypatch.setattr(replaced_file, "LONGEST_WAIT", 0.05)
    os.mkfifo(tmp_path / "pipe")
    command = ["run", str(DECKS / "young/IN1-3-1.dat"), "--no-h5", "-q", "--out", str(tmp_path / "pipe")]
    done = CliRunner().invoke(cli, command)
    assert done.exit_code == 2 and "it is a pipe that nothing reads" in done.output


def test_a_reader_of_a_pipe_may_start_later(tmp_path):
    pipe, read = tmp_path / "pipe", []
    os.mkfifo(pipe)
    reader = threading.Timer(0.1, lambda: read.append(pipe.read_text()))
    reader.start()
    stream = ReplacedText(pipe)
    stream.write("through")
    stream.commit()
    reader.join()
    assert read == ["through"]
