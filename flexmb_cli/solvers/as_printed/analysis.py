"""Report rows of the program YOUNG (1996), errors included, for `flexmb run --as-printed`."""

from collections.abc import Iterator
from typing import Any

import numpy as np

from ...errors import Fault, ModelError
from ...model.mechanism import Mechanism
from ..kinematics.rows import Rows, rows_of
from .equations import MOST_BODIES
from .errors import ALL_ERRORS, EMULATED
from .program import Program

BLOCK = 64  # rows


class AsPrinted:
    """One run over the report times; `warnings` says that the numbers are not those of the mechanism.

    The audit of the rows is that of the equations without errors: it shows what the errors do.
    """

    def __init__(
        self,
        mechanism: Mechanism,
        settings: dict[str, Any] | None = None,
        errors: frozenset[str] = ALL_ERRORS,
        block: int = BLOCK,
    ):
        if len(mechanism.bodies) > MOST_BODIES:
            reported = f"the program of 1996 holds {MOST_BODIES} bodies, the deck has {len(mechanism.bodies)}"
            raise ModelError([Fault("error", f"{reported}; run it without --as-printed", id="SOLVE-031")])
        self.mechanism, self.block = mechanism, block
        self.program = Program(mechanism, errors, settings)
        self.reference = Program(mechanism, frozenset())
        # Screws count slide and turn from the estimates.
        self.reference.residuals(*self.program.state.motion, mechanism.time.time(0))
        self.warnings = [Fault("note", EMULATED, id="SOLVE-032")]

    def rows(self) -> Iterator[Rows]:
        """Yield the report rows in blocks; raises AnalysisError where the program fails."""
        grid = self.mechanism.time
        for first in range(0, grid.rows, self.block):
            times = [grid.time(k) for k in range(first, min(first + self.block, grid.rows))]
            found = [self._row(t) for t in times]
            states, audit = (np.array(part) for part in zip(*found, strict=True))
            yield rows_of(self.mechanism, np.array(times), states, audit)

    def _row(self, t: float) -> tuple[np.ndarray, tuple[float, float, int]]:
        """States (3, 7 n), and residuals of positions and speeds with Newton's iterations."""
        state, iterations = self.program.advance(t)
        gap, rate = self.reference.residuals(state[0], state[1], t)
        return state.reshape(3, -1), (gap, rate, iterations)
