"""Cards of Nastran bulk data: small fields of 8, large fields of 16 columns, free fields by commas.

MSC Nastran Quick Reference Guide, "Bulk data"; continuations follow their card directly.
"""

from collections.abc import Iterator
from pathlib import Path
from typing import NamedTuple

from ...deck import number
from .file_text import integer, line_fault, lines_of


class BulkCard(NamedTuple):
    """A card of a bulk data file."""

    name: str  # in capitals
    line: int  # that it begins on, from 1
    fields: list[str]  # behind the name


def bulk_cards(path: Path, names: tuple[str, ...]) -> Iterator[BulkCard]:
    """The cards called `names` with their continuations."""
    card = None
    for count, line in enumerate(lines_of(path), start=1):
        line = line.split("$", 1)[0].rstrip()
        if not line:
            continue
        head = (line.split(",", 1)[0] if "," in line else line[:8]).strip()
        if not head or head[0] in "+*":
            if card is not None:
                card.fields.extend(_fields(line, head))
            continue
        if card is not None:
            yield card
        name = head.rstrip("*").upper()
        # Files hold far more cards than those wanted.
        card = BulkCard(name, count, _fields(line, head)) if name in names else None
    if card is not None:
        yield card


def _fields(line: str, head: str) -> list[str]:
    """Fields behind the head of a line; a card of small fields has eight, of large ones four."""
    if "," in line:
        fields = [cell.strip() for cell in line.split(",")[1:]]
        count = 4 if head.endswith("*") else 8
        return (fields + [""] * count)[:count]
    width, count = (16, 4) if "*" in head else (8, 8)
    padded = line.ljust(8 + width * count)
    return [padded[8 + width * i : 8 + width * (i + 1)].strip() for i in range(count)]


def integer_field(path: Path, card: BulkCard, index: int, what: str, default: int | None = None) -> int:
    """Field `index` of a card as an integer."""
    text = card.fields[index] if index < len(card.fields) else ""
    if not text and default is not None:
        return default
    try:
        return integer(text)
    except ValueError:
        raise line_fault(
            path.name, card.line, f"{card.name}: {what} wanted; read '{text}'", id="FE-094"
        ) from None


def real_field(path: Path, card: BulkCard, index: int, what: str) -> float:
    """Field `index` of a card as a number, 0 when it is empty."""
    text = card.fields[index] if index < len(card.fields) else ""
    try:
        return number.real(text)[0] if text else 0.0
    except number.Misspelt:
        raise line_fault(
            path.name, card.line, f"{card.name}: {what} wanted; read '{text}'", id="FE-094"
        ) from None
