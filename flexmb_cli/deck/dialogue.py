"""The dialogue of `flexmb new`, which builds a deck number by number: questions out, answers in, no streams.

The questions come from the `Form` of a dialect, which is made of the reader's own tables.  A line may answer
one number, one question or the rest of a record, as Pascal's READ took them.
"""

import json
from collections.abc import Sequence
from dataclasses import replace
from itertools import takewhile
from typing import Any, Protocol

from ..errors import DeckError, Fault, Place
from . import number
from .questions import TEXT, Cell, Entry, Question, spelled
from .record import Number, Record

_DRAFT = "flexmb new"


class Form(Protocol):
    """Questions of a dialect.

    `entries`: all records that the answers so far (name → text) announce, in order; an entry depends on
    answers before it only.  `faults`: what the last of the records brings in, its later numbers missing
    where it is not `complete`; a place is (number of the record, number of the value) from 1.
    `lines`: the deck as pairs (line, prefix of its record or "").
    """

    dialect: str

    def entries(self, values: dict[str, str]) -> list[Entry]: ...  # noqa: D102
    def faults(self, records: Sequence[Record], complete: bool) -> list[Fault]: ...  # noqa: D102
    def lines(self, records: Sequence[Record]) -> list[tuple[str, str]]: ...  # noqa: D102


class Dialogue:
    """State of a dialogue.  `values`: the answers by full name ("body.1.x"), as typed.

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
        """Take `line` as the answer to the present question; the errors and warnings of it.

        An error among them means that the answer was refused, or sent the dialogue back.
        """
        asked = self.question
        if asked is None:
            raise ValueError("every question is answered")
        texts = _texts(asked, line)
        cells = asked.entry.cells[self._cell : self._cell + len(texts)]
        warnings = self._spelling(asked.entry, cells, texts)
        if len(texts) > len(cells) or any(fault.severity == "error" for fault in warnings):
            return warnings
        tried = {_name(asked.entry, cell): text for cell, text in zip(cells, texts, strict=True)}
        before, self.values = self.values, {**self.values, **tried}
        end = self._cell + len(texts)
        faults = self._faults(asked.entry, end)
        wrong = next((fault for fault in faults if fault.severity == "error"), None)
        if wrong is None:
            self._proceed(asked.entry, end)
        elif self._lies_before(wrong):
            self._cell = _start(asked.entry, wrong.place.column - 1)
        else:
            self.values = before
        return [*warnings, *faults]

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
        """Go back to the record called `prefix`; False when none of that name was requested yet."""
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
            self._proceed(asked.entry, end)
            if end < len(asked.entry.cells):
                break
        return []

    def _answered(self, entry: Entry) -> int:
        """Return how many cells of `entry`, from its first on, have a good answer."""
        known = (self._known(entry, cell) is not None for cell in entry.cells)
        return sum(takewhile(bool, known))

    def _spelling(self, entry: Entry, cells: tuple[Cell, ...], texts: list[str]) -> list[Fault]:
        """Errors and warnings of the spelling of `texts`, and the fault of too many."""
        faults = []
        for column, (cell, text) in enumerate(zip(cells, texts, strict=False), start=self._cell + 1):
            place = Place(self._entry + 1, column)
            try:
                if text is None:
                    raise number.Misspelt(f"must be {cell.kind}; Enter gives none here")
                warning = spelled(cell, text)[1]
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

    def _known(self, entry: Entry, cell: Cell) -> Any:
        """The value kept for a cell when it is well spelled, else None."""
        text = self.values.get(_name(entry, cell))
        try:
            return None if text is None else spelled(cell, text)[0]
        except number.Misspelt:
            return None

    def _faults(self, entry: Entry, end: int) -> Any:
        """Faults of `entry` answered up to cell `end`, in the deck so far."""
        complete = end == len(entry.cells)
        # The entry itself may look otherwise now: its labels follow the direction just given.
        entry = self.form.entries(self.values)[self._entry]
        last = _record(self._entry, replace(entry, cells=entry.cells[:end]), self.values)
        return self.form.faults([*self.records, last], complete)

    def _proceed(self, entry: Entry, end: int) -> Any:
        self._entry, self._cell = (self._entry + 1, 0) if end == len(entry.cells) else (self._entry, end)

    def _is_here(self, fault: Fault) -> bool:
        return fault.place is not None and fault.place.line == self._entry + 1

    def _lies_before(self, fault: Any) -> bool:
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
        raise DeckError(
            [Fault("error", f"this is {what}; --restart puts a new {form.dialect} draft here", id="DECK-004")]
        )
    dialogue = Dialogue(form, answers)
    dialogue.forward()
    return dialogue


def _name(entry: Entry, cell: Cell) -> str:
    return f"{entry.prefix}.{cell.key}"


def _way_back(entry: Entry, cells: tuple[Cell, ...], count: int) -> str:
    """Return how to answer a record with `count` values, of which a question takes only some."""
    whole = len(cells) < count <= len(entry.cells)
    return f"; < {entry.prefix} asks for the whole record again" if whole else ""


def _start(entry: Entry, index: int) -> Any:
    """First cell of the group that cell `index` belongs to."""
    return next(start for start, stop in entry.groups if start <= index < stop)


def _record(index: int, entry: Entry, values: dict[str, str]) -> Record:
    numbers = []
    for column, cell in enumerate(entry.cells, start=1):
        text = values[_name(entry, cell)]
        place = Place(index + 1, column)
        numbers.append(Number(cell.key, spelled(cell, text)[0], cell.meaning, cell.unit, place, text))
    return Record(entry.section, entry.number, entry.subject, tuple(numbers))


def _texts(asked: Any, line: str) -> list[str]:
    """The texts that `line` gives for the cells from the asked ones on; None where Enter gives nothing."""
    if not line.strip():
        return list(asked.offered)
    letters = [cell.letter for cell in asked.entry.cells[asked.first :]]
    # Text continues to the end of the line, blanks and all.
    return line.strip().split(None, letters.index(TEXT) if TEXT in letters else -1)
