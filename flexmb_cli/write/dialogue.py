"""A deck asked for number by number: questions out, answers in; no stream is touched here.

What is asked comes from a `Form`, one a dialect, made of the reader's own tables.  A line may answer
one number, one question or the rest of a record, as Pascal's READ took them.
"""

import json
import re
from collections.abc import Sequence
from dataclasses import dataclass, replace
from itertools import groupby, takewhile
from typing import Protocol

from ..errors import DeckError, Fault, Place
from ..read import number
from ..read.deck import Number, Record

INTEGER, REAL, WORD, TEXT = "I", "F", "A", "T"
_KINDS = {INTEGER: "an integer", REAL: "a number", TEXT: "text to the end of the line"}
_DRAFT = "flexmb new"


@dataclass(frozen=True)
class Cell:
    """One value of a record: `letter` INTEGER, REAL, WORD (one of `words`) or TEXT (the rest of a line).

    `default`: what an empty answer gives, None where there must be one.
    """

    key: str
    meaning: str
    unit: str = ""
    letter: str = REAL
    default: str | None = None
    words: tuple[str, ...] = ()

    @property
    def kind(self) -> str:
        """What must be typed, for messages."""
        return _KINDS.get(self.letter) or f"one of {', '.join(self.words)}"

    @property
    def pattern(self) -> str | None:
        """The meaning without its component: equal for x, y, z of one vector, None without components."""
        component = rf"\b{re.escape(self.key.split('.')[-1])}\b"
        return re.sub(component, "{}", self.meaning, count=1) if re.search(component, self.meaning) else None


@dataclass(frozen=True)
class Entry:
    """A record that is asked for; `number` counts within the section, 0 where there is one a deck."""

    section: str
    number: int
    subject: str
    cells: tuple[Cell, ...]

    @property
    def prefix(self) -> str:
        """Its name, as `Record.prefix`."""
        return f"{self.section}.{self.number}" if self.number else self.section

    @property
    def groups(self) -> list[tuple[int, int]]:
        """Ranges of cells that are asked for together: the components of one vector, or a single cell."""
        indices, ranges = range(len(self.cells)), []
        # A cell without components belongs to nobody: its own index keeps it apart.
        for _, found in groupby(indices, key=lambda i: (self.cells[i].pattern or i, self.cells[i].unit)):
            group = list(found)
            ranges.append((group[0], group[-1] + 1))
        return ranges


class Form(Protocol):
    """What a dialect asks for.

    `entries`: all records that the answers so far (name → text) announce, in order; an entry depends on
    answers before it only.  `faults`: what the last of the records brings in, its later numbers missing
    where it is not `complete`; a place is (number of the record, number of the value) from 1.
    `lines`: the deck as pairs (line, prefix of its record or "").
    """

    dialect: str

    def entries(self, values: dict[str, str]) -> list[Entry]: ...  # noqa: D102
    def faults(self, records: Sequence[Record], complete: bool) -> list[Fault]: ...  # noqa: D102
    def lines(self, records: Sequence[Record]) -> list[tuple[str, str]]: ...  # noqa: D102


@dataclass(frozen=True)
class Question:
    """What is asked now: cells of a record from its cell `first` on, and what Enter gives for each."""

    entry: Entry
    first: int
    cells: tuple[Cell, ...]
    offered: tuple[str | None, ...]

    @property
    def text(self) -> str:
        """Names, meaning and unit in one line."""
        return f"{' '.join(cell.key for cell in self.cells)}: {self._meaning}"

    @property
    def prompt(self) -> str:
        """What Enter gives, and the mark behind which the answer is typed."""
        return "> " if None in self.offered else f"[{' '.join(self.offered).strip() or 'none'}] > "

    @property
    def help(self) -> str:
        """A line for every value that is asked for."""
        return "\n".join(_explained(*pair) for pair in zip(self.cells, self.offered, strict=True))

    @property
    def _meaning(self):
        first = self.cells[0]
        if len(self.cells) == 1:
            meaning = first.meaning
        else:
            meaning = first.pattern.format(", ".join(cell.key.split(".")[-1] for cell in self.cells))
        return f"{meaning}, {first.unit}" if first.unit else meaning


def _explained(cell, offered):
    unit = f", {cell.unit}" if cell.unit else ""
    enter = "" if offered is None else f"; Enter gives {offered or 'none'}"
    return f"{cell.key}: {cell.meaning}{unit}; {cell.kind}{enter}"


class Dialogue:
    """Where the dialogue stands.  `values`: the answers by full name ("body.1.x"), as typed.

    An answer that is refused changes nothing, except that the dialogue goes back when the fault lies in
    an earlier answer.
    """

    def __init__(self, form: Form, values: dict[str, str] | None = None):
        self.form = form
        self.values = dict(values or {})
        self._entry = self._cell = 0

    @property
    def question(self) -> Question | None:
        """The next question, None when the deck is complete."""
        entries = self.form.entries(self.values)
        if self._entry >= len(entries):
            return None
        entry = entries[self._entry]
        end = next(stop for start, stop in entry.groups if start <= self._cell < stop)
        cells = entry.cells[self._cell : end]
        offered = tuple(self.values.get(_name(entry, cell), cell.default) for cell in cells)
        return Question(entry, self._cell, cells, offered)

    @property
    def records(self) -> list[Record]:
        """The records answered so far."""
        entries = self.form.entries(self.values)[: self._entry]
        return [_record(index, entry, self.values) for index, entry in enumerate(entries)]

    @property
    def lines(self) -> list[tuple[str, str]]:
        """The deck, line by line with the prefix of each line's record."""
        return self.form.lines(self.records)

    def answer(self, line: str) -> list[Fault]:
        """Take `line` as the answer to the present question; the faults and doubts of it.

        An error among them means that the answer was refused, or sent the dialogue back.
        """
        asked = self.question
        texts = _texts(asked, line)
        cells = asked.entry.cells[self._cell : self._cell + len(texts)]
        doubts = self._spelling(asked.entry, cells, texts)
        if len(texts) > len(cells) or any(fault.severity == "error" for fault in doubts):
            return doubts
        tried = {_name(asked.entry, cell): text for cell, text in zip(cells, texts, strict=True)}
        before, self.values = self.values, {**self.values, **tried}
        end = self._cell + len(texts)
        faults = self._faults(asked.entry, end)
        wrong = next((fault for fault in faults if fault.severity == "error"), None)
        if wrong is None:
            self._go_on(asked.entry, end)
        elif self._lies_before(wrong):
            self._cell = _start(asked.entry, wrong.place.column - 1)
        else:
            self.values = before
        return [*doubts, *faults]

    def back(self) -> bool:
        """Go to the question before the present one; False at the first."""
        entries = self.form.entries(self.values)
        if self._cell == 0 and self._entry == 0:
            return False
        if self._cell == 0:
            self._entry -= 1
            self._cell = len(entries[self._entry].cells)
        self._cell = _start(entries[self._entry], self._cell - 1)
        return True

    def back_to(self, prefix: str) -> bool:
        """Go back to the record called `prefix`; False when none of that name was asked for yet."""
        for index, entry in enumerate(self.form.entries(self.values)[: self._entry + 1]):
            if entry.prefix == prefix:
                self._entry, self._cell = index, 0
                return True
        return False

    def forward(self) -> list[Fault]:
        """Go to the first question without a good answer; the faults of the answer that stopped it."""
        while (asked := self.question) is not None:
            end = self._answered(asked.entry)
            faults = self._faults(asked.entry, end) if end else []
            wrong = next((fault for fault in faults if fault.severity == "error"), None)
            if wrong is not None:
                self._cell = _start(asked.entry, wrong.place.column - 1) if self._is_here(wrong) else 0
                return faults
            self._go_on(asked.entry, end)
            if end < len(asked.entry.cells):
                break
        return []

    def _answered(self, entry):
        """How many cells of `entry`, from its first on, have a good answer."""
        known = (self._known(entry, cell) is not None for cell in entry.cells)
        return sum(takewhile(bool, known))

    def _spelling(self, entry, cells, texts):
        """Faults and doubts of the spelling of `texts`, and the fault of too many."""
        faults = []
        for column, (cell, text) in enumerate(zip(cells, texts, strict=False), start=self._cell + 1):
            place = Place(self._entry + 1, column)
            try:
                if text is None:
                    raise number.Misspelt(f"must be {cell.kind}; Enter gives none here")
                doubt = _spelled(cell, text)[1]
            except number.Misspelt as fault:
                faults.append(Fault("error", f"{cell.key} {fault}", place, entry.subject))
                continue
            if doubt:
                faults.append(Fault("warning", f"{cell.key}: {doubt}", place, entry.subject))
        if len(texts) > len(cells):
            message = f"{len(texts)} values, but only {len(cells)} are left: {' '.join(c.key for c in cells)}"
            place = Place(self._entry + 1, len(entry.cells) + 1)
            faults.append(Fault("error", message, place, entry.subject))
        return faults

    def _known(self, entry, cell):
        """The value kept for a cell when it is well spelled, else None."""
        text = self.values.get(_name(entry, cell))
        try:
            return None if text is None else _spelled(cell, text)[0]
        except number.Misspelt:
            return None

    def _faults(self, entry, end):
        """Faults of `entry` answered up to cell `end`, in the deck so far."""
        complete = end == len(entry.cells)
        # The entry itself may look otherwise now: its labels follow the direction just given.
        entry = self.form.entries(self.values)[self._entry]
        last = _record(self._entry, replace(entry, cells=entry.cells[:end]), self.values)
        return self.form.faults([*self.records, last], complete)

    def _go_on(self, entry, end):
        self._entry, self._cell = (self._entry + 1, 0) if end == len(entry.cells) else (self._entry, end)

    def _is_here(self, fault):
        return fault.place is not None and fault.place.line == self._entry + 1

    def _lies_before(self, fault):
        return self._is_here(fault) and fault.place.column - 1 < self._cell


def draft_text(dialogue: Dialogue) -> str:
    """The answers so far as JSON, for `from_draft`."""
    return json.dumps({_DRAFT: dialogue.form.dialect, "answers": dialogue.values}, indent=1) + "\n"


def from_draft(form: Form, text: str) -> Dialogue:
    """The dialogue of a draft, at the first question without a good answer.

    Raises DeckError when the text is no draft of this dialect.
    """
    try:
        kept = json.loads(text)
        dialect, answers = kept[_DRAFT], kept["answers"]
        good = all(isinstance(v, str) for v in answers.values())
    except (ValueError, TypeError, KeyError, AttributeError):
        dialect, good = "", False
    if not good or dialect != form.dialect:
        what = f"a draft of a {dialect} deck" if good else "no draft of a deck"
        raise DeckError([Fault("error", f"this is {what}; --restart puts a new {form.dialect} draft here")])
    dialogue = Dialogue(form, answers)
    dialogue.forward()
    return dialogue


def _name(entry, cell):
    return f"{entry.prefix}.{cell.key}"


def _start(entry, index):
    """First cell of the group that cell `index` belongs to."""
    return next(start for start, stop in entry.groups if start <= index < stop)


def _record(index, entry, values):
    numbers = []
    for column, cell in enumerate(entry.cells, start=1):
        text = values[_name(entry, cell)]
        place = Place(index + 1, column)
        numbers.append(Number(cell.key, _spelled(cell, text)[0], cell.meaning, cell.unit, place, text))
    return Record(entry.section, entry.number, entry.subject, tuple(numbers))


def _texts(asked, line):
    """The texts that `line` gives for the cells from the asked ones on; None where Enter gives nothing."""
    if not line.strip():
        return list(asked.offered)
    letters = [cell.letter for cell in asked.entry.cells[asked.first :]]
    # Text goes on to the end of the line, blanks and all.
    return line.strip().split(None, letters.index(TEXT) if TEXT in letters else -1)


def _spelled(cell, text):
    """Value and doubt of a cell's text.  Raises Misspelt."""
    if cell.letter == TEXT and not text.isprintable():
        raise number.Misspelt(f"must be text that can be printed; read {number.shown(text)}")
    if cell.letter == TEXT or text == cell.default == "":
        return text, ""
    if cell.letter == WORD:
        word = text.upper()
        if word not in cell.words:
            raise number.Misspelt(f"must be {cell.kind}; read {number.shown(text)}")
        return word, ""
    return number.integer(text) if cell.letter == INTEGER else number.real(text)
