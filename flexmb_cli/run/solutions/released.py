"""Motions in which joints are let go, at a time or when a quantity reaches a value: stage after stage.

Each stage is a motion of the model without the joints that are gone, and begins in the state of the one
before.  A release by a quantity is looked for from row to row, and then between two rows.
"""

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np

from ...deck.record import Deck
from ...dialects.elements_block.line import has_outputs
from ...errors import Fault, ModelError
from ...model.general_joints import Release, without_joints
from ...model.mechanism import ListedTimes
from ...model.signals import SAMPLE_SIGNAL
from ...results.hdf5.layout import Layout, Values
from ...results.hdf5.result_file import empty_result
from ...results.quantities.quantities import SHOWS_ALL, Quantity, ResultError, resolve
from ..load_shares import grid_of, with_grid
from ..outcome import Listener, Run
from . import Solution

# What adds up since the start, or is constant: it continues over the beginning of a stage.
CONTINUED = ("energy/applied_work", "energy/total", "element/work", "element/dissipated", "contact/touches")
COUNTED = ("evaluations", "rejections")  # of steps, which the clock of the first stage sums
SAME_INSTANT = 1e-14  # of the time
OUTPUT_GROUP = "output/"


@dataclass
class _Stage:
    """The beginning of a stage: time, state, expected angles, and what continues."""

    time: float
    rest: np.ndarray | None = None
    angles: np.ndarray | None = None
    continues: bool = False
    sums: dict[str, np.ndarray] = field(default_factory=dict)


SolutionOf = Callable[[Any, Run], Solution]


def released(solution: Solution, model: Any, deck: Deck, run: Run, solution_of: SolutionOf) -> Solution:
    """Return the solution of a model some of whose joints are let go.

    `solution_of`: the solution of the model of a stage.  Raises ModelError.
    """
    _refuse(model, run)
    motion = ReleasedMotion(solution, model, deck, run, solution_of)
    return replace(
        solution,
        analysis=motion,
        values=lambda values: values,
        finer=lambda run: None,
        variants=lambda: None,
        resumable=False,
    )


def _refuse(model: Any, run: Run) -> None:
    first, faults = model.elements.releases[0], []
    if getattr(model, "analysis", "forward") != "forward":
        message = "drivers prescribe the motion, so that nothing moves when a joint is let go"
        faults.append(Fault("error", message, first.place, first.name, id="SOLVE-186"))
    if run.options.estimate_error:
        message = "--estimate-error takes no motion in which joints are let go; leave out one of them"
        faults.append(Fault("error", message, first.place, first.name, id="SOLVE-187"))
    for signal in model.elements.signals:
        if signal.states or signal.kind == SAMPLE_SIGNAL:
            message = "has states or samples, which do not continue when a joint is let go; leave them out"
            faults.append(Fault("error", message, signal.place, signal.name, id="SOLVE-188"))
    for item in model.elements.forces:
        if item.sticks:
            message = "sticks by bristles, which do not continue when a joint is let go; leave out bristle="
            faults.append(Fault("error", message, item.place, item.name, id="SOLVE-230"))
    if faults:
        raise ModelError(faults)


class ReleasedMotion:
    """The analysis of all stages; its rows are values by the paths of their datasets."""

    def __init__(self, solution: Solution, model: Any, deck: Deck, run: Run, solution_of: SolutionOf):
        self.first, self.run, self.solution_of = solution, run, solution_of
        self.begin = _Stage(grid_of(model).start, getattr(solution.analysis, "rest", None))
        self.model = replace(model, elements=replace(model.elements, rests=()))
        self.layout: Layout = solution.layout()
        self.outputs, self.looked = (_outputs(deck, _without_outputs(self.layout)) for _ in range(2))
        self.quantities = _quantities(model.elements.releases, deck, self.layout)
        self.gone: list[str] = []
        self.first_model = self.model
        self._last: Any = None  # analysis of the stage solved last
        self._before = self.begin.time  # of the last row that was looked at, s

    def __getattr__(self, name: str) -> Any:
        """Return what tables want to know of the first stage."""
        return getattr(self.__dict__["first"].analysis, name)

    def rows(self) -> Iterator[Values]:
        """Yield the values of all report rows; raises as the analyses of the stages do."""
        grid, stage, yielded = grid_of(self.model), self.begin, -np.inf
        times = [grid.time(k) for k in range(grid.rows)]
        waiting = list(self.model.elements.releases)
        while True:
            due = [item for item in waiting if item.time is not None and item.time <= times[-1]]
            end = max(min((float(item.time or 0.0) for item in due), default=times[-1]), stage.time)
            listed = sorted({stage.time, end, *(t for t in times if stage.time < t <= end)})
            reached, self._before = None, stage.time
            for whole in self._blocks(stage, listed):
                block, reached = self._until_reached(whole, waiting)
                keep = np.isin(block["time"], times) & (block["time"] > yielded)
                if keep.any():
                    yielded = float(block["time"][keep][-1])
                    yield self.outputs({path: values[keep] for path, values in block.items()})
                if reached is not None:
                    break
            if reached is not None:
                stage, item = self._instant(stage, *reached)
                items = [item]
            elif due:
                stage = self._state_at(stage, listed)
                items = [item for item in due if item.time is not None and item.time <= end]
            else:
                return
            for item in items:
                waiting.remove(item)
                self._let_go(item, stage)

    def _let_go(self, item: Release, stage: _Stage) -> None:
        self.gone.append(item.joint)
        self.model = without_joints(self.model, self.gone)
        message = f"{item.joint} is let go at t = {stage.time:.12g} s"
        self.first.warnings.append(Fault("note", message, item.place, item.name, id="SOLVE-189"))

    # Stages

    def _solution(self, stage: _Stage, times: Sequence[float]) -> Solution:
        """The solution of a stage at report `times`, ready to be solved."""
        grid = grid_of(self.model)
        listed = ListedTimes(times[0], times[-1], grid.step, grid.place, tuple(times))
        options = replace(self.run.options, from_equilibrium=False, strict=False)
        silent = self.run.with_new_outcome._replace(options=options, listener=Listener())
        found = self.solution_of(with_grid(self.model, listed), silent)
        analysis: Any = found.analysis
        analysis.rest = stage.rest
        if stage.continues:
            analysis.continues, analysis.first_angles = True, stage.angles
        return found

    def _blocks(self, stage: _Stage, times: Sequence[float]) -> Iterator[dict[str, np.ndarray]]:
        """Yield the values of a stage at `times`, with the joints that are gone and sums that continue."""
        found = self._solution(stage, times)
        offsets: dict[str, np.ndarray] = {}
        known = len(found.warnings)
        for values in found.blocks():
            whole = self._whole(values)
            for path in stage.sums:
                offsets.setdefault(path, stage.sums[path] - whole[path][0])
                whole[path] = whole[path] + offsets[path]
            yield whole
        self._last = found.analysis
        clock, own = getattr(self.first.analysis, "clock", None), getattr(self._last, "clock", None)
        if clock is not None and own is not None:
            for name in COUNTED:
                clock[name] += own[name]
        self.first.warnings.extend(
            fault for fault in found.warnings[known:] if fault not in self.first.warnings
        )

    def _whole(self, values: Values) -> dict[str, np.ndarray]:
        """The values with 0 for the joints that are gone, and for quantities that they alone had."""
        rows = len(values["time"])
        length = {axis.path: len(axis.values) for axis in self.layout.axes}
        whole = dict(values)
        for series in _without_outputs(self.layout).series:
            shape = tuple(length[path] for path in series.axes)
            found = values.get(series.path, np.zeros((rows, *(0 for _ in shape[:1]), *shape[1:])))
            if found.shape[1:] != shape:
                left = self._left(shape[0])
                padded = np.zeros((rows, *shape))
                padded[:, left] = found
                found = padded
            whole[series.path] = np.array(found)
        return whole

    def _left(self, count: int) -> list[int]:
        """Return which of `count` general joints, or of closures, are left."""
        generals = [joint.name for joint in self.first_model.elements.generals]
        names = generals
        if count != len(generals):
            names = [c.name if c.general else "" for c in self.first_model.closures]
        return [k for k, name in enumerate(names) if name not in self.gone]

    def _last_block(self, stage: _Stage, times: Sequence[float]) -> dict[str, np.ndarray]:
        """The last block of values of a stage."""
        *_, last = self._blocks(stage, times)
        return last

    def _state_at(self, stage: _Stage, times: Sequence[float]) -> _Stage:
        """The beginning of a stage at the last of `times`, to which the stage before moves."""
        from ...solvers.linearisation.equilibrium import state_of

        if len(times) == 1 and stage.rest is not None:
            return stage
        block = self._last_block(stage, times)
        sums = {path: block[path][-1] for path in CONTINUED if path in block}
        angles = getattr(self._last.integration, "angles", None)
        expected = None if angles is None else angles[0].copy()
        return _Stage(float(times[-1]), state_of(self._last), expected, True, sums)

    # Releases by quantities

    def _distances(self, block: Values, items: Sequence[Release]) -> np.ndarray:
        """Return how far (rows, items) each quantity is beyond its value."""
        values = self.looked(block)
        found = []
        for item in items:
            place = self.quantities[item.name]
            index: tuple[Any, ...] = (slice(None), *place.index)
            found.append((values[place.dataset][index] - item.value) * (1.0 if item.rising else -1.0))
        return np.array(found).reshape(len(items), -1).T

    def _until_reached(
        self, block: dict[str, np.ndarray], waiting: Sequence[Release]
    ) -> tuple[dict[str, np.ndarray], Any]:
        """The rows before a quantity reaches its value; the last time before it, and the releases then."""
        items = [item for item in waiting if item.quantity]
        if not items:
            return block, None
        beyond = self._distances(block, items) >= 0.0
        row = int(np.argmax(beyond.any(axis=1))) if beyond.any() else len(beyond)
        if row == len(beyond):
            self._before = float(block["time"][-1])
            return block, None
        last = self._before if row == 0 else float(block["time"][row - 1])
        hit = [item for item, reached in zip(items, beyond[row], strict=True) if reached]
        return {path: values[:row] for path, values in block.items()}, (last, float(block["time"][row]), hit)

    def _instant(
        self, stage: _Stage, last: float, row: float, hit: Sequence[Release]
    ) -> tuple[_Stage, Release]:
        """The beginning of the next stage, and the release with which it begins, between two rows."""
        from scipy.optimize import brentq

        times = [stage.time, *([last] if last > stage.time else [])]
        near = self._state_at(stage, times) if len(times) > 1 or stage.rest is None else stage
        if row <= near.time:
            return near, hit[0]

        def beyond(time: float, item: Release) -> float:
            times = [near.time] if time <= near.time else [near.time, time]
            return float(self._distances(self._last_block(near, times), [item])[-1, 0])

        found = [
            (float(brentq(beyond, near.time, row, (item,), xtol=SAME_INSTANT * abs(row))), k)
            for k, item in enumerate(hit)
        ]
        time, k = min(found)
        return self._state_at(near, [near.time, time]), hit[k]


def _without_outputs(layout: Layout) -> Layout:
    return replace(
        layout, series=tuple(one for one in layout.series if not one.path.startswith(OUTPUT_GROUP))
    )


def _outputs(deck: Deck, layout: Layout) -> Any:
    """Return the function that adds the outputs of a deck to a block of values."""
    if not has_outputs(deck):
        return lambda values: values
    from ...results.outputs.outputs import Outputs

    return Outputs(deck, layout).of


def _quantities(releases: Sequence[Release], deck: Deck, layout: Layout) -> dict[str, Quantity]:
    """Return the quantities that let joints go, by the names of the releases.  Raises ModelError."""
    found, faults = {}, []
    with empty_result(deck, layout) as result:
        for item in releases:
            if not item.quantity:
                continue
            own = f"{OUTPUT_GROUP}{item.quantity}".replace("/", ".")
            known = {series.path.replace("/", ".") for series in layout.series}
            try:
                one, *others = resolve(result, [own if own in known else item.quantity])
            except ResultError as failure:
                message = f"the line names {str(failure).removesuffix(SHOWS_ALL)}"
                faults.append(Fault("error", message, item.place, item.name, id="SOLVE-190"))
                continue
            if others:
                message = f"{item.quantity} is more than one number, {one.name} and others; name one"
                faults.append(Fault("error", message, item.place, item.name, id="SOLVE-191"))
            found[item.name] = one
    if faults:
        raise ModelError(faults)
    return found
