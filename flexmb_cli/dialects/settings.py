"""`--set NAME=VALUE`: numbers of a deck overridden by their readable names."""

from collections.abc import Mapping
from dataclasses import replace
from typing import Any

from ..deck import number
from ..deck.many_records import ManyRecords
from ..deck.record import Deck, Number
from ..errors import DeckError, Fault
from .recognise import dialect_named

COUNTS = "counts"

MOST_SHOWN = 200  # characters of a setting in a message


def apply_settings(deck: Deck, settings: list[str]) -> Deck:
    """`deck` with the numbers named in `settings` ("driver.1.B=6.28") set; the last of two wins.

    A number set has no place in the deck any more.  Raises DeckError with the fault of every
    setting: an unknown name, a count (the deck's layout depends on it), no number, no integer.
    """
    return SettableDeck(deck).with_settings(settings) if settings else deck


class _Unusable(ValueError):
    """The setting cannot be made; `id` is the fault's."""

    def __init__(self, message: str, id: str):
        super().__init__(message)
        self.id = id


class SettableDeck:
    """A deck whose numbers are looked up by name again and again."""

    def __init__(self, deck: Deck):
        self.deck = deck
        self._many = not isinstance(deck.records, tuple)
        self._index: dict[str, int] = {}
        self._places: dict[str, Any] = {}
        if not self._many:
            self._index = {record.prefix: index for index, record in enumerate(deck.records)}

    def __contains__(self, name: str) -> bool:
        return name in self.deck.variables or self._place(name) is not None

    def unknown(self, name: str) -> str:
        """Return what to say of a name that the deck lacks."""
        # difflib is imported for this message only.
        from .near_names import hint

        return f"the deck has no number {name!r}; {hint(name, self.deck)}"

    def _place(self, name: str) -> Any:
        """Return where the record of a number stands among the deck's, and the number's key; None without
        one.
        """
        if name not in self._places:
            self._places[name] = self._looked_up(name)
        return self._places[name]

    def _looked_up(self, name: str) -> Any:
        for dot in (k for k, letter in enumerate(name) if letter == "."):
            index, key = self._find(name[:dot]), name[dot + 1 :]
            if index is not None and key in self.deck.records[index]:
                return index, key
        return None

    def _find(self, prefix: str) -> int | None:
        if not self._many:
            return self._index.get(prefix)
        first = 0
        assert isinstance(self.deck.records, ManyRecords)
        for block in self.deck.records.blocks:
            if prefix == block.section or prefix.startswith(f"{block.section}."):
                for k, record in enumerate(block):
                    if record.prefix == prefix:
                        return first + k
            first += len(block)
        return None

    def with_settings(self, settings: list[str]) -> Deck:
        """Return the records as `apply_settings` does."""
        changes: dict[str, Number] = {}
        variables: dict[str, Number] = {}
        taken, faults = [], []
        for setting in settings:
            try:
                name, changed = self._change(setting)
                (variables if name in self.deck.variables else changes)[name] = changed
                taken.append(f"{name}={changed.text}")
            except _Unusable as fault:
                shown = setting if len(setting) <= MOST_SHOWN else f"{setting[:MOST_SHOWN]}…"
                name, message = setting.partition("=")[0].strip(), f"--set {shown}: {fault}"
                faults.append(Fault("error", message, about=name, id=fault.id))
        if faults:
            raise DeckError(faults)
        records = self._with_changes(self._following(variables) | changes if variables else changes)
        return replace(
            self.deck,
            records=records,
            settings=(*self.deck.settings, *taken),
            variables={**self.deck.variables, **variables},
        )

    def _following(self, variables: Mapping[str, Number]) -> dict[str, Number]:
        """Return the numbers of the deck that other values of variables change."""
        from ..deck.expansion.variables import changed_by

        changes, faults = {}, []
        for name, value in changed_by(self.deck, {key: one.value for key, one in variables.items()}).items():
            index, key = self._place(name)
            known = self.deck.records[index].at(key)
            if value == known.value:
                continue
            whole = isinstance(known.value, int)
            if name.startswith(f"{COUNTS}.") or (whole and not value.is_integer()):
                why = "must be an integer" if whole else "is a count, on which the deck's layout hangs"
                message = f"{name} {why}; {', '.join(variables)} cannot be set to give {value:.15g}"
                faults.append(Fault("error", message, known.place, id="DECK-094"))
            changes[name] = replace(known, value=int(value) if whole else value, text=f"{value:.15g}")
        if faults:
            raise DeckError(faults)
        return changes

    def _change(self, setting: str) -> tuple[str, Number]:
        name, equals, word = (part.strip() for part in setting.partition("="))
        if not equals:
            raise _Unusable("write NAME=VALUE, such as time.end=2.5", id="DECK-057")
        if name in self.deck.variables:
            return name, self._read(name, self.deck.variables[name], word)
        place = self._place(name)
        if place is None:
            raise _Unusable(self.unknown(name), id="DECK-058")
        if name.startswith(f"{COUNTS}."):
            raise _Unusable("a count cannot be set: the deck's layout depends on it", id="DECK-059")
        return name, self._read(name, self.deck.records[place[0]].at(place[1]), word)

    @staticmethod
    def _read(name: str, known: Number, word: str) -> Number:
        """Return a number with the value that a word spells."""
        read = number.integer if isinstance(known.value, int) else number.real
        try:
            value, _ = read(word)
        except number.Misspelt as fault:
            raise _Unusable(f"{name} {fault}", id="DECK-016") from None
        return replace(known, value=value, text=word, place=None)

    def _with_changes(self, changes: Mapping[str, Number]) -> Any:
        """The records with new numbers; those left alone stay the same objects."""
        changed_records: dict[Any, Any] = {}
        dialect = dialect_named(self.deck.dialect)
        for name, changed in changes.items():
            index, key = self._place(name)
            record = changed_records.get(index, self.deck.records[index])
            changed_records[index] = record.with_number(record.positions[key], changed)
        for name, changed in changes.items():
            index, _ = self._place(name)
            changed_records[index] = dialect.relabelled(changed_records[index], changed.key)
        if isinstance(self.deck.records, ManyRecords):
            return self.deck.records.with_changed(changed_records)
        records = list(self.deck.records)
        for index, record in changed_records.items():
            records[index] = record
        return tuple(records)
