"""Pieces of listings: literal text and fields, printed once for each row of values."""

from itertools import chain
from typing import Any

import numpy as np

from .edit import HISTORIC, LAYOUTS, SAFE, Edit
from .pictures.field_columns import MOST_DECIMALS, picture, runs_of

NUMBERS_A_PICTURE = 2**17  # of which a picture is made
NUMBERS_A_KIND = 400  # for fewer in equal fields, a picture does not repay
NUMBERS_A_RUN = 40  # the same for fewer in a run of fields


class Layout:
    """A piece of a listing: literal text and fields in the order of the page.

    `parts` are strings (line ends included) and `Edit`s; `lines` prints the piece once for every row
    of values.
    """

    def __init__(self, *parts: Any, layout: str = SAFE):
        if layout not in LAYOUTS:
            raise ValueError(f"layout must be one of {LAYOUTS}, not {layout!r}")
        self.layout = layout
        self.fields = tuple(part for part in parts if isinstance(part, Edit))
        self._separated = _separated(parts)
        self._runs = runs_of(parts, self._separated)
        self._least = max(NUMBERS_A_KIND * len(set(self.fields)), NUMBERS_A_RUN * len(self._runs))
        self._as_text = [self._needs_text(field) for field in self.fields]
        self._template = self._percent_template(parts)
        self._limits = np.array([field.zero_limit for field in self.fields])
        decimals = max((field.decimals for field in self.fields), default=0)
        self._has_pictures = layout == SAFE and decimals < MOST_DECIMALS

    def lines(self, values: list[Any] | np.ndarray) -> str:
        """Text of the piece for `values`, shape (rows, fields) or (fields,)."""
        values = np.atleast_2d(np.asarray(values, dtype=float))
        if values.shape[1] != len(self.fields):
            raise ValueError(f"{len(self.fields)} fields, {values.shape[1]} values in a row")
        rows = max(1, NUMBERS_A_PICTURE // max(1, len(self.fields)))
        return "".join(self._page(values[k : k + rows]) for k in range(0, len(values), rows))

    def _page(self, values: np.ndarray) -> str:
        """Text of the rows, of many from a picture; rows that it does not know are printed one by one."""
        if not self._has_pictures or values.size < self._least:
            return self._printed(values)
        text, unknown = picture(self._runs, values)
        if not unknown.any():
            return _without_nul(text)
        length = len(text) // len(values)
        pieces, start = [], 0
        for row in [*np.flatnonzero(unknown).tolist(), len(values)]:
            pieces += [
                _without_nul(text[start * length : row * length]),
                self._printed(values[row : row + 1]),
            ]
            start = row + 1
        return "".join(pieces)

    def _printed(self, values: np.ndarray) -> str:
        if self.layout == SAFE:
            values = np.where(np.abs(values) <= self._limits, 0.0, values)
        if any(self._as_text):
            columns = [self._column(k, column) for k, column in enumerate(values.T)]
            printed = tuple(chain.from_iterable(zip(*columns, strict=True)))
        else:
            printed = tuple(values.ravel().tolist())
        return self._template * len(values) % printed

    def _needs_text(self, field: Edit) -> bool:
        """Return whether C's `%` cannot print the field."""
        return field.kind == "e" or (field.stars and self.layout == HISTORIC)

    def _column(self, k: int, values: np.ndarray) -> list[Any]:
        """Return what the template takes for the values of field `k`."""
        if not self._as_text[k]:
            return list(values.tolist())
        field, separated = self.fields[k], self._separated[k]
        return [field.text(value, self.layout, separated) for value in values.tolist()]

    def _percent_template(self, parts: tuple[Edit | str, ...]) -> str:
        pieces, column = [], 0
        for part in parts:
            if isinstance(part, str):
                pieces.append(part.replace("%", "%%"))
            else:
                pieces.append(self._percent(part, column))
                column += 1
        return "".join(pieces)

    def _percent(self, field: Edit, column: int) -> str:
        if self._as_text[column]:
            return "%s"
        decimals = f".{field.decimals}" if field.kind in "fE" else ""
        if self.layout == SAFE and self._separated[column]:
            return f" %{max(field.width - 1, 0)}{decimals}{field.kind}"
        return f"%{field.width}{decimals}{field.kind}"


def _without_nul(text: bytearray) -> str:
    return text.translate(None, b"\0").decode()


def _separated(parts: tuple[Edit | str, ...]) -> list[bool]:
    """For every field: whether it has a left neighbour it must not touch."""
    flags, before = [], "\n"
    for part in parts:
        if isinstance(part, Edit):
            flags.append(before[-1] not in " \n")
            before = "0"
        elif part:
            before = part
    return flags
