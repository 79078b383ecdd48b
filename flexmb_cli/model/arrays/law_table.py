"""Laws of time as the records and knots that kernels read."""

import numpy as np

from ..time_functions import COMPOUND, HELD_TABLE, PIECEWISE, TABLE, MotionLaw
from .records import LAW, law_record

OF_A_COORDINATE = 1.0  # in c[3] of a law of pieces whose argument is no time


class LawTable:
    """Collects laws and their knots."""

    def __init__(self):
        self.laws: list[np.ndarray] = []
        self.knots: list[np.ndarray] = [np.zeros((0, 3))]

    def law(self, law: MotionLaw, of_time: bool = True) -> int:
        """Number of a law; one that is not `of_time` has a coordinate or its rate as argument."""
        if law.kind in (TABLE, HELD_TABLE):
            return self.of_knots(law.kind, np.column_stack([law.times, law.values, law.curvature]))
        if law.kind == PIECEWISE:
            return self._pieces(law.pieces, of_time)
        if law.kind == COMPOUND:
            return self._compound(law.terms, of_time)
        return self._add(law_record(law.kind, law.c))

    def of_knots(self, kind: int, knots: np.ndarray, c=(0.0, 0.0, 0.0, 0.0)) -> int:
        """Number of a law of `kind` with rows (k, 3) of knots."""
        first = sum(map(len, self.knots))
        self.knots.append(knots)
        return self._add(law_record(kind, c, first=first, last=first + len(knots) - 1))

    def _add(self, record):
        self.laws.append(record)
        return len(self.laws) - 1

    def _pieces(self, pieces, of_time):
        count = max(len(piece) - 1 for piece in pieces)
        rows = -(-(count + 1) // 3)
        knots = np.zeros((len(pieces), 3 * rows))
        for k, piece in enumerate(pieces):
            knots[k, : len(piece)] = piece
        c = (len(pieces), count, rows, 0.0 if of_time else OF_A_COORDINATE)
        return self.of_knots(PIECEWISE, knots.reshape(-1, 3), c)

    def _compound(self, terms, of_time):
        rows = [(k, self.law(law, of_time), 0.0) for k, factors in enumerate(terms) for law in factors]
        return self.of_knots(COMPOUND, np.array(rows))

    def law_arrays(self) -> dict[str, np.ndarray]:
        """The LAW records and knots (k, 3)."""
        return {"laws": np.array(self.laws, dtype=LAW).reshape(-1), "knots": np.concatenate(self.knots)}


def break_times(law: np.ndarray, knots: np.ndarray) -> np.ndarray:
    """Times at which a LAW record changes its formula, s; none where its argument is no time."""
    if law["kind"] in (TABLE, HELD_TABLE):
        return knots[law["first"] : law["last"] + 1, 0]
    if law["kind"] == PIECEWISE and law["c"][3] != OF_A_COORDINATE:
        return knots[law["first"] : law["last"] + 1 : int(law["c"][2]), 0][1:]
    return np.zeros(0)
