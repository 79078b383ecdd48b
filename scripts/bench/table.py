"""Table of the work that flexmb is measured by: its time, that of a peer, the errors of both, and the goal.

    scripts/bench/run table [ROW...]      (all without arguments; --rounds 5)

Processor time in one run, the programs in turn, medians of rounds; wall time only where it says so.  Peers:
Exudyn (in the plane), MuJoCo, SciPy, plain compiled code of the same equations, bare imports.  The steps of
Exudyn and MuJoCo are such that their errors are about 1e-6.
"""

import argparse
import math
import statistics
import subprocess
import sys
import tempfile
import time
from dataclasses import replace
from pathlib import Path
from typing import NamedTuple

import chosen_steps
import four_bars
import kinematics
import numpy as np
import reduction
import report_rows
import startup
import sweep
from peers import double_pendulum, mujoco_four_bars, planar_exudyn

TOP = Path(__file__).resolve().parents[2]
ANDREWS_STEP, ANDREWS_END = 1e-5, 0.03
EXUDYN_STEP, MUJOCO_STEP = 0.4 / 260, 0.4 / 1000


class Row(NamedTuple):
    """A line of the table; times and goal in `unit`."""

    work: str
    unit: str
    flexmb: float
    goal: float
    error: float | None = None
    peers: tuple[tuple[str, float, float | None], ...] = ()  # name, time, error


def in_turn(calls, rounds, prepare=None):
    """Median processor time, s, and last answer of each of `calls`; `prepare`: its argument, unclocked."""
    spent, answers = {name: [] for name in calls}, {}
    for _ in range(rounds + 1):  # the first one warms up
        for name, call in calls.items():
            given = () if prepare is None or name not in prepare else (prepare[name](),)
            begin = time.process_time()
            answers[name] = call(*given)
            spent[name].append(time.process_time() - begin)
    return {name: statistics.median(values[1:]) for name, values in spent.items()}, answers


def young_model(text):
    """The model of a YOUNG deck's text."""
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "IN.dat"
        path.write_text(text)
        return four_bars.build_young_dynamics(four_bars.read_young_deck(four_bars.read_text(str(path))))[0]


def angle_of_cranks(count, end):
    """Angle, rad from x, of the cranks of a chain at `end`: a pendulum of one degree of freedom."""
    from scipy.integrate import solve_ivp

    inertia, arm = (count + 1) / 3.0 + count, (count + 1) / 2.0 + count

    def slope(t, z):
        return z[1], -9.81 * arm * math.cos(z[0]) / inertia

    return solve_ivp(slope, (0.0, end), [math.pi / 2, -1.0], method="DOP853", rtol=1e-13, atol=1e-13).y[0, -1]


def chain_for(count, goal, rounds):
    """N four-bars for 0.4 s at 1e-6, start included; errors are those of the first crank's pin."""
    model = young_model(four_bars.deck_of(count, "DOP853", 1e-6, 0.4, 0.4))
    angle = angle_of_cranks(count, 0.4)
    pin = np.array([math.cos(angle), math.sin(angle)])
    calls = {
        "flexmb": lambda: list(four_bars.ForwardDynamics(model).rows()),
        "Exudyn": lambda system: planar_exudyn.places_after(system, EXUDYN_STEP, 0.4, True),
        "MuJoCo": lambda: mujoco_four_bars.turn_of_first_crank(count, MUJOCO_STEP, 0.4),
    }
    seconds, answers = in_turn(calls, rounds, {"Exudyn": lambda: planar_exudyn.planar_system(model)})
    errors = {
        "flexmb": np.abs(answers["flexmb"][-1].position[-1, 2, :2] - pin).max(),
        "Exudyn": np.abs(answers["Exudyn"][1, :2] - pin).max(),
        "MuJoCo": abs(answers["MuJoCo"] + math.pi / 2 - angle),
    }
    peers = tuple((name, 1e3 * seconds[name], errors[name]) for name in ("Exudyn", "MuJoCo"))
    yield Row(
        f"{count} four-bars, 0.4 s at 1e-6", "ms", 1e3 * seconds["flexmb"], goal, errors["flexmb"], peers
    )


def evaluations(rounds):
    """An evaluation of the accelerations and a report row of N four-bars, and how they grow."""
    import mujoco

    model, data = mujoco_four_bars.four_bars(40)
    peer = statistics.median(
        four_bars.least(lambda: mujoco.mj_forward(model, data), 100) for _ in range(rounds)
    )
    costs = {
        count: [four_bars.cost_of(count) for _ in range(rounds if count == 40 else 1)]
        for count in (10, 40, 100, 500)
    }
    medians = {
        count: {key: statistics.median(cost[key] for cost in found) for key in found[0]}
        for count, found in costs.items()
    }
    alone, error = medians[40]["evaluation"], medians[40]["error"]
    yield Row("an evaluation, 40 four-bars", "µs", 1e6 * alone, 30.0, error, (("MuJoCo", 1e6 * peer, None),))
    sizes = np.log(list(medians))
    grown = np.polyfit(sizes[1:], np.log([medians[count]["evaluation"] for count in list(medians)[1:]]), 1)[0]
    yield Row("  its exponent, 81 to 1,001 bodies", "", grown, 1.1, medians[500]["error"])
    for count in (10, 40, 100):
        ratio = medians[count]["row"] / medians[count]["evaluation"]
        yield Row(f"a report row, {count} four-bars", "evaluations", ratio, 5.0)


def whole_process(rounds):
    """40 four-bars for 10 s, 1,001 rows, the whole program with its files."""
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "IN.dat"
        path.write_text(four_bars.deck_of(40, "DOP853", 1e-6))
        command = [sys.executable, "-m", "flexmb_cli", "run", "-q", "-o", folder, str(path)]
        kinematics.child_seconds(command)
        spent = statistics.median(kinematics.child_seconds(command) for _ in range(rounds))
        import h5py

        with h5py.File(Path(folder) / "OUT.h5") as result:
            kinetic, total = (result[f"energy/{name}"][:] for name in ("kinetic", "total"))
    error = np.abs(total - total[0]).max() / kinetic.max()
    yield Row("40 four-bars, 10 s, 1,001 rows, whole process", "s", spent, 1.0, error)


def sweep_case(rounds):
    """A case of a sweep of 20,000 variants of the RSSR, and its kinematic analysis by itself."""
    with tempfile.TemporaryDirectory() as folder:
        case, alone = sweep.costs(20_000, folder)
    yield Row("sweep of 20,000 RSSR, a case", "ms", 1e3 * case, 0.3, None, (("analysis", 1e3 * alone, None),))


def files(rounds):
    """A report row of the RSSR with OUT and HDF5."""
    seconds = report_rows.seconds_a_row(50_000, rounds)
    yield Row("OUT and HDF5, RSSR, a row", "µs", 1e6 * seconds["OUT and HDF5"], 14.0)


def bricks(rounds):
    """Twenty modes of bricks and slender bricks of 10,000 nodes, whole process, and `eigsh` alone."""
    for body in ("bricks", "slender"):
        _nodes, (seconds, _), (alone, _), error = reduction.compared(body, 10_000)
        peers = (("eigsh", alone, None),)
        yield Row(f"20 modes of 10,000 nodes, {body}", "s", seconds, 1.3 * alone, error, peers)


def kinematic_chains(rounds):
    """Chains of RSSR stages, 11 rows, start included: µs a body and row."""
    for stages in (16, 33, 333):
        bodies, cost, error = kinematics.chain_cost(stages, rounds)
        yield Row(f"chain of {bodies} bodies, kinematics, a body and row", "µs", 1e6 * cost, 8.0, error)


def andrews(rounds):
    """A generalised-α step of Andrews' squeezer: 0.03 s by 3,000 steps; errors of places at the end."""
    model = young_model(chosen_steps.andrews(f"GALF {ANDREWS_STEP:g} 0.9\n"))
    model = replace(model, mechanism=replace(model.mechanism, time=replace(model.mechanism.time, step=0.03)))
    exact = list(four_bars.ForwardDynamics(young_model(chosen_steps.andrews("TOLERANCE 1e-12\n"))).rows())[
        -1
    ].position[-1, 1:]
    calls = {
        "flexmb": lambda: list(four_bars.ForwardDynamics(model).rows())[-1].position[-1, 1:],
        "Exudyn": lambda system: planar_exudyn.places_after(system, ANDREWS_STEP, ANDREWS_END, False),
    }
    seconds, places = in_turn(calls, rounds, {"Exudyn": lambda: planar_exudyn.planar_system(model)})
    micro = {name: 1e6 * spent * ANDREWS_STEP / ANDREWS_END for name, spent in seconds.items()}
    errors = {name: np.abs(found - exact).max() for name, found in places.items()}
    yield Row(
        "Andrews, generalised-α step", "µs", micro["flexmb"], 20.0, errors["flexmb"],
        (("Exudyn", micro["Exudyn"], errors["Exudyn"]),),
    )  # fmt: skip


def pendulum(rounds):
    """The double pendulum for 100 s at 1e-9, 1,001 rows, and plain compiled code at about the same error."""
    from flexmb_cli.solvers.tree.analysis import TreeAnalysis

    times = np.linspace(0.0, double_pendulum.END, double_pendulum.ROWS)
    tree = double_pendulum.pendulum_of_flexmb(1e-9)
    exact = double_pendulum.plain_rows(1e-13, double_pendulum.START, times)[:, :2]
    calls = {
        "flexmb": lambda: np.concatenate([rows.q for rows in TreeAnalysis(tree).rows()]),
        "plain": lambda: double_pendulum.plain_rows(2e-10, double_pendulum.START, times)[:, :2],
    }
    seconds, angles = in_turn(calls, rounds)
    errors = {name: np.abs(found - exact).max() for name, found in angles.items()}
    yield Row(
        "double pendulum, 100 s at 1e-9", "ms", 1e3 * seconds["flexmb"], 6.0, errors["flexmb"],
        (("plain numba", 1e3 * seconds["plain"], errors["plain"]),),
    )  # fmt: skip


def start(rounds):
    """The VSDF pendulum, whole process, against the bare imports: wall time, medians of 21."""
    with tempfile.TemporaryDirectory(prefix="flexmb-startup-") as folder:
        environment = startup.surroundings(folder, False)
        commands = {
            "flexmb": ["-m", "flexmb_cli", "run", "-q", str(TOP / "decks/vsdf/pendulum.vsdf")],
            "imports": ["-c", f"import {startup.PACKAGES}"],
        }
        spent = {name: [] for name in commands}
        for _ in range(22):
            for name, command in commands.items():
                begin = time.perf_counter()
                subprocess.run(
                    [sys.executable, *command], cwd=folder, env=environment, check=True, capture_output=True
                )
                spent[name].append(time.perf_counter() - begin)
        whole, bare = (1e3 * statistics.median(spent[name][1:]) for name in commands)
    yield Row(
        "VSDF pendulum, whole process (wall)", "ms", whole, 1.7 * bare, None, (("imports", bare, None),)
    )


ROWS = {
    "chain-40": lambda rounds: chain_for(40, 30.0, rounds),
    "chain-100": lambda rounds: chain_for(100, 70.0, rounds),
    "evaluations": evaluations,
    "whole": whole_process,
    "sweep": sweep_case,
    "files": files,
    "bricks": bricks,
    "kinematics": kinematic_chains,
    "andrews": andrews,
    "pendulum": pendulum,
    "start": start,
}


def line_of(row):
    """The line of a row: the ratio is that to the fastest peer."""
    error = "" if row.error is None else f"{row.error:.0e}"
    told = ", ".join(
        f"{name} {value:.3g}" + ("" if off is None else f" ({off:.0e})") for name, value, off in row.peers
    )
    ratio = f"{row.flexmb / min(value for _, value, _ in row.peers):.2f}" if row.peers else ""
    met = "met" if row.flexmb <= row.goal else "not met"
    return (
        f"| {row.work} | {row.flexmb:.3g} {row.unit} | {error} | {told} | {ratio} | {row.goal:.3g} | {met} |"
    )


def main():
    """Print the table."""
    form = argparse.RawDescriptionHelpFormatter
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=form)
    parser.add_argument("rows", nargs="*", help=", ".join(ROWS))
    parser.add_argument("--rounds", type=int, default=5)
    asked = parser.parse_args()
    print("| work | flexmb | error | peers (error) | ratio | goal | |\n|---|---|---|---|---|---|---|")
    for name in asked.rows or ROWS:
        for row in ROWS[name](asked.rounds):
            print(line_of(row), flush=True)


if __name__ == "__main__":
    main()
