"""`--set NAME=VALUE`: numbers of a deck overridden by their readable names."""

from dataclasses import replace
from difflib import get_close_matches

from ..errors import DeckError, Fault
from . import number
from .deck import Deck, Number
from .young import DIALECT as YOUNG
from .young import labelled

COUNTS = "counts"
_NEAREST = 3


def apply_settings(deck: Deck, settings: list[str]) -> Deck:
    """`deck` with the numbers named in `settings` ("driver.1.B=6.28") set; the last of two wins.

    A number set has no place in the deck any more.  Raises DeckError with the fault of every
    setting: an unknown name, a count (the deck's layout hangs on it), no number, no integer.
    """
    known = dict(deck.numbers())
    changes, faults = {}, []
    for setting in settings:
        try:
            name, changed = _change(setting, known)
            changes[name] = changed
        except number.Misspelt as fault:
            faults.append(Fault("error", f"--set {setting}: {fault}"))
    if faults:
        raise DeckError(faults)
    return _changed(deck, changes)


def _change(setting: str, known: dict[str, Number]) -> tuple[str, Number]:
    name, equals, word = (part.strip() for part in setting.partition("="))
    if not equals:
        raise number.Misspelt("write NAME=VALUE, such as time.end=2.5")
    if name not in known:
        raise number.Misspelt(f"the deck has no number {name!r}{_nearest(name, known)}")
    if name.startswith(f"{COUNTS}."):
        raise number.Misspelt("a count cannot be set: the deck's layout hangs on it")
    read = number.integer if isinstance(known[name].value, int) else number.real
    try:
        value, _ = read(word)
    except number.Misspelt as fault:
        raise number.Misspelt(f"{name} {fault}") from None
    return name, replace(known[name], value=value, text=word, place=None)


def _nearest(name, known):
    found = get_close_matches(name, known, n=_NEAREST, cutoff=0.0)
    return f"; the nearest are {', '.join(found)}"


def _changed(deck, changes):
    """The deck with new numbers; records left alone stay the same objects."""
    records = []
    for record in deck.records:
        named = [(f"{record.prefix}.{old.key}", old) for old in record.numbers]
        if any(name in changes for name, _ in named):
            record = replace(record, numbers=tuple(changes.get(name, old) for name, old in named))
            record = labelled(record) if deck.dialect == YOUNG else record
        records.append(record)
    return replace(deck, records=tuple(records))
