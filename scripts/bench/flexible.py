"""Cost of flexible bodies: steps, equal error against Exudyn, growth with the number of FE nodes.

    pip install -e '.[bench]' && python scripts/bench/flexible.py [PART...]

The pendulum is that of decks/vsdf: 54 nodes, 162 degrees of freedom, let go horizontally.  Both programs
get the same M and K and as many modes; their frames and joints differ (Exudyn: free-free modes and the
mean of the root face, flexmb: three reference nodes and a joint of five equations), so the error of each
is taken against itself with steps so short that they do not matter.  The part `slider` is the slider-crank
with a flexible rod; see flexible_slider.py for how the two describe it.  Errors are the largest at ten even
times.  Times are processor seconds of solving, starting and reporting those ten rows included, the best of
several runs, the two programs in turn.
"""

import argparse
import sys
import tempfile
import time
from dataclasses import replace
from pathlib import Path

import flexible_slider
import numpy as np
from scipy import sparse
from scipy.io import mmread, mmwrite

TOP = Path(__file__).resolve().parents[2]
sys.path.insert(0, str(TOP))
DECKS = TOP / "decks" / "vsdf"
MODES = (8, 20)
END, ROWS = 0.5, 10
STEPS = (1e-3, 5e-4, 2e-4, 1e-4)
REFERENCE = 1e-5
TOLERANCES = (1e-2, 1e-3, 1e-4, 1e-5, 1e-6, 1e-7, 1e-8)
EQUAL_ERROR = 1e-6  # m
REPEATS = 3
TIP = 51


def mechanism(modes, folder=DECKS, *changes):
    """The pendulum with so many modes; `changes` in the text of its deck."""
    from flexmb_cli.fe.build_mechanism import flexible_mechanism
    from flexmb_cli.model.build_vsdf import build_vsdf
    from flexmb_cli.read.deck import DeckText
    from flexmb_cli.read.vsdf import read_vsdf

    text = (DECKS / "pendulum.vsdf").read_text().replace("    1 FLEX    9", f"    1 FLEX{modes:5d}")
    for old, new in changes:
        text = text.replace(old, new)
    return flexible_mechanism(build_vsdf(read_vsdf(DeckText("pendulum", text, "")), folder)[0], cached=False)[
        0
    ]


def march(given, method, step, parameter, end=END, outputs=slice(0, 1)):
    """(places (ROWS, 3 nodes) of output nodes at even times, processor seconds, steps)."""
    from flexmb_cli.model.vsdf_model import Integrator
    from flexmb_cli.solve.flexible_dynamics import FlexibleDynamics

    grid = replace(given.time, end=end, step=end / ROWS)
    analysis = FlexibleDynamics(replace(given, time=grid, integrator=Integrator(method, step, parameter)))
    begin = time.process_time()
    places = np.concatenate([rows.point_position[:, outputs] for rows in analysis.rows()])
    spent = time.process_time() - begin
    return places[1:].reshape(ROWS, -1), spent, int(analysis.clock["steps"][0])


def exudyn_pendulum(modes):
    """The system and the sensor of its tip."""
    import exudyn as exu
    from exudyn.FEM import FEMinterface, ObjectFFRFreducedOrderInterface
    from exudyn.itemInterface import (
        GenericJoint,
        MarkerBodyRigid,
        MarkerSuperElementRigid,
        ObjectGround,
        SensorSuperElement,
    )

    nodes = np.loadtxt(DECKS / "fe" / "pendulum_nodes.txt", comments=("*", "#"))[:, 1:4]
    mbs, fem = exu.SystemContainer().AddSystem(), FEMinterface()
    fem.nodes = {"Position": nodes}
    fem.massMatrix, fem.stiffnessMatrix = (
        mmread(DECKS / "fe" / f"pendulum_{name}.mtx").tocsr() for name in ("M", "K")
    )
    fem.ComputeEigenmodes(modes, excludeRigidBodyModes=6, useSparseSolver=False)
    added = ObjectFFRFreducedOrderInterface(fem).AddObjectFFRFreducedOrder(mbs, gravity=[0, 0, -9.81])
    body = added["oFFRFreducedOrder"]
    root = [int(k) for k in np.flatnonzero(np.abs(nodes[:, 0]) < 1e-9)]
    place = list(nodes[root].mean(axis=0))
    ground = mbs.AddMarker(MarkerBodyRigid(bodyNumber=mbs.AddObject(ObjectGround()), localPosition=place))
    weights = [1 / len(root)] * len(root)
    face = MarkerSuperElementRigid(bodyNumber=body, meshNodeNumbers=root, weightingFactors=weights)
    joint = GenericJoint(markerNumbers=[ground, mbs.AddMarker(face)], constrainedAxes=[1, 1, 1, 1, 0, 1])
    mbs.AddObject(joint)
    tip = {"meshNodeNumber": TIP - 1, "outputVariableType": exu.OutputVariableType.Position}
    sensor = mbs.AddSensor(SensorSuperElement(bodyNumber=body, storeInternal=True, **tip))
    mbs.Assemble()
    return mbs, sensor


def exudyn_march(modes, step):
    """As `march`, by generalised-alpha with the same spectral radius."""
    mbs, sensor = exudyn_pendulum(modes)
    return flexible_slider.solve(mbs, [sensor], step, END, ROWS)


def runs_of(modes):
    """Name, setting → a run, for all contestants; the first of each is its reference."""
    given = mechanism(modes)
    return {
        "Exudyn": (lambda h: exudyn_march(modes, h), (REFERENCE, *STEPS)),
        "flexmb GALF": (lambda h: march(given, "GALF", h, 0.9), (REFERENCE, *STEPS)),
        "flexmb RK45": (lambda tol: march(given, "RK45", 0.0, tol), (1e-12, *TOLERANCES)),
        "flexmb RAD5": (lambda tol: march(given, "RAD5", 0.0, tol), (1e-10, *TOLERANCES)),
    }


def equal_error():
    """The pendulum with few and many modes."""
    for modes in MODES:
        print(f"{modes} modes, {END:g} s")
        compare(runs_of(modes), END, (EQUAL_ERROR,))


def slider():
    """The slider-crank with a flexible rod, and how far apart the converged motions of the programs are."""
    given, M, K = flexible_slider.slider_crank()
    end = flexible_slider.END
    places = flexible_slider.OUTPUTS
    contestants = {
        "Exudyn": (
            lambda h: flexible_slider.exudyn_march(given, M, K, h, flexible_slider.whole_bodies, ROWS),
            (flexible_slider.REFERENCE, *flexible_slider.STEPS),
        ),
        "Exudyn 1D": (
            lambda h: flexible_slider.exudyn_march(given, M, K, h, flexible_slider.single_coordinates, ROWS),
            (flexible_slider.REFERENCE, *flexible_slider.STEPS),
        ),
        "flexmb GALF": (
            lambda h: march(given, "GALF", h, 0.9, end, places),
            (flexible_slider.REFERENCE, *flexible_slider.STEPS),
        ),
        "flexmb RK45": (lambda tol: march(given, "RK45", 0.0, tol, end, places), (1e-12, *TOLERANCES)),
        "flexmb RAD5": (lambda tol: march(given, "RAD5", 0.0, tol, end, places), (1e-10, *TOLERANCES)),
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


def growth():
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
        march(given, "GALF", 1e-4, 0.9, 0.001)
        runs = [march(given, "GALF", 1e-4, 0.9) for _ in range(REPEATS)]
        cost = min(spent / steps for _, spent, steps in runs)
        print(f"{6 * (cells + 1):8d} {built:12.2f} {cost * 1e6:12.1f}", flush=True)


PARTS = {"equal-error": equal_error, "slider": slider, "growth": growth}


def main():
    """Measure the parts named, or all."""
    form = argparse.RawDescriptionHelpFormatter
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=form)
    parser.add_argument("parts", nargs="*", choices=[*PARTS, []], help=", ".join(PARTS))
    for name in parser.parse_args().parts or PARTS:
        PARTS[name]()


if __name__ == "__main__":
    main()
