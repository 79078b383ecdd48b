"""Run the beginning of every shipped deck with compiled and interpreted kernels, and compare the results.

Example: scripts/determinism/run interpreted --rows 4
Of every dataset the largest difference is taken as a share of its largest value, of reactions and energies of
the largest of their group: torques of a planar mechanism are round-off.  Exit 1 beyond TOLERANCE.  Sines and
powers of a compiled kernel may differ in their last digit, and with them the steps of an integration.
"""

import argparse
import sys
import tempfile
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import h5py
import numpy as np
from shipped import KINDS, flexmb, shipped

from flexmb_cli.deck.text import read_text
from flexmb_cli.dialects.recognise import read_deck
from flexmb_cli.dialects.settings import apply_settings

TOLERANCE = 1e-9
# How well the equations are met is round-off itself.
NOT_COMPARED = ("audit/",)
MEASURED_AS_ONE = ("reaction", "energy")


def shortened(path: Path, rows: int) -> str:
    """The `--set` that leaves the first `rows` times of the deck."""
    deck = read_deck(read_text(str(path)))
    time = {n.key: n.value for record in deck.records if record.section == "time" for n in record.numbers}
    if deck.dialect == "dafms":
        change = f"time.IT={min(int(time['IT']), rows - 1)}"
    else:
        start, step = time.get("start", 0.0), time.get("step" if deck.dialect == "young" else "output")
        change = f"time.end={min(float(time['end']), float(start) + (rows - 1) * float(step))!r}"
    apply_settings(deck, [change])
    return change


def results(kind: str, rows: int, folder: Path, interpreted: bool) -> Path:
    """Results of the decks of a kind, each in a fresh process."""
    environment = {"NUMBA_DISABLE_JIT": str(int(interpreted))}
    for deck in shipped(kind):
        settings = ("--set", shortened(deck, rows), "--no-out", "--h5", folder / f"{deck.stem}.h5")
        flexmb("run", "-q", deck, *settings, cwd=folder, environment=environment)
    return folder


def numbers(path: Path) -> dict[str, np.ndarray]:
    """Datasets of real numbers by name."""
    found = {}

    def keep(name, item):
        if isinstance(item, h5py.Dataset) and item.dtype.kind == "f" and not name.startswith(NOT_COMPARED):
            found[name] = item[:]

    with h5py.File(path) as file:
        file.visititems(keep)
    return found


def sizes(results: dict[str, np.ndarray]) -> dict[str, float]:
    """The largest value of every dataset, or of its group."""
    own = {name: float(np.nanmax(np.abs(values), initial=0.0)) for name, values in results.items()}

    def size(name):
        group = name.partition("/")[0]
        if group not in MEASURED_AS_ONE:
            return own[name]
        return max(value for other, value in own.items() if other.startswith(f"{group}/"))

    return {name: size(name) for name in own}


def share(a: np.ndarray, b: np.ndarray, size: float) -> float:
    """Largest difference as a share of `size`; infinite where the shapes or the gaps differ."""
    if a.shape != b.shape or not np.array_equal(np.isnan(a), np.isnan(b)):
        return np.inf
    difference = float(np.nanmax(np.abs(a - b), initial=0.0))
    return difference / size if size else difference


def worst(one: Path, other: Path) -> tuple[float, str]:
    """The largest share of two results, and its dataset."""
    a, b = numbers(one), numbers(other)
    if a.keys() != b.keys():
        return np.inf, "names of datasets"
    size = sizes(a)
    return max((share(a[name], b[name], size[name]), name) for name in a)


def compared(kind: str, rows: int) -> list[tuple[float, str, str]]:
    """(share, dataset, deck) of the decks of a kind."""
    with tempfile.TemporaryDirectory(prefix="flexmb-jit-") as name, ThreadPoolExecutor(2) as pool:
        folders = [Path(name) / kind for kind in ("compiled", "interpreted")]
        for folder in folders:
            folder.mkdir()
        jobs = [pool.submit(results, kind, rows, folder, k == 1) for k, folder in enumerate(folders)]
        one, other = (job.result() for job in jobs)
        return [(*worst(path, other / path.name), path.stem) for path in sorted(one.glob("*.h5"))]


def main():
    """Print a line a deck."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--rows", type=int, default=4, help="times of every deck (4)")
    parser.add_argument("--kinds", nargs="+", default=list(KINDS), choices=list(KINDS))
    asked = parser.parse_args()
    found = []
    for kind in asked.kinds:
        for part, dataset, deck in compared(kind, asked.rows):
            print(f"{part:9.1e}  {kind}/{deck}: {dataset}", flush=True)
            found.append(part)
    equal = sum(part == 0 for part in found)
    print(f"{len(found)} decks, {equal} equal to the bit; largest share {max(found):.1e} of {TOLERANCE:.0e}")
    sys.exit(0 if max(found) <= TOLERANCE else 1)


if __name__ == "__main__":
    main()
