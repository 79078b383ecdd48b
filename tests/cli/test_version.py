"""`flexmb --version`: the version, and in a checkout the commit that git itself names."""

import runpy
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

from flexmb_cli import __version__
from flexmb_cli.cli.terminal.commit import commit

TOP = Path(__file__).resolve().parents[2]
GIT = shutil.which("git")


def git(folder, *arguments):
    command = [GIT, "-c", "user.name=a", "-c", "user.email=a@b", *arguments]
    return subprocess.run(command, cwd=folder, check=True, capture_output=True, text=True).stdout.strip()


@pytest.fixture
def checkout(tmp_path):
    if GIT is None:
        pytest.skip("git is not installed")
    folder = tmp_path / "checkout"
    folder.mkdir()
    (folder / "pyproject.toml").write_text("")
    git(folder, "init", "-q")
    git(folder, "add", ".")
    git(folder, "commit", "-q", "-m", "Begin")
    return folder


def test_the_commit_is_the_one_that_git_names(checkout):
    whole = git(checkout, "rev-parse", "HEAD")
    assert len(commit(checkout)) == 10 and whole.startswith(commit(checkout))
    git(checkout, "pack-refs", "--all")
    assert whole.startswith(commit(checkout))
    git(checkout, "checkout", "-q", "--detach")
    assert whole.startswith(commit(checkout))


def test_a_further_working_tree_has_its_own_commit(checkout):
    git(checkout, "worktree", "add", "-q", "-b", "other", "../other")
    other = checkout.parent / "other"
    git(other, "commit", "-q", "--allow-empty", "-m", "Go on")
    assert git(other, "rev-parse", "HEAD").startswith(commit(other))
    assert commit(other) != commit(checkout)


@pytest.mark.parametrize("content", [None, "gitdir: /nowhere", b"\xff"])
def test_outside_a_checkout_there_is_none(tmp_path, content):
    (tmp_path / "pyproject.toml").write_text("")
    if content is not None:
        (tmp_path / ".git").write_bytes(content if isinstance(content, bytes) else content.encode())
    assert commit(tmp_path) == ""


def test_an_installation_names_the_commit_it_was_built_from(checkout, tmp_path, monkeypatch):
    """`pip install .` leaves no git folder after: setup.py keeps the commit in a file."""
    monkeypatch.setattr("setuptools.setup", lambda **_: None)
    shutil.copy(TOP / "setup.py", checkout)
    place = Path("flexmb_cli/cli/terminal")
    for folder in (checkout, tmp_path / "site-packages"):
        (folder / place).mkdir(parents=True)
        shutil.copy(TOP / place / "commit.py", folder / place)
    runpy.run_path(str(checkout / "setup.py"))["write_commit"](tmp_path / "site-packages")
    installed = runpy.run_path(str(tmp_path / "site-packages" / place / "commit.py"))["commit"]
    assert len(installed()) == 10 and git(checkout, "rev-parse", "HEAD").startswith(installed())


def test_a_wheel_of_an_archive_names_no_commit(tmp_path):
    (tmp_path / "_commit.txt").write_text("")
    assert commit(tmp_path, tmp_path / "_commit.txt") == commit(tmp_path, tmp_path / "none") == ""


@pytest.mark.processes
def test_the_command_names_version_and_commit():
    done = subprocess.run(
        [sys.executable, "-m", "flexmb_cli", "--version"], capture_output=True, text=True, check=True, cwd="/"
    )
    found = commit(TOP)
    assert done.stdout == f"flexmb, version {__version__}{f' (commit {found})' if found else ''}\n"
