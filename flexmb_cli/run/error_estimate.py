"""The global error of every quantity of a run: what a second run at a tighter tolerance gives otherwise."""

from collections.abc import Callable, Iterator, Mapping
from dataclasses import replace
from typing import TYPE_CHECKING, Any

import numpy as np

from ..errors import AnalysisError, Fault
from ..model.time_checks import FINEST
from .outcome import Run

if TYPE_CHECKING:
    from ..results.hdf5.layout import Layout


FINER = 1e-2  # of the tolerance: errors of the second run are hardly seen beside those of the first
PLACE = "audit/global_error/"
NOT_ESTIMATED = ("time", "audit/")
NO_EFFECT = "--estimate-error has no effect: "
NO_STEPS = NO_EFFECT + "nothing is integrated, every row is solved to round-off"
GIVEN_STEPS = NO_EFFECT + (
    "the steps have a given length (GALF); compare with a run of half the step by flexmb diff, or give the "
    "step as 0 for steps chosen by a tolerance"
)
TOO_FINE = (
    "--estimate-error gives too little: no second run can be finer than a tolerance of {:g}, where round-off "
    "is all that is left; ask for the errors of a run to {:g}"
)
STOPPED = (
    "--estimate-error: the second, finer run stops, and errors are estimated up to t = {:.6g} s only: {}"
)


def finer(tolerance: float) -> float:
    """The tolerance of the second run."""
    return max(FINER * tolerance, FINEST)


def why_no_estimate(tolerance: float) -> list[Fault]:
    """The warning where no tolerance is finer."""
    least = FINEST / FINER
    return (
        [Fault("warning", TOO_FINE.format(tolerance, least), id="RUN-015")] if tolerance < 0.1 * least else []
    )


class ErrorEstimate:
    """Compares blocks of values, by the paths of their datasets, with those of a second run."""

    def __init__(self, second: Iterator[Mapping[str, np.ndarray]]):
        self.second = second
        self.waiting: dict[str, Any] = {}
        self.warnings: list[Fault] = []  # that the second run stopped
        self.largest: dict[str, Any] = {}  # by path: error, its time, s, and the largest size of the quantity

    def of(self, values: Mapping[str, np.ndarray]) -> dict[str, np.ndarray]:
        """Values with the largest error (T,) of each quantity in time, nan past the second run's stop."""
        other = self._next(values["time"])
        errors = {
            PLACE + path: _apart(values[path], other.get(path, ())) for path in values if _is_estimated(path)
        }
        self._note(values, errors)
        return {**values, **errors}

    def _next(self, times: np.ndarray) -> Any:
        """The rows of the second run at these times, fewer where it stops."""
        count = len(times)
        while len(self.waiting.get("time", ())) < count and not self.warnings:
            try:
                block = next(self.second)
            except AnalysisError as failure:
                self.warnings.append(
                    Fault("warning", STOPPED.format(failure.time, failure.args[0]), id="RUN-023")
                )
                break
            if self.waiting:
                block = {path: np.concatenate([self.waiting[path], block[path]]) for path in block}
            self.waiting = dict(block)
        taken = {path: rows[:count] for path, rows in self.waiting.items()}
        self.waiting = {path: rows[count:] for path, rows in self.waiting.items()}
        return taken

    def _note(self, values: Mapping[str, np.ndarray], errors: Mapping[str, np.ndarray]) -> None:
        for name, error in errors.items():
            if np.isnan(error).all():
                continue
            path, k = name.removeprefix(PLACE), int(np.nanargmax(error))
            size = float(np.max(np.abs(values[path]), initial=0.0))
            most, when, before = self.largest.get(path, (-1.0, 0.0, 0.0))
            if error[k] > most:
                most, when = float(error[k]), float(values["time"][k])
            self.largest[path] = most, when, max(size, before)

    @property
    def as_dict(self) -> dict[str, Any]:
        """The largest errors, for `--json`."""
        keys = ("error", "time", "largest")
        return {path: dict(zip(keys, figures, strict=True)) for path, figures in self.largest.items()}


def estimate_text(largest: dict[str, Any]) -> str:
    """A line for every quantity: its largest global error, when that is, and its largest value."""
    lines = ["  estimated global error       at t, s   of at most  quantity"]
    for path, error in largest.items():
        lines.append(f"  {error['error']:22.2e}  {error['time']:12.6g}  {error['largest']:11.3e}  {path}")
    return "\n".join(lines)


def nothing_to_refine(run: Run) -> None:
    """Say that no errors can be estimated, since nothing is integrated."""
    run.outcome.faults.append(Fault("warning", NO_STEPS, id="RUN-024"))


def finer_motion(
    analysis_of: Callable[..., Any], values: Callable[..., Any], run: Run
) -> Iterator[Mapping[str, np.ndarray]] | None:
    """Return the blocks of values of a second analysis at a tighter tolerance, if that chooses its steps."""
    second = analysis_of(run.with_new_outcome)
    if not second.integrator.chosen:
        run.outcome.faults.append(Fault("warning", GIVEN_STEPS, id="RUN-067"))
        return None
    clock = second.clock
    tolerance = float(clock["rtol"][0])
    run.outcome.faults += why_no_estimate(tolerance)
    clock["rtol"] = clock["atol"] = finer(tolerance)
    return (values(rows) for rows in second.rows())


def with_errors(layout: "Layout") -> Any:
    """A Layout with the largest error of every quantity along time."""
    errors = tuple(
        replace(item, path=PLACE + item.path, axes=(), long_name=f"largest global error: {item.long_name}")
        for item in layout.series
        if _is_estimated(item.path)
    )
    return replace(layout, series=(*layout.series, *errors))


def _is_estimated(path: str) -> bool:
    return not path.startswith(NOT_ESTIMATED)


def _apart(a: np.ndarray, b: np.ndarray) -> Any:
    """The largest distance in each row of a and b (T, ...); nan in rows that only a has."""
    apart = np.full(len(a), np.nan)
    count = len(b)
    if count:
        apart[:count] = np.max(np.abs(a[:count] - b).reshape(count, -1), axis=1, initial=0.0)
    return apart
