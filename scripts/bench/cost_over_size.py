"""Cost over size, drawn: bodies, loops, modes, elements, report rows and cases, with exponents; memory too.

    scripts/bench/run cost_over_size [PART...] [--most 1000000] [--output cost_over_size.svg]

Prints a table, and draws it (SVG, PNG or PDF).  Times are processor time, the least of some repeats, of an
evaluation, step or row, or of a whole process; memory is the largest of a process, beyond that of the
smallest.  The exponent is the slope of log(cost) over log(size) of the three largest sizes.
"""

import argparse
import json
import resource
import subprocess
import sys
import tempfile
from pathlib import Path
from typing import NamedTuple

import numpy as np

ROWS = (1_000, 10_000, 100_000, 1_000_000)
CASES = (100, 1_000, 10_000, 100_000)


class Series(NamedTuple):
    """Costs over sizes."""

    name: str
    size: str  # what is counted
    unit: str
    sizes: list[int]
    costs: list[float]

    @property
    def exponent(self) -> float:
        """Slope of the three largest sizes."""
        x, y = np.log(self.sizes[-3:]), np.log(np.maximum(self.costs[-3:], 1e-300))
        return float(np.polyfit(x, y, 1)[0])


def trees(most):
    """An evaluation of a chain of rigid links."""
    import four_bars
    import trees as chains

    sizes = [n for n in (8, 32, 128, 512, 1024) if n <= most]
    costs = []
    for links in sizes:
        evaluate, _ = chains.flexmb_evaluator(chains.chain(links))
        count = max(5, 4000 // links)
        costs.append(1e6 * four_bars.least(lambda run=evaluate, n=count: run(n), 1) / count)
    yield Series("tree, an evaluation", "bodies", "µs", sizes, costs)


def loops(most):
    """An evaluation, a report row and the start of N four-bars."""
    import four_bars

    sizes = [n for n in (5, 10, 40, 100, 200, 500) if 2 * n <= most]
    found = list(map(four_bars.cost_of, sizes))
    for key, factor, unit in (("evaluation", 1e6, "µs"), ("row", 1e6, "µs"), ("start", 1e3, "ms")):
        costs = [factor * cost[key] for cost in found]
        yield Series(f"four-bars, {key}", "loops", unit, sizes, costs)


def kinematics(most):
    """A row of a serial chain of RSSR stages."""
    import kinematics as chains

    found = [chains.chain_cost(stages, 3) for stages in (3, 16, 33, 100, 333) if 3 * stages <= most]
    sizes = [bodies for bodies, _, _ in found]
    costs = [1e6 * seconds * bodies for bodies, seconds, _ in found]
    yield Series("kinematics, a row", "bodies", "µs", sizes, costs)


def modes(most):
    """A generalised-α step of the flexible pendulum."""
    import flexible

    sizes, costs = [4, 8, 16, 32, 64], []
    for count in sizes:
        given = flexible.mechanism(count)
        runs = [flexible.integration(given, "GALF", 1e-4, 0.9, end=0.1) for _ in range(4)]
        costs.append(1e6 * min(spent / steps for _, spent, steps in runs[1:]))
    yield Series("flexible body, a step", "modes", "µs", sizes, costs)


def elements(most):
    """An evaluation of a chain of 1,024 links with springs in some of its hinges, less that without."""
    import four_bars
    import trees as chains

    sizes, count = [128, 256, 512, 1024], 50
    evaluators = [chains.flexmb_evaluator(chains.sprung(1024, number))[0] for number in (0, *sizes)]
    rounds = [[four_bars.least(lambda run=run: run(count), 1) for run in evaluators] for _ in range(5)]
    alone, *found = np.min(rounds, axis=0) / count
    yield Series(
        "springs, in an evaluation", "elements", "µs", sizes, [1e6 * (cost - alone) for cost in found]
    )


def rows(most):
    """A whole run of the RSSR with OUT and HDF5."""
    yield from whole("rows", "RSSR with OUT and HDF5", [n for n in ROWS if n <= most])


def cases(most):
    """A sweep of the RSSR in one process."""
    yield from whole("cases", "sweep of the RSSR", [n for n in CASES if n <= most])


def whole(part, name, sizes):
    """Processor time and memory of processes of their own."""
    found = []
    for size in sizes:
        command = [sys.executable, __file__, "--child", part, str(size)]
        done = subprocess.run(command, check=True, capture_output=True, text=True)
        found.append(json.loads(done.stdout))
    yield Series(name, part, "s", sizes, [seconds for seconds, _ in found])
    first = found[0][1]
    growth = [max(peak - first, 0.1) for _, peak in found[1:]]
    yield Series(f"{name}, memory", part, "MB", sizes[1:], growth)


def child(part, size):
    """Run a part in this process; print its processor seconds and its memory, MB."""
    import report_rows
    import sweep

    with tempfile.TemporaryDirectory() as folder:
        if part == "rows":
            path = Path(folder) / report_rows.DECK.name
            path.write_text(report_rows.deck_of(size))
            seconds = report_rows.spent(str(path), folder, {})
        else:
            study = sweep.study_of(size, folder)
            study.solver.solve(0)
            blocks = list(study.pending())
            seconds = sweep.spent_on(lambda: sweep.solve_here(study, blocks, lambda cases: None))
            table = str(Path(folder) / "table.h5")
            seconds += sweep.spent_on(lambda: sweep.write_study_table(table, study))
    print(json.dumps([seconds, resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1e3]))


PARTS = {
    "trees": trees, "loops": loops, "kinematics": kinematics, "modes": modes, "elements": elements,
    "rows": rows, "cases": cases,
}  # fmt: skip


def draw(found, output):
    """Draw all series, one picture for each."""
    import matplotlib

    matplotlib.use("Agg")
    from matplotlib import pyplot

    columns, lines = min(4, len(found)), -(-len(found) // 4)
    figure, axes = pyplot.subplots(lines, columns, figsize=(3.2 * columns, 2.8 * lines), squeeze=False)
    for axis in axes.flat[len(found) :]:
        axis.axis("off")
    for axis, series in zip(axes.flat, found, strict=False):
        axis.loglog(series.sizes, series.costs, "o-", color="#1f5fa8")
        axis.set_title(f"{series.name}: exponent {series.exponent:.2f}", fontsize=8)
        axis.set_xlabel(series.size)
        axis.set_ylabel(series.unit)
        axis.tick_params(which="minor", labelbottom=False, labelleft=False)
        axis.grid(True, which="major", alpha=0.3)
    figure.tight_layout()
    figure.savefig(output)


def main():
    """Print the table and draw it."""
    form = argparse.RawDescriptionHelpFormatter
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=form)
    parser.add_argument("parts", nargs="*", help=", ".join(PARTS))
    parser.add_argument("--most", type=int, default=1_000_000, help="largest size")
    parser.add_argument("--output", default="cost_over_size.svg", help="the drawing")
    parser.add_argument("--child", nargs=2, help=argparse.SUPPRESS)
    asked = parser.parse_args()
    if asked.child:
        child(asked.child[0], int(asked.child[1]))
        return
    found = []
    for part in asked.parts or PARTS:
        for series in PARTS[part](asked.most):
            found.append(series)
            pairs = "  ".join(f"{n}: {cost:.3g}" for n, cost in zip(series.sizes, series.costs, strict=True))
            print(
                f"{series.name} ({series.unit}), {series.size}  {pairs}  exponent {series.exponent:.2f}",
                flush=True,
            )
    draw(found, asked.output)


if __name__ == "__main__":
    main()
