"""Characters of fields of many rows at once, from tables of numerals instead of a call for each number.

A column has a cell in the picture of the rows, which is as wide as its longest number.  What a shorter number
leaves unused beyond the width of its field is NUL, to be deleted from the text of the picture.
"""

from collections.abc import Iterable
from functools import lru_cache
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

if TYPE_CHECKING:
    from ..edit import Edit

BLANK, MINUS, POINT, ZERO = b" -.0"
MOST_DECIMALS = 9  # these and the longest whole part are exact in a double
_MOST_WHOLE = 5  # digits of a whole part that has a numeral
_DECIMALS_AT_ONCE = 4  # decimals that a table gives at once
_LARGEST_POWER = 98  # of ten, either way: rounding may raise it, and it shall keep two figures
_PRODUCT_ROUND_OFF = 2.0**-50  # of a product with a power of ten, relative
_UNITS = 10 ** np.arange(_MOST_WHOLE + 1, dtype=np.uint32)


class Figures(NamedTuple):
    """Numbers (rows, fields) without their signs as whole numbers, in units of the last decimal."""

    number: np.ndarray  # (rows, fields) in units of the last decimal
    power: np.ndarray  # (rows, fields) 1; of the first figure in exponent form, meaningless for 0
    unknown: np.ndarray  # (rows, fields) bool: these have no figures here


def fixed_point(values: np.ndarray, decimals: int) -> Figures:
    """Return figures of fixed-point numbers: the exact values rounded, ties to even, as Python does."""
    size = np.abs(values)
    unknown = ~(size < 10.0**_MOST_WHOLE - 1.0)
    size[unknown] = 0.0
    scaled = size * 10.0**decimals
    number = np.rint(scaled)
    near = np.flatnonzero(np.abs(np.abs(scaled - number) - 0.5) <= _PRODUCT_ROUND_OFF * scaled)
    if near.size:
        ties, places = np.unique(size.flat[near], return_inverse=True)
        exact = [float(f"{value:.{decimals}f}".replace(".", "")) for value in ties.tolist()]
        number.flat[near] = np.array(exact)[places]
    return Figures(number, np.zeros(()), unknown)


def exponent_form(values: np.ndarray, digits: int) -> Figures:
    """Return so many figures of each number; those of one near a tie are unknown."""
    size = np.abs(values)
    unknown = (size != 0.0) & ~((size > 10.0**-_LARGEST_POWER) & (size < 10.0**_LARGEST_POWER))
    size[unknown] = 0.0
    power = np.floor(np.log10(np.where(size == 0.0, 1.0, size)))
    scaled = size * _powers_of_ten()[(digits + _LARGEST_POWER - power).astype(np.intp)]
    number = np.rint(scaled)
    unknown |= np.abs(np.abs(scaled - number) - 0.5) <= _PRODUCT_ROUND_OFF * scaled
    raised = number >= 10.0**digits  # 9.9996 to four figures, and logarithms that are rounded down
    number[raised] = 10.0 ** (digits - 1)
    return Figures(number, power + raised, unknown)


@lru_cache(maxsize=1)
def _powers_of_ten() -> np.ndarray:
    """Powers from -(_LARGEST_POWER + 1) on."""
    return np.array([float(f"1e{k}") for k in range(-_LARGEST_POWER - 1, _LARGEST_POWER + MOST_DECIMALS + 3)])


class Run(NamedTuple):
    """Equal fields that stand side by side."""

    field: "Edit"  # of each number
    separated: bool  # a blank must stand before each number
    fields: int  # count


def runs_of(parts: Iterable[Any], separated: list[bool]) -> list[bytes | Run]:
    """Return the parts of a row, texts and fields, with fields joined to runs."""
    runs: list[bytes | Run] = []
    apart = iter(separated)
    for part in parts:
        last = runs[-1] if runs else b""
        if isinstance(part, str):
            runs.append(part.encode())
            continue
        run = Run(part, next(apart), 1)
        if isinstance(last, Run) and (last.field, last.separated) == (run.field, run.separated):
            runs[-1] = last._replace(fields=last.fields + 1)
        else:
            runs.append(run)
    return runs


def picture(runs: list[bytes | Run], values: np.ndarray) -> tuple[bytearray, np.ndarray]:
    """Return the text of rows of equal length, with NULs, and which rows are not known (rows,).

    Equal fields of all runs are taken together, and runs that stand at equal distances put in their places
    together, as those of the lines of many bodies.
    """
    columns: dict[Run, list[int]] = {}
    column = 0
    for run in runs:
        if isinstance(run, Run):
            columns.setdefault(run._replace(fields=1), []).extend(range(column, column + run.fields))
            column += run.fields
    unknown = np.zeros(len(values), bool)
    cells = {kind: _pieces(kind, values[:, places], unknown) for kind, places in columns.items()}
    row, stretches = _stretches(runs, {kind: sum(p.itemsize for p in cells[kind]) for kind in cells})
    text = bytearray(row * len(values))
    for stretch in stretches:
        _fill(text, len(row), stretch, cells[stretch.kind])
    return text, unknown


class Stretch(NamedTuple):
    """Runs of equal fields and length at equal distances in a row."""

    kind: Run  # a field of them
    column: int  # of the first among all equal fields
    start: int  # of the first, characters
    fields: int  # count in a run
    runs: int  # count
    distance: int  # from run to run, characters


def _stretches(runs: list[bytes | Run], widths: dict[Run, int]) -> tuple[bytes, list[Stretch]]:
    """Return the text of a row with NULs for its fields, and the stretches of its runs."""
    row, length, done = [], 0, dict.fromkeys(widths, 0)
    last: dict[Run, Stretch] = {}
    complete: list[Stretch] = []
    for run in runs:
        if isinstance(run, bytes):
            row.append(run)
            length += len(run)
            continue
        kind = run._replace(fields=1)
        before = last.get(kind)
        distance = length - before.start if before else 0
        if before and before.fields == run.fields and before.runs * (before.distance or distance) == distance:
            last[kind] = before._replace(runs=before.runs + 1, distance=before.distance or distance)
        else:
            complete += [before] if before else []
            last[kind] = Stretch(kind, done[kind], length, run.fields, 1, 0)
        done[kind] += run.fields
        row.append(bytes(run.fields * widths[kind]))
        length += run.fields * widths[kind]
    return b"".join(row), complete + list(last.values())


def _fill(text: bytearray, length: int, stretch: Stretch, pieces: list[np.ndarray]) -> None:
    """Put the pieces of a stretch in their places in rows of a length."""
    cell, place = sum(piece.itemsize for piece in pieces), stretch.start
    some = slice(stretch.column, stretch.column + stretch.runs * stretch.fields)
    for piece in pieces:
        shape = len(piece), stretch.runs, stretch.fields
        strides = length, stretch.distance, cell
        np.ndarray(shape, piece.dtype, text, place, strides)[:] = piece[:, some].reshape(shape)
        place += piece.itemsize


def _pieces(run: Run, values: np.ndarray, unknown: np.ndarray) -> list[np.ndarray]:
    """Return the pieces of the cells of a run, (rows, fields) each."""
    figures, whole, tail = _divided(run.field, values)
    unknown |= figures.unknown.any(axis=1)
    negative = np.signbit(values) & (figures.number > 0.0)
    room = run.field.width - sum(piece.itemsize for piece in tail)
    digits = len(str(whole.max()))
    table = _whole_parts(digits, room, run.separated)
    return [table[whole + _UNITS[digits] * negative], *tail]


def _divided(field: "Edit", values: np.ndarray) -> tuple[Figures, np.ndarray, list[np.ndarray]]:
    """Return figures, whole parts, and the characters after these, piece by piece."""
    decimals = field.decimals
    if field.kind in "df":
        figures = fixed_point(np.trunc(values) if field.kind == "d" else values, decimals)
        raised = []
    else:
        figures = exponent_form(values, decimals + (field.kind == "E"))
        power = np.where(figures.number == 0.0, 0.0, figures.power + (field.kind == "e"))
        raised = [_exponents()[(power + _LARGEST_POWER + 1).astype(np.intp)]]
    rest: Any = figures.number.astype(np.uint32 if decimals + _MOST_WHOLE <= 9 else np.uint64)
    while decimals:
        count = min(decimals, _DECIMALS_AT_ONCE)
        unit = rest.dtype.type(10**count)
        high = rest // unit
        raised.insert(0, _decimals(count, decimals <= _DECIMALS_AT_ONCE)[rest - high * unit])
        rest, decimals = high, decimals - count
    return figures, rest.astype(np.uint32), raised


@lru_cache(maxsize=1)
def _exponents() -> np.ndarray:
    return np.array([f"E{power:+03d}" for power in range(-_LARGEST_POWER - 1, _LARGEST_POWER + 2)], "S4")


def _numerals(count: int) -> np.ndarray:
    """Characters (10**count, count) of the numbers with so many digits, leading zeros among them."""
    digits = np.arange(ZERO, ZERO + 10, dtype=np.uint8)
    return np.stack(np.meshgrid(*count * [digits], indexing="ij"), axis=-1).reshape(-1, count)


@lru_cache(maxsize=16)
def _decimals(count: int, point: bool) -> np.ndarray:
    table = _numerals(count)
    if point:
        table = np.insert(table, 0, POINT, axis=1)
    return _texts(table)


@lru_cache(maxsize=64)
def _whole_parts(digits: int, room: int, separated: bool) -> np.ndarray:
    """Texts of the numbers below 10**digits, and of the same with a minus sign after them.

    They fill `room`; longer ones have a blank before them if `separated`, shorter ones as many NULs.
    """
    cell = max(room, separated + 1 + digits)
    table = np.full((2, 10**digits, cell), BLANK, np.uint8)
    table[:, :, cell - digits :] = _numerals(digits)
    for minus, numbers in enumerate(table):
        for count in range(digits, 0, -1):  # figures of the numbers below 10**count
            shorter = numbers[: 10**count]
            shorter[:, : cell - count] = BLANK
            if minus:
                shorter[:, cell - count - 1] = MINUS
            shorter[:, : cell - max(room, separated + minus + count)] = 0
    return _texts(table.reshape(-1, cell))


def _texts(table: np.ndarray) -> np.ndarray:
    """Return rows of characters as texts of fixed length."""
    return np.ascontiguousarray(table).view(f"S{table.shape[1]}").ravel()
