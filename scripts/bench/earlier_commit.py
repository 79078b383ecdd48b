"""Time of the kernels against those of an earlier commit, in pairs within one run.

Example: .venv/bin/python scripts/bench/earlier_commit.py 2fd7237 --pairs 7
The package of the earlier commit is taken out of git into a temporary folder, with a cache of its own: its
first runs compile for a minute or two.  Every figure is a difference of two runs of the same deck, a long and
a short one, so that starting, reading and compiling cancel: processor time by rows, evaluations or steps.
"""

import argparse
import os
import re
import resource
import statistics
import subprocess
import sys
import tempfile
from pathlib import Path
from typing import NamedTuple

TOP = Path(__file__).resolve().parents[2]


class Case(NamedTuple):
    """A deck, what is replaced in it for a short and a long run, what `run -v` says is counted.

    Decks without elements at joints: they must not pay for these.
    """

    deck: str
    text: str
    short: str
    long: str
    counted: str


CASES = (
    Case("young/IN-RSSR.dat", "0.0035717333", "0.0001", "0.000001", "rows"),
    Case("young/dynamics/IN-ANDREWS.dat", "0 0.03 0.0005", "0 0.01 0.0005", "0 0.3 0.0005", "evaluations"),
    Case("dafms/shaft_beam_n10.DAT", "  500\n", "   50\n", " 1500\n", "evaluations"),
    Case(
        "vsdf/pendulum.vsdf", "       0.5    5.0E-4", "      0.05    5.0E-2", "       2.5    5.0E-2", "steps"
    ),
)


def processor_seconds(package: Path, deck: Path, cache: Path) -> tuple[float, str]:
    """Return the time of a run without files by the package in a folder, and what it says."""
    kept = {name: value for name, value in os.environ.items() if name not in ("HOME", "XDG_CACHE_HOME")}
    environment = kept | {
        "PYTHONPATH": str(package),
        "NUMBA_CACHE_DIR": str(cache),
        "OPENBLAS_NUM_THREADS": "1",
    }
    command = [sys.executable, "-m", "flexmb_cli", "run", "-v", "--no-out", "--no-h5", str(deck)]
    before = resource.getrusage(resource.RUSAGE_CHILDREN).ru_utime
    done = subprocess.run(
        command, cwd=deck.parent, env=environment, check=True, stderr=subprocess.PIPE, text=True
    )
    return resource.getrusage(resource.RUSAGE_CHILDREN).ru_utime - before, done.stderr


def microseconds_each(case: Case, decks: list[Path], package: Path, cache: Path) -> float:
    """Return the time of one row, evaluation or step, µs."""
    spent, counts = [], []
    for deck in decks:
        seconds, said = processor_seconds(package, deck, cache)
        spent.append(seconds)
        found = re.search(rf"(\d+) {case.counted}|{case.counted} (\d+)", said)
        counts.append(int(found[1] or found[2]))
    return (spent[1] - spent[0]) / (counts[1] - counts[0]) * 1e6


def short_and_long(case: Case, folder: Path) -> list[Path]:
    """Write the two decks of a case beside the files that they read."""
    source = TOP / "decks" / case.deck
    text, made = source.read_text(encoding="utf-8"), []
    for name, new in (("short", case.short), ("long", case.long)):
        if text.count(case.text) != 1:
            sys.exit(f"{source}: {case.text!r} is not there once")
        made.append(folder / f"{name}_{source.name}")
        made[-1].write_text(text.replace(case.text, new), encoding="utf-8")
    if not (folder / "fe").exists():
        (folder / "fe").symlink_to(TOP / "decks" / "vsdf" / "fe")
    return made


def compare(case: Case, packages: dict[Path, Path], folder: Path, pairs: int) -> str:
    """Return a line of the table; the packages are taken in turn."""
    decks = short_and_long(case, folder)
    for package, cache in packages.items():
        processor_seconds(package, decks[0], cache)  # compiles
    found = [
        [microseconds_each(case, decks, package, cache) for package, cache in packages.items()]
        for _ in range(pairs)
    ]
    now, before = (statistics.median(column) for column in zip(*found, strict=True))
    ratio = statistics.median(then / today for today, then in found)
    return f"{case.deck:29} {case.counted:12} {before:9.3f} {now:9.3f} {ratio:7.2f}"


def take_out(commit: str, folder: Path) -> None:
    """Write the package of a commit into a folder."""
    folder.mkdir(parents=True)
    command = ["git", "-C", str(TOP), "archive", commit, "flexmb_cli"]
    archive = subprocess.run(command, check=True, stdout=subprocess.PIPE).stdout
    subprocess.run(["tar", "-x", "-C", str(folder)], input=archive, check=True)


def main() -> None:
    """Print one line for each case."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("commit")
    parser.add_argument("--pairs", type=int, default=5)
    parser.add_argument("--keep", type=Path, help="a folder for what is compiled, for later calls")
    asked = parser.parse_args()
    with tempfile.TemporaryDirectory(prefix="flexmb-earlier-") as name:
        folder, kept = Path(name), (asked.keep or Path(name)).absolute()
        earlier = kept / asked.commit
        if not earlier.exists():
            take_out(asked.commit, earlier)
        packages = {TOP: kept / "cache-now", earlier: kept / "cache-earlier"}
        print("deck                          counted      µs before    µs now  faster", flush=True)
        for case in CASES:
            print(compare(case, packages, folder, asked.pairs), flush=True)


if __name__ == "__main__":
    main()
