"""Cuts the power: rebuilds what a disk may hold after any call of a command, and judges it.

Example: scripts/inject_faults power --most 300 --seed 1

Every output must be the old file or the new one whole; and the command, given again (`--resume` for trees),
must end with the bytes of an undisturbed one, or be refused in words.  Needs strace.
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
from .disk_states import not_understood, states
from .judge import faults_of_end
from .stage import Stage
from .traced import ANY_FILE, concerned, is_here, recorded, tracer
from .traced_commands import prepared, traced_commands


def main(arguments) -> int:
    options = _options(arguments)
    if not is_here():
        print("strace is not installed, or may not trace here", file=sys.stderr)
        return 2
    top = Path(tempfile.mkdtemp(prefix="power-"))
    stage = Stage(top, set(options.commands))
    broken = 0
    print(f"{'command':28}{'calls':>7}{'states':>8}{'tried':>7}{'same bytes':>12}{'refused':>9}{'wrong':>7}")
    for command, with_old in traced_commands(stage, top, options.commands):
        broken += _campaign(command, with_old, top / f"{command.name}-{with_old}", options)
    if broken:
        print(f"what was left is in {top}", file=sys.stderr)
        return 1
    shutil.rmtree(top)
    return 0


def _options(arguments):
    parser = argparse.ArgumentParser(description=__doc__.partition("\n")[0])
    parser.add_argument("--commands", nargs="*", default=[], help="of the stage, these alone")
    parser.add_argument("--most", type=int, help="states of a command, chosen at random  [default: all]")
    parser.add_argument("--seed", type=int, default=1)
    return parser.parse_args(arguments)


def _campaign(command, with_old, top, options) -> int:
    """Every state of one command; how many are wrong."""
    folder = top / "w"
    before = prepared(command, folder, with_old)
    log = top / "log"
    start = time.monotonic()
    ended = command.run(folder, Hit(begin=tracer(log, "-e", f"trace={ANY_FILE}")))
    calls = concerned(recorded(log), folder)
    strange = not_understood(calls)
    if ended.code or strange or not calls:
        print(f"{command.name}: not recorded: exit {ended.code}, {sorted(strange)}, {ended.stderr[-300:]}")
        return 1
    found = list(states(calls, folder, before))
    chosen = found if options.most is None else _some(found, options)
    counts = Counter()
    for number, tree in chosen:
        _judge(command, before, tree, calls[number], top / "state", counts)
    name = f"{command.name}{', old' if with_old else ''}"
    print(f"{name:28}{len(calls):7}{len(found):8}{len(chosen):7}{counts['same']:12}{counts['refused']:9}"
          f"{counts['wrong']:7}  {time.monotonic() - start:.0f} s", flush=True)  # fmt: skip
    return counts["wrong"]


def _some(found, options):
    return random.Random(options.seed).sample(found, min(options.most, len(found)))


def _judge(command, before, tree, call, folder, counts):
    shutil.rmtree(folder, ignore_errors=True)
    _build(folder, tree)
    wrong = [
        f"{output} is torn" for output in command.outputs if not _is_whole(command, before, tree, output)
    ]
    ended = command.run_other((*command.arguments, *command.again), folder)
    wrong += faults_of_end(ended, {0, 2})
    if ended.code == 0:
        wrong += [f"{output}: other bytes" for output in command.outputs if _differs(command, folder, output)]
        wrong += _left(command, folder, before)
    if wrong:
        counts["wrong"] += 1
        kept = folder.with_name(f"wrong-{counts['wrong']}")
        shutil.rmtree(kept, ignore_errors=True)
        _build(kept, tree)
        print(
            f"{command.name}, behind {call.name} {call.at}: {kept}\n    " + "\n    ".join(wrong),
            file=sys.stderr,
        )
    else:
        counts["refused" if ended.code else "same"] += 1


def _build(folder, tree):
    folder.mkdir(parents=True)
    for name in tree:
        if name.endswith("/"):
            (folder / name).mkdir(parents=True, exist_ok=True)
    for name, content in tree.items():
        if not name.endswith("/"):
            (folder / name).parent.mkdir(parents=True, exist_ok=True)
            (folder / name).write_bytes(content)


def _is_whole(command, before, tree, output):
    return tree.get(output) in (before.get(output), command.whole[output])


def _differs(command, folder, output):
    path = folder / output
    return not path.is_file() or path.read_bytes() != command.whole[output]


def _left(command, folder, before):
    """Files that nobody asked for, when all is done."""
    names = [str(path.relative_to(folder)) for path in folder.rglob("*") if not path.is_dir()]
    return [f"{name} is left behind" for name in names if name not in before and name not in command.outputs]
