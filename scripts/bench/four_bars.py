"""Chains of N four-bars through singular positions: steps, time and energy error by method and tolerance.

Example: scripts/bench/run four_bars --count 1 2 5 --method DOP853 RAD5 --tolerance 1e-6 1e-9
Example: scripts/bench/run four_bars --size --count 1 10 40 100 200 500

With --size: processor time of an evaluation of the accelerations, of a report row, of a start, and of 0.4 s
at 1e-6 with two rows, warm; errors of the evaluation, against the closed form of cranks, and of the energy.

The N-four-bar mechanism of the IFToMM library of computational benchmark problems (A08; González, Kövecses
and others, Multibody System Dynamics 36 (2016)): bars of 1 m and 1 kg, gravity 9.81 m/s², the first pin moves
at 1 m/s at the start, where the cranks stand upright.  All couplers stay parallel to the ground, so that the
chain is a pendulum of one degree of freedom; twice a turn all its bars lie in line.
"""

import argparse
import math
import tempfile
import time
from pathlib import Path

import numpy as np

from flexmb_cli.deck.text import read_text
from flexmb_cli.dialects.young.build_dynamics import build_young_dynamics
from flexmb_cli.dialects.young.dynamic_cards import read_young_deck
from flexmb_cli.errors import AnalysisError
from flexmb_cli.kernels.constrained.accelerations import accelerations
from flexmb_cli.kernels.constrained.report import observe_rows
from flexmb_cli.solvers.constrained.system import blank_report
from flexmb_cli.solvers.constrained.young_dynamics import ForwardDynamics

BAR = "1 0.5 0 0 0 0.08333333333333333 0.08333333333333333"
CARDS = {"DOP853": "", "RAD5": "RAD5\n", "GALF": "GALF 0 0.9\n"}


def deck_of(count: int, method: str, tolerance: float, end: float = 10.0, interval: float = 0.01) -> str:
    """The YOUNG deck of `count` four-bars: body 1 is the ground, then cranks and couplers in turn."""
    half = math.sqrt(0.5)
    bodies, joints, masses, speeds = ["0 0 0 1 0 0 0"], [], [], []
    for k in range(count + 1):
        crank = 2 * k + 2
        bodies.append(f"{k} 0 0 {half!r} 0 0 {half!r}")
        joints.append(f"1 {crank} {k} 0 0 0 0 0 {k} 0 1 0 0 1")
        speeds.append(f"VELOCITY {crank} 0 0 0 0 0 -1")
        if k < count:
            bodies.append(f"{k} 1 0 1 0 0 0")
            joints.append(f"{crank} {crank + 1} 1 0 0 0 0 0 1 0 1 0 0 1")
            joints.append(f"{crank + 1} {crank + 2} 1 0 0 1 0 0 1 0 1 1 0 1")
            speeds.append(f"VELOCITY {crank + 1} 1 0 0 0 0 0")
    masses = [f"MASS {body} {BAR}" for body in range(2, len(bodies) + 1)]
    counts = f"{len(bodies)} 0 0 0 0 {len(joints)} 0 0 0 0 0 1"
    cards = ["DYNAMICS forward", "GRAVITY 0 -9.81 0", *masses, *speeds, f"TOLERANCE {tolerance:g}"]
    lines = [counts, *bodies, *joints, "1 0 0 0 0 0 0", f"0 {end:g} {interval:g}", *cards]
    return "\n".join(lines) + f"\n{CARDS[method]}END\n"


def run(deck: str) -> tuple[dict, list, str]:
    """Run a deck's text: its clock, blocks of rows, and what stopped it."""
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "IN.dat"
        path.write_text(deck)
        model, _ = build_young_dynamics(read_young_deck(read_text(str(path))))
    analysis, blocks, stopped = ForwardDynamics(model), [], ""
    try:
        blocks.extend(analysis.rows())
    except AnalysisError as failure:
        stopped = str(failure)
    return analysis.clock[0], blocks, stopped


def energy_error(blocks) -> float:
    """The largest change of the total energy, as a share of the largest kinetic energy."""
    first = blocks[0].total[0]
    drift = max(abs(block.total - first).max() for block in blocks)
    return drift / max(block.kinetic.max() for block in blocks)


def least(call, count: int) -> float:
    """Least processor time of a call, s, of five measurements of `count` calls."""
    found = math.inf
    for _ in range(5):
        begin = time.process_time()
        for _ in range(count):
            call()
        found = min(found, (time.process_time() - begin) / count)
    return found


def cost_of(count: int) -> dict[str, float]:
    """Times, s, and errors of a chain of `count` four-bars, see `--size`."""
    text, angle = deck_of(count, "DOP853", 1e-6, 0.4, 0.4), 1.2
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "IN.dat"
        path.write_text(text)
        model = build_young_dynamics(read_young_deck(read_text(str(path))))[0]
    analysis = ForwardDynamics(model)
    analysis.start()
    system, work, calls = analysis.system, analysis.work, max(2, 400 // count)
    q, (u, ud) = analysis.arrays.q.copy().reshape(-1, 7), np.zeros((2, analysis.arrays.speeds))
    q[1::2, 3], q[1::2, 6] = math.cos(0.5 * angle), math.sin(0.5 * angle)
    q[2::2, 0], q[2::2, 1] = np.arange(count) + math.cos(angle), math.sin(angle)
    evaluation = least(lambda: accelerations(system, work, q.ravel(), u, 0.0, ud), calls)
    inertia, arm = (count + 1) / 3.0 + count, (count + 1) / 2.0 + count
    wanted = -9.81 * arm * math.cos(angle) / inertia
    report = blank_report(analysis.arrays, np.zeros(calls), analysis.works)
    report.states[:, : q.size] = q.ravel()
    expected = np.zeros((calls, analysis.arrays.angles.size))
    blocks: list = []

    def whole():
        blocks[:] = ForwardDynamics(model).rows()

    return {
        "evaluation": evaluation,
        "row": least(lambda: observe_rows(system, work, expected, report), 1) / calls,
        "start": least(lambda: ForwardDynamics(model).start(), 1),
        "whole": least(whole, 1),
        "error": float(np.abs(ud.reshape(-1, 6)[1::2, 5] / wanted - 1.0).max()),
        "energy": energy_error(blocks),
    }


def show_sizes(counts: list[int]) -> None:
    """Print a row for every chain, and by which power of its number of bodies an evaluation grows."""
    print("  N bodies evaluation/us row/us start/ms 0.4 s/ms  error  energy  power")
    before: tuple[int, float] | None = None
    for count in counts:
        found = cost_of(count)
        ratio = found["evaluation"] / before[1] if before else 1.0
        power = f"{math.log(ratio) / math.log(count / before[0]):.2f}" if before else ""
        before = count, found["evaluation"]
        print(
            f"{count:4d} {2 * count + 1:5d} {found['evaluation'] * 1e6:12.1f} {found['row'] * 1e6:7.1f} "
            f"{found['start'] * 1e3:8.1f} {found['whole'] * 1e3:8.1f} {found['error']:6.0e} "
            f"{found['energy']:7.1e}  {power}",
            flush=True,
        )


def main():
    """Print a row for every chain, method and tolerance."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawTextHelpFormatter)
    parser.add_argument("--count", nargs="+", type=int, default=[1, 2, 5, 10, 40])
    parser.add_argument("--method", nargs="+", choices=CARDS, default=list(CARDS))
    parser.add_argument("--tolerance", nargs="+", type=float, default=[10.0**-k for k in range(6, 12)])
    parser.add_argument("--end", type=float, default=10.0)
    parser.add_argument("--size", action="store_true", help="cost over size, of the explicit method")
    given = parser.parse_args()
    if given.size:
        show_sizes(given.count)
        return
    run(deck_of(1, given.method[0], 1e-4, 0.1))
    print("  N method tolerance   steps rejected        s energy/tol  stop")
    for count in given.count:
        for method in given.method:
            for tolerance in given.tolerance:
                begin = time.process_time()
                clock, blocks, stopped = run(deck_of(count, method, tolerance, given.end))
                spent, share = time.process_time() - begin, energy_error(blocks) / tolerance
                reported = stopped.splitlines()[0] if stopped else f"t = {blocks[-1].time[-1]:g} s"
                print(
                    f"{count:3d} {method:6} {tolerance:9.0e} {clock['steps']:7d} {clock['rejections']:8d} "
                    f"{spent:8.2f} {share:10.2g}  {reported[:110]}",
                    flush=True,
                )


if __name__ == "__main__":
    main()
