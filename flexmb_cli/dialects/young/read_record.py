"""Records of a YOUNG deck as they were read, with the units that a direction gives their values."""

from collections.abc import Sequence
from dataclasses import replace
from functools import cached_property
from typing import Any

from ...deck.record import Number, Record
from ...deck.words import Words
from ...errors import Place
from .sections import YOUNG_SECTIONS, Section


def relabelled(record: Record, key: str) -> Record:
    """Return `record` after a change of the number `key`: a direction gives the values behind it units."""
    return labelled(record) if key == "direction" else record


def labelled(record: Record) -> Record:
    """`record` with the meanings and units that its present direction gives the values behind it."""
    section = next((section for section in YOUNG_SECTIONS if section.name == record.section), None)
    if section is None:
        return record
    turning = any(n.key == "direction" and n.value in (4, 5, 6) for n in record.numbers)
    return record.with_numbers(
        replace(number, meaning=column.label(turning)[0], unit=column.label(turning)[1])
        for column, number in zip(section.columns, record.numbers, strict=True)
    )


class ReadRecord(Record):
    """A record of a deck; what is more of its numbers than their values is made when it is looked at."""

    _section: Section
    _words: Words
    _first: int  # word

    def __init__(self, section: Section, number: int, values: tuple[Any, ...], words: Words, first: int):
        vars(self).update(
            section=section.name, number=number, subject=subject_of(section, number), made={}, values=values,
            positions=section.positions, _section=section, _words=words, _first=first,
        )  # fmt: skip

    @cached_property
    def numbers(self) -> tuple[Number, ...]:
        """The numbers with their places."""
        return tuple(map(self._number, range(len(self.values))))

    @property
    def place(self) -> Place | None:
        """Place of the first number."""
        return self._words[self._first].place

    def at(self, key: str) -> Number:
        """The number called `key`."""
        found: Number = self._number(self.positions[key])
        return found

    def _number(self, k: int) -> Number:
        word, column = self._words[self._first + k], self._section.columns[k]
        meaning, unit = column.label(is_rotation(self._section, self.values))
        return Number(column.key, self.values[k], meaning, unit, word.place, word.text)


def is_rotation(section: Section, values: Sequence[float]) -> bool:
    """Return whether the record's direction is a rotation, so that its values are angles."""
    where = section.direction
    return where is not None and where < len(values) and values[where] in (4, 5, 6)


def subject_of(section: Section, number_of_record: int) -> str:
    """Name of a record in messages: "body 1"."""
    return f"{section.subject} {number_of_record}" if number_of_record else section.subject
