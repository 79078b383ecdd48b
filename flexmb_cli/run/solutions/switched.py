"""Motions in which joints and drivers are caught or let go, at a time or by a quantity: stage after stage.

Each stage is a motion of the model with the parts that hold then, and begins in the state of the one before;
where something is caught, an inelastic impulse changes the speeds.  A switch by a quantity is looked for from
row to row, and then between two rows.
"""

import json
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import replace
from typing import Any

import numpy as np

from ...deck.record import Deck
from ...errors import Fault, ModelError
from ...model.general_joints import GeneralJoint, Switch
from ...model.mechanism import ListedTimes
from ...model.signals import SAMPLE_SIGNAL
from ...model.vectors import rotation_matrix
from ...results.hdf5.layout import Layout, Values
from ...solvers.checkpoint import OtherRun, faults_reported, reported, row_of, taken
from ..load_shares import grid_of, with_grid
from ..outcome import Listener, Run
from . import Solution
from .switch_parts import caught, parts_of, shifted, with_parts
from .switch_quantities import Instants, outputs_of, without_outputs
from .switch_stages import Stage, at_row, moved, named, part_of, restored, whole_block, with_closure_names

# What adds up since the start, or is constant: it continues over the beginning of a stage.
CONTINUED = ("energy/applied_work", "energy/total", "element/work", "element/dissipated", "contact/touches")
WORK, KINETIC = "energy/applied_work", "energy/kinetic"
COUNTED = ("evaluations", "rejections")  # of steps, which the clock of the first stage sums

SolutionOf = Callable[[Any, Run], Solution]


def switched(
    model: Any, deck: Deck, run: Run, solution_of: SolutionOf, with_outputs: Callable[..., Solution]
) -> Solution:
    """Return the solution of a model some of whose joints and drivers are caught or let go.

    `solution_of`: the solution of the model of a stage; `with_outputs`: one with the outputs of the deck.
    Raises ModelError.
    """
    _refuse(model, run)
    solution = solution_of(model, run)
    whole = model
    if model.elements.later:
        rested = replace(model, elements=replace(model.elements, rests=()))
        whole = with_parts(rested, [_as_it_stands(part) for part in parts_of(model)])
        solution = replace(solution, layout=_quiet(run, solution_of)(whole).layout)
    solution = with_outputs(solution, deck)
    motion = SwitchedMotion(solution, model, deck, run, solution_of)
    motion.whole = with_closure_names(without_outputs(motion.layout), whole)
    return replace(
        solution,
        analysis=motion,
        values=lambda values: values,
        finer=lambda run: None,
        variants=lambda: None,
        outputs=motion.seen,
    )


def _as_it_stands(part: Any) -> Any:
    return replace(part, turned=np.eye(3)) if isinstance(part, GeneralJoint) and part.turned is None else part


def _quiet(run: Run, solution_of: SolutionOf) -> Callable[[Any], Solution]:
    """Return what solves models of stages without a word."""
    options = replace(run.options, from_equilibrium=False, strict=False)
    silent = run.with_new_outcome._replace(options=options, listener=Listener())
    return lambda model: solution_of(model, silent)


def _refuse(model: Any, run: Run) -> None:
    first, faults = model.elements.switches[0], []
    if getattr(model, "analysis", "forward") != "forward":
        message = "drivers prescribe the motion, so that nothing moves when a part is caught or let go"
        faults.append(Fault("error", message, first.place, first.name, id="SOLVE-186"))
    if run.options.estimate_error:
        message = "--estimate-error takes no lines CATCH and RELEASE; leave out one of them"
        faults.append(Fault("error", message, first.place, first.name, id="SOLVE-187"))
    for signal in model.elements.signals:
        if signal.states or signal.kind == SAMPLE_SIGNAL:
            message = (
                "has states or samples, which do not continue when parts are caught or let go; leave it out"
            )
            faults.append(Fault("error", message, signal.place, signal.name, id="SOLVE-188"))
    for item in model.elements.forces:
        if item.sticks:
            message = "sticks by bristles, which do not continue over a CATCH or RELEASE; leave out bristle="
            faults.append(Fault("error", message, item.place, item.name, id="SOLVE-230"))
    if faults:
        raise ModelError(faults)


class SwitchedMotion:
    """The analysis of all stages; its rows are values by the paths of their datasets."""

    def __init__(self, solution: Solution, model: Any, deck: Deck, run: Run, solution_of: SolutionOf):
        self.first, self.solution_of = solution, _quiet(run, solution_of)
        self.stage = Stage(grid_of(model).start, getattr(solution.analysis, "rest", None))
        self.model = replace(model, elements=replace(model.elements, rests=()))
        self.layout: Layout = solution.layout()
        self.whole = self.layout  # that of the analysis with all parts
        self._stage_model = self.model
        self.outputs = outputs_of(deck, self.layout)
        self.instants = Instants(self, deck)
        self.parts = {part.name: part for part in parts_of(model)}  # as the deck has them
        self.present = {name: part for name, part in self.parts.items() if part not in model.elements.later}
        self.waiting: list[Switch] = list(model.elements.switches)
        self.row = 0
        self.current: Any = None  # solution of the stage, None at its beginning
        self._known = 0  # warnings of that solution before it is solved
        self._offsets: dict[str, np.ndarray] = {}  # what continues less what the stage itself counts
        self._stored: dict[str, np.ndarray] = {}  # checkpoint of the analysis of the stage

    def __getattr__(self, name: str) -> Any:
        """Return what tables want to know of the first stage."""
        return getattr(self.__dict__["first"].analysis, name)

    def seen(self, values: Values) -> Values:
        """Return a block of stored values with the outputs, which later ones continue."""
        self.instants.looked(values)
        return self.outputs(values)

    def rows(self) -> Iterator[Values]:
        """Yield the values of all report rows; raises as the analyses of the stages do."""
        grid = grid_of(self.model)
        times = [grid.time(k) for k in range(grid.rows)]
        while True:
            due = {one: at_row(one.time, times) for one in self.waiting if one.time is not None}
            due = {one: time for one, time in due.items() if time <= times[-1]}
            end = max(min(due.values(), default=times[-1]), self.stage.time)
            listed = sorted({self.stage.time, end, *(t for t in times if self.stage.time < t <= end)})
            over, blocks = False, self.blocks(self.stage, listed)
            for whole in blocks:
                block, reached = self.instants.until_reached(whole, self.waiting, self.present)
                over = reached is not None or bool(whole["time"][-1] >= listed[-1])
                if over and (reached or due):
                    blocks = iter(()) if reached else blocks
                    for _ in blocks:
                        pass
                    hit = [one for one, time in due.items() if time <= end]
                    self._switch(whole, hit) if reached is None else self._switch(*self.instants.of(*reached))
                keep = np.isin(block["time"], times[self.row :])
                if keep.any():
                    self.row += int(keep.sum())
                    yield self.outputs({path: values[keep] for path, values in block.items()})
                if over:
                    break
            if not (over and (reached or due)):
                return

    # Resuming

    @property
    def checkpoint(self) -> dict[str, np.ndarray]:
        """Return where to go on after the rows that have been yielded: the stage, and its own checkpoint."""
        stage, clock = self.stage, getattr(self.first.analysis, "clock", None)
        changed = {name: part for name, part in self.present.items() if part is not self.parts[name]}
        record = {
            "waiting": [one.name for one in self.waiting],
            "present": list(self.present),
            "caught": [one.name for one in stage.caught],
        }
        rest, current = stage.rest, self.current
        return {
            "row": np.array(self.row),
            "warnings": reported(self.first.warnings),
            "record": np.array(json.dumps(record)),
            "time": np.array([stage.time, self.instants.before]),
            "counts": np.array([0 if clock is None else int(clock[name][0]) for name in COUNTED]),
            **({} if rest is None else {"rest": rest}),
            **({} if stage.kinetic is None else {"kinetic": np.array(stage.kinetic)}),
            **{f"memory/{name}": values for name, values in stage.memory.items()},
            **{f"sums/{path}": np.asarray(values) for path, values in stage.sums.items()},
            **{f"offsets/{path}": np.asarray(values) for path, values in self._offsets.items()},
            **{f"moved/{name}": moved(part) for name, part in changed.items()},
            **({} if current is None else {"known": np.array(self._known)}),
            **({} if current is None else named("stage/", current.analysis.checkpoint)),
        }

    def restore(self, checkpoint: Mapping[str, np.ndarray]) -> None:
        """Go on after the rows that were yielded up to a checkpoint.  Raises OtherRun."""
        self.row, self.first.warnings[:] = row_of(checkpoint), faults_reported(checkpoint)
        time, self.instants.before = taken(checkpoint, "time", (2,)).tolist()
        switches = {one.name: one for one in self.waiting}
        try:
            record = json.loads(str(checkpoint["record"]))
            self.waiting = [switches[name] for name in record["waiting"]]
            numbers = part_of(checkpoint, "moved/")
            self.present = {n: restored(self.parts[n], numbers.get(n)) for n in record["present"]}
            caught = [switches[name] for name in record["caught"]]
        except (ValueError, KeyError, TypeError, RecursionError) as fault:
            raise OtherRun("record") from fault
        kinetic = float(checkpoint["kinetic"]) if "kinetic" in checkpoint else None
        rest, memory = checkpoint.get("rest"), part_of(checkpoint, "memory/")
        self.stage = Stage(time, rest, memory, part_of(checkpoint, "sums/"), kinetic, caught)
        self._offsets, self._stored = part_of(checkpoint, "offsets/"), part_of(checkpoint, "stage/")
        if self._stored:
            self._known = int(taken(checkpoint, "known", (), np.int64))
        clock = getattr(self.first.analysis, "clock", None)
        for name, count in zip(COUNTED, taken(checkpoint, "counts", (2,), None), strict=True):
            if clock is not None:
                clock[name] = count

    # Stages

    def solution_at(self, stage: Stage, times: Sequence[float]) -> Solution:
        """The solution of a stage at report `times`, ready to be solved."""
        from ...solvers.linearisation.switched import remember

        grid = grid_of(self.model)
        listed = ListedTimes(times[0], times[-1], grid.step, grid.place, tuple(times))
        order = [self.present[name] for name in self.parts if name in self.present]
        self._stage_model = with_parts(self.model, order)
        solution = self.solution_of(with_grid(self._stage_model, listed))
        analysis: Any = solution.analysis
        analysis.rest = stage.rest
        if stage.memory:
            analysis.continues = True
            remember(analysis, stage.memory)
        return solution

    def blocks(self, stage: Stage, times: Sequence[float]) -> Iterator[dict[str, np.ndarray]]:
        """Yield the values of a stage at `times`, with the parts that are off and sums that continue."""
        solution = self.solution_at(stage, times)
        stored, self._stored = self._stored, {}
        if stored:
            solution.analysis.restore(stored)
        else:
            self._offsets, self._known = {}, len(solution.warnings)
        self.current = solution
        offsets, own_layout = self._offsets, with_closure_names(solution.layout(), self._stage_model)
        for values in solution.blocks():
            whole = whole_block(values, own_layout, self.whole)
            if not offsets:
                offsets.update(self._first_offsets(stage, whole))
            for path, offset in offsets.items():
                whole[path] = whole[path] + offset
            yield whole
        clock, own = getattr(self.first.analysis, "clock", None), getattr(solution.analysis, "clock", None)
        if clock is not None and own is not None:
            for name in COUNTED:
                clock[name] += own[name]
        new = [fault for fault in solution.warnings[self._known :] if fault not in self.first.warnings]
        self.first.warnings.extend(new)

    def _first_offsets(self, stage: Stage, whole: Values) -> dict[str, np.ndarray]:
        """Return what the stage lacks of sums, at its first row; note what an impulse took."""
        offsets = {path: stage.sums[path] - whole[path][0] for path in stage.sums}
        if stage.kinetic is not None:
            gained = float(whole[KINETIC][0]) - stage.kinetic
            if WORK in offsets:
                offsets[WORK] = offsets[WORK] + gained
            for item in stage.caught:
                message = (
                    f"{item.part} is caught at t = {stage.time:.12g} s; the impulse changes the kinetic "
                    f"energy by {gained:.6g} J"
                )
                self.first.warnings.append(Fault("note", message, item.place, item.name, id="SOLVE-212"))
            stage.caught = []
        return offsets

    def moved_to(self, stage: Stage, times: Sequence[float]) -> tuple[Stage, dict[str, np.ndarray]]:
        """The state at the last of `times` to which a stage moves, and its last block of values."""
        from ...solvers.linearisation.equilibrium import state_of
        from ...solvers.linearisation.switched import memory_of

        *_, block = self.blocks(stage, times)
        analysis = self.current.analysis
        sums = {path: block[path][-1] for path in CONTINUED if path in block}
        return Stage(float(times[-1]), state_of(analysis), memory_of(analysis), sums), block

    def _switch(self, block: Values, items: Sequence[Switch]) -> None:
        """Begin the next stage where the current analysis stands, after its last `block`."""
        from ...solvers.linearisation.equilibrium import state_of
        from ...solvers.linearisation.switched import driver_gap, memory_for, struck

        time, before = float(block["time"][-1]), self.current.analysis
        sums = {path: np.array(block[path][-1]) for path in CONTINUED if path in block}
        stage = Stage(time, state_of(before), memory_for(before, before), sums)
        for item in sorted(items, key=lambda one: one.catches):
            self.waiting.remove(item)
            self._put(item, block, stage)
        stage.memory = memory_for(before, self.solution_at(replace(stage, memory={}), [time]).analysis)
        for item in stage.caught:
            if not isinstance(self.parts[item.part], GeneralJoint):
                gap = driver_gap(self.solution_at(stage, [time]).analysis, self.parts[item.part])
                self.present[item.part] = shifted(self.parts[item.part], gap)
        if stage.caught:
            stage.kinetic = float(block[KINETIC][-1])
            stage.rest = struck(self.solution_at(stage, [time]).analysis)
        self.stage, self.current, self._offsets = stage, None, {}
        self.instants.before = time

    def _put(self, item: Switch, block: Values, stage: Stage) -> None:
        """Catch a part or let it go, and note that."""
        what = f"{item.part} is let go"
        if item.catches == (item.part in self.present):
            what = f"{item.part} {'holds already' if item.catches else 'holds nothing'}"
        elif item.catches:
            part = self.parts[item.part]
            if isinstance(part, GeneralJoint):
                places = block["body/position"][-1]
                axes = np.array([rotation_matrix(p) for p in block["body/euler_parameters"][-1]])
                part = caught(part, places, axes)
            self.present[item.part] = part
            stage.caught.append(item)
            return
        else:
            del self.present[item.part]
        message = f"{what} at t = {stage.time:.12g} s"
        self.first.warnings.append(Fault("note", message, item.place, item.name, id="SOLVE-189"))
