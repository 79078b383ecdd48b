"""Names of a deck near to one that it lacks: likely names of the same card, and the fields of that card."""

from collections.abc import Iterable, Iterator, Sequence
from difflib import get_close_matches
from itertools import islice

from ..deck.record import Deck, Number, Record

NEAR_NAMES = 3
FIELDS_SHOWN = 14
COMPARED = 20_000  # records of a large deck
SAME_CARD, SAME_FIELD = 0.7, 0.6  # likeness of words: the twice common letters in the letters of both
ALL = "flexmb check --echo shows all"
# Symbols of textbooks and other programs: the word for it in names and meanings of fields.
SYMBOLS = {"k": "stiffness", "c": "damping", "mu": "coefficient", "m": "mass"}


def hint(name: str, deck: Deck) -> str:
    """Return what leads from the unknown `name` to the deck's names: clauses with "; " between them."""
    records = list(islice(deck.records, COMPARED))
    section, number, field = _parts(name)
    sections = dict.fromkeys(_card_name(record) for record in records)
    close = get_close_matches(section, sections, n=1, cutoff=SAME_CARD)
    cards = [record for record in records if close and _card_name(record) == close[0]]
    same = [card for card in cards if str(card.number) == number]
    clauses, spelled = [], _spelled(field, same or cards)
    if cards:
        clauses += _near(spelled or _likely(field, same or cards))
        if number and not same:
            clauses.append(f"the deck has {_listed([card.prefix for card in cards])}")
        if not spelled:
            clauses.append(_fields((same or cards)[0]))
    elif len(field) > 1 or not field:
        names = _spelled(field or section, records)
        clauses += _near(sorted(names, key=lambda known: f".{number}." not in known))
    return "; ".join([*clauses, ALL])


def _card_name(record: Record) -> str:
    """Return its section, or the name of an element of a block."""
    return (record.section if record.prefix.startswith(record.section) else record.prefix).lower()


def _parts(name: str) -> tuple[str, str, str]:
    """Return the section, the number of the record ("" without) and the field; capitals do not count."""
    section, *rest = name.lower().split(".")
    number = rest.pop(0) if rest and rest[0].isdigit() else ""
    return section, number, ".".join(rest)


def _spelled(field: str, cards: Sequence[Record]) -> list[str]:
    """Return names whose field is `field` but for capitals; where none is, whose last component is."""
    numbers = list(_numbers(cards))
    whole = [name for name, number in numbers if number.key.lower() == field]
    return whole or [name for name, number in numbers if number.key.lower().rpartition(".")[2] == field]


def _likely(field: str, cards: Sequence[Record]) -> list[str]:
    """Return names that `field` may mean: those with its word in key or meaning, then like spellings."""
    numbers = list(_numbers(cards))
    word = SYMBOLS.get(field, field)
    meant = [name for name, number in numbers if len(word) > 1 and word in _words(number)]
    keys: dict[str, list[str]] = {}
    for name, number in numbers:
        keys.setdefault(number.key.lower(), []).append(name)
    slips = get_close_matches(field, keys, n=NEAR_NAMES, cutoff=SAME_FIELD)
    return list(dict.fromkeys([*meant, *(name for key in slips for name in keys[key])]))


def _words(number: Number) -> list[str]:
    return [*number.key.lower().split("."), *number.meaning.lower().split()]


def _numbers(cards: Iterable[Record]) -> Iterator[tuple[str, Number]]:
    for card in cards:
        for number in card.numbers:
            yield f"{card.prefix}.{number.key}", number


def _near(names: Sequence[str]) -> list[str]:
    if not names:
        return []
    return [f"near it {'are' if len(names) > 1 else 'is'} {', '.join(names[:NEAR_NAMES])}"]


def _fields(card: Record) -> str:
    """Return what a card holds; a short card with its meanings."""
    keys = [number.key for number in card.numbers]
    if len(keys) <= NEAR_NAMES:
        keys = [f"{number.key} ({number.meaning})" for number in card.numbers]
    return f"{card.prefix} holds {_listed(keys, FIELDS_SHOWN)}"


def _listed(words: Sequence[str], most: int = NEAR_NAMES) -> str:
    if len(words) <= most + 1:
        return ", ".join(words)
    return f"{', '.join(words[: most - 1])}, …, {words[-1]}"
