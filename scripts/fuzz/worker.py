"""Answers damaged inputs of one kind, one after the other, under limits of memory and time.

worker.py KIND SEED FIRST COUNT FOLDER seeds      fills FOLDER/seeds/KIND
worker.py KIND SEED FIRST COUNT FOLDER            prints a line for every input and waits for one
"""

import json
import random
import resource
import shutil
import signal
import sys
import time
from pathlib import Path

from answer import without_surroundings
from kinds import KINDS

# More than a file of a megabyte may ask for, above what the libraries themselves take.
MEMORY = 768 * 2**20
GROWTH = 256 * 2**20
HOPELESS = 10.0


def main() -> None:
    name, seed, first, count, folder, *wish = sys.argv[1:]
    kind, folder = KINDS[name], Path(folder)
    without_surroundings()
    seeds = folder / "seeds" / name
    if wish:
        seeds.mkdir(parents=True)
        kind.seeds(seeds)
        return
    limited = False
    for number in range(int(first), int(first) + int(count)):
        work = folder / f"work-{name}"
        shutil.rmtree(work, ignore_errors=True)
        work.mkdir()
        record = _outcome(kind, f"{seed}/{name}/{number}", seeds, work)
        print(json.dumps(record), flush=True)
        sys.stdin.readline()
        if not limited:
            # The first input has loaded the libraries.
            _limit_memory()
            limited = True


def _outcome(kind, seed, seeds, work):
    before, start = _peak(), time.process_time()
    # Time of the processor, not of the clock: the machine may be busy.
    signal.setitimer(signal.ITIMER_PROF, HOPELESS)
    answer = kind.attempt(random.Random(seed), seeds, work)
    signal.setitimer(signal.ITIMER_PROF, 0)
    took, grown = time.process_time() - start, _peak() - before
    fault = answer.fault
    if not fault and took > kind.slow:
        fault = f"slow: {took:.1f} s"
    if not fault and grown > GROWTH:
        fault = f"memory: {grown / 2**20:.0f} MB"
    return {"code": answer.code, "fault": fault, "took": took, "errors": answer.errors[-500:]}


def _peak():
    return 1024 * resource.getrusage(resource.RUSAGE_SELF).ru_maxrss


def _limit_memory():
    taken = int(Path("/proc/self/statm").read_text().split()[0]) * resource.getpagesize()
    resource.setrlimit(resource.RLIMIT_AS, (taken + MEMORY, taken + MEMORY))


if __name__ == "__main__":
    main()
