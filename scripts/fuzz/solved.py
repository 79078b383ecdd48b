"""Solve damaged decks, and let a judge that shares nothing with flexmb's solvers look at the results.

Example: scripts/fuzz/run solved --count 10000 --seed 1 -j 2 --keep found
A result is wrong when it has numbers that are not finite, times, joints, drivers or grounds that contradict
its deck, forces that do not balance, an energy that strays without a warning, or when `check` and `run`
disagree.
Exit 1 when any is; those are kept in the folder of --keep, each with the reason.
"""

import argparse
import json
import math
import os
import random
import re
import shutil
import signal
import subprocess
import sys
import tempfile
import traceback
import warnings
from collections import Counter
from pathlib import Path

SECONDS = 10.0  # of processor time: a deck may ask for any number of steps
BATCH = 250  # decks of one process
CORNERS = (b"HSTO", b"CABL", b"ASTO", b"TSTO", b"TSTOP")  # cards


def main() -> int:
    options = _options()
    if options.alone:
        _solve_all(options)
        return 0
    os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")
    tally, sorts, judged = Counter(), Counter(), Counter()
    for record in _records(options):
        tally[record["end"]] += 1
        judged.update(record.get("judged", ()))
        if record["wrong"]:
            sorts[record["wrong"].split(":")[0]] += 1
            print(f"deck {record['number']} ({record['name']}): {record['wrong'][-1500:]}", flush=True)
    ends = ", ".join(f"{count} {end}" for end, count in sorted(tally.items()))
    print(f"{tally.total()} decks: {ends}; {sorts.total()} wrong")
    for what, count in (*judged.most_common(), *sorts.most_common()):
        print(f"    {count:6} {what}")
    return 1 if sorts else 0


def _options():
    parser = argparse.ArgumentParser(description=__doc__.partition("\n")[0])
    parser.add_argument("--count", type=int, default=1000)
    parser.add_argument("--first", type=int, default=0, help="number of the first")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--keep", type=Path, metavar="FOLDER")
    parser.add_argument(
        "--dialect", choices=("young", "dafms", "vsdf"), default="", help="of these decks alone"
    )
    words = "decks with springs, bushings, friction, stops, cables, couplings alone"
    parser.add_argument("--elements", action="store_true", help=words)
    parser.add_argument("-j", "--jobs", type=int, default=1)
    parser.add_argument("--alone", action="store_true", help=argparse.SUPPRESS)
    return parser.parse_args()


def _records(options):
    """What became of every deck; batches of them in processes, `jobs` at once."""
    starts = list(range(options.first, options.first + options.count, BATCH))
    end = options.first + options.count
    while starts:
        now, starts = starts[: options.jobs], starts[options.jobs :]
        yield from _together([(start, min(BATCH, end - start)) for start in now], options)


def _together(batches, options):
    keep = ["--keep", str(options.keep)] if options.keep else []
    keep += ["--dialect", options.dialect] if options.dialect else []
    keep += ["--elements"] if options.elements else []
    running = []
    for first, count in batches:
        words = ["--alone", "--seed", options.seed, "--first", first, "--count", count, *keep]
        command = [sys.executable, __file__, *map(str, words)]
        running.append((first, count, subprocess.Popen(command, stdout=subprocess.PIPE, text=True)))
    for first, count, process in running:
        lines = process.communicate()[0].splitlines()
        yield from map(json.loads, lines)
        if len(lines) < count:
            wrong = f"the process ended with {process.returncode}"
            yield {"number": first + len(lines), "name": "?", "end": "crashed", "wrong": wrong}


class TooLong(BaseException):
    """The time of a deck is over."""


def _solve_all(options):
    warnings.simplefilter("ignore")
    signal.signal(signal.SIGPROF, _stop)
    with tempfile.TemporaryDirectory(prefix="solved-", dir=_memory()) as folder:
        for number in range(options.first, options.first + options.count):
            work = Path(folder) / "work"
            shutil.rmtree(work, ignore_errors=True)
            work.mkdir()
            record = {"number": number, "name": "?", "end": "failed", "wrong": ""}
            try:
                record |= _solved(random.Random(f"{options.seed}/solved/{number}"), work, options)
            except TooLong:
                record["end"] = "too long"
            except Exception:
                record["wrong"] = traceback.format_exc()
            finally:
                signal.setitimer(signal.ITIMER_PROF, 0)
            if record["wrong"] and options.keep:
                shutil.copytree(work, options.keep / f"solved-{options.seed}-{number}", dirs_exist_ok=True)
            print(json.dumps(record), flush=True)


def _memory():
    """Results are synced: in memory that costs nothing."""
    return "/dev/shm" if os.access("/dev/shm", os.W_OK) else None


def _stop(_number, _frame):
    raise TooLong


def _solved(chance, work, options) -> dict:
    from judged.decks import damaged

    from flexmb_cli.run.check.check import check_deck
    from flexmb_cli.run.outcome import RunOptions
    from flexmb_cli.run.solution import run_deck

    deck = damaged(chance, options.dialect, options.elements)
    # Files that a deck names are found beside it.
    for path in deck.folder.iterdir():
        if path.is_dir():
            (work / path.name).symlink_to(path)
    path = work / deck.name
    path.write_bytes(deck.raw)
    choices = RunOptions(folder=str(work / "out"), no_out=True, h5=str(work / "r.h5"), changes=deck.changes)
    signal.setitimer(signal.ITIMER_PROF, SECONDS)
    checked = check_deck(str(path), choices).outcome
    ran = run_deck(str(path), choices)
    signal.setitimer(signal.ITIMER_PROF, 0)
    end = {0: "solved", 1: "failed in words", 2: "refused"}.get(ran.exit_code, "interrupted")
    judged = []
    wrong = _disagree(checked, ran) or _judged(deck, ran, work / "r.h5", judged)
    reported = {"name": deck.name, "end": end if end != "interrupted" else "too long", "wrong": wrong}
    return reported | {"judged": judged}


def _disagree(checked, ran) -> str:
    """What `check` promised and `run` did not do, or the other way round."""
    codes = f"check ends with {checked.exit_code}, run with {ran.exit_code}"
    reported = [fault.message for fault in (*checked.faults, *ran.faults) if fault.severity == "error"]
    if 3 in (checked.exit_code, ran.exit_code):
        return f"a fault of flexmb: {codes}: {reported}"
    if ran.exit_code in (130, 143) or checked.exit_code in (130, 143):
        return ""
    if (checked.exit_code == 2) != (ran.exit_code == 2) or (checked.exit_code and not ran.exit_code):
        return f"check and run disagree: {codes}: {reported}"
    if ran.exit_code and not reported:
        return f"no word: {codes}"
    return ""


def _judged(deck, ran, result, judged) -> str:
    """What is wrong with the result; `judged` gets what was looked at besides."""
    from judged.judge import judge

    if not result.exists():
        return "" if ran.exit_code else "no result: exit 0"
    text = _text(deck)
    # The equations of UNCO leave out what the deflection does to the rigid motion, and with it energy.
    reported = math.inf if b"UNCO" in deck.raw else _stated_drift(ran.faults)
    # Steps that leave out the highest modes make rates that are not theirs; flexmb says so.
    coarse = any(fault.id == "FE-007" for fault in ran.faults)
    smooth = not any(word in deck.raw for word in CORNERS)
    return judge(result, text, reported, coarse, judged, smooth)


def _stated_drift(faults) -> float:
    """The largest drift of energy that a run warns of, J; 0 without such a warning."""
    stated = (re.search(r"total energy drifts by ([-+.\de]+) J", fault.message) for fault in faults)
    return max((float(found[1]) for found in stated if found), default=0.0)


def _text(deck):
    """What the judge reads of a deck, with the changes of `--set`; None where it cannot."""
    from judged.dafms_text import read_dafms_text
    from judged.vsdf_text import read_vsdf_text
    from judged.young_text import read_young_text

    raw = deck.raw.decode("utf-8", "replace")
    if deck.name.endswith(".vsdf"):
        return read_vsdf_text(raw, deck.folder)
    reader = read_young_text if deck.name.endswith(".dat") else read_dafms_text
    text = reader(raw)
    return text and _with_changes(text, deck.changes)


def _with_changes(text, changes):
    from dataclasses import replace

    for change in changes:
        name, value = change.split("=")
        if name == "time.IT":
            text = replace(text, rows=int(value))
        else:
            time = list(text.time)
            time[("time.start", "time.end", "time.step").index(name)] = float(value)
            text = replace(text, time=tuple(time))
    return text


if __name__ == "__main__":
    sys.exit(main())
