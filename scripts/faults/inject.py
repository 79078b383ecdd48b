"""Injects faults into every command that writes, counts them, and judges what becomes of the files.

Example: scripts/inject_faults --seed 1
         scripts/inject_faults --only kill_at_deeds --count 200

The rules (judge.py): every output is the old one, or the new one whole, or marked partial; a message says
which; given again, the command ends with the bytes of an undisturbed one.  Exit 1 when a rule is broken;
the folder of that fault is kept and named.
"""

import argparse
import json
import os
import random
import shutil
import sys
import tempfile
import time
import traceback
from collections import Counter
from dataclasses import asdict
from pathlib import Path

os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")  # a fork has no threads
os.environ.setdefault("MPLBACKEND", "agg")
sys.path.insert(0, str(Path(__file__).resolve().parents[1]))

from faults import trip

trip.install()

from faults import caches, cluster, damage, disks, failing_calls, places, power, stops, surroundings  # noqa: E402 - opens files counted
from faults.stage import Stage  # noqa: E402
from faults.stops import Verdict  # noqa: E402

# Every kind with its share of the faults; processes of their own take seconds each.
KINDS = {
    stops.kill_at_deeds: 240,
    stops.torn_writes: 60,
    stops.kill_at_any_time: 100,
    stops.kill_resumed: 50,
    stops.kill_process: 16,
    stops.kill_with_workers: 8,
    stops.kill_a_worker: 4,
    cluster.kill_driver_of_cluster: 3,
    cluster.kill_driver_and_worker_of_cluster: 1,
    stops.signals_at_deeds: 120,
    stops.signals_at_any_time: 60,
    stops.signals_to_process: 12,
    disks.full_from_a_deed_on: 90,
    disks.broken_deed: 80,
    disks.small_disk: 60,
    disks.limited_size: 50,
    disks.vanishing_folder: 50,
    places.read_only_folder: 17,
    places.read_only_old: 34,
    places.output_is_a_folder: 34,
    places.missing_folder: 34,
    places.failing_run_keeps_the_old: 16,
    places.no_working_folder: 8,
    damage.other_run_resumed: 24,
    damage.damaged_resume_file: 64,
    damage.changed_study: 10,
    damage.damaged_parts: 20,
    damage.damaged_result: 60,
    damage.broken_draft: 20,
    caches.damaged_kernels: 12,
    caches.lost_kernel_folder: 2,
    caches.damaged_bodies: 16,
    caches.unwritable_bodies: 2,
    caches.changed_matrix: 3,
    caches.homeless: 6,
    caches.first_runs_at_once: 1,
    surroundings.closed_streams: 44,
    surroundings.full_standard_output: 6,
    surroundings.full_table_on_standard_output: 7,
    surroundings.odd_names: 10,
    surroundings.other_locales: 12,
    surroundings.narrow_masks: 17,
}
# Of every system call, under a tracer; these have options of their own.
CAMPAIGNS = {"power": power.main, "calls": failing_calls.main}
NAMED = {kind.__name__: kind for kind in KINDS}


def main() -> int:
    campaign = CAMPAIGNS.get("".join(sys.argv[1:2]))
    if campaign is not None:
        return campaign(sys.argv[2:])
    options = _options()
    top = Path(tempfile.mkdtemp(prefix="faults-"))
    top.chmod(0o755)  # other users are tried, too
    # Bodies that an earlier version of flexmb or of LAPACK reduced would have other last digits.
    os.environ["FLEXMB_CACHE_DIR"] = str(top / "bodies")
    start = time.monotonic()
    stage = Stage(top, set(options.commands))
    tasks = _tasks(options)
    reported = list(_reported(stage, tasks, options, top))
    return _summary(reported, options, top, time.monotonic() - start)


def _options():
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--count", type=int, help="faults of every kind  [default: the kind's own]")
    parser.add_argument("--only", action="append", choices=list(NAMED), default=[], help="this kind alone")
    parser.add_argument("--without", action="append", choices=list(NAMED), default=[], help="not this kind")
    parser.add_argument("--commands", nargs="*", default=[], help="of the stage, these alone")
    parser.add_argument("--most", type=int, help="of all these faults, in their mixed order, at most so many")
    parser.add_argument("--jobs", type=int, default=2)
    parser.add_argument("--json", metavar="FILE", help="the counts, for tables")
    return parser.parse_args()


def _tasks(options):
    """(kind, number) of all faults; kinds mixed, so that slow ones do not come together."""
    names = options.only or [name for name in NAMED if name not in options.without]
    tasks = [(name, k) for name in names for k in range(options.count or KINDS[NAMED[name]])]
    random.Random(options.seed).shuffle(tasks)
    return tasks[: options.most]


def _reported(stage, tasks, options, top):
    """(kind, verdict, folder) of every task, by forks of this process that share the work."""
    files, workers = [], []
    for job in range(options.jobs):
        files.append(top / f"verdicts-{job}")
        number = os.fork()
        if number == 0:
            try:
                _work(stage, tasks[job :: options.jobs], options.seed, top, files[-1])
            finally:
                sys.stdout.flush(), sys.stderr.flush()
                os._exit(0)
        workers.append(number)
    for number in workers:
        os.waitpid(number, 0)
    for file in files:
        for line in file.read_text().splitlines():
            name, number, verdict = json.loads(line)
            yield name, number, Verdict(**verdict)


def _work(stage, tasks, seed, top, file):
    with open(file, "w") as stream:
        for name, number in tasks:
            folder = top / f"{name}-{number}" / "w"
            folder.mkdir(parents=True)
            verdict = _one(stage, name, number, seed, folder)
            stream.write(json.dumps([name, number, asdict(verdict)]) + "\n")
            stream.flush()
            if verdict.faults:
                said = "\n    ".join(verdict.faults)
                print(
                    f"{name} {number}, {verdict.what}: {folder.parent}\n    {said}",
                    file=sys.stderr,
                    flush=True,
                )
            else:
                shutil.rmtree(folder.parent, ignore_errors=True)


def _one(stage, name, number, seed, folder) -> Verdict:
    chance = random.Random(f"{seed}/{name}/{number}")
    try:
        return NAMED[name](stage, chance, number, folder)
    except Exception:
        return Verdict("the script", [traceback.format_exc()])


def _summary(reported, options, top, seconds) -> int:
    injected, broken, resumed, skipped = Counter(), Counter(), Counter(), {}
    for name, _, verdict in reported:
        if verdict.skipped:
            skipped[name] = verdict.skipped
            continue
        injected[name] += 1
        broken[name] += bool(verdict.faults)
        resumed[name] += verdict.resumed
    print(f"{'kind':32}{'faults':>8}{'resumed to the same bytes':>28}{'rules broken':>14}")
    for name in injected:
        print(f"{name:32}{injected[name]:8}{resumed[name]:28}{broken[name]:14}")
    print(f"{'all':32}{injected.total():8}{resumed.total():28}{broken.total():14}")
    kills = sum(count for name, count in resumed.items() if name.startswith(("kill", "torn")))
    print(f"kills resumed to identical bytes: {kills}; {seconds:.0f} s, seed {options.seed}")
    for name, why in skipped.items():
        print(f"{name}: some were skipped: {why}")
    if options.json:
        counts = {"faults": injected, "resumed": resumed, "broken": broken, "kills resumed": kills}
        Path(options.json).write_text(json.dumps(counts, indent=1))
    if broken.total():
        print(f"what was left is in {top}", file=sys.stderr)
        return 1
    shutil.rmtree(top)
    return 0


if __name__ == "__main__":
    sys.exit(main())
