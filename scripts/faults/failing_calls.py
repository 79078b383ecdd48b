"""Makes each system call of a command fail in its turn: call 1, 2, 3 … with ENOSPC, EIO, EMFILE, EACCES.

Example: scripts/inject_faults calls --commands "run young" --seed 1

Tried are all calls about files in the command's folder and the deck.  The rules are those of the other faults
(judge.py); given again, without a failure, the command must end with the bytes of an undisturbed one.
Needs strace.
"""

import argparse
import random
import shutil
import sys
import tempfile
import time
from collections import Counter
from pathlib import Path

from .child import Hit
from .judge import faults_of_end, faults_of_files, faults_of_finish
from .stage import Stage
from .traced import ANY_FILE, concerned, is_here, recorded, tracer
from .traced_commands import is_left_by_stop, prepared, traced_commands

ERRORS = ("ENOSPC", "EIO", "EMFILE", "EACCES")
# Where a file cannot be removed it stays; the next command that writes the same output clears up.
KEEPS = ("unlink", "rmdir", "getdents64")


def main(arguments) -> int:
    options = _options(arguments)
    if not is_here():
        print("strace is not installed, or may not trace here", file=sys.stderr)
        return 2
    top = Path(tempfile.mkdtemp(prefix="calls-"))
    stage = Stage(top, set(options.commands))
    print(f"{'command':28}{'calls':>7}{'failures':>10}{'exit 0':>8}{'1':>6}{'2':>6}{'wrong':>7}")
    wrong = 0
    for command, with_old in traced_commands(stage, top, options.commands):
        if not with_old and not _goes_on(command):  # then a lost file would not be seen
            continue
        wrong += _campaign(command, with_old, top / f"{command.name}", options)
    if wrong:
        print(f"what was left is in {top}", file=sys.stderr)
        return 1
    shutil.rmtree(top)
    return 0


def _options(arguments):
    parser = argparse.ArgumentParser(description=__doc__.partition("\n")[0])
    parser.add_argument("--commands", nargs="*", default=[], help="of the stage, these alone")
    parser.add_argument("--most", type=int, help="failures of a command, chosen at random  [default: all]")
    parser.add_argument("--once", action="store_true", help="one error a call, the four in turn")
    parser.add_argument("--seed", type=int, default=1)
    return parser.parse_args(arguments)


def _campaign(command, with_old, top, options) -> int:
    start = time.monotonic()
    prepared(command, top / "w", with_old)
    log = top / "log"
    ended = command.run(top / "w", Hit(begin=tracer(log, "-e", f"trace={ANY_FILE}")))
    calls = concerned(recorded(log), top / "w")
    if ended.code or not calls:
        print(f"{command.name}: not recorded: exit {ended.code}, {ended.stderr[-300:]}")
        return 1
    chosen = _chosen(calls, options)
    counts, wrong = Counter(), 0
    for number, (call, error) in enumerate(chosen):
        found, code = _one(command, with_old, top / f"{number}" / "w", call, error)
        counts[code] += 1
        wrong += bool(found)
        if found:
            place = f"{command.name}, {call.name} {call.at} ({_short(call)}), {error}: {top / str(number)}"
            print("\n    ".join([place, *found]), file=sys.stderr, flush=True)
        else:
            shutil.rmtree(top / f"{number}")
    print(f"{command.name:28}{len(calls):7}{len(chosen):10}{counts[0]:8}{counts[1]:6}{counts[2]:6}{wrong:7}"
          f"  {time.monotonic() - start:.0f} s", flush=True)  # fmt: skip
    return wrong


def _chosen(calls, options):
    pairs = [(call, error) for call in calls for error in ERRORS]
    if options.once:
        pairs = [(call, ERRORS[(number + options.seed) % 4]) for number, call in enumerate(calls)]
    return (
        pairs
        if options.most is None
        else random.Random(options.seed).sample(pairs, min(options.most, len(pairs)))
    )


def _short(call):
    return ", ".join(Path(path).name for path in call.paths)[:80]


def _goes_on(command):
    return any(is_left_by_stop(name) for name in command.inputs)


def _one(command, with_old, folder, call, error):
    before = prepared(command, folder, with_old)
    # What a stopped command left is used up, or stays until it is.
    before = {name: content for name, content in before.items() if not is_left_by_stop(name)}
    options = ("-e", f"trace={call.name}", "-e", f"inject={call.name}:error={error}:when={call.at}")
    ended = command.run(folder, Hit(begin=tracer(folder.parent / "log", *options)))
    if "(INJECTED)" not in _reported(folder.parent / "log"):
        return [f"{call.name} {call.at} did not come"], ended.code
    found = faults_of_end(ended, {0, 1, 2}) + faults_of_files(command, folder, before, ended)
    if call.name in KEEPS:
        found = [fault for fault in found if "was left behind" not in fault]
    again = command.run_other((*command.arguments, *command.again), folder)
    return found + faults_of_finish(command, folder, before, again), ended.code


def _reported(log):
    recorded(log)
    return log.read_text(errors="replace")
