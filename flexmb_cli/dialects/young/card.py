"""Card behind DYNAMICS: a keyword, and the columns of its numbers."""

from dataclasses import dataclass

from .sections import Column


@dataclass(frozen=True)
class Card:
    """A card: its keyword, the section its records form, and its columns.

    The last `optional` columns may be left out and are then 0.
    """

    keyword: str
    section: str
    columns: tuple[Column, ...]
    optional: int = 0

    def takes(self, count: int) -> bool:
        """Return whether a card may have so many numbers."""
        return -self.optional <= count - len(self.columns) <= 0

    @property
    def begins_with_text(self) -> bool:
        """Return whether a word follows its keyword."""
        return bool(self.columns) and self.columns[0].is_text

    @property
    def numbers(self) -> str:
        """Return how many numbers the card takes, and what they are called."""
        keys = " ".join(column.key for column in self.columns)
        most = len(self.columns)
        asked = f"{most}" if not self.optional else f"{most - self.optional} to {most}"
        return f"{asked} {'words' if self.begins_with_text else 'numbers'} ({keys})"


def card(head: str, *columns: Column, optional: int = 0) -> Card:
    """Return a card; `head`: its keyword and its section."""
    keyword, section = head.split()
    return Card(keyword, section, columns, optional)


def whole(key: str, meaning: str) -> Column:
    """A column of integers."""
    return Column(key, meaning, is_integer=True)


def vector(key: str, meaning: str, unit: str) -> tuple[Column, ...]:
    """The columns of three components."""
    return tuple(Column(f"{key}.{axis}", f"{axis} of {meaning}", unit) for axis in "xyz")
