"""What a study costs beside its solver, and what a second worker brings.

Usage: scripts/bench/run sweep [overhead] [workers]   (both without arguments)
"""

import sys
import tempfile
import time
from pathlib import Path

from flexmb_cli.dialects.settings import apply_settings
from flexmb_cli.dialects.young.build import build_young
from flexmb_cli.solvers.kinematics.analysis import KinematicAnalysis
from flexmb_cli.study.cluster import solve_on_cluster
from flexmb_cli.study.sweep import Sweep, write_study_table
from flexmb_cli.study.workers import solve_here

DECK = Path(__file__).resolve().parents[2] / "decks/young/IN-RSSR.dat"
STUDY = """
deck = "{deck}"
sampling = "latin-hypercube"
count = {count}
seed = 1

[parameters]
"driver.1.B" = {{ from = 100.0, to = 200.0 }}
"point.1.x" = {{ from = 0.0, to = 0.1 }}

[results]
top = "max body.3.z"
spin = "last body.2.omega.x"
"""


def study_of(count, folder):
    """A sweep of `count` variants of the RSSR in a fresh folder."""
    path = Path(folder) / "study.toml"
    path.write_text(STUDY.format(deck=DECK, count=count))
    return Sweep.of(str(path), str(Path(folder) / "parts"), fresh=True)


def costs(count, folder):
    """Processor seconds of a case of a study in one process, and of its solver alone, block by block in turn.

    The clock of a shared machine wavers within a minute: both sides of a ratio have to feel it alike.
    """
    whole = alone = 0.0
    sweep = study_of(count, folder)
    sweep.solver.solve(0)
    for block in sweep.pending():
        whole += spent_on(lambda block=block: solve_here(sweep, [block], lambda cases: None))
        alone += solver_time(sweep, sweep.job.cases(block))
    whole += spent_on(lambda: write_study_table(str(Path(folder) / "table.h5"), sweep))
    return whole / count, alone / count


def overhead(count=20_000):
    """Print the cost of a case of a study in one process, and of its solver alone."""
    with tempfile.TemporaryDirectory() as folder:
        whole, alone = costs(count, folder)
    print(f"{count} cases in one process: {whole / alone:.3f} times their solver alone")
    print(f"a case: {1e3 * whole:.2f} ms, its solver alone {1e3 * alone:.2f} ms")


def spent_on(work):
    """Processor time of a call."""
    start = time.process_time()
    work()
    return time.process_time() - start


def solver_time(sweep, cases):
    """Processor time of the kinematic analyses of `cases`, models made beforehand."""
    settings = sweep.solver.cases.settings
    models = (build_young(apply_settings(sweep.deck, settings(case)))[0] for case in cases)
    return sum(spent_on(lambda model=model: solve(model)) for model in models)


def solve(mechanism):
    """All rows of the mechanism's motion."""
    for _ in KinematicAnalysis(mechanism).rows():
        pass


def workers(count=2000, repeats=5):
    """Wall time of a study on one and on two Dask workers of this machine."""
    from distributed import LocalCluster

    times = {}
    for number in (1, 2):
        with LocalCluster(n_workers=number, threads_per_worker=1, dashboard_address=None) as cluster:
            times[number] = [on_cluster(count, cluster.scheduler_address) for _ in range(repeats + 1)][1:]
    one, two = (sorted(times[number])[repeats // 2] for number in (1, 2))
    print(f"{count} cases: one worker {one:.2f} s, two {two:.2f} s: {one / two:.2f} times as fast")


def on_cluster(count, address):
    """Wall time of solving a study on the cluster."""
    with tempfile.TemporaryDirectory() as folder:
        sweep = study_of(count, folder)
        start = time.perf_counter()
        solve_on_cluster(sweep, sweep.pending(), lambda cases: None, address)
        return time.perf_counter() - start


if __name__ == "__main__":
    for part in sys.argv[1:] or ["overhead", "workers"]:
        {"overhead": overhead, "workers": workers}[part]()
