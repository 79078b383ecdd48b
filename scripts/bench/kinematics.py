"""Cost of the YOUNG kinematics: steps, writing, start-up, compilation, growth with the number of bodies.

Run with `scripts/bench/run kinematics [PART...]`.  Times are processor seconds, medians of repeats; where a
comparison is meant, both sides are measured in turn in this one run and the ratio is printed.
"""

import argparse
import os
import resource
import statistics
import subprocess
import sys
import tempfile
import textwrap
import time
from dataclasses import replace
from pathlib import Path

TOP = Path(__file__).resolve().parents[2]
DECKS = TOP / "decks" / "young"
sys.path.insert(0, str(TOP))
STEPS = 11_000

BARE = """
import numba, h5py
@numba.njit(cache=True)
def one(x):
    return x + 1.0
"""


def child_seconds(command, **environment) -> float:
    """Processor seconds of one child process."""
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    environment = {**os.environ, **environment}
    subprocess.run(command, check=True, capture_output=True, env=environment, cwd=tempfile.gettempdir())
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    return after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime


def median_ms(seconds) -> str:
    """Median and range in milliseconds."""
    seconds = sorted(seconds)
    return f"{1e3 * statistics.median(seconds):.0f} ms ({1e3 * seconds[0]:.0f}-{1e3 * seconds[-1]:.0f})"


def mechanism_of(name, steps):
    """The mechanism of a shipped deck on a grid of `steps` steps."""
    from flexmb_cli.deck.text import read_text
    from flexmb_cli.dialects.recognise import read_deck
    from flexmb_cli.dialects.young.build import build_young

    mechanism, _ = build_young(read_deck(read_text(DECKS / f"{name}.dat")))
    grid = mechanism.time
    return replace(mechanism, time=replace(grid, step=(grid.end - grid.start) / steps))


def steps(repeats):
    """Microseconds a step, solving only."""
    from flexmb_cli.solvers.kinematics.analysis import KinematicAnalysis

    for name in ("IN-RSSR-COELHO", "IN4-BAR"):
        mechanism = mechanism_of(name, STEPS)
        list(KinematicAnalysis(mechanism_of(name, 10)).rows())
        seconds = []
        for _ in range(repeats):
            analysis = KinematicAnalysis(mechanism)
            start = time.process_time()
            for _ in analysis.rows():
                pass
            seconds.append((time.process_time() - start) / STEPS)
        print(f"{name}: {1e6 * statistics.median(seconds):.1f} us a step over {STEPS} steps (aim 10)")


def written(repeats):
    """Microseconds a step of the whole program with OUT and HDF5 written, start-up taken off."""
    for name in ("IN-RSSR-COELHO", "IN4-BAR"):
        grid = mechanism_of(name, STEPS).time
        with tempfile.TemporaryDirectory() as folder:
            command = [
                sys.executable,
                "-m",
                "flexmb_cli",
                "run",
                str(DECKS / f"{name}.dat"),
                "-q",
                "-o",
                folder,
            ]
            many = [*command, "--set", f"time.step={grid.step!r}"]
            pairs = [(child_seconds(many), child_seconds(command)) for _ in range(repeats)]
        cost = statistics.median((long - short) / STEPS for long, short in pairs)
        print(f"{name}: {1e6 * cost:.1f} us a step with OUT and HDF5 (aim 60)")


def start_up(repeats):
    """`flexmb run` on the four-bar against a bare import of numba and h5py and one cached call."""
    with tempfile.TemporaryDirectory() as folder:
        Path(folder, "bare.py").write_text(BARE)
        bare = [sys.executable, "-c", "import bare; bare.one(1.0)"]
        place = {"PYTHONPATH": folder, "NUMBA_CACHE_DIR": folder}
        run = [sys.executable, "-m", "flexmb_cli", "run", str(DECKS / "IN4-BAR.dat"), "-q", "-o", folder]
        child_seconds(bare, **place), child_seconds(run)
        pairs = [(child_seconds(run), child_seconds(bare, **place)) for _ in range(repeats)]
    ratio = statistics.median(a / b for a, b in pairs)
    print(f"flexmb run IN4-BAR: {median_ms([a for a, _ in pairs])}; bare numba + h5py + one cached call: "
          f"{median_ms([b for _, b in pairs])}; ratio {ratio:.2f} (aim 1.3)")  # fmt: skip
    help_times = [child_seconds([sys.executable, "-m", "flexmb_cli", "--help"]) for _ in range(repeats)]
    print(f"flexmb --help: {median_ms(help_times)} of CPU (aim 150)")
    checks = [
        child_seconds([sys.executable, "-m", "flexmb_cli", "check", str(DECKS / "IN4-BAR.dat")])
        for _ in range(repeats)
    ]
    print(f"flexmb check IN4-BAR: {median_ms(checks)} of CPU")


def compilation(repeats):
    """First run with an empty kernel cache, less a run with a warm one."""
    seconds = []
    for _ in range(min(repeats, 3)):
        with tempfile.TemporaryDirectory() as folder:
            run = [sys.executable, "-m", "flexmb_cli", "run", str(DECKS / "IN4-BAR.dat"), "-q", "-o", folder]
            cold = child_seconds(run, NUMBA_CACHE_DIR=folder)
            seconds.append(cold - child_seconds(run, NUMBA_CACHE_DIR=folder))
    print(f"first-run compilation: {statistics.median(seconds):.1f} s (aim 15)")


def chain_cost(stages, repeats):
    """(bodies, processor seconds a body and row, error) of a serial RSSR chain.

    There are 11 rows, and the start is included.  The error is the largest of the rods' ends against
    their closed form.
    """
    import numpy as np

    from flexmb_cli.solvers.kinematics.analysis import KinematicAnalysis
    from tests.solvers.kinematics.rssr_chain import TIME, chain, rod_ends

    mechanism = chain(stages, replace(TIME, end=0.5, step=0.05))
    seconds = []
    for _ in range(repeats + 1):
        start = time.process_time()
        blocks = list(KinematicAnalysis(mechanism).rows())
        seconds.append(time.process_time() - start)
    times = np.concatenate([block.time for block in blocks])
    places = np.concatenate([block.point_position for block in blocks])
    error = np.abs(places - rod_ends(stages, times)[0]).max()
    return len(mechanism.bodies), statistics.median(seconds[1:]) / 11 / len(mechanism.bodies), error


def chains(repeats):
    """Cost per body and step of serial RSSR chains."""
    print(
        "RSSR chains, 11 rows: bodies, us per body and row, ratio to the smallest chain and to the one before"
    )
    first = before = None
    for stages in (3, 10, 16, 33, 100, 333, 666):
        bodies, seconds, error = chain_cost(stages, repeats)
        cost = 1e6 * seconds
        first, before = first or cost, before or cost
        print(f"  {bodies:5d}  {cost:8.1f}  {cost / first:5.2f}  {cost / before:5.2f}  error {error:.0e} m")
        before = cost


PARTS = {
    "steps": steps, "written": written, "start-up": start_up, "compilation": compilation, "chains": chains
}  # fmt: skip


def main():
    """Measure the parts named, or all."""
    parser = argparse.ArgumentParser(description=textwrap.dedent(__doc__))
    parser.add_argument("parts", nargs="*", choices=[*PARTS, []], help=", ".join(PARTS))
    parser.add_argument("--repeats", type=int, default=5)
    arguments = parser.parse_args()
    for name in arguments.parts or PARTS:
        print(f"-- {name}")
        PARTS[name](arguments.repeats)


if __name__ == "__main__":
    main()
