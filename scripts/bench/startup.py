"""Ratio of the processor time of short commands to that of importing what they cannot do without.

Example: .venv/bin/python scripts/bench/startup.py --pairs 9
Each command runs in turn with the import it is measured against; the median of the ratios is told, and the
limit.  Bytecode is kept, as pip keeps it.  Run twice where nothing is compiled yet.  With --fresh every run
is a first one: it finds neither HOME nor a cache, and keeps nothing.  An installed wheel is measured by
pip install --no-deps --target FOLDER WHEEL && PYTHONPATH=FOLDER python scripts/bench/startup.py --fresh
"""

import argparse
import os
import resource
import statistics
import subprocess
import sys
import tempfile
from pathlib import Path

DECKS = Path(__file__).resolve().parents[2] / "decks"
PACKAGES = "numpy, h5py, click"
# Words of the command, what is imported for comparison, and the largest ratio wanted.
COMMANDS = (
    (("run", "-q", "young/IN4-BAR.dat"), PACKAGES, 1.7),
    (("run", "-q", "young/dynamics/IN-RSSR-MASS.dat"), PACKAGES, 1.7),
    (("run", "-q", "young/dynamics/IN4-BAR-MASS.dat"), PACKAGES, 1.7),
    (("run", "-q", "dafms/pendulum.DAT"), PACKAGES, 1.7),
    (("run", "-q", "vsdf/pendulum.vsdf"), PACKAGES, 2.7),
    (("check", "-q", "young/IN4-BAR.dat"), PACKAGES, 1.4),
    (("check", "-q", "dafms/pendulum.DAT"), PACKAGES, 1.4),
    (("--help",), "click", 2.0),
)


OF_CACHES = ("HOME", "XDG_CACHE_HOME", "NUMBA_CACHE_DIR", "FLEXMB_CACHE_DIR", "LOCALAPPDATA")


def surroundings(folder: str, fresh: bool) -> dict[str, str]:
    """Return the environment of the processes."""
    if not fresh:
        kept = {name: value for name, value in os.environ.items() if name != "PYTHONDONTWRITEBYTECODE"}
        return kept | {"OPENBLAS_NUM_THREADS": "1", "PYTHONPYCACHEPREFIX": f"{folder}/bytecode"}
    kept = {name: value for name, value in os.environ.items() if name not in OF_CACHES}
    return kept | {"OPENBLAS_NUM_THREADS": "1", "PYTHONDONTWRITEBYTECODE": "1", "TMPDIR": f"{folder}/none"}


def seconds(arguments: list[str], folder: str, environment: dict[str, str]) -> float:
    """Return the processor time of a process of Python's."""
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    subprocess.run([sys.executable, *arguments], cwd=folder, env=environment, check=True, capture_output=True)
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    return after.ru_utime - before.ru_utime + after.ru_stime - before.ru_stime


def main() -> int:
    """Measure all commands; return 1 where one is above its limit."""
    parser = argparse.ArgumentParser()
    parser.add_argument("--pairs", type=int, default=9)
    parser.add_argument("--fresh", action="store_true", help="every run is a first one")
    asked, above = parser.parse_args(), 0
    with tempfile.TemporaryDirectory(prefix="flexmb-startup-") as folder:
        environment = surroundings(folder, asked.fresh)
        for words, packages, limit in COMMANDS:
            command = ["-m", "flexmb_cli", *words[:-1], str(DECKS / words[-1]) if words[1:] else words[0]]
            needed = ["-c", f"import {packages}"]
            pairs = [
                [seconds(arguments, folder, environment) for arguments in (command, needed)]
                for _ in range(asked.pairs + 1)
            ]
            found = [one / other for one, other in pairs[1:]]  # the first pair writes bytecode
            ratio = statistics.median(found)
            above += ratio > limit
            print(f"{ratio:5.2f} (wanted {limit})  flexmb {' '.join(words)}", flush=True)
    return min(above, 1)


if __name__ == "__main__":
    sys.exit(main())
