"""The echo of a deck: every number as it was understood, for `--echo`."""

from collections.abc import Callable
from functools import partial

from ...deck.record import Deck, Lines, Number, Record
from ...deck.units import UNITS, declared
from ...dialects.elements_block.line import system_of
from ...dialects.recognise import dialect_named
from ...errors import visible

HEADINGS = ("line", "name", "value", "unit", "meaning")
_ALIGN_RIGHT = (True, False, True, False, False)


def echo(deck: Deck) -> str:
    """A table of all numbers of `deck`, one a line, columns aligned, ending with a line end.

    Line of the deck (`--set` for a number set there), readable name, value as typed, unit, meaning.  An
    empty field has what the model took for it, once that is built, else its default.
    """
    lines = deck.source.lines
    system = system_of(deck)
    unit_of = partial(declared, system=UNITS[system]) if system else str
    rows = [HEADINGS, *(_cells(name, number, number.text, lines) for name, number in deck.variables.items())]
    rows += (_row(record, number, lines, unit_of) for record in deck.records for number in record.numbers)
    widths = [max(map(len, column)) for column in zip(*rows, strict=True)]
    return "".join(f"{line}\n" for line in (_title(deck), *(_aligned(row, widths) for row in rows)))


def _title(deck: Deck) -> str:
    dialect = dialect_named(deck.dialect)
    name = visible(deck.source.name)
    return f"{name}: read as a {dialect.title} deck, which begins with {dialect.begins}"


def _row(record: Record, number: Number, lines: Lines, unit_of: Callable[[str], str]) -> tuple[str, ...]:
    value = number.text or str(record.made.get(number.key, number.value))
    return _cells(f"{record.prefix}.{number.key}", number, value, lines, unit_of)


def _cells(
    name: str, number: Number, value: str, lines: Lines, unit_of: Callable[[str], str] = str
) -> tuple[str, ...]:
    line = lines.reported(number.place) if number.place else "--set"
    return line, *map(visible, (name, value, unit_of(number.unit) or "-", number.meaning))


def _aligned(row: tuple[str, ...], widths: list[int]) -> str:
    cells = [
        cell.rjust(width) if right else cell.ljust(width)
        for cell, width, right in zip(row, widths, _ALIGN_RIGHT, strict=True)
    ]
    return "  ".join(cells).rstrip()
