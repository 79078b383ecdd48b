"""Equilibria of a deck under its loads, stepped from none to all of them, or along the times of its rows."""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING, Any

import numpy as np

from ..deck.record import Deck
from ..errors import AnalysisError, Fault, ModelError, sentences
from ..model.general_joints import refuse_switches
from ..model.unit_checks import unit_warnings
from ..results.files.file_names import refuse_foreign
from ..results.hdf5.layout import TIME, Layout, Series
from .load_shares import grid_of, with_grid, with_loads
from .mechanism_modes import Wish, kernels_for
from .model import analysis_of, model_of, open_deck
from .outcome import Listener, Outcome, Run, RunOptions, Stop, ending_recorded
from .solution import solution_of, with_outputs
from .solutions.at_rest import refuse_states

if TYPE_CHECKING:
    from ..solvers.linearisation.stiffness import Stiffness

LOADS = Series("statics/load_factor", (), "1", "share of gravity, forces and torques that acts")
LOWEST = Series("statics/lowest_eigenvalue", (), "1/s2", "lowest eigenvalue of M^-1 K: stable if positive")
FEW_STEPS = 20
# What is reported of an equilibrium: names of quantities, and the axis that names their items.
REPORTED = (
    ("coordinate/q", "coordinate"),
    ("body/position", "body"),
    ("reaction/force", "joint"),
    ("reaction/torque", "joint"),
    ("hinge/force", "hinge"),
    ("hinge/torque", "hinge"),
    ("driver/effort", "driver"),
    ("element/effort", "element"),
)


@dataclass(frozen=True)
class Stepping:
    """Steps of the loads, a number of `steps`, 0 for all at once, or of time, those of all `rows`.

    `time`: when loads and drivers act, s; None: at the start.
    """

    steps: int = 0
    rows: bool = False
    time: float | None = None


@dataclass(frozen=True)
class Equilibrium:
    """An equilibrium at a share of the loads and a time, s, and its stiffness."""

    share: float
    time: float
    stiffness: "Stiffness"


@dataclass
class StaticsReport:
    """Equilibria of one deck; `values` (steps, …): their quantities by the paths of their datasets."""

    outcome: Outcome
    deck: Deck | None = None
    layout: Layout | None = None
    equilibria: list[Equilibrium] = field(default_factory=list)
    values: Mapping[str, np.ndarray] = field(default_factory=dict)

    def named(self) -> Iterator[tuple[str, list[str], np.ndarray]]:
        """Yield the quantities that are reported, the names of their items, and values (steps, items, …)."""
        axes = {axis.path: axis for axis in self.layout.axes} if self.layout else {}
        for path, axis in REPORTED:
            if path in self.values and f"{axis}/{axis}" in axes:
                labels = {label: names for label, names, _ in axes[f"{axis}/{axis}"].labels}
                yield path, list(labels[f"{axis}/name"]), self.values[path]

    def as_dict(self) -> dict[str, Any]:
        """The record that `--json` prints."""
        record = self.outcome.as_dict() | {"equilibria": []}
        for k, each in enumerate(self.equilibria):
            fields: dict[str, Any] = {"load_factor": each.share, "time": each.time}
            fields |= {"stability": each.stiffness.stability}
            fields |= {"eigenvalues": each.stiffness.eigenvalues.tolist()}
            fields |= {"coordinates": list(each.stiffness.names), "units": list(each.stiffness.units)}
            fields |= {"relative_to": list(each.stiffness.relative_to)}
            fields |= {"stiffness": each.stiffness.matrix.tolist()}
            for path, names, values in self.named():
                fields[path] = dict(zip(names, values[k].tolist(), strict=True))
            record["equilibria"].append(fields)
        return record


def statics_of_deck(path: str, stepping: Stepping, options: RunOptions, listener: Listener) -> StaticsReport:
    """Return the equilibria of the deck at `path`; failures become the outcome's faults.

    A result goes to `options.h5`, if that names a file.
    """
    report = StaticsReport(Outcome(path))
    with ending_recorded(report.outcome, options), Stop.released():
        _fill(report, stepping, Run(report.outcome, options, listener.kept_in(report.outcome.notices)))
    return report


def _fill(report: StaticsReport, stepping: Stepping, run: Run) -> None:
    report.deck = deck = open_deck(run.outcome.deck, run.options, run.outcome)
    if run.options.h5 is not None:
        refuse_foreign((run.options.h5,), run.options.force)
    model = model_of(deck, run)
    analysis = analysis_of(model)
    if analysis == "kinematic" or (analysis == "dynamic" and model.analysis != "forward"):
        message = (
            "an equilibrium needs masses and a free motion: cards after the last number, from DYNAMICS "
            "forward on, give them"
        )
        raise ModelError([Fault("error", message, id="SOLVE-180")])
    refuse_states(model.elements.signals, "flexmb statics")
    if stepping.rows or stepping.time is not None:
        refuse_switches(model.elements, "statics at later times")
    # What lines START equilibrium ask for is what this command does.
    model = replace(model, elements=replace(model.elements, rests=()))
    run.warn(unit_warnings(model))
    steps = list(_steps(grid_of(model), stepping))
    blocks: list[Mapping[str, np.ndarray]] = []
    try:
        _follow(model, steps, report, blocks, run)
    finally:
        if blocks:
            _gather(report, model, blocks, run)
    _warn_of_instability(report.equilibria, run)
    _write(report, run)


def _steps(grid: Any, stepping: Stepping) -> Iterator[tuple[float, float]]:
    """Yield shares of the loads, and times, s."""
    if stepping.rows:
        yield from ((1.0, grid.time(k)) for k in range(grid.rows))
        return
    time = grid.start if stepping.time is None else stepping.time
    shares = [k / stepping.steps for k in range(stepping.steps + 1)] if stepping.steps else [1.0]
    yield from ((share, time) for share in shares)


def _follow(
    model: Any,
    steps: Sequence[tuple[float, float]],
    report: StaticsReport,
    blocks: list[Mapping[str, np.ndarray]],
    run: Run,
) -> None:
    """Go from equilibrium to equilibrium; raises AnalysisError where there is none."""
    grid, rest = grid_of(model), None
    # Of many steps compiled kernels pay off earlier.
    speeds = _speeds(model) * (1 + len(steps) // FEW_STEPS)
    with kernels_for(speeds, Wish(None, True), grid, run.listener):
        for share, time in steps:
            Stop.raise_if_asked()
            loaded = with_grid(with_loads(model, share), replace(grid, start=time, end=time))
            try:
                stiffness, rest = _settled(loaded, rest, run)
            except AnalysisError as failure:
                raise _at_share(failure, share, time) from None
            solution = solution_of(loaded, _silent(run))
            analysis: Any = solution.analysis
            analysis.rest = rest
            blocks.append(next(iter(solution.blocks())))
            report.equilibria.append(Equilibrium(share, time, stiffness))


def _settled(model: Any, rest: np.ndarray | None, run: Run) -> tuple["Stiffness", np.ndarray]:
    """Return stiffness and state of the equilibrium that a model falls into from its start, or `rest`."""
    from ..solvers.linearisation.equilibrium import put_at_rest, state_of
    from ..solvers.linearisation.stiffness import stiffness_of

    analysis: Any = solution_of(model, _silent(run)).analysis
    analysis.rest = rest
    formulation = put_at_rest(analysis)
    run.outcome.faults += [fault for fault in analysis.warnings if fault not in run.outcome.faults]
    return stiffness_of(formulation(analysis)), state_of(analysis)


def _at_share(failure: AnalysisError, share: float, time: float) -> AnalysisError:
    [fault] = failure.faults
    return AnalysisError(replace(fault, message=f"at the load factor {share:.6g}: {fault.message}"), time)


def _silent(run: Run) -> Run:
    """The run whose solutions neither report nor begin at rest by themselves."""
    options = replace(run.options, from_equilibrium=False, strict=False)
    return run.with_new_outcome._replace(options=options, listener=Listener())


def _speeds(model: Any) -> int:
    if hasattr(model, "coordinates"):
        return len(model.coordinates)
    bodies = model.mechanism.bodies if hasattr(model, "mechanism") else model.bodies
    return sum(6 + getattr(body, "modes", 0) for body in bodies)


def _gather(report: StaticsReport, model: Any, blocks: list[Mapping[str, np.ndarray]], run: Run) -> None:
    """Put the equilibria one after the other; their `time` is the share of the loads where these step."""
    assert report.deck is not None, "the deck is read"
    equilibria = report.equilibria
    values = {path: np.concatenate([block[path] for block in blocks]) for path in blocks[0]}
    shares = np.array([each.share for each in equilibria])
    times = np.array([each.time for each in equilibria])
    values["time"] = times if np.ptp(times) > 0.0 else shares
    values[LOADS.path] = shares
    values[LOWEST.path] = np.array([each.stiffness.lowest for each in equilibria])
    solution = with_outputs(solution_of(model, _silent(run)), report.deck)
    layout = solution.layout()
    report.layout = replace(
        layout, analysis="static", rows=len(blocks), series=(*layout.series, LOADS, LOWEST)
    )
    report.values = solution.outputs(values)
    run.outcome.rows = len(blocks)


def _warn_of_instability(equilibria: Sequence[Equilibrium], run: Run) -> None:
    """Warn of the first unstable equilibrium, and of the share of the loads at which stability is lost."""
    for k, each in enumerate(equilibria):
        if each.stiffness.stability != "unstable":
            continue
        message = (
            f"the equilibrium is unstable: its lowest eigenvalue is {each.stiffness.lowest:.6g} 1/s^2; begin "
            "aside of it for one that is stable"
        )
        before = equilibria[k - 1] if k else None
        if before and before.stiffness.lowest > 0.0:
            high, low = before.stiffness.lowest, each.stiffness.lowest
            critical = before.share + (each.share - before.share) * high / (high - low)
            message += f"; stability is lost at the load factor {critical:.4g}, interpolated"
        run.warn([Fault("warning", message, id="SOLVE-181")])
        return


def _write(report: StaticsReport, run: Run) -> None:
    path = run.options.h5
    if path is None:
        return
    from ..results.hdf5.result_file import ResultFile

    assert report.deck is not None and report.layout is not None, "there are equilibria"
    layout, values = report.layout, report.values
    paths = {TIME.path, *(series.path for series in layout.series)}
    result = ResultFile(path, report.deck, layout)
    result.rows({name: array for name, array in values.items() if name in paths})
    result.close(notes=sentences(run.outcome.faults))
    run.outcome.files = (path,)
