"""Decks that begin with a line SET or INCLUDE: the files that they include, and their lines of definitions.

    SET b = a/2      a variable; in any order, once each
    INCLUDE file     the lines of a file, in the deck's folder or below it

Both stand in column 1.  A deck whose first line is neither, comments aside, is read as it is: no deck of the
historic programs begins like that.  Comments are {…}, over any number of lines, and lines that begin with *.
"""

import hashlib
import re
from collections.abc import Iterator
from dataclasses import replace
from itertools import islice
from pathlib import Path
from typing import Any

from ...errors import DeckError, Fault, FlexmbError, Place
from ..record import DeckText, Lines
from ..text import LARGEST_DECK, STANDARD_INPUT, read_text
from .expressions import CONSTANTS, Formula, WrongFormula, formula
from .origins import Expansion, Origin, Piece

MOST_INCLUDED = 1000  # files
BEGINNING = 10_000  # characters of a deck among which its first line stands
_STATEMENT = re.compile(r"(?:SET|INCLUDE)\s", re.IGNORECASE)
_SET = re.compile(r"SET\s+([A-Za-z_]\w*)\s*=\s*", re.IGNORECASE)
_INCLUDE = re.compile(r'INCLUDE\s+(?:"([^"]+)"|(\S+))\s*', re.IGNORECASE)
_BRACES = re.compile(r"\{[^}]*\}")


def is_expandable(text: str) -> bool:
    """Return whether a deck begins with a line SET or INCLUDE."""
    text = text[:BEGINNING]
    first = next((line for line in _code(text) if line.strip()), "")
    return bool(_STATEMENT.match(first))


def with_includes(source: DeckText, path: str) -> DeckText:
    """Return the deck read at `path` with the lines of the files that it includes, without its statements.

    Another one is returned as it is.  Faults are kept in its expansion.
    """
    if not is_expandable(source.text):
        return source
    folder = Path() if path == STANDARD_INPUT else Path(path).parent
    reader = _Reader(folder)
    reader.take(source, "", [path])
    return reader.expanded(source)


def _code(text: str) -> Iterator[str]:
    """The lines of a text, comments being blank."""
    bare = _BRACES.sub(lambda comment: re.sub(r"[^\r\n]", " ", comment[0]), text) if "{" in text else text
    return ("" if line.startswith("*") else line for line in Lines(bare).after(0))


class _Reader:
    """The lines read so far, of the deck and of the files that it includes."""

    def __init__(self, folder: Path):
        self.folder = folder
        self.lines: list[Origin] = []
        self.statements: list[Origin] = []
        self.definitions: dict[str, tuple[Formula, int]] = {}  # with the number of its statement
        self.faults: list[tuple[Fault, int]] = []  # with the same
        self.files = self.size = 0

    def take(self, source: DeckText, file: str, within: list[str]) -> None:
        """Take the lines of a file; `within`: paths of the files that include it, and its own."""
        self.size += len(source.text)
        lines = zip(Lines(source.text).after(0), _code(source.text), strict=True)
        for number, (text, code) in enumerate(lines, 1):
            origin = Origin(file, number, text, code)
            if not _STATEMENT.match(code):
                self.lines.append(origin)
                continue
            self.statements.append(origin)
            if code[0] in "Ss":
                self._define(code)
            else:
                self._include(code, within)
        if file and self.lines and not self.lines[-1].text:  # after its last line end
            self.lines.pop()

    def _error(self, message: str, column: int, width: int, id: str) -> None:
        place = Place(0, column, max(1, width))
        self.faults.append((Fault("error", message, place, id=id), len(self.statements)))

    def _define(self, code: str) -> None:
        match = _SET.match(code)
        if match is None:
            self._error("write SET name = formula, such as SET b = a/2", 1, 3, "DECK-080")
            return
        name, start = match[1], match.end()
        if name in self.definitions:
            self._error(
                f"{name} is defined twice; remove one line", match.start(1) + 1, len(name), "DECK-081"
            )
        elif name.lower() in CONSTANTS:
            self._error(f"{name} is a constant already", match.start(1) + 1, len(name), "DECK-082")
        else:
            try:
                self.definitions[name] = formula(code[start:].rstrip()), len(self.statements)
            except WrongFormula as fault:
                self._error(f"{name}: {fault}", start + fault.offset + 1, 1, "DECK-083")

    def _include(self, code: str, within: list[str]) -> None:
        match = _INCLUDE.fullmatch(code)
        if match is None:
            self._error('write INCLUDE file; a name with blanks stands in "…"', 1, 7, "DECK-084")
            return
        name, column = match[1] or match[2], match.start(1 if match[1] else 2) + 1
        path = Path(within[-1]).parent / name
        if wrong := self._wrong(path, within):
            self._error(f"{name}: {wrong}", column, len(name), "DECK-085")
            return
        self.files += 1
        try:
            included = read_text(path, "file to include")
        except FlexmbError as failure:
            self._error(f"{name}: {failure}", column, len(name), "DECK-086")
            return
        self.take(included, str(path), [*within, str(path)])

    def _wrong(self, path: Path, within: list[str]) -> str:
        """Return why a file is not included, "" where it is."""
        whole = path.resolve()
        if not whole.is_relative_to(self.folder.resolve()):
            return "lies outside the folder of the deck; copy it there"
        if any(whole == Path(other).resolve() for other in within):
            return f"includes itself: {' → '.join(map(str, [*within, path]))}"
        if self.files >= MOST_INCLUDED or self.size > LARGEST_DECK:
            return f"more than {MOST_INCLUDED} files or {LARGEST_DECK // 1024**2} MB are included"
        if path.exists() and not path.is_file():
            return "is not a regular file"
        return ""

    def expanded(self, source: DeckText) -> DeckText:
        """Return the text without its statements, and where it comes from."""
        first = len(self.lines)

        def placed(fault: Fault, statement: int) -> Fault:
            assert fault.place is not None, "statements have places"
            return replace(fault, place=fault.place._replace(line=first + statement))

        places = {name: Place(first + n, 5, len(name)) for name, (_, n) in self.definitions.items()}
        expansion = Expansion(
            (*self.lines, *self.statements),
            {name: one for name, (one, _) in self.definitions.items()},
            places,
            tuple(placed(*fault) for fault in self.faults),
        )
        return with_text(source, "\n".join(line.text for line in self.lines), expansion)


def with_text(source: DeckText, text: str, expansion: Expansion) -> DeckText:
    """Return the deck with an expanded text, of which its digest is."""
    return replace(source, text=text, sha256=hashlib.sha256(text.encode()).hexdigest(), expansion=expansion)


def code_lines(source: DeckText, expansion: Expansion) -> Iterator[tuple[str, str]]:
    """The lines of the text, with comments and with blanks in their place."""
    count = len(Lines(source.text))
    return ((origin.text, origin.code) for origin in islice(expansion.origins, count))


def refuse_faulty(source: DeckText) -> None:
    """Raise DeckError for statements that are wrong."""
    if source.expansion is not None and source.expansion.faults:
        raise DeckError(source.expansion.faults)


def unread(piece: Piece, about: Any) -> Fault:
    """Return the fault of a variable that no number of the deck has."""
    message = (
        f"{piece.formula.text} = {piece.text} stands where no number is read, or over the edge of its "
        "columns; write it at the right end of its columns"
    )
    return Fault("error", message, Place(piece.line, piece.column, len(piece.text)), about, id="DECK-087")
