"""Files made by the grammar of what flexmb reads, with hostile values: hypothesis makes and shrinks them.

Example: scripts/fuzz/run structure --count 2000 --seed 1 --keep found
Each grammar has a process of its own, `--count` files and at most `--seconds`.  The property is that of
fuzz.py: an answer, in words, in time and in memory.  Exit 1 when a file is not answered; the smallest such
file is shown, and kept in the folder of --keep.
"""

import argparse
import shutil
import subprocess
import sys
import tempfile
import time
from collections import Counter
from pathlib import Path

from hypothesis import HealthCheck, Phase, given, seed, settings
from limits import limit_memory, outcome
from structure_kinds import STRUCTURES

PHASES = (Phase.generate, Phase.shrink)
EVERY = 250  # files of one call of hypothesis, which keeps all of them in mind


def main() -> int:
    options = _options()
    if options.alone:
        return _hunt(options.kind[0], options)
    codes = []
    for name in options.kind or STRUCTURES:
        command = [sys.executable, __file__, *sys.argv[1:], "--kind", name, "--alone"]
        codes.append(subprocess.run([*command]).returncode)
        if codes[-1] not in (0, 1):
            print(f"{name:20} the process ended with {codes[-1]}")
    return 1 if any(codes) else 0


def _options():
    parser = argparse.ArgumentParser(description=__doc__.partition("\n")[0])
    parser.add_argument("--count", type=int, default=1000, help="files of each grammar")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--seconds", type=float, default=600.0, help="longest time for a grammar")
    parser.add_argument("--kind", action="append", choices=list(STRUCTURES))
    parser.add_argument("--keep", type=Path, metavar="FOLDER")
    parser.add_argument("--alone", action="store_true", help=argparse.SUPPRESS)
    options = parser.parse_args()
    options.kind = options.kind[-1:] if options.alone else options.kind
    return options


def _hunt(name, options) -> int:
    """Batches of files of one grammar until they are enough, or one is not answered."""
    tally, slowest, fault = Counter(), 0.0, ""
    end = time.monotonic() + options.seconds
    with tempfile.TemporaryDirectory(prefix="structure-") as folder:
        trial = Trial(name, Path(folder))
        for first in range(0, options.count, EVERY):
            fault = trial.batch(min(EVERY, options.count - first), options.seed + first)
            if fault or time.monotonic() > end:
                break
        tally, slowest = trial.codes, trial.slowest
        if fault and options.keep:
            shutil.copytree(trial.work, options.keep / f"structure-{name}", dirs_exist_ok=True)
    counts = " ".join(f"{tally[code]:6}" for code in (0, 1, 2))
    print(
        f"{name:20} {sum(tally.values()):7} files, exit 0 1 2: {counts}, slowest {slowest:.2f} s", flush=True
    )
    if fault:
        print(f"    {fault.strip()[-1500:]}", flush=True)
    return 1 if fault else 0


class Trial:
    """The files of one grammar, answered in this process."""

    def __init__(self, name: str, folder: Path, limited: bool = True):
        self.name, self.kind, self._limited = name, STRUCTURES[name], not limited
        self.seeds, self.work = folder / "seeds", folder / "work"
        self.seeds.mkdir()
        self.kind.seeds(self.seeds)
        self.codes: Counter = Counter()
        self.slowest = 0.0

    def batch(self, count: int, number: int) -> str:
        """The fault of the smallest file that is not answered, "" when all are."""
        reported = {}

        @seed(number)
        @settings(
            max_examples=count,
            database=None,
            deadline=None,
            suppress_health_check=list(HealthCheck),
            phases=PHASES,
            print_blob=False,
        )
        @given(self.kind.strategy)
        def answers(example):
            record = self._answer(example)
            # Faults in one place are one to hypothesis, which shrinks them to the smallest.
            reported["fault"] = record["fault"]
            assert not record["fault"]

        try:
            answers()
        except BaseException as failure:
            if isinstance(failure, KeyboardInterrupt):
                raise
            return reported.get("fault") or repr(failure)
        return ""

    def _answer(self, example):
        shutil.rmtree(self.work, ignore_errors=True)
        self.work.mkdir()
        record = outcome(self.kind, example, self.seeds, self.work)
        self.codes[record["code"]] += 1
        self.slowest = max(self.slowest, record["took"])
        if not self._limited:
            limit_memory()
            self._limited = True
        return record


if __name__ == "__main__":
    sys.exit(main())
