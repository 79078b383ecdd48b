"""The shipped decks, and what a fresh process writes for them."""

import hashlib
import os
import subprocess
import sys
from dataclasses import dataclass
from pathlib import Path

DECKS = Path(__file__).resolve().parents[2] / "decks"
# pendulum.DAT and pendulum.vsdf give files of one name: every kind goes to a folder of its own.
KINDS = {
    "young": "young/*.dat",
    "young/dynamics": "young/dynamics/*.dat",
    "dafms": "dafms/*.DAT",
    "vsdf": "vsdf/*.vsdf",
}


@dataclass(frozen=True)
class Written:
    """A file of a run: its digest and its size in bytes."""

    sha256: str
    size: int


def shipped(kind: str, decks: Path = DECKS) -> list[Path]:
    """Paths of the decks of a kind."""
    return sorted(decks.glob(KINDS[kind]))


def flexmb(*arguments, cwd, environment=()) -> None:
    """A command in a fresh process; what it says goes to the terminal.  Raises CalledProcessError."""
    command = [sys.executable, "-m", "flexmb_cli", *map(str, arguments)]
    # The package is found beside this script, whether or not it is installed.
    path = os.pathsep.join([str(DECKS.parent), os.environ.get("PYTHONPATH", "")])
    given = {**os.environ, **dict(environment), "PYTHONPATH": path}
    subprocess.run(command, cwd=cwd, env=given, check=True)


def written(folder: Path) -> dict[str, Written]:
    """Files below `folder` by their path there."""
    found = {}
    for path in sorted(path for path in folder.rglob("*") if path.is_file()):
        content = path.read_bytes()
        name = path.relative_to(folder).as_posix()
        found[name] = Written(hashlib.sha256(content).hexdigest(), len(content))
    return found
