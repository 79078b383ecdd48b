"""Cards of Nastran bulk data: small fields of 8, large fields of 16 columns, free fields by commas.

MSC Nastran Quick Reference Guide, "Bulk data"; continuations follow their card directly.  INCLUDE names a
file, which quotes may spread over several lines.
"""

import re
from collections.abc import Iterator
from pathlib import Path
from typing import NamedTuple

from .file_text import IncludedLines, Line, integer, real
from .matrix_file import FEFileFault

_INCLUDE = re.compile(r"\s*INCLUDE(?![A-Z0-9])\s*=?\s*(.*)", re.IGNORECASE)


class BulkCard(NamedTuple):
    """A card of a bulk data file."""

    name: str  # in capitals
    line: Line  # that it begins on
    fields: list[str]  # after the name

    def card_fault(self, message: str, *, id: str) -> FEFileFault:
        """Return the fault of this card."""
        return self.line.fault(f"{self.name}: {message}", id=id)

    def field(self, index: int) -> str:
        """Return a field, "" when the card is shorter."""
        return self.fields[index] if index < len(self.fields) else ""

    def integer(self, index: int, what: str, default: int | None = None) -> int:
        """Return a field as an integer.  Raises FEFileFault."""
        text = self.field(index)
        if not text and default is not None:
            return default
        try:
            return integer(text)
        except ValueError:
            raise self.card_fault(f"expected {what}; read '{text}'", id="FE-094") from None

    def real(self, index: int, what: str) -> float:
        """Return a field as a number, 0 if it is empty.  Raises FEFileFault."""
        text = self.field(index)
        try:
            return real(text) if text else 0.0
        except ValueError:
            raise self.card_fault(f"expected {what}; read '{text}'", id="FE-094") from None


def lines(path: Path) -> Iterator[Line]:
    """Yield the lines of a file and of those that it includes.  Raises FEFileFault."""
    source = IncludedLines(path)
    for line in source:
        match = _INCLUDE.fullmatch(line.text)
        if match is None:
            yield line
            continue
        name, quote = match[1].split("$")[0].strip(), match[1][:1]
        if quote in ("'", '"'):
            while name.count(quote) < 2 and (more := next(source, None)):
                name += more.text.strip()
            name = name.split(quote)[1].strip()
        source.include(name, line)


def bulk_cards(path: Path, names: tuple[str, ...]) -> Iterator[BulkCard]:
    """The cards called `names` with their continuations, of this file and those that it includes."""
    card = None
    for source in lines(path):
        line = source.text.split("$", 1)[0].rstrip()
        if not line:
            continue
        head = (line.split(",", 1)[0] if "," in line else line[:8]).strip()
        _check_head(source, head.upper(), names, card is not None)
        if not head or head[0] in "+*":
            if card is not None:
                card.fields.extend(_fields(line, head))
            continue
        if card is not None:
            yield card
        name = head.rstrip("*").upper()
        if name == "ENDDATA":
            return
        # Files hold far more cards than those wanted.
        card = BulkCard(name, source, _fields(line, head)) if name in names else None
    if card is not None:
        yield card


def _check_head(line: Line, head: str, names: tuple[str, ...], follows: bool) -> None:
    """Refuse what hides cards: repetition, fields out of their columns, a comma that makes them free ones.

    `follows`: whether a continuation of a card called `names` may stand here.
    """
    if head.startswith("="):
        raise line.fault("cards repeated by = are not read; let a preprocessor write them out", id="FE-168")
    word, *more = head.split() or [""]
    known, comma = word.rstrip("*") in names, "," in line.text
    tabs = "\t" in line.text.split("$", 1)[0].rstrip() and not comma
    if (known and (more or tabs)) or (
        follows and (tabs or (comma and (word[:1].isdigit() or (more and word[:1] in "+*"))))
    ):
        message = (
            "fields out of their columns of 8 or 16, tabs, or decimals with commas; write blanks and points"
        )
        raise line.fault(message, id="FE-169")


def _fields(line: str, head: str) -> list[str]:
    """Fields after the head of a line; a card of small fields has eight, of large ones four."""
    if "," in line:
        fields = [cell.strip() for cell in line.split(",")[1:]]
        count = 4 if head.endswith("*") else 8
        return (fields + [""] * count)[:count]
    width, count = (16, 4) if "*" in head else (8, 8)
    padded = line.ljust(8 + width * count)
    return [padded[8 + width * i : 8 + width * (i + 1)].strip() for i in range(count)]


def check_material(card: BulkCard, elastic: tuple[float, float, float]) -> None:
    """Refuse another material than that of the deck."""
    for i, name, value in zip((1, 3, 4), ("E", "nu", "density"), elastic, strict=True):
        if card.field(i) and abs(card.real(i, name) - value) > 1e-6 * abs(value):
            message = f"{name} is {card.field(i)}, and {value:g} on MATL: the deck's material is meant"
            raise card.card_fault(message, id="FE-279")
