"""The dialects: what each begins with, and its reader."""

import re
from collections.abc import Callable, Sequence
from importlib import import_module
from itertools import islice

from ..collector import without_collector
from ..deck import number
from ..deck.lines import as_lines
from ..deck.record import Deck, DeckText
from ..deck.words import Word, words
from ..errors import DeckError, Fault
from ..quick_dataclass import dataclass, replace

AUTO = "auto"
CHOOSES = "--dialect chooses one"

_DAFMS_MACROS = ("DFMB", "STAR", "STOP")


@dataclass(frozen=True)
class Dialect:
    """A dialect: how its decks begin, and module and function (imported at need) that read them."""

    begins: str
    fits: Callable[[Sequence[str]], bool]
    module: str
    reader: str


def read_deck(source: DeckText, dialect: str = AUTO) -> Deck:
    """The deck in the given dialect, or in the one it begins like.

    The warnings about the text stand before those of the reader.  Raises DeckError.
    """
    name = recognise(source.lines) if dialect == AUTO else dialect
    with without_collector():
        deck = _reader(name)(source)
    return replace(deck, warnings=(*source.warnings, *deck.warnings))


def recognise(lines: Sequence[str]) -> str:
    """Name of the dialect that a deck of these lines begins like; raises DeckError when none fits."""
    for name, dialect in DIALECTS.items():
        if dialect.fits(lines):
            return name
    first = next(words(lines), None)
    if first is None:
        raise DeckError([Fault("error", f"the deck is empty; {_beginnings()}", id="DECK-012")])
    message = f"no dialect begins like this; {_beginnings()}; {CHOOSES}"
    raise DeckError([Fault("error", message, first.place, id="DECK-013")])


def _reader(name):
    if name not in DIALECTS:
        raise DeckError(
            [Fault("error", f"there is no dialect {name!r}, only {', '.join(DIALECTS)}", id="DECK-014")]
        )
    dialect = DIALECTS[name]
    module = f"{__package__}.{dialect.module}"
    try:
        return getattr(import_module(module), dialect.reader)
    except ModuleNotFoundError as fault:
        # A module that the reader itself needs and lacks is a fault of the program, not of the deck.
        if fault.name != module:
            raise
        message = f"the deck is of dialect {name}, which this version cannot read yet"
        raise DeckError([Fault("error", message, id="DECK-015")]) from None


def _beginnings():
    return ", ".join(f"a {name.upper()} deck begins with {d.begins}" for name, d in DIALECTS.items())


def _begins_vsdf(lines):
    return re.match(r"\s*VSDF", as_lines(lines).text, re.IGNORECASE) is not None


def _begins_dafms(lines):
    # Cards before the first macro are skipped by the historic program, but they are never many.
    # Blank lines stand in the place of a deck's other models.
    beginning = islice((line for line in islice(lines, 1, None) if line.strip()), 19)
    macro = any(line[:4].upper() in _DAFMS_MACROS for line in beginning)
    return macro and not lines[0].strip(" 0123456789+-")


def _begins_young(lines):
    """Twelve integers; half of them are enough, so that the reader can name the faulty ones."""
    start = list(islice(words(lines), 12))
    return bool(start) and _is_integer(start[0]) and sum(map(_is_integer, start)) >= 6


def _is_integer(word: Word):
    try:
        number.integer(word.text)
    except number.Misspelt:
        return False
    return True


DIALECTS = {
    "vsdf": Dialect("the word VSDF", _begins_vsdf, "vsdf.reader", "read_vsdf"),
    "dafms": Dialect(
        "two integers, then a card DFMB, STAR or STOP", _begins_dafms, "dafms.reader", "read_dafms"
    ),
    "young": Dialect("twelve integers", _begins_young, "young.dynamic_cards", "read_young_deck"),
}
