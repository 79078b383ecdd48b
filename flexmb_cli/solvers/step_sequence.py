"""Steps of one run made again by others whose numbers differ a little.

Differences of two motions are smooth if both are made by the same steps: they are then those of one
discrete motion.  Bock (1981), Numerical treatment of inverse problems in chemical reaction kinetics, in:
Modelling of Chemical Reaction Systems, Springer: internal numerical differentiation.
"""

from collections.abc import Callable
from typing import Any, NamedTuple

import numpy as np

from ..kernels.integrators import clock as codes

ONE_ATTEMPT = 1  # evaluations: a call ends after the attempt that it makes


class Attempt(NamedTuple):
    """An attempt at a step."""

    length: float  # s, before a stop or a contact cuts it
    singular: float  # time of the singular position ahead, s, infinity: none near
    again: bool  # whether it comes after one that failed


class StepSequence:
    """Records attempts at steps, or makes those recorded by another one.

    Failed attempts are made again, too: implicit methods renew their matrices then.  Contacts still end steps
    where they begin and end, so that the times of these events may move.
    """

    def __init__(self, recorded: "StepSequence | None" = None):
        self._recorded = recorded.attempts if recorded else []
        self._place = 0
        self.attempts: list[Attempt] = []

    def fill(self, integrate: Callable[[Any, int], int], clock: np.ndarray, report: Any, once: bool) -> int:
        """Fill rows of a report step by step, or by one step if `once`; return a code of `clock`.

        integrate(report, evaluations) fills rows and returns a code; clock["row"] counts those filled.
        """
        filled, code = 0, codes.PAUSED
        while code == codes.PAUSED:
            rest = report._replace(**{name: part[filled:] for name, part in report._asdict().items()})
            code = self._one_call(integrate, clock, rest)
            filled += int(clock["row"][0])
            if once:
                break
        clock["row"] = filled
        return code

    def _one_call(self, integrate: Callable[[Any, int], int], clock: np.ndarray, report: Any) -> int:
        now = clock[0]
        again, tries = bool(now["rejected"]), now["steps"] + now["rejections"]
        # Iterations of implicit methods may converge where those recorded did not, or fail where they did.
        while not again and self._next and self._next.again:
            self._place += 1
        recorded = self._next
        if recorded and recorded.again == again:
            now["step"], now["singular"] = recorded.length, recorded.singular
        attempt = Attempt(float(now["step"]), float(now["singular"]), again)
        code = int(integrate(report, ONE_ATTEMPT))
        if now["steps"] + now["rejections"] > tries:
            self.attempts.append(attempt)
            self._place += int(bool(recorded and recorded.again == again))
        return code

    @property
    def _next(self) -> Attempt | None:
        """Return the attempt that is to be made again, None where there are no more."""
        return self._recorded[self._place] if self._place < len(self._recorded) else None
