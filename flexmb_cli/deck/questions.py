"""Questions of a dialogue: values, the records they belong to, and their wording."""

import re
from dataclasses import dataclass
from itertools import groupby

from . import number
from .record import Value

INTEGER, REAL, WORD, TEXT = "I", "F", "A", "T"
MOST_ASKED = 1000  # records of a section
_KINDS = {INTEGER: "an integer", REAL: "a number", TEXT: "text to the end of the line"}


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
        """Return what must be typed, for messages."""
        return _KINDS.get(self.letter) or f"one of {', '.join(self.words)}"

    @property
    def pattern(self) -> str | None:
        """The meaning without its component: equal for x, y, z of one vector, None without components."""
        component = rf"\b{re.escape(self.key.split('.')[-1])}\b"
        return re.sub(component, "{}", self.meaning, count=1) if re.search(component, self.meaning) else None


@dataclass(frozen=True)
class Entry:
    """A record that is requested; `number` counts within the section, 0 where there is one a deck.

    `optional`: at the end of a pipe of answers it is answered by what Enter gives.
    """

    section: str
    number: int
    subject: str
    cells: tuple[Cell, ...]
    optional: bool = False

    @property
    def prefix(self) -> str:
        """Its name, as `Record.prefix`."""
        return f"{self.section}.{self.number}" if self.number else self.section

    @property
    def groups(self) -> list[tuple[int, int]]:
        """Ranges of cells that are requested together: the components of one vector, or a single cell."""
        indices, ranges = range(len(self.cells)), []
        # A cell without components belongs to nobody: its own index keeps it apart.
        for _, found in groupby(indices, key=lambda i: (self.cells[i].pattern or i, self.cells[i].unit)):
            group = list(found)
            ranges.append((group[0], group[-1] + 1))
        return ranges


TITLE_ENTRY = Entry(
    "title", 0, "title", (Cell("text", "one line on the mechanism", letter=TEXT, default=""),)
)


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
        return f"{' '.join(cell.key for cell in self.cells)}: {self._meaning}"

    @property
    def prompt(self) -> str:
        """Return what Enter gives, and the mark behind which the answer is typed."""
        offered = [value for value in self.offered if value is not None]
        return f"[{' '.join(offered).strip() or 'none'}] > " if len(offered) == len(self.offered) else "> "

    @property
    def help(self) -> str:
        """A line for every value that is requested."""
        return "\n".join(_explained(*pair) for pair in zip(self.cells, self.offered, strict=True))

    @property
    def _meaning(self) -> str:
        first = self.cells[0]
        if len(self.cells) == 1:
            meaning = first.meaning
        else:
            meaning = (first.pattern or first.meaning).format(
                ", ".join(cell.key.split(".")[-1] for cell in self.cells)
            )
        return f"{meaning}, {first.unit}" if first.unit else meaning


def _explained(cell: Cell, offered: str | None) -> str:
    unit = f", {cell.unit}" if cell.unit else ""
    enter = "" if offered is None else f"; Enter gives {offered or 'none'}"
    return f"{cell.key}: {cell.meaning}{unit}; {cell.kind}{enter}"


def spelled(cell: Cell, text: str) -> tuple[Value, str]:
    """Value and warning of a cell's text.  Raises Misspelt."""
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
