"""Questions of a dialogue: values, the records they belong to, and their wording."""

import re
from collections.abc import Callable
from dataclasses import dataclass, field
from itertools import groupby

from . import number
from .fortran_fields import filled
from .record import Value

INTEGER, REAL, WORD, TEXT = "I", "F", "A", "T"
MOST_ASKED = 1000  # records of a section
COUNT = (0, MOST_ASKED)
_KINDS = {INTEGER: "an integer", REAL: "a number", TEXT: "text to the end of the line"}
_FUNCTION = re.compile(r"[A-Za-z][A-Za-z0-9_-]*")


@dataclass(frozen=True)
class Cell:
    """One value of a record: `letter` INTEGER, REAL, WORD (one of `words`) or TEXT (the rest of a line).

    `default`: what an empty answer gives, None where there must be one; `within`: least and most value;
    `width`: columns that it must fit, 0 for any number; `names`: it may name a function that comes later;
    `refused`: characters that a text must not hold.
    """

    key: str
    meaning: str
    unit: str = ""
    letter: str = REAL
    default: str | None = None
    words: tuple[str, ...] = ()
    within: tuple[int, int] | None = None
    width: int = 0
    names: bool = False
    refused: str = ""

    @property
    def kind(self) -> str:
        """Return what must be typed, for messages."""
        return _KINDS.get(self.letter) or f"one of {', '.join(self.words)}"

    @property
    def pattern(self) -> str | None:
        """The meaning without its component: equal for x, y, z of one vector, None without components."""
        component = rf"\b{re.escape(self.key.split('.')[-1])}\b"
        return re.sub(component, "{}", self.meaning, count=1) if re.search(component, self.meaning) else None

    def spelled(self, text: str) -> tuple[Value, str]:
        """Value and warning of a text.  Raises Misspelt."""
        value, warning = self._read(text)
        if self.within and value != "" and not self.within[0] <= value <= self.within[1]:
            raise number.Misspelt(f"must be within {self.within[0]}..{self.within[1]}; read {text}")
        if not self.width or self._fits(value, text):
            return value, warning
        if self.letter == TEXT:
            raise number.Misspelt(f"has room for {self.width} characters; read {len(text)}")
        nearest = f"; the nearest that fits is {filled(value, self.width)}" if self.letter == REAL else ""
        raise number.Misspelt(f"must fit {self.width} columns; read {text}{nearest}")

    def _read(self, text: str) -> tuple[Value, str]:
        if self.letter == TEXT:
            wrong = next((letter for letter in self.refused if letter in text), "")
            if wrong or not text.isprintable():
                rule = f"cannot hold {wrong}" if wrong else "must be text that can be printed"
                raise number.Misspelt(f"{rule}; read {number.shown(text)}")
            return text, ""
        if text == self.default == "" or (self.names and _FUNCTION.fullmatch(text)):
            return text, ""
        if self.letter == WORD:
            if text.upper() not in self.words:
                raise number.Misspelt(f"must be {self.kind}; read {number.shown(text)}")
            return text.upper(), ""
        return number.integer(text) if self.letter == INTEGER else number.real(text)

    def _fits(self, value: Value, text: str) -> bool:
        if self.letter != REAL:
            return len(str(value)) <= self.width
        return ("." in text and len(text) <= self.width) or float(filled(value, self.width)) == value


@dataclass(frozen=True)
class Entry:
    """A record that is requested; `number` counts within the section, 0 where there is one a deck.

    `optional`: at the end of a pipe of answers it is answered by what Enter gives.  `topics`: what `? TOPIC`
    explains.
    """

    section: str
    number: int
    subject: str
    cells: tuple[Cell, ...]
    optional: bool = False
    topics: Callable[[str], str] | None = field(default=None, compare=False)

    @property
    def prefix(self) -> str:
        """Its name, as `Record.prefix`."""
        return f"{self.section}.{self.number}" if self.number else self.section

    @property
    def groups(self) -> list[tuple[int, int]]:
        """Ranges of cells that are requested together: the components of one vector, or a single cell."""
        indices, ranges = range(len(self.cells)), []
        # A cell without components belongs to nobody: its own index keeps it apart.
        for _, members in groupby(indices, key=lambda i: (self.cells[i].pattern or i, self.cells[i].unit)):
            group = list(members)
            ranges.append((group[0], group[-1] + 1))
        return ranges

    def start(self, index: int) -> int:
        """First cell of the group that cell `index` belongs to."""
        return next(start for start, stop in self.groups if start <= index < stop)

    def name(self, cell: Cell) -> str:
        """Full name of a cell's answer ("body.1.x")."""
        return f"{self.prefix}.{cell.key}"


@dataclass(frozen=True)
class Question:
    """Current question: cells of a record from its cell `first` on, and what Enter gives for each."""

    entry: Entry
    first: int
    cells: tuple[Cell, ...]
    offered: tuple[str | None, ...]

    @property
    def text(self) -> str:
        """Names, meaning and unit in one line."""
        first = self.cells[0]
        keys = ", ".join(cell.key.split(".")[-1] for cell in self.cells)
        meaning = (first.pattern or first.meaning).format(keys) if len(self.cells) > 1 else first.meaning
        unit = f", {first.unit}" if first.unit else ""
        return f"{' '.join(cell.key for cell in self.cells)}: {meaning}{unit}"

    @property
    def prompt(self) -> str:
        """Return what Enter gives, and the mark after which the answer is typed."""
        offered = [value for value in self.offered if value is not None]
        return f"[{' '.join(offered).strip() or 'none'}] > " if len(offered) == len(self.offered) else "> "

    def help(self, topic: str = "") -> str:
        """A line for every value that is requested, and what the record says about a topic."""
        lines = [_explained(*pair) for pair in zip(self.cells, self.offered, strict=True)]
        return "\n".join([*lines, *([self.entry.topics(topic)] if self.entry.topics else [])])


def _explained(cell: Cell, offered: str | None) -> str:
    unit = f", {cell.unit}" if cell.unit else ""
    enter = "" if offered is None else f"; Enter gives {offered or 'none'}"
    return f"{cell.key}: {cell.meaning}{unit}; {cell.kind}{enter}"
