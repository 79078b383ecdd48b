"""Result of a reader: the deck's text, and every number of it with a name, a meaning and a place."""

import dataclasses
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property, lru_cache
from typing import TYPE_CHECKING, Any

from ..errors import Fault, Place
from .lazy import BySection
from .lines import Lines

if TYPE_CHECKING:
    from .expansion.expressions import Formula
    from .expansion.origins import Expansion


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
