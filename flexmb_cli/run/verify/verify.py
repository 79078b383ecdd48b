"""Two formulations of a deck, and how far their motions lie apart.

Trees: Kane's equations and absolute coordinates.  Mechanisms: Euler parameters and natural coordinates.
Flexible bodies: two floating frames.
"""

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from ...errors import ANALYSIS_FAILED, Fault, ModelError
from ...model.general_joints import refuse_switches
from ...model.integrators import METHODS, Integrator
from ...results.texts.echo import echo
from ..model import model_of, module_for, open_deck
from ..outcome import Listener, Outcome, Run, RunOptions, Stop, ending_recorded

# Shares of a mechanism's length, or of a turn, below which a motion in the time of a run may be round-off.
# In accelerations large forces cancel.
RESTING, CANCELLING = 1e-6, 1e-3


@dataclass(frozen=True)
class Size:
    """Length of a mechanism, m, duration of its motion, s, 0 of a single position, and mass, kg."""

    length: float
    time: float
    mass: float = 0.0

    def least(self, unit: str) -> float:
        """Return the least value by which a quantity of `unit` is measured; 0 where none is known.

        Of a mechanism at rest all values are round-off, of which none may be a measure of the others.
        """
        time = self.time or 1.0
        speed, turn = self.length / time, 1.0 / time
        force = self.mass * speed / time
        sizes = {
            "m": RESTING * self.length,
            "rad": RESTING,
            "m/s": RESTING * speed,
            "rad/s": RESTING * turn,
            "m/s^2": CANCELLING * speed / time,
            "rad/s^2": CANCELLING * turn / time,
            "N": CANCELLING * force,
            "N m": CANCELLING * force * self.length,
            "W": CANCELLING * force * speed,
            "J": RESTING * self.mass * speed**2,
        }
        return max(sizes.get(part, 0.0) for part in unit.split(", "))


@dataclass(frozen=True)
class Difference:
    """Largest difference of a quantity over the run, at a time, s, and the largest value of its type."""

    name: str
    unit: str
    difference: float
    scale: float
    time: float

    @property
    def relative(self) -> float:
        """The difference as a share of the scale; of what is always zero, the difference."""
        return self.difference / self.scale if self.scale else self.difference


def largest_difference(
    name: str,
    unit: str,
    time: np.ndarray,
    one: np.ndarray,
    other: np.ndarray,
    size: Size,
    scale: float | None = None,
) -> Difference:
    """Return the largest difference of two series (T, ...) at the times (T,), and where it is.

    Its scale is the largest value of `one`, or `scale`, and at least what `size` says.
    """
    apart = np.abs(one - other).reshape(len(one), -1).max(axis=1, initial=0.0)
    row = int(np.argmax(apart))
    scale = float(np.max(np.abs(one), initial=0.0)) if scale is None else float(scale)
    return Difference(name, unit, float(apart[row]), max(scale, size.least(unit)), float(time[row]))


def compared_rows(analysis: Any) -> Iterator[Any]:
    """Yield the blocks of rows; raises ModelError where an overconstrained loop closes only nearly.

    Each formulation leaves such a gap in other equations, and their motions differ by as much.
    """
    for block in analysis.rows():
        if note := getattr(analysis, "loop_note", None):
            message = (
                f"{note.message}: each formulation leaves it elsewhere, so their motions cannot be "
                "compared; align the axes of the loop, or replace a joint by one with more freedom"
            )
            raise ModelError([Fault("error", message, note.place, note.subject, id="RUN-034")])
        yield block
        Stop.raise_if_asked()


@dataclass
class Verification:
    """Result of a comparison; `tolerance` is what a relative difference may reach.

    `formulations` names what was compared.
    """

    outcome: Outcome
    tolerance: float
    differences: tuple[Difference, ...] = ()
    formulations: str = ""

    @property
    def largest(self) -> Difference | None:
        """The largest relative difference; None before anything was compared."""
        # What is no number is further apart than any.
        sizes = np.nan_to_num([difference.relative for difference in self.differences], nan=np.inf)
        return self.differences[int(np.argmax(sizes))] if self.differences else None

    def as_dict(self) -> dict[str, Any]:
        """The record that `--json` prints."""
        names = ("unit", "difference", "scale", "relative", "time")
        rows = [
            {"quantity": difference.name} | {name: getattr(difference, name) for name in names}
            for difference in self.differences
        ]
        agree = bool(rows) and self.outcome.exit_code == 0
        record = {"formulations": self.formulations, "tolerance": self.tolerance, "agree": agree}
        return self.outcome.as_dict() | record | {"differences": rows}


def verify_deck(
    path: str, options: RunOptions, tolerance: float, listener: Listener | None = None
) -> Verification:
    """Run the deck at `path` by two formulations, and compare the motions.

    The outcome's exit code is 1 when they lie further apart than `tolerance`.  Never raises for what a
    deck can do.
    """
    verification = Verification(Outcome(path), tolerance)
    with ending_recorded(verification.outcome, options), Stop.released():
        deck = open_deck(path, options, verification.outcome)
        if options.echo:
            verification.outcome.echo = echo(deck)
        run = Run(
            verification.outcome, options, (listener or Listener()).kept_in(verification.outcome.notices)
        )
        model = model_of(deck, run)
        _refuse_rest(model)
        formulation = module_for(model, "verify")
        verification.formulations = formulation.FORMULATIONS
        verification.differences = formulation.differences(model, deck, run)
        largest = verification.largest
        if largest is None or not largest.relative <= tolerance:
            verification.outcome.exit_code = ANALYSIS_FAILED
    return verification


def _refuse_rest(model: Any) -> None:
    elements = getattr(model, "elements", None)
    if elements is not None and elements.rests:
        message = "verify begins both motions as the deck does; leave out this line in a copy of the deck"
        [line] = elements.rests
        raise ModelError([Fault("error", message, line.place, line.name, id="SOLVE-182")])
    refuse_switches(elements, "verify")


# Name and units of what elements have, by the paths of their datasets.
ELEMENTS = {
    "element/coordinate": ("element coordinate", "m, rad"),
    "element/rate": ("element rate", "m/s, rad/s"),
    "element/effort": ("element effort", "N, N m"),
    "element/power": ("element power", "W"),
    "element/energy": ("element energy", "J"),
    "coupling/effort": ("coupling effort", "N, N m"),
}


def joined(blocks: Sequence[Any], names: Iterable[str]) -> dict[str, np.ndarray]:
    """Return the fields of blocks of rows that are called `names`, whole runs of those that there are."""
    known = [name for name in names if hasattr(blocks[0], name)]
    return {name: np.concatenate([getattr(block, name) for block in blocks]) for name in known}


def finely_stepped(given: Integrator, options: RunOptions, method: str, tolerance: float) -> Integrator:
    """Return the integrator with a finer tolerance, of `method` where it has steps of a given length."""
    method = method if METHODS[given.method].given_step else given.method
    return Integrator(method, tolerance=options.integration.get("rtol", tolerance))
