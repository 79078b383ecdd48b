"""Answers damaged inputs of one kind, one after the other, under limits of memory and time.

worker.py KIND SEED FIRST COUNT FOLDER seeds      fills FOLDER/seeds/KIND
worker.py KIND SEED FIRST COUNT FOLDER            prints a line for every input and waits for one
"""

import json
import random
import shutil
import sys
from pathlib import Path

from answer import without_surroundings
from kinds import KINDS
from limits import limit_memory, outcome


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
        record = outcome(kind, random.Random(f"{seed}/{name}/{number}"), seeds, work)
        print(json.dumps(record), flush=True)
        sys.stdin.readline()
        if not limited:
            # The first input has loaded the libraries.
            limit_memory()
            limited = True


if __name__ == "__main__":
    main()
