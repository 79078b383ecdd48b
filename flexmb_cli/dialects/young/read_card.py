"""Records of cards; those of a large deck make the places of their numbers when they are looked at."""

import re
from collections.abc import Mapping, Sequence
from functools import cached_property
from typing import Any

from ...deck import number
from ...deck.record import DeckText, Number, Record
from ...deck.words import Word, words_from
from ...errors import Fault, FaultList, Place
from .cards import CARDS, Card
from .sections import Column

# Words that stand for no number, where one is wanted, and are no keyword.
NO_NUMBER = re.compile(r"nan|inf(inity)?", re.IGNORECASE)
# A card without comments: its keyword and its numbers, without the name of a function after them.
_PLAIN_CARD = re.compile(r"[A-Za-z]\w*\s+([^\s{A-Za-z][^\s{]*(?:\s+[^\s{A-Za-z][^\s{]*)*)\s*({)?")


def card_at(source: DeckText, section: str, starts: Any, index: int) -> "ReadCard":
    """Return the card of a section that begins at a place of the text; `starts`: those of all its cards."""
    kind = next(card for card in CARDS if card.section == section)
    return ReadCard(source, kind, index + 1, starts[index])


class CardRecords:
    """Makes records of cards; `faults` holds those of their numbers."""

    def __init__(self) -> None:
        self.faults: list[Fault] = FaultList()

    def error(self, place: Place, subject: str, message: str, *, id: str) -> None:
        """Report what is wrong at a place."""
        self.faults.append(Fault("error", message, place, subject, id=id))

    def record(self, kind: Card, number_of_card: int, keyword: Word, words: Sequence[Word]) -> Record:
        """The record of a card with as many words as it needs; faults of its numbers are noted."""
        subject = f"{kind.section} {number_of_card}"
        numbers = [self.number(subject, *pair) for pair in zip(kind.columns, words, strict=False)]
        numbers += [
            Number(c.key, 0 if c.is_integer else 0.0, c.meaning, c.unit, keyword.place, "0")
            for c in kind.columns[len(words) :]
        ]
        return Record(kind.section, number_of_card, subject, tuple(numbers))

    def number(self, subject: str, column: Column, word: Word) -> Number:
        """The number that a word spells; 0 where it is none."""
        if column.is_text:
            return Number(column.key, word.text, column.meaning, column.unit, word.place, word.text)
        if column.is_function and is_keyword(word):
            return Number(column.key, word.text, column.meaning, column.unit, word.place, word.text)
        value: float = 0
        try:
            value, warning = number.integer(word.text) if column.is_integer else number.real(word.text)
            if warning:
                self.faults.append(
                    Fault("warning", f"{column.key}: {warning}", word.place, subject, id="YOUNG-021")
                )
        except number.Misspelt as fault:
            self.error(word.place, subject, f"{column.key} {fault}", id="YOUNG-020")
        return Number(column.key, value, column.meaning, column.unit, word.place, word.text)


class ReadCard(Record):
    """A card of a large deck: places of its numbers are made when they are looked at."""

    _source: DeckText
    _kind: Card
    _start: int  # in the text, from 0

    def __init__(self, source: DeckText, kind: Card, number_of_card: int, start: int):
        names = {"section": kind.section, "number": number_of_card, "made": {}}
        names["subject"] = f"{kind.section} {number_of_card}"
        vars(self).update(names, _source=source, _kind=kind, _start=start)

    @cached_property
    def values(self) -> tuple[float | int, ...]:
        """Values of the numbers."""
        if not self._plain:
            return tuple(item.value for item in self.numbers)
        texts = self._plain[1].split()
        columns = self._kind.columns
        spellings = [number.integer if column.is_integer else number.real for column in columns]
        read = [spelled(text)[0] for spelled, text in zip(spellings, texts, strict=False)]
        return *read, *(0 if column.is_integer else 0.0 for column in columns[len(read) :])

    @cached_property
    def positions(self) -> Mapping[str, int]:
        """Return where among the numbers each key stands."""
        return {column.key: k for k, column in enumerate(self._kind.columns)}

    @cached_property
    def numbers(self) -> tuple[Number, ...]:
        """The numbers with their places."""
        words_ahead = words_from(self._source.lines, self._start)
        keyword = next(words_ahead)
        words = [next(words_ahead)] if self._kind.begins_with_text else []
        for word in words_ahead:
            if is_keyword(word) and not wants_text({self._kind.keyword: self._kind}, [keyword, *words], word):
                break
            words.append(word)
        return CardRecords().record(self._kind, self.number, keyword, words).numbers

    @property
    def place(self) -> Place:
        """Place of the first number."""
        if self._plain is None:
            place = self.numbers[0].place
            assert place is not None, "the card is read from the deck"
            return place
        first = self._plain[1].split(maxsplit=1)[0]
        return Place(*self._source.lines.place_of(self._plain.start(1)), len(first))

    @cached_property
    def _plain(self) -> Any:
        """The card in the text; None where a comment stands in it or after it."""
        if self._kind.begins_with_text:
            return None
        match = _PLAIN_CARD.match(self._source.text, self._start)
        if not match or match[2] or (self._takes_function and self._names_one(match)):
            return None
        return match

    @property
    def _takes_function(self) -> bool:
        return any(column.is_function for column in self._kind.columns)

    def _names_one(self, match: re.Match[str]) -> bool:
        """Return whether the name of a function follows on the line of the last number."""
        text, end = self._source.text, match.end()
        return text[end : end + 1].isalpha() and not text[match.end(1) : end].strip(" \t")


def is_keyword(word: Word) -> bool:
    """Return whether a word is no number, so that it begins a card."""
    return word.text[0].isalpha() and not NO_NUMBER.fullmatch(word.text)


def wants_text(cards: Mapping[str, Card], card: Sequence[Word], word: Word) -> bool:
    """Return whether a word that is no number belongs to the card that is being read.

    That is a text that follows the keyword, or the name of a function on the line of the number before it.
    """
    kind = cards.get(card[0].text.upper()) if card else None
    if kind is None:
        return False
    if len(card) == 1:
        return kind.begins_with_text
    count = len(card) - 1
    named = count < len(kind.columns) and kind.columns[count].is_function
    return named and card[-1].line == word.line and word.text.upper() not in cards
