"""A deck that the Python interface has read."""

from dataclasses import dataclass

from .deck.record import Deck
from .errors import Fault


@dataclass(frozen=True)
class OpenDeck:
    """A deck that was read; the finite-element files that it names are looked up beside its `path`.

    `changes`: numbers that differ from the deck's, "NAME=VALUE" each.
    """

    deck: Deck
    path: str
    changes: tuple[str, ...] = ()
    warnings: tuple[Fault, ...] = ()

    def __repr__(self) -> str:
        return f"OpenDeck({self.path!r}, {self.dialect}, {len(self.deck.records)} records)"

    @property
    def dialect(self) -> str:
        """The name of its dialect."""
        return self.deck.dialect

    @property
    def numbers(self) -> dict[str, float | int | str]:
        """Every number of the deck by the name that `changes` take, in SI units."""
        return {name: number.value for name, number in self.deck.numbers()}
