"""Every command of the README runs as shown, and what the README prints is what comes out."""

import os
import re
import subprocess
import sys
from pathlib import Path

import pytest

pytestmark = pytest.mark.processes

TOP = Path(__file__).resolve().parents[1]
README = (TOP / "README.md").read_text(encoding="utf-8")
SHIM = f'#!/bin/sh\nexec "{sys.executable}" -m flexmb_cli "$@"\n'


def transcripts():
    """(command, lines shown below it) of all console blocks, in order."""
    for block in re.findall(r"```console\n(.*?)```", README, re.DOTALL):
        for part in re.split(r"^\$ ", block, flags=re.MULTILINE)[1:]:
            command, *shown = part.rstrip("\n").split("\n")
            yield command, shown


@pytest.fixture(scope="module")
def newcomer(tmp_path_factory):
    """A folder that looks like the checkout; its scripts/flexmb is the flexmb under test."""
    folder = tmp_path_factory.mktemp("checkout")
    (folder / "scripts").mkdir()
    (folder / "scripts" / "flexmb").write_text(SHIM)
    (folder / "scripts" / "flexmb").chmod(0o755)
    (folder / "decks").symlink_to(TOP / "decks")
    return folder


def test_every_command_runs_and_prints_what_is_shown(newcomer):
    ran = 0
    for command, shown in transcripts():
        if command == "scripts/test":  # this very suite
            continue
        done = subprocess.run(
            command, shell=True, cwd=newcomer, capture_output=True, text=True, encoding="utf-8", timeout=300
        )
        lines = [line for line in (done.stdout + done.stderr).splitlines() if "compiling kernels" not in line]
        assert lines[: len(shown)] == shown, command
        # A command that shows nothing is quiet because it succeeded.
        assert shown or (not lines and done.returncode == 0), command
        ran += 1
    assert ran >= 7


def test_the_reading_example_reads_the_four_bar(newcomer):
    code = re.search(r"```python\n(.*?)```", README, re.DOTALL).group(1)
    run = [sys.executable, "-m", "flexmb_cli", "run", str(TOP / "decks/young/IN4-BAR.dat"), "-q"]
    subprocess.run(run, cwd=newcomer, check=True, timeout=300)
    done = subprocess.run(
        [sys.executable, "-c", code], cwd=newcomer, capture_output=True, text=True, check=True, timeout=60
    )
    # The range of z of body 3 in the published OUT4-BAR (tests/published/young/IN4-BAR.csv).
    assert done.stdout.splitlines() == [
        "complete",
        "26 rows, z of body 3 from 2.627 to 3.698 m",
        "all equations are met to round-off: True",
        "spherical 1",
        "universal 1",
        "revolute 1",
        "revolute 2",
    ]


def test_every_deck_stands_in_the_readme():
    decks = {path.stem for path in (TOP / "decks" / "young").glob("*.dat")}
    listed = README.split("## The decks")[1].split("\n## ")[0]
    named = set(re.findall(r"`(IN[-\w]+)`", listed)) | {"IN1-3-2", "IN1-3-3", "IN1-4-2"}  # inside ranges
    assert decks == named


def test_no_machine_is_named():
    assert os.sep + "work" not in README
