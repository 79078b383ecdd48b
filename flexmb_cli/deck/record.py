"""Result of a reader: the deck's text, and every number of it with a name, a meaning and a place."""

import dataclasses
import re
from array import array
from bisect import bisect_right
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property, lru_cache
from itertools import chain
from typing import TYPE_CHECKING, Any

from ..errors import Fault, Place
from .lazy import BySection

if TYPE_CHECKING:
    from .expansion.expressions import Formula
    from .expansion.origins import Expansion

_LINE_END = re.compile(r"\r\n?|\n")
_AT_ONCE, _MOST_PIECES = 256, 8  # lines that are cut out at once, and how many such pieces are kept


class Lines(Sequence[str]):
    """The lines of `text` without their ends (LF, CR LF or CR); the last one ends with the text.

    `starts`: the offset of each line's first character; `located`: of an expanded text, function of a place
    in it: file, place and line as they were read.
    """

    def __init__(self, text: str, located: Callable[[Place], tuple[str, Place, str]] | None = None):
        self.text, self.located = text, located
        self.starts = array("i", [0])
        self._pieces: dict[int, list[str]] = {}
        self.starts.extend(match.end() for match in _LINE_END.finditer(text))

    def __reduce__(self) -> tuple[type, tuple[Any, ...]]:
        return Lines, (self.text, self.located)

    def __len__(self) -> int:
        return len(self.starts)

    def __getitem__(self, index: Any) -> Any:
        if isinstance(index, slice):
            return [self[k] for k in range(*index.indices(len(self)))]
        if not -len(self) <= index < len(self):
            raise IndexError(index)
        piece, line = divmod(index % len(self), _AT_ONCE)
        # Readers go from line to line, builders through several sections at a time.
        if piece not in self._pieces:
            if len(self._pieces) >= _MOST_PIECES:
                self._pieces.pop(next(iter(self._pieces)))
            self._pieces[piece] = self._cut(piece * _AT_ONCE, min((piece + 1) * _AT_ONCE, len(self)))
        return self._pieces[piece][line]

    def __iter__(self) -> Iterator[str]:
        return self.after(0)

    def after(self, count: int) -> Iterator[str]:
        """Return the lines after the first `count`."""
        ends = chain(range(count + _AT_ONCE, len(self), _AT_ONCE), (len(self),))
        pieces = zip(range(count, len(self), _AT_ONCE), ends, strict=False)
        return (line for first, end in pieces for line in self._cut(first, end))

    def between(self, first: int, end: int) -> str:
        """Return the text from line `first` to before line `end`, its lines ended by LF."""
        piece = self.text[self.start_of(first) : self.start_of(end)]
        return piece.replace("\r\n", "\n").replace("\r", "\n")

    def start_of(self, index: int) -> int:
        """Return where a line begins, the end of the text after the last."""
        return self.starts[index] if index < len(self) else len(self.text)

    def place_of(self, offset: int) -> tuple[int, int]:
        """Return line and column of a character, counted from 1."""
        line = bisect_right(self.starts, offset)
        return line, offset - self.starts[line - 1] + 1

    def end(self) -> tuple[int, int]:
        """Return line and column just after the last character that is neither blank nor a line end."""
        return self.place_of(len(self.text.rstrip())) if self.text.strip() else (1, 1)

    def reported(self, place: Place) -> str:
        """Return the line of a place as it was read: its number, and the file where it is not the deck's."""
        file, read, _ = self.located(place) if self.located else ("", place, "")
        return f"{file}:{read.line}" if file else str(read.line)

    def _cut(self, first: int, end: int) -> list[str]:
        piece = self.text[self.starts[first] : self.start_of(end)]
        lines = piece.replace("\r\n", "\n").replace("\r", "\n").split("\n")
        return lines[: end - first]


def as_lines(lines: Sequence[str]) -> Lines:
    """Return lines of any type as `Lines`."""
    return lines if isinstance(lines, Lines) else Lines("\n".join(lines))


# A float, an int or a str: the column of the number decides, which a type checker cannot know.
Value = Any


@dataclass(frozen=True)
class DeckText:
    """A deck as read: `name` is the file name without folder ("-" for standard input).

    `warnings` are the warnings about the text itself, such as its character code; `expansion`: of a text with
    variables or included files, where it comes from.
    """

    name: str
    text: str
    sha256: str
    warnings: tuple[Fault, ...] = ()
    expansion: "Expansion | None" = None

    @cached_property
    def lines(self) -> Lines:
        """The text's lines without their ends (LF, CR LF or CR)."""
        return Lines(self.text, self.expansion.located if self.expansion else None)


@dataclasses.dataclass(frozen=True, slots=True)  # of large decks there are millions
class Number:
    """One number of the deck.

    `key` names it within its record ("P_i.x"), `meaning` says what it is, `unit` is SI ("" for a
    pure number), `place` where it stands, `text` how it is spelled there.  Where a deck has a word
    or a file name, that is the value.
    """

    key: str
    value: Value
    meaning: str
    unit: str = ""
    place: Place | None = None
    text: str = ""


@lru_cache(maxsize=256)
def _positions(keys: tuple[str, ...]) -> dict[str, int]:
    """Return where each key stands first: one table for all records of a type."""
    return {key: k for k, key in reversed([*enumerate(keys)])}


@dataclass(frozen=True)
class Record:
    """One entry of a section: "universal" 1 is the first universal joint.

    `subject` is its name in messages ("universal joint 1"), `prefix` its name in `--set` and in
    echoes ("universal.1").  `made` is where a builder may keep what it made of the record, which never
    changes: decks that differ in other records share this one.  Under the key of an empty field it is what
    the model took for it.
    """

    section: str
    number: int
    subject: str
    numbers: tuple[Number, ...]
    made: dict[str, Any] = field(default_factory=dict[str, Any], init=False, repr=False, compare=False)

    @property
    def prefix(self) -> str:
        """Readable name of the record; the counts and the time grid need no number."""
        return self.section if self.number == 0 else f"{self.section}.{self.number}"

    @property
    def place(self) -> Place | None:
        """Place of the record's first number."""
        return self.numbers[0].place if self.numbers else None

    @cached_property
    def values(self) -> Sequence[Value]:
        """Values of the numbers."""
        return tuple(number.value for number in self.numbers)

    @cached_property
    def positions(self) -> Mapping[str, int]:
        """Return where among the numbers each key stands first."""
        return _positions(tuple(number.key for number in self.numbers))

    def __contains__(self, key: str) -> bool:
        return key in self.positions

    def __getitem__(self, key: str) -> Value:
        """Value of the number called `key`."""
        return self.values[self.positions[key]]

    def at(self, key: str) -> Number:
        """The number called `key`, with its place."""
        return self.numbers[self.positions[key]]

    def with_numbers(self, numbers: Iterable[Number]) -> "Record":
        """The record with other numbers."""
        return Record(self.section, self.number, self.subject, tuple(numbers))

    def with_number(self, index: int, number: Number) -> "Record":
        """The record with another number at `index`."""
        return self.with_numbers((*self.numbers[:index], number, *self.numbers[index + 1 :]))

    def vector(self, key: str) -> tuple[float, float, float]:
        """The three components `key`.x, `key`.y, `key`.z."""
        return float(self[f"{key}.x"]), float(self[f"{key}.y"]), float(self[f"{key}.z"])


@dataclass(frozen=True)
class Deck:
    """A deck that was read without error: its records in reading order, and what was doubtful.

    `records` is a tuple, or `ManyRecords` where they are too many to be kept.
    `slips`, also among the `warnings`, are lines that seem to have lost a number: when the model
    proves wrong, they are the likely cause.  `settings` are the changes by `--set`, "NAME=VALUE" each,
    `options` what the run was reported of how to solve it, "rtol=1e-06" for instance; `model`: which of
    several models of a DAFMS deck it is, 0 for the only one; `variables`: those of lines SET by their names,
    `formulas`: of the numbers that have some, by their full names.
    """

    dialect: str
    source: DeckText
    records: tuple[Record, ...] | BySection
    warnings: tuple[Fault, ...] = field(default=())
    slips: tuple[Fault, ...] = field(default=())
    settings: tuple[str, ...] = ()
    options: tuple[str, ...] = ()
    model: int = 0
    variables: Mapping[str, Number] = field(default_factory=dict[str, Number])
    formulas: "Mapping[str, Formula]" = field(default_factory=dict[str, "Formula"])

    def section(self, name: str) -> Sequence[Record]:
        """All records of one section, in the deck's order."""
        if not isinstance(self.records, tuple):
            return self.records.section(name)
        return [record for record in self.records if record.section == name]

    def one(self, name: str) -> Record:
        """The only record of a section such as "counts" or "time"."""
        return self.section(name)[0]

    def numbers(self) -> Iterator[tuple[str, Number]]:
        """Pairs (full readable name, Number) of the whole deck."""
        for record in self.records:
            for number in record.numbers:
                yield f"{record.prefix}.{number.key}", number

    def with_values(self, changes: Mapping[str, Value]) -> "Deck":
        """A copy in which the numbers named in `changes` have other values (`--set`)."""
        records = tuple(
            record.with_numbers(
                replace(n, value=changes.get(f"{record.prefix}.{n.key}", n.value)) for n in record.numbers
            )
            for record in self.records
        )
        return replace(self, records=records)
