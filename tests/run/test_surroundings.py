"""No result tells where, by whom or on which machine it was made."""

import getpass
import platform
import shutil
from pathlib import Path

import pytest
from click.testing import CliRunner

from flexmb_cli.cli import cli

DECKS = Path(__file__).parents[2] / "decks"
HOME, USER, SECRET = "/home/someone-in-particular", "someone-in-particular", "value-of-a-variable"
STUDY = """\
deck = "IN1-3-1.dat"
[parameters]
"driver.1.B" = [1.0, 2.0]
[results]
top = "max body.1.z"
"""


@pytest.fixture
def outputs(tmp_path, monkeypatch):
    """A folder with every kind of file that commands write, and nothing else in it."""
    (tmp_path / "in").mkdir()
    (tmp_path / "out").mkdir()
    shutil.copy(DECKS / "young" / "IN1-3-1.dat", tmp_path / "in")
    (tmp_path / "in" / "study.toml").write_text(STUDY)
    monkeypatch.chdir(tmp_path / "out")
    monkeypatch.setenv("HOME", HOME)
    monkeypatch.setenv("USER", USER)
    monkeypatch.setenv("LOGNAME", USER)
    monkeypatch.setenv("TOKEN", SECRET)
    deck, study = (str(tmp_path / "in" / name) for name in ("IN1-3-1.dat", "study.toml"))
    for command in (
        ["run", deck],
        ["report", "OUT1-3-1.h5"],
        ["plot", "OUT1-3-1.h5", "-o", "x.svg"],
        ["export", "OUT1-3-1.h5", "--to", "csv"],
        ["export", "OUT1-3-1.h5", "--to", "mat"],
        ["export", "OUT1-3-1.h5", "--to", "vtkhdf"],
        ["sweep", study],
    ):
        assert CliRunner().invoke(cli, command).exit_code == 0, command
    answers = "a title\n1 1 1\n!\n"
    assert (
        CliRunner().invoke(cli, ["new", "young", "--draft", "-o", "IN-X.dat"], input=answers).exit_code == 1
    )
    return tmp_path / "out"


def test_no_file_holds_a_path_a_name_of_user_or_host_or_a_variable(outputs):
    secrets = [str(outputs.parent), str(Path.cwd()), HOME, USER, SECRET, getpass.getuser(), platform.node()]
    found = sorted(outputs.iterdir())
    kinds = {".dat", ".h5", ".html", ".svg", ".csv", ".mat", ".vtkhdf", ".draft"}
    assert {path.suffix for path in found} == kinds
    for path in found:
        raw = path.read_bytes()
        # Short names, such as root, are words of many texts.
        reported = [word for word in secrets if len(word) > 6 and word.encode() in raw]
        assert not reported, f"{path.name} tells {reported}"
