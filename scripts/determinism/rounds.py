"""Run every shipped deck, and a study, again and again in changed surroundings, and compare the bytes.

Example: scripts/determinism/run rounds --count 20
What changes from round to round: the folder and how the decks are named, their order, runs alone or
two at once, the hash seed, the time zone, the language, threads of the linear algebra, and whether
flexible bodies are reduced anew or taken from the cache.  Exit 1 when a byte differs.
"""

import argparse
import os
import random
import shutil
import sys
import tempfile
from dataclasses import dataclass
from pathlib import Path

from shipped import DECKS, KINDS, Written, flexmb, shipped, written

ZONES = ["UTC", "Asia/Kathmandu", "America/St_Johns", "Pacific/Kiritimati"]
LANGUAGES = ["C", "C.UTF-8", "de_DE.UTF-8", "tr_TR.UTF-8"]
STUDY = """
deck = "{deck}"
sampling = "latin-hypercube"
count = 200
seed = 7
[parameters]
"driver.1.B" = {{ from = 100.0, to = 200.0 }}
"point.1.x" = {{ from = 0.001, to = 1.0, scale = "log" }}
[results]
mean = "mean point.1.z"
path = "series point.1.y"
"""


@dataclass(frozen=True)
class Surroundings:
    """What is different in a round."""

    number: int

    def environment(self, scratch: Path) -> dict[str, str]:
        """Variables of the environment; `scratch` is the folder of the round."""
        k = self.number
        threads = str(1 + k % 2)
        fresh = {"FLEXMB_CACHE_DIR": str(scratch / "bodies")} if k % 4 < 2 else {}
        return {
            "PYTHONHASHSEED": str(1000 * k + 1),
            "TZ": ZONES[k % 4],
            "LC_ALL": LANGUAGES[k // 2 % 4],
            "OMP_NUM_THREADS": threads,
            "OPENBLAS_NUM_THREADS": threads,
            "LINES": str(20 + k),
            **fresh,
        }

    @property
    def jobs(self) -> int:
        """Processes at once."""
        return 1 + self.number // 2 % 2

    def decks(self, kind: str, scratch: Path) -> list[Path | str]:
        """The decks in another order; by their own paths, by relative ones, or copied elsewhere."""
        folder = DECKS
        if self.number % 3 == 2:
            folder = scratch / "a copy"
            shutil.copytree(DECKS, folder, dirs_exist_ok=True)
        found = shipped(kind, folder)
        random.Random(self.number).shuffle(found)
        return [os.path.relpath(path, scratch) for path in found] if self.number % 3 == 1 else found


def one_round(number: int, kinds) -> dict[str, Written]:
    """Files of a round by their names."""
    round_ = Surroundings(number)
    with tempfile.TemporaryDirectory(prefix="flexmb-round-") as name:
        scratch = Path(name).resolve()
        environment = round_.environment(scratch)
        for kind in kinds:
            folder = scratch / "results" / kind
            decks = round_.decks(kind, scratch)
            flexmb("run", "-q", "-j", round_.jobs, "-o", folder, *decks, cwd=scratch, environment=environment)
        (scratch / "study.toml").write_text(STUDY.format(deck=DECKS / "young/IN-RSSR.dat"))
        for study in (DECKS / "studies/rssr.toml", scratch / "study.toml"):
            table = scratch / "results" / "studies" / f"{study.stem}.h5"
            table.parent.mkdir(parents=True, exist_ok=True)
            arguments = ("sweep", study, "-q", "-j", 1 + number % 2, "-o", table)
            flexmb(*arguments, cwd=scratch, environment=environment)
        return written(scratch / "results")


def differences(first: dict[str, Written], other: dict[str, Written]) -> list[str]:
    """Names of files that are not the same in both."""
    return sorted(name for name in first.keys() | other.keys() if first.get(name) != other.get(name))


def main():
    """Print a line a round and the counts."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--count", type=int, default=20, help="rounds (20)")
    parser.add_argument("--kinds", nargs="+", default=list(KINDS), choices=list(KINDS))
    asked = parser.parse_args()
    first, different, files, size = {}, 0, 0, 0
    for number in range(asked.count):
        found = one_round(number, asked.kinds)
        first = first or found
        names = differences(first, found)
        different += len(names)
        files += len(found)
        size += sum(file.size for file in found.values())
        print(f"round {number + 1}: {len(found)} files, different: {' '.join(names) or 'none'}", flush=True)
    decks = sum(len(shipped(kind)) for kind in asked.kinds)
    print(f"{asked.count} rounds of {decks} decks and 2 studies: {files} files, {size} bytes")
    print(f"{different} files differ from those of the first round")
    sys.exit(1 if different else 0)


if __name__ == "__main__":
    main()
