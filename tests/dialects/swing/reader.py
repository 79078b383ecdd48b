"""Lines `key = value` to a Deck."""

from flexmb_cli.deck import number
from flexmb_cli.deck.record import Deck, Number, Record
from flexmb_cli.errors import DeckError, Fault, Place

MEANINGS = {
    "mass": ("kg", "mass of the bob"),
    "length": ("m", "distance of the bob from the pivot"),
    "angle": ("rad", "first angle from where it hangs"),
    "end": ("s", "last time"),
    "step": ("s", "time between rows"),
}


def begins(lines):
    return lines[0].strip() == "a pendulum"


def read(source):
    numbers, faults = [], []
    for k, line in enumerate(source.lines, 1):
        key, equals, word = (part.strip() for part in line.partition("="))
        if not equals:
            continue
        place = Place(k, line.index("=") + 2)
        try:
            unit, meaning = MEANINGS[key]
            numbers.append(Number(key, number.real(word)[0], meaning, unit, place, word))
        except KeyError:
            faults.append(Fault("error", f"there is no {key}", place, id="SWING-001"))
        except number.Misspelt as fault:
            faults.append(Fault("error", f"{key} {fault}", place, id="SWING-002"))
    if faults:
        raise DeckError(faults)
    return Deck("swing", source, (Record("bob", 0, "the bob", tuple(numbers)),))
