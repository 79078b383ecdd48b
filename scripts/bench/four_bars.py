"""Chains of N four-bars through singular positions: steps, time and energy error by method and tolerance.

Example: scripts/bench/run four_bars --count 1 2 5 --method DOP853 RAD5 --tolerance 1e-6 1e-9

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

from flexmb_cli.deck.text import read_text
from flexmb_cli.dialects.young.build_dynamics import build_young_dynamics
from flexmb_cli.dialects.young.dynamic_cards import read_young_deck
from flexmb_cli.errors import AnalysisError
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
    strayed = max(abs(block.total - first).max() for block in blocks)
    return strayed / max(block.kinetic.max() for block in blocks)


def main():
    """Print a row for every chain, method and tolerance."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawTextHelpFormatter)
    parser.add_argument("--count", nargs="+", type=int, default=[1, 2, 5, 10, 40])
    parser.add_argument("--method", nargs="+", choices=CARDS, default=list(CARDS))
    parser.add_argument("--tolerance", nargs="+", type=float, default=[10.0**-k for k in range(6, 12)])
    parser.add_argument("--end", type=float, default=10.0)
    given = parser.parse_args()
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
