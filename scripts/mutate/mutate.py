"""Mutation test of the mechanics: do the tests notice a wrong sign, factor or index in a kernel?

    scripts/mutate/run --folder FOLDER [--sample 240] [--seed 1] [-j 2] [--again] [TEST...]

1. Copies the checkout into FOLDER; the checkout itself is never edited.
2. Runs the tests once with kernels interpreted and records the lines that each test runs (map.jsonl).
   Tests that start processes or step by the thousand are left out.  A later run records only tests whose
   file has changed, unless a kernel has changed.
3. Draws a sample of all single edits of signs, factors and indices in compiled functions, spread evenly over
   files and kinds.  `bookkeeping.toml` lists the functions that hold no mechanics, with reasons.
4. Runs, for each mutant, the tests that cover its line, until one fails, for at most a minute.  A test that
   takes many times as long as it should fails.
5. Prints the survivors.  Those that cannot be noticed belong in `equivalent.toml`, with the reason; every
   other one needs a test.  Exit code 1 if fewer than 95 % of those that can be noticed are killed.

Verdicts are appended to FOLDER/verdicts.jsonl, one JSON object each: an interrupted run continues.
`--again` tries survivors once more, after tests were added.  TEST: files or folders of tests (default: all).
Times are processor seconds, so that other work on the machine does not change verdicts.
"""

import argparse
import json
import multiprocessing
import os
import shutil
import sys
import tempfile
import time
import tomllib
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from queue import SimpleQueue

import mutations
import trial
from tree import ENVIRONMENT, PACKAGE, copy_checkout, kernel_files, read_map, renew_map

ENOUGH = 0.95
PATIENCE = 1800  # s: a process that waits for nothing is ended after this time


def equivalents() -> dict[str, str]:
    """Return {key of a mutant: reason} of those that no test can notice."""
    text = (mutations.HERE / "equivalent.toml").read_text(encoding="utf-8")
    listed = tomllib.loads(text).get("mutant", [])
    return {f"{m['function']}: {m['before']} -> {m['after']}": m["reason"] for m in listed}


def read_verdicts(path: Path) -> dict[str, dict]:
    """Return the last verdict on each mutant."""
    lines = path.read_text(encoding="utf-8").splitlines() if path.exists() else []
    return {v["name"]: v for v in map(json.loads, lines)}


def worker_folder(folder: Path, number: int) -> Path:
    """Make and return a folder with a copy of the package, of which one file at a time is edited."""
    worker = folder / f"worker-{number}"
    shutil.rmtree(worker, ignore_errors=True)
    shutil.copytree(folder / "tree" / PACKAGE, worker / PACKAGE)
    return worker


def try_mutant(mutant, folder: Path, worker: Path, limits: tuple, most: float, context):
    """Return what `trial.judge` sends of a mutant, made in `worker`."""
    original, edited = folder / "tree" / mutant.file, worker / mutant.file
    source = original.read_bytes()
    edited.write_bytes(source[: mutant.begin] + mutant.text.encode() + source[mutant.end :])
    receiver, sender = context.Pipe(duplex=False)
    arguments = (sender, str(folder / "tree"), str(worker), limits, most, str(worker / "log"))
    process = context.Process(target=trial.judge, args=arguments)
    process.start()
    sender.close()
    process.join(PATIENCE)
    process.kill()
    process.join()
    shutil.copy2(original, edited)
    try:
        return receiver.recv()
    except EOFError:
        if process.exitcode == 1:
            raise RuntimeError(f"{mutant.name}: the trial itself failed, see {worker / 'log'}") from None
        end = f"process ended with {process.exitcode}"
        return {"killer": "process", "why": end, "late": False, "ran": 0, "seconds": 0.0}


def verdict_of(mutant, found: dict) -> dict:
    """Return what is kept of a trial."""
    place = {"name": mutant.name, "kind": mutant.kind, "line": mutant.line}
    return place | {"killed": found["killer"] is not None} | found


def try_all(mutants, folder: Path, jobs: int, most: float, records: list[dict]) -> None:
    """Append a verdict on every mutant, each after at most so many processor seconds."""
    os.environ.update(ENVIRONMENT, FLEXMB_CACHE_DIR=str(folder / "cache"), PYTEST_DISABLE_PLUGIN_AUTOLOAD="1")
    context = multiprocessing.get_context("forkserver")
    context.set_forkserver_preload(trial.PRELOADED)
    free, done = SimpleQueue(), 0
    for number in range(jobs):
        free.put(worker_folder(folder, number))

    def run(mutant):
        worker = free.get()
        limits = trial.covering_tests(records, str(folder / "tree" / mutant.file), mutant.lines)
        try:
            return verdict_of(mutant, try_mutant(mutant, folder, worker, limits, most, context))
        finally:
            free.put(worker)

    with ThreadPoolExecutor(jobs) as pool, open(folder / "verdicts.jsonl", "a", encoding="utf-8") as log:
        for verdict in pool.map(run, mutants):
            log.write(json.dumps(verdict, ensure_ascii=False) + "\n")
            log.flush()
            done += 1
            by = verdict["killer"] or ("SURVIVED" + (" (time over)" if verdict["late"] else ""))
            print(f"{time.strftime('%T')} {done}/{len(mutants)} {verdict['name']}\n    {by}", flush=True)


def summary(mutants, verdicts: dict[str, dict], known: dict[str, str]) -> bool:
    """Print counts and survivors; return whether enough are killed."""
    killed = sum(verdicts[m.name]["killed"] for m in mutants)
    survivors = [m for m in mutants if not verdicts[m.name]["killed"]]
    same = [m for m in survivors if m.key in known]
    for mutant in survivors:
        if mutant.key not in known:
            found = verdicts[mutant.name]
            print(f"{mutant.file}:{mutant.line}: {mutant.key}  [{found['ran']} tests, {found['seconds']} s]")
    share = killed / max(1, len(mutants) - len(same))
    print(f"{len(mutants)} mutants: {killed} killed, {len(same)} equivalent, ", end="")
    print(f"{len(survivors) - len(same)} others survive; {share:.1%} of those that can be noticed are killed")
    for m in mutants:
        if verdicts[m.name]["killed"] and m.key in known:
            print(f"equivalent.toml: {m.key} was killed by {verdicts[m.name]['killer']}")
    return share >= ENOUGH


def parse_arguments():
    """Return the options."""
    form = argparse.RawDescriptionHelpFormatter
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=form)
    parser.add_argument("--folder", type=Path, default=Path(tempfile.gettempdir()) / "flexmb-mutate")
    parser.add_argument("--sample", type=int, default=240)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--only", default="", help="mutants whose name holds this text")
    parser.add_argument("-j", "--jobs", type=int, default=1)
    parser.add_argument("--seconds", type=float, default=60.0, help="of the processor, for a mutant")
    parser.add_argument("--again", action="store_true", help="try survivors once more")
    parser.add_argument("tests", nargs="*", default=["tests"])
    return parser.parse_args()


def main():
    """Map, sample, try, print; exit code 1 if too many survive."""
    given = parse_arguments()
    folder = given.folder.resolve()
    folder.mkdir(parents=True, exist_ok=True)
    tree = copy_checkout(folder)
    renew_map(folder, tree, given.tests)
    drawn = mutations.sample(mutations.all_mutants(tree, kernel_files(tree)), given.sample, given.seed)
    drawn = [m for m in drawn if given.only in m.name]
    known = read_verdicts(folder / "verdicts.jsonl")
    missing = [m for m in drawn if m.name not in known or (given.again and not known[m.name]["killed"])]
    try_all(missing, folder, given.jobs, given.seconds, read_map(folder))
    sys.exit(0 if summary(drawn, read_verdicts(folder / "verdicts.jsonl"), equivalents()) else 1)


if __name__ == "__main__":
    main()
