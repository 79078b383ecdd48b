"""Studies that are damaged or made to harm: refused in words, at once."""

import os

import pytest

from flexmb_cli.errors import DeckError
from flexmb_cli.study.sweep import Sweep

STUDY = 'deck = "x"\n[parameters]\n"driver.1.B" = [1.0]\n[results]\ntop = "max body.1.z"\n'


@pytest.mark.parametrize("make", [os.mkfifo, os.mkdir, lambda path: os.symlink("/dev/zero", path)])
def test_a_deck_that_is_no_regular_file_is_not_waited_for(tmp_path, make):
    make(tmp_path / "x")
    (tmp_path / "s.toml").write_text(STUDY)
    with pytest.raises(DeckError, match="not a regular file"):
        Sweep.of(str(tmp_path / "s.toml"), str(tmp_path / "parts"))


@pytest.mark.parametrize("number", ["9" * 5000, "9" * 400, "[" * 5000])
def test_numbers_and_brackets_without_end_are_refused(tmp_path, number):
    """Python's int() refuses more than 4300 digits, float() more than 308, each by another exception."""
    (tmp_path / "s.toml").write_text(STUDY.replace("1.0", number))
    with pytest.raises(DeckError):
        Sweep.of(str(tmp_path / "s.toml"), str(tmp_path / "parts"))
