"""The global error of every quantity of a run: what a second run at a tighter tolerance gives otherwise."""

from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace

import numpy as np

from ..errors import Fault
from ..model.time_checks import FINEST

FINER = 1e-2  # of the tolerance: errors of the second run are hardly seen beside those of the first
PLACE = "audit/global_error/"
NOT_ESTIMATED = ("time", "audit/")
GIVEN_STEPS = (
    "--estimate-error has no effect: no step of this run is chosen by a tolerance; compare with a run of "
    "half the step (GALF) by flexmb diff"
)


def finer(tolerance: float) -> float:
    """The tolerance of the second run."""
    return max(FINER * tolerance, FINEST)


def without_estimate() -> Fault:
    """The warning where nothing can be estimated."""
    return Fault("warning", GIVEN_STEPS, id="RUN-015")


class ErrorEstimate:
    """Compares blocks of values, by the paths of their datasets, with those of a second run."""

    def __init__(self, second: Iterator[dict]):
        self.second = second
        self.waiting: dict = {}
        self.largest: dict = {}  # by path: error, its time, s, and the largest size of the quantity

    def of(self, values: dict) -> dict:
        """Values with the largest error (T,) of every quantity at every time."""
        count = len(values["time"])
        other = self._next(count)
        errors = {PLACE + path: _apart(values[path], other[path]) for path in values if _is_estimated(path)}
        self._note(values, errors)
        return {**values, **errors}

    def _next(self, count):
        """The next `count` rows of the second run."""
        while not self.waiting or len(self.waiting["time"]) < count:
            block = next(self.second)
            if self.waiting:
                block = {path: np.concatenate([self.waiting[path], block[path]]) for path in block}
            self.waiting = dict(block)
        taken = {path: rows[:count] for path, rows in self.waiting.items()}
        self.waiting = {path: rows[count:] for path, rows in self.waiting.items()}
        return taken

    def _note(self, values, errors):
        for name, error in errors.items():
            path, k = name.removeprefix(PLACE), int(np.argmax(error))
            size = float(np.max(np.abs(values[path]), initial=0.0))
            most, when, before = self.largest.get(path, (-1.0, 0.0, 0.0))
            if error[k] > most:
                most, when = float(error[k]), float(values["time"][k])
            self.largest[path] = most, when, max(size, before)

    @property
    def as_dict(self) -> dict:
        """The largest errors, for `--json`."""
        keys = ("error", "time", "largest")
        return {path: dict(zip(keys, found, strict=True)) for path, found in self.largest.items()}


def estimate_text(largest: dict) -> str:
    """A line for every quantity: its largest global error, when that is, and its largest value."""
    lines = ["  estimated global error       at t, s   of at most  quantity"]
    for path, found in largest.items():
        lines.append(f"  {found['error']:22.2e}  {found['time']:12.6g}  {found['largest']:11.3e}  {path}")
    return "\n".join(lines)


@dataclass
class EstimatingCount:
    """Counts rows as `count` does, and keeps the errors of their values in the outcome."""

    count: object
    values: Callable
    estimate: ErrorEstimate
    outcome: object

    def add(self, rows) -> None:
        """Count report rows."""
        self.values(rows)
        self.count.add(rows)
        self.outcome.errors = self.estimate.as_dict

    @property
    def doubts(self) -> tuple[Fault, ...]:
        """What the rows make doubtful."""
        return self.count.doubts

    def __str__(self):
        return str(self.count)


def with_estimate(solution, second, outcome):
    """A Solution with its errors against the same one at a tighter tolerance, if that chooses its steps."""
    stepper = getattr(second.analysis, "stepper", None)
    if stepper is None or not stepper.chosen:
        outcome.faults.append(without_estimate())
        return solution
    clock = second.analysis.clock
    clock["rtol"] = clock["atol"] = finer(float(clock["rtol"][0]))
    return estimated(solution, second.analysis, outcome)


def estimated(solution, second, outcome):
    """A Solution whose values hold their errors against the analysis `second`."""
    contents = solution.contents
    estimate = ErrorEstimate(contents.values(rows) for rows in second.rows())
    last: list = [None, None]

    def values(rows):
        # Asked for by the result file and, without one, by the count.
        if last[0] is not rows:
            last[:] = rows, estimate.of(contents.values(rows))
        return last[1]

    count = EstimatingCount(solution.count, values, estimate, outcome)
    shown = replace(contents, layout=lambda: with_errors(contents.layout()), values=values)
    return replace(solution, contents=shown, count=count)


def with_errors(layout):
    """A Layout with the largest error of every quantity along time."""
    errors = tuple(
        replace(item, path=PLACE + item.path, axes=(), long_name=f"largest global error: {item.long_name}")
        for item in layout.series
        if _is_estimated(item.path)
    )
    return replace(layout, series=(*layout.series, *errors))


def _is_estimated(path):
    return not path.startswith(NOT_ESTIMATED)


def _apart(a, b):
    """The largest distance in each row of a and b (T, ...)."""
    return np.max(np.abs(a - b).reshape(len(a), -1), axis=1, initial=0.0)
