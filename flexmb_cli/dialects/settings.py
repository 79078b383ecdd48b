"""`--set NAME=VALUE`: numbers of a deck overridden by their readable names."""

from ..deck import number
from ..deck.record import Deck, Number
from ..errors import DeckError, Fault
from ..quick_dataclass import replace
from .recognise import dialect_named

COUNTS = "counts"
_NEAREST = 3


def apply_settings(deck: Deck, settings: list[str]) -> Deck:
    """`deck` with the numbers named in `settings` ("driver.1.B=6.28") set; the last of two wins.

    A number set has no place in the deck any more.  Raises DeckError with the fault of every
    setting: an unknown name, a count (the deck's layout hangs on it), no number, no integer.
    """
    return SettableDeck(deck).with_settings(settings) if settings else deck


class SettableDeck:
    """A deck whose numbers are looked up by name again and again."""

    def __init__(self, deck: Deck):
        self.deck = deck
        self._known = dict(deck.numbers())
        self._places = {
            f"{record.prefix}.{number.key}": (index, position)
            for index, record in enumerate(deck.records)
            for position, number in enumerate(record.numbers)
        }

    def __contains__(self, name: str) -> bool:
        return name in self._known

    def unknown(self, name: str) -> str:
        """Return what to say of a name that the deck lacks."""
        from difflib import get_close_matches

        close = get_close_matches(name, self._known, n=_NEAREST, cutoff=0.0)
        return f"the deck has no number {name!r}; the nearest are {', '.join(close)}"

    def with_settings(self, settings: list[str]) -> Deck:
        """As `apply_settings`."""
        changes, taken, faults = {}, [], []
        for setting in settings:
            try:
                name, changed = self._change(setting)
                changes[name] = changed
                taken.append(f"{name}={changed.text}")
            except number.Misspelt as fault:
                faults.append(Fault("error", f"--set {setting}: {fault}", id="DECK-016"))
        if faults:
            raise DeckError(faults)
        records = self._with_changes(changes)
        return replace(self.deck, records=records, settings=(*self.deck.settings, *taken))

    def _change(self, setting: str) -> tuple[str, Number]:
        name, equals, word = (part.strip() for part in setting.partition("="))
        if not equals:
            raise number.Misspelt("write NAME=VALUE, such as time.end=2.5")
        if name not in self._known:
            raise number.Misspelt(self.unknown(name))
        if name.startswith(f"{COUNTS}."):
            raise number.Misspelt("a count cannot be set: the deck's layout hangs on it")
        read = number.integer if isinstance(self._known[name].value, int) else number.real
        try:
            value, _ = read(word)
        except number.Misspelt as fault:
            raise number.Misspelt(f"{name} {fault}") from None
        return name, replace(self._known[name], value=value, text=word, place=None)

    def _with_changes(self, changes):
        """The records with new numbers; those left alone stay the same objects."""
        records, dialect = list(self.deck.records), dialect_named(self.deck.dialect)
        for name, changed in changes.items():
            index, position = self._places[name]
            numbers = list(records[index].numbers)
            numbers[position] = changed
            records[index] = records[index].with_numbers(numbers)
        for name, changed in changes.items():
            index, _ = self._places[name]
            records[index] = dialect.relabelled(records[index], changed.key)
        return tuple(records)
