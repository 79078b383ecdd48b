"""Wrong printed digits of the supplied decks whose steps are chosen by a tolerance, and what right ones cost.

Example: scripts/bench/run printed_digits --deck two_link_n2 IN-BRICARD

A printed number is wrong that is more than one unit of its last digit off that of a run to 1e-13.  Formats
with exponents print all digits of numbers that are zero but for round-off: one that is off by no more than
1e-14 of the largest number of its kind (positions, velocities, ...) is right.

The cost is the time of a run over that of one to 1e-9, the tolerance of all dialects before.  `--tolerance`
takes another one than the deck's.
"""

import argparse
import re
import shutil
import tempfile
import time
from pathlib import Path

import numpy as np

from flexmb_cli.deck.text import read_text
from flexmb_cli.dialects.dafms.reader import read_dafms
from flexmb_cli.results.diff.compare import compare
from flexmb_cli.results.diff.listings import read_listing
from flexmb_cli.results.diff.tolerances import Tolerance, Tolerances
from flexmb_cli.run.outcome import RunOptions
from flexmb_cli.run.solution import run_deck

DECKS = Path(__file__).parents[2] / "decks"
REFERENCE, BEFORE = 1e-13, 1e-9
ROUND_OFF = 1e-14  # of the largest number of a kind


def chosen() -> list[Path]:
    """The supplied decks whose steps a tolerance chooses, all dialects."""
    young = [path for path in sorted((DECKS / "young/dynamics").glob("*.dat")) if _is_forward(path)]
    vsdf = [path for path in sorted((DECKS / "vsdf").glob("*.vsdf")) if _method(path)]
    return [*young, *vsdf, *sorted((DECKS / "dafms").glob("*.DAT"))]


def _is_forward(path):
    text = path.read_text()
    return "DYNAMICS forward" in text and "GALF" not in text


def _method(path):
    return re.search(r"^ (RK45|RAD5)", path.read_text(), re.MULTILINE)


def prepared(deck: Path, folder: Path, tolerance: float | None) -> tuple[Path, dict]:
    """The deck in a folder, to be run to `tolerance` (None: its own), and options of the run."""
    text, options = deck.read_text(), {}
    if deck.suffix == ".DAT" and tolerance is not None:
        options = {"integration": {"rtol": tolerance, "atol": tolerance * _of_atol(deck, tolerance)}}
    elif deck.suffix == ".vsdf" and tolerance is not None:
        text = re.sub(r"^ (RK45|RAD5).*$", rf" \1{tolerance:10.0E}", text, flags=re.MULTILINE)
    elif tolerance is not None:
        text = re.sub(r"^TOLERANCE.*\n", "", text, flags=re.MULTILINE)
        text = text.replace("\nEND", f"\nTOLERANCE {tolerance:g}\nEND")
    folder.mkdir()
    (folder / "fe").symlink_to(DECKS / "vsdf/fe")
    path = folder / deck.name
    path.write_text(text)
    return path, options


def _of_atol(deck, tolerance):
    """Absolute tolerances of a reference are those of coordinates of 1e-3 and less."""
    stiff = bool(read_dafms(read_text(str(deck))).section("method"))
    return 1.0 if tolerance == BEFORE or stiff else 1e-3


def results(deck: Path, folder: Path, tolerance: float | None) -> tuple[list[Path], float]:
    """The printed files of a run, and its time, s."""
    path, options = prepared(deck, folder, tolerance)
    begin = time.process_time()
    outcome = run_deck(str(path), RunOptions(folder=str(folder / "out"), no_h5=True, **options))
    spent = time.process_time() - begin
    if outcome.exit_code:
        raise SystemExit(f"{deck.name} to {tolerance}: {outcome.faults[-1]}")
    return [Path(name) for name in outcome.files], spent


def wrong_digits(ours: list[Path], exact: list[Path]) -> tuple[int, int, str]:
    """How many printed numbers are wrong, of how many, and the worst of them."""
    wrong = compared = 0
    worst = None
    for a, b in zip(ours, exact, strict=True):
        report = compare(a, b, tolerances_of(b))
        wrong, compared = wrong + report.differing, compared + report.compared
        if report.worst and (worst is None or report.worst.distance > worst.distance):
            worst = report.worst
    return wrong, compared, "" if worst is None else f"{worst.a} for {worst.b}"


def tolerances_of(exact: Path) -> Tolerances:
    """One unit of the last digit, or round-off of the largest number of a kind in `exact`."""
    largest: dict[str, float] = {}
    for section in read_listing(exact).sections.values():
        for kind, column in zip(section.kinds, section.values.T, strict=True):
            largest[kind] = max(largest.get(kind, 0.0), float(np.nanmax(np.abs(column), initial=0.0)))
    kinds = {kind: Tolerance(ROUND_OFF * size, 0.0, 1) for kind, size in largest.items()}
    # The echo has the tolerance itself.
    return Tolerances(last_digit=1, kinds={**kinds, "echo": Tolerance(np.inf)})


def main():
    """Print a row for every deck."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawTextHelpFormatter)
    parser.add_argument("--deck", nargs="+", help="stems of decks; all where none is named")
    parser.add_argument("--tolerance", type=float, help="in place of the decks' own")
    given = parser.parse_args()
    print("deck                    wrong       of   time    to 1e-9  cost  worst")
    for deck in chosen():
        if given.deck and deck.stem not in given.deck:
            continue
        folder = Path(tempfile.mkdtemp())
        try:
            results(deck, folder / "warm", None)
            ours, spent = results(deck, folder / "ours", given.tolerance)
            exact, _ = results(deck, folder / "exact", REFERENCE)
            _, before = results(deck, folder / "before", BEFORE)
            wrong, compared, worst = wrong_digits(ours, exact)
        finally:
            shutil.rmtree(folder)
        print(
            f"{deck.stem:20} {wrong:8d} {compared:8d} {spent:6.2f} s {before:6.2f} s {spent / before:5.2f}  "
            f"{worst}",
            flush=True,
        )


if __name__ == "__main__":
    main()
