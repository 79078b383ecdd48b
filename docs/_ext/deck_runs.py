"""Results of the supplied decks, solved once: docs/_build/results keeps them by digest.

The digest is that of the deck (of a VSDF deck with its finite-element files) and of what solves it, so a new
build after a change of a page solves nothing.
"""

import hashlib
import json
import os
import subprocess
import sys
from pathlib import Path

DOCS = Path(__file__).resolve().parents[1]
TOP = DOCS.parent
RESULTS = DOCS / "_build" / "results"
SOLVING = ("deck", "dialects", "model", "fe", "kernels", "solvers", "run")
FINITE_ELEMENTS = TOP / "decks" / "vsdf" / "fe"


def flexmb(*arguments, folder: Path = RESULTS) -> str:
    """Run a command of this checkout's flexmb and return what it prints."""
    environment = os.environ | {"PYTHONPATH": str(TOP)}
    command = [sys.executable, "-m", "flexmb_cli", *map(str, arguments)]
    done = subprocess.run(command, cwd=folder, env=environment, check=True, capture_output=True, text=True)
    return done.stdout


def digest(paths, begun: str = "") -> str:
    """A short digest of files, in the order of their names."""
    whole = hashlib.sha256(begun.encode())
    for path in sorted(paths):
        whole.update(path.read_bytes())
    return whole.hexdigest()[:12]


def program() -> str:
    """The digest of what solves decks."""
    return digest(path for folder in SOLVING for path in (TOP / "flexmb_cli" / folder).rglob("*.py"))


def solved(decks: list[Path], *options: str) -> dict[Path, Path]:
    """The HDF5 result of each deck; those that are not kept are solved, a process for each folder."""
    by, folders, missing = program() + " ".join(options), {}, {}
    files = digest(path for path in FINITE_ELEMENTS.rglob("*") if path.is_file())
    for deck in dict.fromkeys(decks):
        stamp = digest([deck], by + (files if deck.suffix == ".vsdf" else ""))
        folders[deck] = RESULTS / f"{deck.stem}-{stamp}"
        if not any(folders[deck].glob("*.h5")):
            missing.setdefault(deck.parent, []).append(deck)
    for group in missing.values():
        _solve(group, folders, options)
    return {deck: next(folder.glob("*.h5")) for deck, folder in folders.items()}


def _solve(decks, folders, options):
    here = RESULTS / "solving"
    here.mkdir(parents=True, exist_ok=True)
    reported = flexmb("run", "--no-out", "--json", "-q", *options, *decks, folder=here)
    for deck, line in zip(decks, reported.splitlines(), strict=True):
        folders[deck].mkdir(parents=True, exist_ok=True)
        name = json.loads(line)["files"][0]
        os.replace(here / name, folders[deck] / name)


def checked(decks: list[Path]) -> dict[Path, dict]:
    """The record of `flexmb check --json` of each deck."""
    reported = flexmb("check", "--json", "-q", *decks, folder=TOP)
    return dict(zip(decks, map(json.loads, reported.splitlines()), strict=True))
