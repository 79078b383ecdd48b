"""Errors of the program of 1996 that explain a number of an archived listing of any YOUNG deck.

The deck is run with all known errors, and with all but one of them.  A number of the listing that the
first run gives, to a unit of its last digit, is explained; the errors after it are those without which
it is not given.
"""

from contextlib import suppress
from pathlib import Path
from typing import Any

import numpy as np

from ...dialects.recognise import dialect_named, open_text, read_deck
from ...errors import AnalysisError, DeckError, Fault
from ...model.mechanism import Mechanism
from ...solvers.as_printed.errors import ALL_ERRORS, AS_PRINTED
from ...solvers.as_printed.program import AsPrinted
from ...solvers.kinematics.rows import Rows

ITERATION = "the program's iteration, which ends when no coordinate changes by more than 1e-4"
DATASETS = {
    "position": ("position", "euler_parameters"),
    "velocity": ("velocity", "euler_parameter_rates", "angular_velocity"),
    "acceleration": ("acceleration", "euler_parameter_accelerations", "angular_acceleration"),
    "point": ("point_position", "point_velocity", "point_acceleration"),
}


class Emulation:
    """Listing that the program of 1996 would print of a deck, with all errors and without each of them."""

    def __init__(self, path: str):
        deck = read_deck(open_text(path))
        dialect, mechanism = dialect_named(deck.dialect), None
        if AS_PRINTED in dialect.options:
            mechanism, _ = dialect.build(deck, Path())
        if not isinstance(mechanism, Mechanism):
            raise DeckError([Fault("error", "--deck needs a YOUNG deck without dynamics", id="DIFF-029")])
        self.blocks = _rows(mechanism, ALL_ERRORS)
        self.without = {error: _rows(mechanism, ALL_ERRORS - {error}) for error in sorted(ALL_ERRORS)}

    def causes(
        self,
        section: str,
        step: np.ndarray,
        index: np.ndarray,
        columns: list[int],
        printed: np.ndarray,
        unit: np.ndarray,
    ) -> list[tuple[str, np.ndarray]]:
        """Causes with masks (lines, columns): `printed` (lines, columns) to `unit` is what the errors give.

        `step` and `index` (lines,) count from 0 and from 1, `columns` from 0.
        """
        places = section, np.asarray(step), np.asarray(index) - 1, np.asarray(columns)
        explained = _agrees(self._values(self.blocks, *places), printed, unit)
        behind = {
            error: explained & ~_agrees(self._values(blocks, *places), printed, unit)
            for error, blocks in self.without.items()
        }
        return _grouped(explained, behind)

    @staticmethod
    def _values(
        blocks: list[Rows], section: str, step: np.ndarray, index: np.ndarray, columns: np.ndarray
    ) -> np.ndarray:
        """Numbers of the lines; nan beyond the last row that could be computed."""
        parts = [[getattr(block, name) for block in blocks] for name in DATASETS[section]]
        table = np.concatenate([np.concatenate(part) for part in parts], axis=2)
        known = (step < len(table)) & (index < table.shape[1])
        values = table[np.where(known, step, 0), np.where(known, index, 0)]
        return np.where(known[:, None], values, np.nan)[:, columns]


def _rows(mechanism: Mechanism, errors: frozenset[str]) -> list[Rows]:
    """The rows up to the first that cannot be computed."""
    blocks: list[Any] = []
    with suppress(AnalysisError):
        blocks.extend(AsPrinted(mechanism, errors=errors, block=1).rows())
    return blocks


def _agrees(values: np.ndarray, printed: np.ndarray, unit: np.ndarray) -> np.ndarray:
    with np.errstate(invalid="ignore"):
        return np.abs(values - printed) <= (1.0 + 1e-9) * unit


def _grouped(explained: np.ndarray, behind: dict[str, np.ndarray]) -> list[tuple[str, np.ndarray]]:
    """One cause for every set of errors that occurs."""
    code = np.zeros(explained.shape, dtype=int)
    for k, mask in enumerate(behind.values()):
        code |= mask.astype(int) << k
    groups = []
    for number in np.unique(code[explained]).tolist():
        errors = [error for k, error in enumerate(behind) if number >> k & 1]
        groups.append(("; ".join(errors) or ITERATION, explained & (code == number)))
    return groups
