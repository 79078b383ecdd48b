"""Frequencies and damping of the linearised motion as quantities: `mode.1.frequency`, `mode.1.damping`."""

import re
from collections.abc import Callable, Sequence
from typing import Any

import numpy as np

from ..errors import AnalysisError, Fault, ModelError
from ..results.quantities.quantities import Quantity
from ..run.mechanism_modes import Wish
from ..run.model import analysis_of
from ..run.modes import MODES
from ..run.outcome import Run
from ..solvers.linearisation.motion import differentiated

NAME = re.compile(r"mode\.(\d+)\.(frequency|damping)")
STEP = 1e-3  # of a number, of differences of fourth order
MODES_APART = 1e-6  # relative distance of frequencies that are two modes


def is_mode(name: str) -> bool:
    """Return whether a quantity is one of modes."""
    return name.startswith("mode.")


class ModeQuantities:
    """Frequencies and damping at the start, at the time `at`, s, or at the equilibrium: one row.

    model(name, change) returns the model with a number larger by a change, and its run.  Raises FlexmbError.
    """

    def __init__(
        self, model: Callable[..., tuple[Any, Run]], of: Sequence[str], equilibrium: bool, at: float | None
    ):
        self.model, self.wish = model, Wish(at, equilibrium)
        self.eigenvalues, time = self._eigenvalues()
        self.time = np.array([time])
        self.quantities = [self._quantity(name) for name in of]
        self.values = self._columns(self.eigenvalues)

    def _eigenvalues(self, *change: Any) -> tuple[np.ndarray, float]:
        """Return those (k,) of the modes that oscillate, slowest first, 1/s, and the time."""
        model, run = self.model(*change)
        analysis = analysis_of(model)
        if analysis not in MODES or (analysis == "dynamic" and model.analysis != "forward"):
            message = "modes need masses and a free motion; drivers prescribe this one"
            raise ModelError([Fault("error", message, id="RUN-165")])
        linearised = MODES[analysis](model, self.wish, run)
        values: np.ndarray = linearised.modes.eigenvalues
        return values[values.imag > 1e-7 * np.abs(values)], linearised.time

    def _quantity(self, name: str) -> Quantity:
        match = NAME.fullmatch(name)
        count = len(self.eigenvalues)
        if match is None or not 1 <= int(match[1]) <= count:
            message = f"{name}: there are mode.1.frequency and mode.1.damping, up to mode {count}"
            raise ModelError([Fault("error", message, about=name, id="RUN-166")])
        k, what = int(match[1]) - 1, match[2]
        self._refuse_repeated(k)
        meaning = "damped frequency" if what == "frequency" else "damping ratio"
        unit = "Hz" if what == "frequency" else "1"
        return Quantity(name, unit, f"{meaning} of mode {k + 1}", what, (k,))

    def _refuse_repeated(self, k: int) -> None:
        others = np.abs(np.delete(self.eigenvalues, k) - self.eigenvalues[k])
        if np.min(others, initial=np.inf) < MODES_APART * abs(self.eigenvalues[k]):
            message = f"mode {k + 1} has the frequency of another: neither has a derivative of its own"
            raise AnalysisError(Fault("error", message, id="RUN-167"), float(self.time[0]))

    def _columns(self, eigenvalues: np.ndarray) -> np.ndarray:
        """Return the quantities (1, of)."""
        of = {
            "frequency": eigenvalues.imag / (2.0 * np.pi),
            "damping": -eigenvalues.real / np.abs(eigenvalues),
        }
        return np.array([[of[one.dataset][one.index[0]] for one in self.quantities]])

    def derivative(self, name: str, scale: float) -> np.ndarray:
        """Return the derivatives (1, of) by a number whose size is `scale`.  Raises FlexmbError."""

        def values(change: float) -> np.ndarray:
            eigenvalues, _ = self._eigenvalues(name, change)
            return self._columns(self._in_order(eigenvalues))

        return differentiated(values, STEP * scale)

    def _in_order(self, eigenvalues: np.ndarray) -> np.ndarray:
        """Return those of a neighbour in the order of those of the deck: frequencies may cross."""
        from scipy.optimize import linear_sum_assignment

        if len(eigenvalues) != len(self.eigenvalues):
            message = "a mode stops oscillating near the numbers of the deck: there is no derivative"
            raise AnalysisError(Fault("error", message, id="RUN-168"), float(self.time[0]))
        distance = np.abs(self.eigenvalues[:, None] - eigenvalues)
        return eigenvalues[linear_sum_assignment(distance)[1]]
