"""Send SIGTERM to a run at instructions of its Python code taken at random, and look at what it leaves.

Example: .venv/bin/python scripts/faults/instructions.py decks/young/IN1-1-1.dat --seconds 60 --seed 1
A rule is broken where the signal leaves the run as an exception, where a temporary file stays, where the
files are not those told, or where the exit code and the status in the HDF5 result differ.  Exit 1 if so.
"""

import argparse
import os
import random
import signal
import sys
import tempfile
import time
from collections import Counter
from pathlib import Path

import h5py

from flexmb_cli.run.outcome import TERMINATED, RunOptions, Stop
from flexmb_cli.run.processes.signal_mask import stop_on_signals
from flexmb_cli.run.solution import run_deck

PACKAGE = str(Path(sys.modules[run_deck.__module__].__file__).parents[1])
TRACED = (
    f"{PACKAGE}/run/",
    f"{PACKAGE}/results/files/replaced_file",
    f"{PACKAGE}/results/files/temporary_file",
    f"{PACKAGE}/results/hdf5/result_file",
)


class SignalAt:
    """Traces a run and raises SIGTERM at its instruction of number `at`; counts them."""

    def __init__(self, at: int):
        self.at, self.count, self.where = at, 0, ""

    def __call__(self, frame, event, argument):
        name = frame.f_code.co_filename
        if not name.startswith(TRACED) and not name.endswith("contextlib.py"):
            return None
        frame.f_trace_opcodes, frame.f_trace_lines = True, False
        return self.step

    def step(self, frame, event, argument):
        """One instruction."""
        if event == "opcode":
            self.count += 1
            if self.count == self.at:
                self.where = f"{Path(frame.f_code.co_filename).name}:{frame.f_lineno}"
                sys.settrace(None)
                signal.raise_signal(signal.SIGTERM)
        return self.step


def traced_run(deck: str, folder: str, at: int):
    """The tracer, and the outcome of the run or the exception that left it."""
    Stop.asked, Stop.held = None, 1
    tracer = SignalAt(at)
    sys.settrace(tracer)
    try:
        return tracer, run_deck(deck, RunOptions(folder=folder))
    except BaseException as escaped:
        return tracer, escaped
    finally:
        sys.settrace(None)


def broken_rules(outcome, folder: str) -> list[str]:
    """What is wrong with the outcome of a run and the files that it left."""
    if isinstance(outcome, BaseException):
        return [f"{type(outcome).__name__} left the run"]
    names = set(os.listdir(folder))
    wrong = ["a temporary file stays"] if any(name.endswith(".tmp") for name in names) else []
    left = {name for name in names if not name.endswith((".tmp", ".resume"))}
    if left != {Path(file).name for file in outcome.files}:
        wrong.append("the files are not those told")
    if outcome.exit_code not in (0, TERMINATED):
        wrong.append(f"exit code {outcome.exit_code}")
    if outcome.rows and not left:
        wrong.append("rows are told, and none is kept")
    for name in left:
        if name.endswith(".h5"):
            with h5py.File(Path(folder) / name) as result:
                if (result.attrs["status"] == "complete") != (outcome.exit_code == 0):
                    wrong.append("exit code and status differ")
    return wrong


def main() -> int:
    """Count what became of runs until the time is over."""
    options = _options()
    stop_on_signals()
    with tempfile.TemporaryDirectory() as folder:
        traced_run(options.deck, folder, 0)  # kernels and modules are loaded
        instructions = traced_run(options.deck, folder, 0)[0].count
    places = random.Random(options.seed).sample(range(1, instructions + 1), instructions)
    ends, wrong, until = Counter(), Counter(), time.monotonic() + options.seconds
    for at in places:
        if time.monotonic() > until:
            break
        with tempfile.TemporaryDirectory() as folder:
            tracer, outcome = traced_run(options.deck, folder, at)
            broken = broken_rules(outcome, folder)
        ends["escaped" if isinstance(outcome, BaseException) else outcome.status] += 1
        wrong.update(f"{rule} ({tracer.where})" for rule in broken)
    print(f"{options.deck}: {sum(ends.values())} of {instructions} instructions: {dict(ends)}")
    for rule, count in wrong.most_common():
        print(f"{count:6} {rule}")
    return 1 if wrong else 0


def _options():
    parser = argparse.ArgumentParser(description=__doc__.partition("\n")[0])
    parser.add_argument("deck")
    parser.add_argument("--seconds", type=float, default=60.0)
    parser.add_argument("--seed", type=int, default=1)
    return parser.parse_args()


if __name__ == "__main__":
    sys.exit(main())
