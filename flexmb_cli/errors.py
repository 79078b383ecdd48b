"""Faults as values and exceptions: a sentence, a place, an object, and an exit code.

Faults are collected, not thrown one at a time: a reader continues after a fault and raises one
`DeckError` that carries all of them.  Only the commands (`cli`) turn them into text on a stream.
"""

from collections.abc import Iterable
from dataclasses import dataclass, field
from functools import cached_property
from typing import TYPE_CHECKING, Any, NamedTuple, Protocol, Self

if TYPE_CHECKING:
    from collections.abc import Sequence
    from os import PathLike

    import numpy as np


DONE, ANALYSIS_FAILED, BAD_INPUT, INTERNAL_FAULT = 0, 1, 2, 3
COMPLETE, FAILED = "complete", "failed"  # status of a result

SHOWN_FAULTS = 20
MOST_ALIKE = 1000
MOST_LISTED_ERRORS = 50_000
SHOWN_LINE = 160


class Place(NamedTuple):
    """Place in a deck: line and column count from 1, columns in characters."""

    line: int  # from 1
    column: int  # of the first character, from 1
    width: int = 1  # characters


@dataclass(frozen=True)
class Fault:
    """One thing wrong (or doubtful) in a deck.

    `severity` is "error", "warning" or "note"; `subject` the object by its deck name ("universal
    joint 1"), "" when the whole deck is meant; `message` the rule, what was read and the remedy;
    `guide` lines to set above the deck's line (the columns that a fixed FORMAT prescribes); `about` the
    object where the message itself names it, for records only; `id` the stable identifier of this type of
    fault ("YOUNG-012"), whatever its words become.
    """

    severity: str
    message: str
    place: Place | None = None
    subject: str = ""
    guide: tuple[str, ...] = ()
    about: str = ""
    id: str = field(default="", compare=False)

    @property
    def sentence(self) -> str:
        """Subject and message in one line."""
        return f"{self.subject}: {self.message}" if self.subject else self.message

    def as_record(self) -> list[Any]:
        """Return all fields in JSON's types."""
        return [self.severity, self.message, self.place, self.subject, self.guide, self.about, self.id]

    @classmethod
    def of_record(cls, record: list[Any]) -> "Fault":
        """The fault that `as_record` was made of, as JSON gives it back."""
        severity, message, place, subject, guide, about, name = record
        return cls(severity, message, place and Place(*place), subject, tuple(guide), about, name)

    def as_dict(self, lines: "Sequence[str]" = ()) -> dict[str, Any]:
        """Plain record for `--json`; `lines` as in `compiler_style`, "file" that of another than the deck."""
        own, place, _ = _located(self, lines)
        line, column = place[:2] if place else (None, None)
        return {
            **({"file": own} if own else {}),
            "id": self.id,
            "severity": self.severity,
            "object": self.subject or self.about,
            "message": self.message,
            "line": line,
            "column": column,
        }


class FaultList(list[Fault]):
    """Faults as they are found: up to `MOST_LISTED_ERRORS` errors, `MOST_ALIKE` warnings of one type."""

    def append(self, fault: Fault) -> None:
        """Add a fault, or say once that there are more like it."""
        if fault.severity == "error":
            self._append_error(fault)
            return
        alike = self._counts[fault.id] = self._counts.get(fault.id, 0) + 1
        if alike <= MOST_ALIKE:
            super().append(fault)
        elif alike == MOST_ALIKE + 1:
            message = f"{MOST_ALIKE} like the last are listed, the others are not: {fault.message}"
            super().append(Fault("note", message, fault.place, fault.subject, id="FLEXMB-005"))

    def _append_error(self, fault: Fault) -> None:
        self._errors += 1
        if self._errors <= MOST_LISTED_ERRORS:
            super().append(fault)
        elif self._errors == MOST_LISTED_ERRORS + 1:
            message = f"{MOST_LISTED_ERRORS} errors are listed, the others are not"
            super().append(Fault("error", message, fault.place, id="FLEXMB-007"))

    _errors = 0

    def extend(self, faults: Iterable[Fault]) -> None:
        """Add faults."""
        for fault in faults:
            self.append(fault)

    # Of lists of faults alone, as `append`; `+` makes a plain list.
    def __iadd__(self, faults: Iterable[Fault]) -> Self:  # type: ignore[override, misc]
        self.extend(faults)
        return self

    @cached_property
    def _counts(self) -> dict[Any, Any]:
        return {}


def sentences(faults: Iterable[Any]) -> tuple[str, ...]:
    """Return subject and message of every fault, as results keep them."""
    return tuple(fault.sentence for fault in faults)


class FlexmbError(Exception):
    """Base of everything flexmb raises on purpose; `exit_code` is the program's.

    `file` is the one at fault as the user named it, "" where it is none; `of_the_call`: an option is at
    fault, and no file; `printed`: as JSON already.
    """

    exit_code = INTERNAL_FAULT
    file = ""
    of_the_call = False
    printed = False

    def __init__(self, message: str, faults: tuple[Fault, ...] = (), id: str = ""):
        super().__init__(message)
        self.faults = tuple(faults) or (Fault("error", message, id=id),)

    def __reduce__(self) -> tuple[Any, ...]:
        # Exceptions are pickled with their message alone, which is not what these classes take.
        return _same_error, (type(self), self.args, self.__dict__)


def _same_error(
    of_type: type[FlexmbError], arguments: tuple[Any, ...], content: dict[str, Any]
) -> FlexmbError:
    error = of_type.__new__(of_type, *arguments)
    error.__dict__.update(content)
    return error


class DeckError(FlexmbError):
    """The deck cannot be read, or does not describe a model (exit 2)."""

    exit_code = BAD_INPUT

    def __init__(self, faults: Any):
        faults = tuple(faults)
        first = next((fault for fault in faults if fault.severity == "error"), faults[0])
        super().__init__(first.sentence, faults)


class ModelError(DeckError):
    """The deck is well formed, but the model cannot be solved as given (exit 2)."""


class SolvedRows(Protocol):
    """Rows of a run in memory, by the paths of datasets and the names of quantities (`flexmb_cli.Result`)."""

    def __getitem__(self, name: str) -> "np.ndarray":
        """Return a dataset or a quantity."""

    def __len__(self) -> int:
        """Return the number of datasets."""

    @property
    def time(self) -> "np.ndarray":
        """The times of the rows, s (times,)."""

    def unit(self, name: str) -> str:
        """Return the unit of a dataset or a quantity."""

    def save(self, path: "str | PathLike[str]") -> None:
        """Write an HDF5 file."""


class AnalysisError(FlexmbError):
    """The analysis stopped at `time`; what was computed before is kept (exit 1).

    `norms` carries the figures of the failure (remaining gap, worst residuals) for `--json`; `result` the
    rows so far, where `interface.solve` raised it.
    """

    exit_code = ANALYSIS_FAILED
    result: "SolvedRows | None" = None

    def __init__(self, fault: Fault, time: float, norms: dict[str, Any] | None = None):
        super().__init__(fault.sentence, (fault,))
        self.time = time
        self.norms = norms or {}


class OutputError(FlexmbError):
    """A result cannot be written: a wrong place (exit 2), or a disk that fills up on the way (exit 1)."""

    def __init__(self, message: str, exit_code: int = BAD_INPUT, id: str = ""):
        super().__init__(message, id=id)
        self.exit_code = exit_code


def compiler_style(deck_name: str, faults: "Sequence[Any]", lines: "Sequence[str]" = ()) -> str:
    """Text of `faults` as compilers print them: place, severity, sentence, the line and a caret.

    `lines` are the deck's lines, which may know another place where they were read (`deck.record.Lines`); a
    fault without a place shows neither line nor caret.
    """
    deck_name = visible(deck_name)
    blocks = [_one_fault(deck_name, fault, lines) for fault in _most_serious(faults)]
    if len(faults) > SHOWN_FAULTS:
        blocks.append(f"{deck_name}: {len(faults) - SHOWN_FAULTS} more faults not shown")
    return "\n".join(blocks)


def _most_serious(faults: "Sequence[Any]") -> "Sequence[Any]":
    """At most `SHOWN_FAULTS` of `faults` in their order, so that no crowd of warnings hides an error."""
    if len(faults) <= SHOWN_FAULTS:
        return faults
    by_weight = sorted(range(len(faults)), key=lambda index: faults[index].severity != "error")
    return [faults[index] for index in sorted(by_weight[:SHOWN_FAULTS])]


def _one_fault(deck_name: str, fault: Fault, lines: "Sequence[str]") -> str:
    file, place, text = _located(fault, lines)
    deck_name = visible(file) or deck_name
    if place is None:
        return f"{deck_name}: {fault.severity}: {visible(fault.sentence)}"
    head = f"{deck_name}:{place.line}:{place.column}: {fault.severity}: {visible(fault.sentence)}"
    if text is None:
        return head
    before, line = _excerpt(text, place.column - 1)
    # Tabs are kept in front of the caret, so that it stands below its token at any tab width.
    lead = "".join("\t" if char == "\t" else " " for char in line[:before])
    lead = lead.ljust(before)
    shown = (*fault.guide, line, lead + "^" * max(1, place.width))
    return "\n    ".join((head, *shown))


def _located(fault: Fault, lines: "Sequence[str]") -> tuple[str, Place | None, str | None]:
    """Return file ("": that of the deck), place and line of a fault as they were read."""
    place, located = fault.place, getattr(lines, "located", None)
    if place is not None and located is not None:
        return located(place)
    known = place is not None and 1 <= place.line <= len(lines)
    return "", place, lines[place.line - 1] if place is not None and known else None


def _excerpt(line: str, before: int) -> tuple[int, str]:
    """The line and how much stands before the caret; long lines cut."""
    if len(line) > SHOWN_LINE:
        start = max(0, before - SHOWN_LINE // 2)
        cut = "…" if start else ""
        more = "…" if len(line) > start + SHOWN_LINE else ""
        line, before = f"{cut}{line[start : start + SHOWN_LINE]}{more}", before - start + len(cut)
    return before, visible(line)


def visible(text: str) -> str:
    """`text` with marks for what cannot be printed: data may hold anything, and no terminal shall obey it."""
    # The ideographic space is a blank to the readers of decks, and no damage.
    text = text.replace("\u3000", "  ")
    return "".join(char if char.isprintable() or char == "\t" else "�" for char in text)


def lines_visible(text: str) -> str:
    """`visible` of every line."""
    return "\n".join(map(visible, text.split("\n")))
