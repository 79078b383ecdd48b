"""Runs of decks through the command line, and their results."""

import subprocess
import sys
from pathlib import Path

import h5py

TOP = Path(__file__).resolve().parents[2]
DECKS = TOP / "decks"
PUBLISHED = TOP / "tests" / "published"


def run(deck: str, folder: Path):
    """The open result of `deck` (its path below decks/), run in `folder`; stops when the run fails."""
    known = set(folder.glob("*.h5"))
    command = [sys.executable, "-m", "flexmb_cli", "run", str(DECKS / deck), "-q", "--no-out", "-o", folder]
    subprocess.run(command, check=True)
    (made,) = set(folder.glob("*.h5")) - known
    return h5py.File(made)
