"""The dialogue of `flexmb new`, which builds a deck number by number: questions out, answers in, no streams.

The `Form` of a dialect walks through the reader's own tables of cards, and the reader judges the answers.  A
line may answer one number, one question or the rest of a record, as Pascal's READ took them.
"""

import json
from abc import ABC, abstractmethod
from collections.abc import Generator, Iterator, Mapping, Sequence
from dataclasses import replace
from itertools import takewhile
from pathlib import Path
from typing import Any

from ..errors import DeckError, Fault, FlexmbError, Place
from . import number
from .questions import TEXT, WORD, Cell, Entry, Question
from .record import DeckText, Number, Record
from .text import decode

_DRAFT = "flexmb new"

# A line of a deck in pieces: text, and the name of the answer that it comes from or "".
Line = Sequence[tuple[str, str]]
Entries = Generator[Entry, Record, None]


def titled(refused: str = "", width: int = 0) -> Entry:
    """The question for the title."""
    cell = Cell("text", "one line on the mechanism", "", TEXT, "", refused=refused, width=width)
    return Entry("title", 0, "title", (cell,))


def named(record: Record, separator: str = " ") -> Line:
    """The texts of a record as pieces of a line."""
    ends = [separator] * (len(record.numbers) - 1) + [""]
    pairs = zip(record.numbers, ends, strict=True)
    return [(f"{value.text}{end}", f"{record.prefix}.{value.key}") for value, end in pairs]


class Form(ABC):
    """Questions of a dialect; file names are relative to `folder`, `cards`: whether to ask for all cards.

    `early`: keys whose errors do not depend on later numbers of their record.  `of_whole`: identifiers of
    notes that say something only of a complete deck.
    """

    dialect = ""
    has_cards = False
    early: frozenset[str] = frozenset()
    of_whole: frozenset[str] = frozenset()

    def __init__(self, folder: Path = Path(), cards: bool = False):
        self.folder, self.cards = folder, cards

    @abstractmethod
    def entries(self, values: Mapping[str, str]) -> Entries:
        """Yield the records to ask for in order, and receive each as it was answered.

        `values`: all answers so far, by full name.  Raises DeckError for an answer that is wrong by itself.
        """

    @abstractmethod
    def lines(self, records: Sequence[Record]) -> list[Line]:
        """The deck of these records, which the reader takes even where others are still to be asked for."""

    @abstractmethod
    def read(self, source: DeckText, last: Record) -> Sequence[Fault]:
        """Read the deck so far, of which `last` is new, and return the warnings.  Raises FlexmbError."""

    def faults(self, records: Sequence[Record]) -> Iterator[tuple[str, Fault]]:
        """Yield what reader and builder say about the deck so far, with the name of the answer concerned."""
        lines = self.lines(records)
        if not lines:
            return
        try:
            faults_there = self.read(decode(_DRAFT, text_of(lines).encode()), records[-1])
        except FlexmbError as failure:
            faults_there = failure.faults
        for fault in faults_there:
            if fault.id not in self.of_whole and (name := name_at(lines, fault.place)):
                yield name, fault


def text_of(lines: Sequence[Line]) -> str:
    """The text of a deck."""
    return "".join("".join(text for text, _ in line) + "\n" for line in lines)


def name_at(lines: Sequence[Line], place: Place | None) -> str:
    """Name of the answer at a place of a deck, that of the next or last one of its line; "" without one."""
    if place is None or place.line > len(lines):
        return ""
    end, last = 0, ""
    for text, name in lines[place.line - 1]:
        end += len(text)
        last = name or last
        if name and place.column <= end:
            break
    return last


class Dialogue:
    """State of a dialogue.  `values`: the answers by full name ("body.1.x"), as typed.

    Of an answer with a misspelt number those before it stay.  An answer that is refused otherwise changes
    nothing, except that the dialogue goes back when the fault lies in an earlier answer.
    """

    def __init__(self, form: Form, values: dict[str, str] | None = None):
        self.form = form
        self.values = dict(values or {})
        self._entry = self._cell = 0

    @property
    def _asked(self) -> tuple[list[Entry], list[Record], Sequence[Fault]]:
        """The records that are answered well, as asked for and as answered, and the next one asked for.

        With them go the faults for which the form refuses the answer to that.
        """
        entries: list[Entry] = []
        records: list[Record] = []
        asking = self.form.entries(self.values)
        try:
            entries.append(next(asking))
            while self._answered(entries[-1]) == len(entries[-1].cells):
                records.append(self._record(len(records), entries[-1]))
                entries.append(asking.send(records[-1]))
        except StopIteration:
            pass
        except DeckError as refused:
            del records[-1]
            return entries, records, refused.faults
        return entries, records, ()

    @property
    def question(self) -> Question | None:
        """The next question, None when the deck is complete."""
        entries = self._asked[0]
        if self._entry >= len(entries):
            return None
        entry = entries[self._entry]
        end = next(stop for start, stop in entry.groups if start <= self._cell < stop)
        cells = entry.cells[self._cell : end]
        offered = tuple(self.values.get(entry.name(cell), cell.default) for cell in cells)
        return Question(entry, self._cell, cells, offered)

    @property
    def records(self) -> list[Record]:
        """The records answered so far."""
        return self._asked[1][: self._entry]

    @property
    def text(self) -> str:
        """The deck."""
        return text_of(self.form.lines(self.records))

    def answer(self, line: str) -> list[Fault]:
        """Take `line` as the answer to the present question; the errors and warnings of it.

        An error among them means that the answer was refused, or sent the dialogue back.
        """
        asked = self.question
        if asked is None:
            raise ValueError("every question is answered")
        entry, texts = asked.entry, _texts(asked, line)
        end = self._cell + len(texts)
        cells = entry.cells[self._cell : end]
        warnings = self._spelling(entry, cells, texts)
        if wrong := _first_error(warnings):
            if len(texts) <= len(cells):
                self._take_before(entry, cells, texts, wrong)
            return warnings
        before = self.values
        self.values = {**before, **{entry.name(c): text for c, text in zip(cells, texts, strict=True)}}
        faults = self._faults(end)
        wrong = _first_error(faults)
        if wrong is None:
            self._proceed(entry, end)
        elif wrong.place.line == self._entry + 1 and wrong.place.column > self._cell:
            self.values = before
        else:
            self._go_to(wrong.place)
        return [*warnings, *faults]

    def _take_before(self, entry: Entry, cells: tuple[Cell, ...], texts: list[str], wrong: Fault) -> None:
        """Take the numbers that stand before a misspelt one, for which the next question asks."""
        count = wrong.place.column - 1 - self._cell if wrong.place else 0
        taken = zip(cells[:count], texts, strict=False)
        self.values = {**self.values, **{entry.name(cell): text for cell, text in taken}}
        self._cell += count

    def back(self) -> bool:
        """Go to the question before the present one; False at the first."""
        if self._cell == 0 and self._entry == 0:
            return False
        entries = self._asked[0]
        if self._cell == 0:
            self._entry -= 1
            self._cell = len(entries[self._entry].cells)
        self._cell = entries[self._entry].start(self._cell - 1)
        return True

    def back_to(self, prefix: str) -> bool:
        """Go back to the record called `prefix`; False when none of that name was requested yet."""
        for index, entry in enumerate(self._asked[0][: self._entry + 1]):
            if entry.prefix == prefix:
                self._entry, self._cell = index, 0
                return True
        return False

    def back_to_place(self, place: Place) -> bool:
        """Go back to the record that a place of the deck comes from; False where there is none."""
        name = name_at(self.form.lines(self.records), place)
        return any(
            self.back_to(entry.prefix) for entry in self._asked[0] if name in map(entry.name, entry.cells)
        )

    def forward(self) -> list[Fault]:
        """Go to the first question without a good answer; the faults of the answer that stopped it."""
        entries, records, _ = self._asked
        self._entry = len(records)
        self._cell = self._answered(entries[-1]) if len(entries) > len(records) else 0
        faults = [*self._reader_faults(records), *(self._faults(self._cell) if self._cell else ())]
        wrong = [fault for fault in faults if fault.severity == "error"]
        if wrong:
            self._go_to(wrong[0].place)
        return wrong

    def _answered(self, entry: Entry) -> int:
        """Return how many cells of `entry`, from its first on, have a good answer."""
        return sum(takewhile(bool, (self._is_good(entry, cell) for cell in entry.cells)))

    def _is_good(self, entry: Entry, cell: Cell) -> bool:
        text = self.values.get(entry.name(cell))
        try:
            return text is not None and bool(cell.spelled(text))
        except number.Misspelt:
            return False

    def _spelling(self, entry: Entry, cells: tuple[Cell, ...], texts: list[str]) -> list[Fault]:
        """Errors and warnings of the spelling of `texts`, and the fault of too many."""
        faults = []
        for column, (cell, text) in enumerate(zip(cells, texts, strict=False), start=self._cell + 1):
            place = Place(self._entry + 1, column)
            try:
                if text is None:
                    raise number.Misspelt(f"must be {cell.kind}; Enter gives none here")
                warning = cell.spelled(text)[1]
            except number.Misspelt as fault:
                faults.append(Fault("error", f"{cell.key} {fault}", place, entry.subject, id="DECK-001"))
                continue
            if warning:
                faults.append(Fault("warning", f"{cell.key}: {warning}", place, entry.subject, id="DECK-002"))
        if len(texts) > len(cells):
            left = f"{' '.join(c.key for c in cells)}{_way_back(entry, cells, len(texts))}"
            message = f"{len(texts)} values, but only {len(cells)} are left: {left}"
            place = Place(self._entry + 1, len(entry.cells) + 1)
            faults.append(Fault("error", message, place, entry.subject, id="DECK-003"))
        return faults

    def _faults(self, end: int) -> list[Fault]:
        """Faults that the present record, answered up to cell `end`, brings into the deck so far."""
        entries, records, refused = self._asked
        entry, line = entries[self._entry], self._entry + 1
        complete = end == len(entry.cells)
        if complete and refused and len(records) == self._entry:
            return [replace(fault, place=Place(line, 1), subject=entry.subject) for fault in refused]
        keys = {cell.key for cell in entry.cells[:end]}
        if not complete:
            keys &= self.form.early
        if not keys:
            return []
        last = records[self._entry] if complete else self._record(self._entry, entry, end)
        faults = self._reader_faults([*records[: self._entry], last])
        if complete:
            return [fault for fault in faults if fault.severity == "error" or fault.place.line == line]
        return [f for f in faults if f.place.line == line and entry.cells[f.place.column - 1].key in keys]

    def _reader_faults(self, records: list[Record]) -> list[Any]:
        """Return what reader and builder say about the deck of `records`; places are those of the answers."""
        names = {f"{record.prefix}.{value.key}": value for record in records for value in record.numbers}
        entries = self._asked[0]
        cells = {entry.name(cell): cell for entry in entries[: len(records)] for cell in entry.cells}
        return [
            replace(fault, place=names[name].place)
            for name, fault in (self.form.faults(records) if records else ())
            if name in names and not cells[name].names
        ]

    def _record(self, index: int, entry: Entry, end: int | None = None) -> Record:
        """The record of an entry as answered, its cells from `end` on being zero or what Enter gives."""
        numbers = []
        for column, cell in enumerate(entry.cells, start=1):
            text = cell.default or "0" if cell.letter != WORD else cell.words[0]
            if end is None or column <= end:
                text = self.values[entry.name(cell)]
            value = cell.spelled(text)[0]
            place = Place(index + 1, column)
            numbers.append(Number(cell.key, value, cell.meaning, cell.unit, place, text))
        return Record(entry.section, entry.number, entry.subject, tuple(numbers))

    def _proceed(self, entry: Entry, end: int) -> None:
        self._entry, self._cell = (self._entry + 1, 0) if end == len(entry.cells) else (self._entry, end)

    def _go_to(self, place: Any) -> None:
        self._entry = place.line - 1
        self._cell = self._asked[0][self._entry].start(place.column - 1)


def draft_text(dialogue: Dialogue) -> str:
    """The answers so far as JSON, for `from_draft`."""
    return json.dumps({_DRAFT: dialogue.form.dialect, "answers": dialogue.values}, indent=1) + "\n"


def from_draft(form: Form, text: str) -> Dialogue:
    """The dialogue of a draft, at the first question without a good answer.

    Raises DeckError when the text is no draft of this dialect.
    """
    try:
        draft = json.loads(text)
        dialect, answers = draft[_DRAFT], draft["answers"]
        good = all(isinstance(v, str) for v in answers.values())
    except (ValueError, TypeError, KeyError, AttributeError):
        dialect, good = "", False
    if not good or dialect != form.dialect:
        what = f"a draft of a {dialect} deck" if good else "not a draft of a deck"
        raise DeckError(
            [Fault("error", f"this is {what}; --restart puts a new {form.dialect} draft here", id="DECK-004")]
        )
    dialogue = Dialogue(form, answers)
    dialogue.forward()
    return dialogue


def _first_error(faults: list[Fault]) -> Any:
    return next((fault for fault in faults if fault.severity == "error"), None)


def _way_back(entry: Entry, cells: tuple[Cell, ...], count: int) -> str:
    """Return how to answer a record with `count` values, of which a question takes only some."""
    whole = len(cells) < count <= len(entry.cells)
    return f"; < {entry.prefix} asks for the whole record again" if whole else ""


def _texts(asked: Question, line: str) -> list[Any]:
    """The texts that `line` gives for the cells from the asked ones on; None where Enter gives nothing."""
    if not line.strip():
        return list(asked.offered)
    letters = [cell.letter for cell in asked.entry.cells[asked.first :]]
    # Text continues to the end of the line, blanks and all.
    return line.strip().split(None, letters.index(TEXT) if TEXT in letters else -1)
