"""Cost of flexible bodies: the same pendulum in flexmb and Exudyn, steps, equal errors, growth with the mesh.

    pip install -e '.[bench]' && python scripts/bench/flexible.py [PART...]

The part `agree` solves the pendulum of decks/vsdf with ever shorter steps in both programs and ends with
exit code 1 unless the places of its tip agree; see flexible_pendulum.py for how Exudyn describes it.
`equal-error` does the same first.  `slider` is the slider-crank with a flexible rod; see flexible_slider.py.

Errors are the largest at ten even times; those of the pendulum against one reference for all, flexmb's RK45
at 1e-11.  Times are processor seconds of solving, starting and reporting those ten rows included, but neither
building nor compiling.  Of the pendulum they are medians of rounds in which all contestants take turns.
"""

import argparse
import sys
import tempfile
import time
from dataclasses import replace
from pathlib import Path

import flexible_pendulum
import flexible_slider
import numpy as np
from scipy import sparse
from scipy.io import mmwrite

sys.exudynFast = True  # Exudyn's module without range checks; it looks here when it is imported
TOP = Path(__file__).resolve().parents[2]
sys.path.insert(0, str(TOP))
DECKS = TOP / "decks" / "vsdf"
MODES = (8, 20)
END, ROWS = 0.5, 10
LIMIT = 1e-7  # m, by which the converged places of the two programs may differ
STEPS = (1e-3, 1e-4)  # s, at which the cost of a step is measured
EQUAL_ERRORS = (1e-5, 1e-6)  # m
NEWTON = (1e-8, 1e-6, 1e-5)  # Exudyn's tolerance, of which the first is its default
TOLERANCES = (1e-2, 1e-3, 1e-4, 1e-5, 1e-6, 1e-7, 1e-8)  # of the slider-crank
REPEATS, ROUNDS = 3, 7
STRIDE = 6  # of the settings that `cheapest` tries first


def mechanism(modes, folder=DECKS, *changes):
    """The pendulum with so many modes; `changes` in the text of its deck."""
    from flexmb_cli.deck.record import DeckText
    from flexmb_cli.dialects.vsdf.build import build_vsdf
    from flexmb_cli.dialects.vsdf.reader import read_vsdf
    from flexmb_cli.fe.build_mechanism import flexible_mechanism

    text = (DECKS / "pendulum.vsdf").read_text().replace("    1 FLEX    9", f"    1 FLEX{modes:5d}")
    for old, new in changes:
        text = text.replace(old, new)
    return flexible_mechanism(build_vsdf(read_vsdf(DeckText("pendulum", text, "")), folder)[0], cached=False)[
        0
    ]


def integration(given, method, step, parameter, end=END, outputs=slice(0, 1)):
    """(places (ROWS, 3 nodes) of output nodes at even times, processor seconds, steps)."""
    from flexmb_cli.model.integrators import Integrator
    from flexmb_cli.solvers.constrained.flexible_dynamics import FlexibleDynamics

    grid = replace(given.time, end=end, step=end / ROWS)
    numbers = (1e-6, parameter) if method == "GALF" else (parameter,)
    analysis = FlexibleDynamics(replace(given, time=grid, integrator=Integrator(method, step, *numbers)))
    begin = time.process_time()
    places = np.concatenate([rows.point_position[:, outputs] for rows in analysis.rows()])
    spent = time.process_time() - begin
    return places[1:].reshape(ROWS, -1), spent, int(analysis.clock["steps"][0])


def agree(choice):
    """Whether both programs have the same motion, with few and many modes."""
    for modes in choice.modes:
        require_agreement(modes, mechanism(modes))


def require_agreement(modes, given):
    """Print how far apart the converged places of the tip are; return flexmb's, or end the program."""
    exact = integration(given, "RK45", 0.0, 1e-11)[0]
    places, corrected = flexible_pendulum.converged(given.bodies[0].flexible, END, ROWS)
    apart = np.abs(places - exact).max()
    galf = np.abs(integration(given, "GALF", 2e-5, 0.9)[0] - exact).max()
    print(f"{modes} modes, {END:g} s: converged Exudyn is off flexmb by {apart:.1e} m", end=" ")
    print(f"(after a correction of {corrected:.0e} m); GALF with steps of 2e-5 s by {galf:.1e} m", flush=True)
    if not apart <= LIMIT:
        sys.exit(f"the two programs do not solve the same pendulum: {apart:.1e} m, more than {LIMIT:g} m")
    return exact


def contestants(given):
    """Name → (a run by its setting, settings from cheap to dear)."""
    body = given.bodies[0].flexible
    steps = [END / ROWS / n for n in np.unique(np.round(np.geomspace(20, 5000, 85)).astype(int))]
    tolerances = [10.0 ** (-k / 4) for k in range(8, 41)]

    def exudyn(newton):
        return lambda h: flexible_pendulum.exudyn_integration(body, h, newton, END, ROWS)

    return {
        **{f"Exudyn, Newton {newton:g}": (exudyn(newton), steps) for newton in NEWTON},
        "flexmb GALF": (lambda h: integration(given, "GALF", h, 0.9), steps),
        "flexmb RK45": (lambda tol: integration(given, "RK45", 0.0, tol), tolerances),
        "flexmb RAD5": (lambda tol: integration(given, "RAD5", 0.0, tol), tolerances),
    }


def cheapest(run, settings, exact, error):
    """The cheapest setting with no larger error, at the next dearer one either; None if there is none.

    Errors must fall with the cost.  One setting alone may be lucky where stability limits the steps.
    """

    def enough(k):
        pair = settings[k : k + 2]
        return max(np.abs(run(setting)[0] - exact).max() for setting in pair) <= error

    high = next((k for k in range(0, len(settings), STRIDE) if enough(k)), None)
    if high is None:
        return None
    low = max(0, high - STRIDE + 1)
    while low < high:
        middle = (low + high) // 2
        low, high = (low, middle) if enough(middle) else (middle + 1, high)
    return settings[high]


def jobs_of(given, exact):
    """(aim, name, run, setting) of all that is to be timed."""
    for name, (run, settings) in contestants(given).items():
        run(settings[0])  # compile
        if "Exudyn" in name or "GALF" in name:
            yield from ((f"step {h:g} s", name, run, h) for h in STEPS)
        for error in EQUAL_ERRORS:
            setting = cheapest(run, settings, exact, error)
            if setting is None:
                print(f"  {name} does not reach {error:g} m")
            else:
                yield f"error {error:g} m", name, run, setting


def equal_error(choice):
    """The pendulum with few and many modes: what a step costs, and a given error."""
    for modes in choice.modes:
        given = mechanism(modes)
        exact = require_agreement(modes, given)
        jobs = list(jobs_of(given, exact))
        rounds = [[run(setting) for _, _, run, setting in jobs] for _ in range(choice.rounds)]
        print("  aim            program               setting  error, m   steps  µs a step        ms")
        for k, (aim, name, _, setting) in sorted(enumerate(jobs), key=lambda job: job[1][0]):
            places, _, steps = rounds[0][k]
            spent = np.median([results[k][1] for results in rounds])
            row = f"  {aim:14} {name:20} {setting:8.1e} {np.abs(places - exact).max():9.1e} {steps:7d}"
            print(f"{row} {spent / steps * 1e6:10.1f} {spent * 1e3:9.1f}", flush=True)


def slider(_choice):
    """The slider-crank with a flexible rod, and how far apart the converged motions of the programs are."""
    given, M, K = flexible_slider.slider_crank()
    end = flexible_slider.END
    places = flexible_slider.OUTPUTS
    contestants = {
        "Exudyn": (
            lambda h: flexible_slider.exudyn_integration(given, M, K, h, flexible_slider.whole_bodies, ROWS),
            (flexible_slider.REFERENCE, *flexible_slider.STEPS),
        ),
        "Exudyn 1D": (
            lambda h: flexible_slider.exudyn_integration(
                given, M, K, h, flexible_slider.single_coordinates, ROWS
            ),
            (flexible_slider.REFERENCE, *flexible_slider.STEPS),
        ),
        "flexmb GALF": (
            lambda h: integration(given, "GALF", h, 0.9, end, places),
            (flexible_slider.REFERENCE, *flexible_slider.STEPS),
        ),
        "flexmb RK45": (lambda tol: integration(given, "RK45", 0.0, tol, end, places), (1e-12, *TOLERANCES)),
        "flexmb RAD5": (lambda tol: integration(given, "RAD5", 0.0, tol, end, places), (1e-10, *TOLERANCES)),
    }
    print(f"slider-crank, rod of {given.bodies[1].flexible.modes} modes, {end:g} s")
    exact = compare(contestants, end, flexible_slider.EQUAL_ERRORS)
    sag = flexible_slider.deflection(exact["Exudyn"])
    print(f"  middle of the rod off its rigid place by {sag:.2e} m")
    for name, places in exact.items():
        apart = np.abs(places - exact["Exudyn"]).max()
        print(f"  converged {name} is off Exudyn by {apart:.1e} m, there or at the slider")


def compare(contestants, end, errors):
    """Tables of steps and errors, and the seconds each needs for the same error → the references."""
    for run, settings in contestants.values():
        run(settings[-1])  # compile
    exact = {name: run(settings[0])[0] for name, (run, settings) in contestants.items()}
    print("  program      step or tol.  error, m   µs a step   s per simulated s")
    measured = {}
    for name, (run, settings) in contestants.items():
        found = []
        for setting in settings[1:]:
            repeats = [run(setting) for _ in range(REPEATS)]
            spent, (place, _, steps) = min(r[1] for r in repeats), repeats[0]
            error = np.abs(place - exact[name]).max()
            found.append((error, spent / end))
            row = f"  {name:12} {setting:8.0e} {error:12.1e} {spent / steps * 1e6:10.1f}"
            print(f"{row} {spent / end:12.4f}", flush=True)
        measured[name] = found
    for equal in errors:
        needed = {name: seconds_at(found, equal) for name, found in measured.items()}
        for name in (name for name in needed if name.startswith("flexmb")):
            for peer in (peer for peer in needed if peer.startswith("Exudyn")):
                gain = needed[peer] / needed[name]
                print(f"  for {equal:g} m {name} takes {needed[name]:.4f} s, {peer} {gain:.2g} times that")
    return exact


def seconds_at(found, equal):
    """Seconds per simulated second of the cheapest run whose error is small enough."""
    return min((seconds for error, seconds in found if error <= equal), default=np.nan)


def lattice(folder, cells):
    """Files of a rod of so many cells: point masses, and springs between all nodes of a cell."""
    (folder / "fe").mkdir()
    x, y, z = np.meshgrid(np.arange(cells + 1), np.arange(3), np.arange(2), indexing="ij")
    nodes = np.stack([0.1 * x / cells, 0.005 * y, 0.015 * z], axis=-1).reshape(-1, 3)
    number = np.arange(len(nodes)).reshape(cells + 1, 3, 2)
    ends = (slice(0, -1), slice(1, None))
    corners = [number[a, b, c].ravel() for a in ends for b in ends for c in (0, 1)]
    pairs = [np.stack([p, q], 1) for k, p in enumerate(corners) for q in corners[k + 1 :]]
    pairs = np.unique(np.concatenate(pairs), axis=0)
    gap = nodes[pairs[:, 1]] - nodes[pairs[:, 0]]
    length = np.linalg.norm(gap, axis=1)
    blocks = 1e3 / length[:, None, None] * (gap[:, :, None] * gap[:, None, :]) / length[:, None, None] ** 2
    rows, columns, values = [], [], []
    for a, b, sign in ((0, 0, 1), (1, 1, 1), (0, 1, -1), (1, 0, -1)):
        rows.append(np.repeat(3 * pairs[:, a][:, None] + np.arange(3), 3, axis=1).ravel())
        columns.append(np.tile(3 * pairs[:, b][:, None] + np.arange(3), (1, 3)).ravel())
        values.append(sign * blocks.ravel())
    n = 3 * len(nodes)
    K = sparse.coo_matrix((np.concatenate(values), (np.concatenate(rows), np.concatenate(columns))), (n, n))
    mmwrite(folder / "fe" / "pendulum_K.mtx", K.tocsr(), symmetry="symmetric")
    mmwrite(folder / "fe" / "pendulum_M.mtx", sparse.identity(n) * 0.26 / len(nodes), symmetry="symmetric")
    table = [f"{k} {p[0]:.9g} {p[1]:.9g} {p[2]:.9g}" for k, p in enumerate(nodes, start=1)]
    (folder / "fe" / "pendulum_nodes.txt").write_text("\n".join(table) + "\n")


def growth(_choice):
    """Cost of a step against the number of FE nodes, 8 modes."""
    print("FE nodes   building, s   µs a step")
    for cells in (8, 32, 128, 512):
        with tempfile.TemporaryDirectory() as name:
            lattice(Path(name), cells)
            last = 6 * cells
            chord = ("    1   13    9\n", f"    1{last + 1:5d}    5\n")
            tip = ("    1   51", f"    1{last + 3:5d}")
            begin = time.process_time()
            given = mechanism(8, Path(name), chord, tip)
            built = time.process_time() - begin
        integration(given, "GALF", 1e-4, 0.9, 0.001)
        runs = [integration(given, "GALF", 1e-4, 0.9) for _ in range(REPEATS)]
        cost = min(spent / steps for _, spent, steps in runs)
        print(f"{6 * (cells + 1):8d} {built:12.2f} {cost * 1e6:12.1f}", flush=True)


PARTS = {"agree": agree, "equal-error": equal_error, "slider": slider, "growth": growth}


def main():
    """Measure the parts named, or all."""
    form = argparse.RawDescriptionHelpFormatter
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=form)
    parser.add_argument("parts", nargs="*", choices=[*PARTS, []], help=", ".join(PARTS))
    parser.add_argument("--modes", type=int, nargs="+", default=MODES, help="of the pendulum")
    parser.add_argument("--rounds", type=int, default=ROUNDS, help="of which medians are taken")
    given = parser.parse_args()
    for name in given.parts or PARTS:
        PARTS[name](given)


if __name__ == "__main__":
    main()
