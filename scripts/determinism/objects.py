"""Run every shipped deck with kernels from objects and with kernels of numba's own, and compare the files.

Example: scripts/determinism/run objects --kinds young dafms
One process runs all decks by objects, another all by what numba compiles in memory for this processor; every
file that they write has to be the same to the byte.  Exit 1 where one differs.  The second process compiles
for some minutes.
"""

import argparse
import json
import subprocess
import sys
import tempfile
from pathlib import Path

from interpreted import shortened
from shipped import DECKS, KINDS, shipped, written

CHILD = """
import json, os, sys
import numba
from flexmb_cli.kernels import _entry
from flexmb_cli.run.solution import run_deck
from flexmb_cli.run.outcome import RunOptions

asked = json.loads(sys.argv[1])
if asked["numba"]:
    class Dispatchers(dict):
        def __missing__(self, entry):
            self[entry] = numba.njit(error_model="numpy")(entry.py_func)
            return self[entry]

    made = Dispatchers()
    _entry.Entry.__call__ = lambda entry, *values: made[entry](*values)
    for kind in (_entry.Entry, _entry.PlainEntry):
        kind._numba_type_ = property(lambda entry: made[entry]._numba_type_)
for kind, deck, changes in asked["decks"]:
    outcome = run_deck(deck, RunOptions(folder=os.path.join(asked["folder"], kind), changes=tuple(changes)))
    assert outcome.exit_code == 0, (deck, outcome.faults)
    assert bool(_entry._loaded) != asked["numba"], deck
"""


def results(numba: bool, decks: list, folder: Path) -> subprocess.Popen:
    """Start the process that runs all decks in one of the ways."""
    asked = json.dumps({"numba": numba, "decks": decks, "folder": str(folder)})
    return subprocess.Popen([sys.executable, "-c", CHILD, asked], cwd=DECKS.parent)


def main() -> int:
    """Print what differs, and how many files of how many decks were compared."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--kinds", nargs="+", default=list(KINDS), choices=list(KINDS))
    parser.add_argument("--rows", type=int, help="only the first times of every deck")
    asked = parser.parse_args()
    decks = [
        (kind, str(deck), [shortened(deck, asked.rows)] if asked.rows else [])
        for kind in asked.kinds
        for deck in shipped(kind)
    ]
    with tempfile.TemporaryDirectory(prefix="flexmb-objects-") as name:
        folders = {numba: Path(name) / ("numba" if numba else "objects") for numba in (True, False)}
        running = [results(numba, decks, folder) for numba, folder in folders.items()]
        codes = [process.wait() for process in running]
        if any(codes):
            return 1
        one, other = (written(folder) for folder in folders.values())
    differing = sorted(path for path in one.keys() | other.keys() if one.get(path) != other.get(path))
    print(*(f"differs: {path}" for path in differing), sep="\n", end="\n" * bool(differing))
    print(f"{len(decks)} decks, {len(one)} files, {len(differing)} differ")
    return min(len(differing), 1)


if __name__ == "__main__":
    sys.exit(main())
