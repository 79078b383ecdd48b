"""Damage what flexmb reads at random, and see that it answers each input, fast and in words.

Example: scripts/fuzz/run --count 1000 --seed 1 --keep found
Kinds are decks of three dialects, finite-element files, results, listings, studies, drafts, journals and
caches; with --kind only those named.  An input is answered when the exit code is 0, 1 or 2 with a message and
without a traceback, within 2 s of processor time and within bounds of memory.  Exit 1 when any is not; those
are kept in the folder of --keep, each with the reason.
"""

import argparse
import json
import os
import re
import select
import shutil
import subprocess
import sys
import tempfile
from collections import Counter
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass, field
from pathlib import Path

from kinds import KINDS

HERE = Path(__file__).parent
PATIENCE = 60.0  # s by the clock: a worker that waits for something takes no time of the processor
BATCH = 2000  # inputs of one process
KEPT_OF_A_SORT = 3


@dataclass
class Tally:
    """What became of the inputs of a kind: exit codes, faults by their sort, slowest answer."""

    codes: Counter = field(default_factory=Counter)
    faults: Counter = field(default_factory=Counter)
    slowest: float = 0.0


def main() -> int:
    options = _options()
    wanted = options.kind or list(KINDS)
    with tempfile.TemporaryDirectory(prefix="fuzz-") as folder, ThreadPoolExecutor(options.jobs) as pool:
        hunts = [_Hunt(name, options, Path(folder)) for name in wanted]
        tallies = list(pool.map(_Hunt.run, hunts))
    print(f"{'kind':20} {'inputs':>7} {'exit 0':>7} {'1':>6} {'2':>7} {'slowest':>9} {'faults':>7}")
    for name, tally in zip(wanted, tallies, strict=True):
        counts = [tally.codes[code] for code in (0, 1, 2)]
        line = f"{name:20} {sum(tally.codes.values()):7} {counts[0]:7} {counts[1]:6} {counts[2]:7}"
        print(f"{line} {tally.slowest:7.2f} s {sum(tally.faults.values()):7}")
        for sort, count in tally.faults.most_common():
            print(f"    {count:6} {sort}")
    total = sum(sum(tally.codes.values()) for tally in tallies)
    wrong = sum(sum(tally.faults.values()) for tally in tallies)
    print(f"{total} inputs, {wrong} not answered as they should be")
    return 1 if wrong else 0


def _options():
    parser = argparse.ArgumentParser(description=__doc__.partition("\n")[0])
    parser.add_argument("--count", type=int, default=1000, help="inputs of each kind")
    parser.add_argument("--first", type=int, default=0, help="number of the first")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--kind", action="append", choices=list(KINDS))
    parser.add_argument("--keep", type=Path, metavar="FOLDER", help="where inputs that are not answered go")
    parser.add_argument("-j", "--jobs", type=int, default=1, help="kinds at once")
    return parser.parse_args()


class _Hunt:
    """All inputs of one kind, in child processes that may crash."""

    def __init__(self, name, options, folder):
        self.name, self.options, self.folder = name, options, folder
        self.tally = Tally()

    def run(self) -> Tally:
        subprocess.run([*self._command(0, 0), "seeds"], check=True)
        at, end = self.options.first, self.options.first + self.options.count
        while at < end:
            at = self._batch(at, min(BATCH, end - at))
        return self.tally

    def _command(self, first, count):
        words = (self.name, self.options.seed, first, count, self.folder)
        return [sys.executable, str(HERE / "worker.py"), *map(str, words)]

    def _batch(self, first, count):
        """One process; the number of the input that comes next."""
        at = first
        pipes = {"stdin": subprocess.PIPE, "stdout": subprocess.PIPE}
        with subprocess.Popen(self._command(first, count), bufsize=0, **pipes) as child:
            while record := _next_record(child):
                self._note(at, record)
                at += 1
                # The worker waits: until then its files can be kept.
                child.stdin.write(b"\n")
            child.kill()
            code = child.wait()
        if at < first + count:
            self._note(
                at, {"code": None, "fault": f"the process ended with {code}", "took": 0.0, "errors": ""}
            )
            at += 1
        return at

    def _note(self, number, record):
        self.tally.codes[record["code"]] += 1
        self.tally.slowest = max(self.tally.slowest, record["took"])
        if record["fault"]:
            sort = _sort(record["fault"])
            self.tally.faults[sort] += 1
            if self.options.keep and self.tally.faults[sort] <= KEPT_OF_A_SORT:
                self._keep(number, record)

    def _keep(self, number, record):
        place = self.options.keep / f"{self.name}-{self.options.seed}-{number}"
        shutil.rmtree(place, ignore_errors=True)
        shutil.copytree(self.folder / f"work-{self.name}", place)
        (place / "why.txt").write_text(f"{record['fault']}\n\n{record['errors']}\n", encoding="utf-8")


def _next_record(child):
    """The next line of a worker; nothing when it has ended, or waits for something."""
    line = b""
    while not line.endswith(b"\n"):
        ready, _, _ = select.select([child.stdout], [], [], PATIENCE)
        piece = os.read(child.stdout.fileno(), 65536) if ready else b""
        if not piece:
            return None
        line += piece
    return json.loads(line)


def _sort(fault):
    """Faults of one cause: the exception and the last place in flexmb, or the sentence without numbers."""
    lines = fault.strip().splitlines()
    places = re.findall(r'flexmb_cli/(\S+)", line (\d+)', fault)
    words = re.sub(r"[0-9.]+", "#", lines[-1])[:100]
    return f"{words} at {':'.join(places[-1])}" if places else words


if __name__ == "__main__":
    sys.exit(main())
