"""Final errors of the steps that GALF chooses, in tolerances: positions, and speeds of their largest.

Example: scripts/bench/run chosen_steps --tolerance 1e-3 1e-5 1e-7 --radius 0.9 0.6

Stiff flyball governor of the IFToMM library of computational benchmark problems (A05): shaft, slider and
two rods of 3000 kg/m³, 5 kg at the rods' ends, springs of 8e5 N/m and dampers of 4e4 N s/m between the rods'
middles and the slider, 2π rad/s at the start.  Andrews' squeezer: decks/young/dynamics/IN-ANDREWS.dat.
The four-bar: `four_bars`.  The pendulum: decks/vsdf/pendulum.vsdf, 9 modes, its tip.  The reference is
DOP853 at 1e-12.  With --given, the processor time of steps of given lengths of the squeezer follows: a run of
0.03 s less one of 0.003 s, so that neither start nor report rows count.
"""

import argparse
import math
from pathlib import Path

import numpy as np
from four_bars import deck_of, least, run

from flexmb_cli.deck.record import DeckText
from flexmb_cli.dialects.vsdf.build import build_vsdf
from flexmb_cli.dialects.vsdf.reader import read_vsdf
from flexmb_cli.fe.build_mechanism import flexible_mechanism
from flexmb_cli.solvers.constrained.flexible_dynamics import FlexibleDynamics

DECKS = Path(__file__).parents[2] / "decks"
ANDREWS = DECKS / "young/dynamics/IN-ANDREWS.dat"


def governor(cards: str, end: float = 10.0) -> str:
    """The deck of the governor: ground, shaft, slider, two rods from the shaft's top."""
    a = 0.5 * math.radians(30.0)
    rods = ((0.05, math.cos(a), math.sin(a)), (-0.05, math.sin(a), math.cos(a)))
    bodies = ["0 0 0 1 0 0 0", "0 0 0.5 1 0 0 0", "0 0 0.5 1 0 0 0"]
    bodies += [f"{x} 0 1 {e0!r} 0 {e2!r} 0" for x, e0, e2 in rods]
    revolute = ["1 2 0 0 0 0 0 -0.5 0 0 1 0 0 0.5"]
    revolute += [f"2 {k} {x} 0 0.5 0 0 0 {x} 1 0.5 0 1 0" for k, (x, *_) in zip((4, 5), rods, strict=True)]
    slide = ["2 3 0 0 0 0 0 0 0 0 1 0 0 1 1 0 0 0 1 0"]
    # Rod 0.3 kg about its middle, and 5 kg at its end.
    m, c = 5.3, (0.3 * 0.5 + 5.0) / 5.3
    about = 0.3 * (1.0 + 1e-4) / 12.0 + 0.3 * (c - 0.5) ** 2 + 5.0 * (1.0 - c) ** 2
    masses = [f"MASS 2 0.3 0 0 0 {0.3 * 1.0001 / 12!r} {0.3 * 1.0001 / 12!r} {0.3 * 2e-4 / 12!r}"]
    masses += ["MASS 3 3 0 0 0 0.005 0.005 0.005"]
    masses += [f"MASS {k} {m} {c!r} 0 0 {0.3 * 2e-4 / 12!r} {about!r} {about!r}" for k in (4, 5)]
    springs = [f"SPRING 3 {k} {x} 0 0 0.5 0 0 8e5 0.5 4e4" for k, (x, *_) in zip((4, 5), rods, strict=True)]
    spin = f"0 0 {2 * math.pi!r}"
    speeds = [f"VELOCITY {k} 0 0 0 {spin}" for k in (2, 3)]
    speeds += [
        f"VELOCITY {k} 0 {2 * math.pi * x!r} 0 {spin}" for k, (x, *_) in zip((4, 5), rods, strict=True)
    ]
    counts = "5 0 0 0 0 3 0 1 0 0 0 1"
    lines = [
        counts,
        *bodies,
        *revolute,
        *slide,
        "1 0 0 0 0 0 0",
        f"0 {end:g} {end / 100:g}",
        "DYNAMICS forward",
    ]
    return "\n".join([*lines, "GRAVITY 0 0 -9.81", *masses, *springs, *speeds]) + f"\n{cards}END\n"


def andrews(cards: str) -> str:
    """The supplied deck with other cards for its steps."""
    return ANDREWS.read_text().replace("TOLERANCE 1e-10\n", cards)


def four_bar(cards: str) -> str:
    """One four-bar for 10 s."""
    return deck_of(1, "DOP853", 1.0).replace("TOLERANCE 1\n", cards)


def pendulum(tolerance: float, radius: float | None):
    """Clock and blocks of rows of the flexible pendulum, by DOP853 where there is no radius."""
    text = (DECKS / "vsdf/pendulum.vsdf").read_text().replace("    5.0E-4    5.0E-5", "    5.0E-4       0.0")
    method = f" RK45{tolerance:10.0E}" if radius is None else f" GALF{radius:10g}"
    deck = read_vsdf(DeckText("pendulum", text.replace(" GALF       0.9", method), ""))
    analysis = FlexibleDynamics(flexible_mechanism(build_vsdf(deck, DECKS / "vsdf")[0], cached=False)[0])
    analysis.clock["rtol"] = analysis.clock["atol"] = tolerance
    blocks = list(analysis.rows())
    return analysis.clock[0], blocks


def rigid(make):
    """The same of a YOUNG deck that `make` writes around the cards of its steps."""

    def solved(tolerance, radius):
        steps = "" if radius is None else f"GALF 0 {radius:g}\n"
        clock, blocks, _ = run(make(f"TOLERANCE {tolerance:g}\n{steps}"))
        return clock, blocks

    return solved


RIGID = ("position", "euler_parameters"), ("velocity", "angular_velocity")
FLEXIBLE = ("euler_parameters", "point_position"), ("point_velocity", "angular_velocity")
# How a problem is solved, and what of its rows is compared.
PROBLEMS = {
    "governor": (rigid(governor), *RIGID),
    "squeezer": (rigid(andrews), *RIGID),
    "four-bar": (rigid(four_bar), *RIGID),
    "pendulum": (pendulum, *FLEXIBLE),
}
REFERENCE = 1e-12


def last(problem: str, tolerance: float, radius: float | None):
    """Positions with Euler parameters, speeds of their largest of the whole run, time reached, steps."""
    solved, places, speeds = PROBLEMS[problem]
    clock, blocks = solved(tolerance, radius)
    end = blocks[-1]
    largest = [max(np.abs(getattr(block, name)).max() for block in blocks) for name in speeds]
    place = np.concatenate([getattr(end, name)[-1].ravel() for name in places])
    speed = [getattr(end, name)[-1].ravel() / size for name, size in zip(speeds, largest, strict=True)]
    return place, np.concatenate(speed), float(end.time[-1]), int(clock["steps"])


def errors(problem: str, tolerance: float, radius: float, exact) -> tuple[float, float, float, int]:
    """Errors of positions and speeds in tolerances against `last` of the reference; time reached, steps."""
    place, speeds, t, steps = last(problem, tolerance, radius)
    off = [float(np.abs(a - b).max()) / tolerance for a, b in ((place, exact[0]), (speeds, exact[1]))]
    return *off, t, steps


def step_cost(step: float) -> tuple[float, float]:
    """Processor time, s, and evaluations of a step of given length of the squeezer."""
    costs = []
    for end in (0.003, 0.03):
        deck = andrews(f"GALF {step:g} 0.9\n").replace("0 0.03 0.0005", f"0 {end} {end}")
        clock = run(deck)[0]
        costs.append((least(lambda deck=deck: run(deck), 1), clock["evaluations"], clock["steps"]))
    time, evaluations, steps = (long - short for short, long in zip(*costs, strict=True))
    return time / steps, evaluations / steps


def main():
    """Print a row for every problem, tolerance and spectral radius."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawTextHelpFormatter)
    parser.add_argument("--problem", nargs="+", choices=PROBLEMS, default=list(PROBLEMS))
    parser.add_argument("--tolerance", nargs="+", type=float, default=[1e-3, 1e-5, 1e-7])
    parser.add_argument("--radius", nargs="+", type=float, default=[0.9])
    parser.add_argument("--given", nargs="+", type=float, default=[], help="lengths of steps, s")
    given = parser.parse_args()
    print("problem   radius  tolerance    steps  position    speed (errors in tolerances)")
    for problem in given.problem:
        exact = last(problem, REFERENCE, None)
        for radius in given.radius:
            for tolerance in given.tolerance:
                position, speed, t, steps = errors(problem, tolerance, radius, exact)
                print(
                    f"{problem:9} {radius:6g} {tolerance:10.0e} {steps:8d} {position:9.2g} {speed:8.2g}  "
                    f"t = {t:g} s",
                    flush=True,
                )
    for step in given.given:
        time, evaluations = step_cost(step)
        print(f"squeezer, steps of {step:g} s: {1e6 * time:.1f} µs and {evaluations:.2f} evaluations a step")


if __name__ == "__main__":
    main()
