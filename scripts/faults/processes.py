"""Stop, kill and starve commands of several processes (`run -j`, `sweep -j`), and look at what they leave.

Example: .venv/bin/python scripts/faults/processes.py --count 60 --seed 1
A rule is broken where a command does not end or leaves processes, prints a traceback, lacks the record of a
deck or of the study, or ends with another exit code than its records; where a deck called complete has other
files than an undisturbed run; where a study does not go on to the same table; and where a temporary file
stays though nobody was killed.  Exit 1 if so.
"""

import argparse
import json
import os
import random
import resource
import shutil
import signal
import subprocess
import sys
import tempfile
import time
from collections import Counter
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path

DECKS = Path(__file__).parents[2] / "decks"
NAMES = ("IN1-1-1", "IN1-2-1", "IN1-3-1", "IN1-4-1", "IN2-1-1", "IN2-6-1", "IN4-BAR", "IN5BODY", "IN-RSSR")
SIGNALS = (signal.SIGINT, signal.SIGTERM, signal.SIGHUP)
STUDY = """
deck = "IN-RSSR.dat"
[parameters]
"driver.1.B" = { from = 100.0, to = 200.0, count = 400 }
[results]
highest = "max point.1.z"
"""
TROUBLES = ("signals", "kills", "files", "memory")
# s: a command that has not ended hangs; of what it leaves, the last ends a little later.
HANGS, LEAVES = 120.0, 5.0


@dataclass
class Ended:
    """How a command ended."""

    code: int
    printed: str
    said: str
    hung: bool
    left: bool


def main() -> int:
    """Count what became of commands in trouble."""
    parser = argparse.ArgumentParser(description=__doc__.partition("\n")[0])
    parser.add_argument("--count", type=int, default=60)
    parser.add_argument("--seed", type=int, default=1)
    options = parser.parse_args()
    counts, wrong = Counter(), 0
    with tempfile.TemporaryDirectory() as folder:
        place = Place(Path(folder))
        for number in range(options.seed, options.seed + options.count):
            chance = random.Random(number)
            command, trouble = chance.choice(("run", "sweep")), chance.choice(TROUBLES)
            counts[command, trouble] += 1
            for rule in place.tried(command, trouble, chance):
                wrong += 1
                print(f"{command}, {trouble}: {rule} (--seed {number} --count 1)", flush=True)
    for (command, trouble), count in sorted(counts.items()):
        print(f"{count:5} {command}, {trouble}")
    print(f"{sum(counts.values())} commands, {wrong} rules broken")
    return 1 if wrong else 0


class Place:
    """Decks and a study in a folder, with what an undisturbed run makes of them."""

    def __init__(self, folder: Path):
        self.folder, self.work, self.whole = folder, folder / "work", folder / "whole"
        self.whole.mkdir()
        for name in NAMES:
            shutil.copy(DECKS / f"young/{name}.dat", folder)
        tree = (DECKS / "dafms/pendulum.DAT").read_text()
        (folder / "pendulum.DAT").write_text(tree.replace("\n 6000\n", "\n 9000\n"))
        (folder / "study.toml").write_text(STUDY)
        self.decks = [str(folder / f"{name}.dat") for name in NAMES]
        self.decks.insert(2, str(folder / "pendulum.DAT"))
        for command in ("run", "sweep"):
            ended = watched(self.arguments(command, self.whole, 1))
            if ended.code:
                sys.exit(f"without trouble {command} ended with {ended.code}: {ended.said}")

    def arguments(self, command: str, folder: Path, jobs: int) -> list[str]:
        """A command whose results go into `folder`."""
        end = ["-j", str(jobs), "--json", "-q", "-o"]
        if command == "run":
            return ["run", *self.decks, *end, str(folder)]
        return ["sweep", str(self.folder / "study.toml"), *end, str(folder / "table.h5")]

    def tried(self, command: str, trouble: str, chance: random.Random) -> list[str]:
        """Rules that a command in trouble breaks."""
        shutil.rmtree(self.work, ignore_errors=True)
        self.work.mkdir()
        arguments = self.arguments(command, self.work, chance.randint(2, 6))
        ended = watched(arguments, in_trouble(trouble, chance), limit(trouble, chance))
        broken = [
            *reported(ended),
            *(self._runs(ended) if command == "run" else self._sweep(ended, arguments)),
        ]
        if trouble != "kills" and any(self.work.rglob("*.tmp")):
            broken.append("a temporary file stays")
        return broken

    def _runs(self, ended):
        records = records_of(ended)
        if len(records) == 1 and "deck" not in records[0]:
            return [] if records[0]["exit_code"] == ended.code != 0 else ["no deck has its record"]
        if sorted(record["deck"] for record in records) != sorted(self.decks):
            return [f"{len(records)} records of {len(self.decks)} decks"]
        broken = []
        if max(record["exit_code"] for record in records) != ended.code:
            broken.append("the exit code is not the largest of the records")
        for file in (Path(file) for r in records if r["exit_code"] == 0 for file in r["files"]):
            if file.read_bytes() != (self.whole / file.name).read_bytes():
                broken.append(f"{file.name} is another than without trouble")
        return broken

    def _sweep(self, ended, arguments):
        records = records_of(ended)
        if [record["exit_code"] for record in records] != [ended.code]:
            return ["the study has no record, or another exit code"]
        table = self.work / "table.h5"
        if not table.exists() and (again := watched(arguments)).code:
            return [f"the study does not go on: {again.said[-200:]}"]
        same = table.read_bytes() == (self.whole / "table.h5").read_bytes()
        left = sorted(path.name for path in self.work.iterdir() if path != table)
        return [*([] if same else ["the table is another"]), *([f"{left} stay"] if left else [])]


def records_of(ended: Ended) -> list[dict]:
    """What was printed, a JSON object a line."""
    return [json.loads(line) for line in ended.printed.splitlines()]


def reported(ended: Ended) -> list[str]:
    """Rules for every command."""
    broken = {"it did not end": ended.hung, "processes are left": ended.left}
    broken["a traceback"] = "Traceback" in ended.said or "Error:" in ended.said
    broken["a signal ended it"] = ended.code < 0
    return [rule for rule, is_broken in broken.items() if is_broken]


def watched(arguments, trouble=lambda process: None, limits=lambda: None) -> Ended:
    """Run flexmb in a group of its own that hears Ctrl-C, whatever the shell behind it ignores."""

    def begin():
        signal.signal(signal.SIGINT, signal.SIG_DFL)
        limits()

    with tempfile.TemporaryFile("w+") as printed, tempfile.TemporaryFile("w+") as said:
        process = subprocess.Popen(
            [sys.executable, "-m", "flexmb_cli", *arguments], stdin=subprocess.DEVNULL,
            stdout=printed, stderr=said, start_new_session=True, preexec_fn=begin,
        )  # fmt: skip
        trouble(process)
        hung = False
        try:
            process.wait(HANGS)
        except subprocess.TimeoutExpired:
            hung = True
        left = not ends(process)
        printed.seek(0), said.seek(0)
        return Ended(process.returncode, printed.read(), said.read(), hung, left)


def ends(process) -> bool:
    """Whether the whole group ends by itself."""
    until = time.monotonic() + LEAVES
    while time.monotonic() < until:
        try:
            os.killpg(process.pid, 0)
        except ProcessLookupError:
            return True
        time.sleep(0.05)
    os.killpg(process.pid, signal.SIGKILL)
    process.wait()
    return False


def limit(trouble: str, chance: random.Random):
    """What limits the command from its beginning."""
    if trouble == "files":
        files = chance.randint(14, 40)
        return lambda: resource.setrlimit(resource.RLIMIT_NOFILE, (files, files))
    if trouble == "memory":
        size = chance.randint(80, 400) * 2**20
        return lambda: resource.setrlimit(resource.RLIMIT_AS, (size, size))
    return lambda: None


def in_trouble(trouble: str, chance: random.Random):
    """What is done to a command from when its first process is there."""
    if trouble not in ("signals", "kills"):
        return lambda process: None

    def disturb(process):
        while process.poll() is None and not workers_of(process):
            time.sleep(0.005)
        time.sleep(chance.choice((0.0, chance.uniform(0.0, 3.0))))
        for _ in range(chance.randint(1, 4)):
            with suppress(ProcessLookupError):
                (stop if trouble == "signals" else kill)(process, chance)
            time.sleep(chance.choice((0.0, 0.001, 0.02, 0.3)))

    return disturb


def stop(process, chance: random.Random) -> None:
    """A signal to the command, to its processes or to all."""
    number, whom = chance.choice(SIGNALS), chance.choice(("group", "parent", "workers"))
    if whom == "group":
        os.killpg(process.pid, number)
    elif whom == "parent":
        os.kill(process.pid, number)
    else:
        for worker in workers_of(process):
            os.kill(worker, number)


def kill(process, chance: random.Random) -> None:
    """One of the processes, as where memory is short."""
    if found := workers_of(process):
        os.kill(chance.choice(found), signal.SIGKILL)


def workers_of(process) -> list[int]:
    """Ids of the processes that solve something."""
    with suppress(OSError):
        children = Path(f"/proc/{process.pid}/task/{process.pid}/children").read_text().split()
        return [int(pid) for pid in children if b"spawn_main" in Path(f"/proc/{pid}/cmdline").read_bytes()]
    return []


if __name__ == "__main__":
    sys.exit(main())
