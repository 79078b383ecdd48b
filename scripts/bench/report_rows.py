"""Processor time of a report row: solved only, with the OUT table, with the HDF5 result, and with both.

Usage: scripts/bench/run report_rows [ROWS]   (100000 without it)
"""

import statistics
import sys
import tempfile
import time
from pathlib import Path

from flexmb_cli.run.outcome import RunOptions
from flexmb_cli.run.solution import run_deck

DECK = Path(__file__).resolve().parents[2] / "decks/young/IN-RSSR.dat"
TIMES = "0.000000119 0.04 0.0035717333"
REPEATS = 5
OUTPUTS = {
    "solved only": {"no_out": True, "no_h5": True},
    "OUT": {"no_h5": True},
    "HDF5": {"no_out": True},
    "OUT and HDF5": {},
}


def deck_of(rows: int) -> str:
    """Return the text of the deck with so many rows."""
    return DECK.read_text().replace(TIMES, f"0.000000119 0.04 {0.04 / rows!r}")


def spent(deck: str, folder: str, outputs: dict[str, bool]) -> float:
    """Processor time of a run, s."""
    start = time.process_time()
    outcome = run_deck(deck, RunOptions(folder=folder, **outputs))
    if outcome.exit_code:
        raise SystemExit(str(outcome.faults[-1]))
    return time.process_time() - start


def seconds_a_row(rows: int, repeats: int) -> dict[str, float]:
    """Return the median processor time of a row, s, of all outputs, in turn within each of some runs."""
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / DECK.name
        path.write_text(deck_of(rows))
        spent(str(path), folder, {})
        times = [[spent(str(path), folder, outputs) for outputs in OUTPUTS.values()] for _ in range(repeats)]
    medians = [statistics.median(found) / rows for found in zip(*times, strict=True)]
    return dict(zip(OUTPUTS, medians, strict=True))


def main(rows: int = 100_000) -> None:
    """Print the cost of a row by output."""
    for name, seconds in seconds_a_row(rows, REPEATS).items():
        print(f"RSSR, {rows} rows, {name:12}: {1e6 * seconds:5.1f} us a row")


if __name__ == "__main__":
    main(*map(int, sys.argv[1:]))
