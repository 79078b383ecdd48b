"""Runs of decks through the command line, and their results."""

import json
import subprocess
import sys
from pathlib import Path

import h5py

TOP = Path(__file__).resolve().parents[2]
DECKS = TOP / "decks"
PUBLISHED = TOP / "tests" / "published"


def run(folder: Path, *decks: str, options: tuple[str, ...] = ()) -> list[h5py.File]:
    """The open results of `decks` (paths below decks/), run in `folder`; stops when a run fails."""
    options = ("-q", "--no-out", "--json", "-o", folder, *options)
    command = [sys.executable, "-m", "flexmb_cli", "run", *(DECKS / deck for deck in decks), *options]
    reported = subprocess.run(command, check=True, stdout=subprocess.PIPE, text=True).stdout
    return [h5py.File(json.loads(line)["files"][0]) for line in reported.splitlines()]
