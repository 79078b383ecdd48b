"""scripts/venv with FLEXMB_LOCKED=1: an environment counts as locked only when it was made from the lock."""

import os
import shutil
import subprocess
from pathlib import Path

import pytest

VENV = Path(__file__).parents[2] / "scripts" / "venv"


@pytest.fixture
def checkout(tmp_path):
    """A checkout whose environment stands, and whose interpreter only notes how it is called."""
    (tmp_path / "scripts").mkdir()
    shutil.copy(VENV, tmp_path / "scripts" / "venv")
    programs = tmp_path / ".venv" / "bin"
    programs.mkdir(parents=True)
    for name in ("python", "flexmb"):
        (programs / name).write_text(f'#!/bin/sh\necho "$@" >> "{tmp_path}/calls"\n')
        (programs / name).chmod(0o755)
    for name in ("pyproject.toml", "requirements.lock"):
        (tmp_path / name).touch()
        os.utime(tmp_path / name, (1e9, 1e9))
    (tmp_path / ".venv" / ".made-for-test").touch()
    return tmp_path


def calls(checkout, **variables):
    """Return what the interpreter is called with by one call of the script."""
    (checkout / "calls").write_text("")
    surroundings = {name: value for name, value in os.environ.items() if name != "FLEXMB_LOCKED"}
    script = [str(checkout / "scripts" / "venv"), "test"]
    subprocess.run(script, env=surroundings | variables, check=True, capture_output=True)
    return (checkout / "calls").read_text()


def test_an_environment_made_without_the_lock_is_made_again(checkout):
    assert calls(checkout) == ""
    assert "--require-hashes" in calls(checkout, FLEXMB_LOCKED="1")
    assert calls(checkout, FLEXMB_LOCKED="1") == ""
    assert calls(checkout) == ""


def test_a_newer_lock_is_installed(checkout):
    calls(checkout, FLEXMB_LOCKED="1")
    os.utime(checkout / "requirements.lock", (4e9, 4e9))
    assert "--require-hashes" in calls(checkout, FLEXMB_LOCKED="1")


def test_what_is_installed_without_the_lock_no_longer_counts_as_locked(checkout):
    calls(checkout, FLEXMB_LOCKED="1")
    (checkout / ".venv" / ".made-for-test").unlink()
    assert "--require-hashes" not in calls(checkout)
    assert "--require-hashes" in calls(checkout, FLEXMB_LOCKED="1")
