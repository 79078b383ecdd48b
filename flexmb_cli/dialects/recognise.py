"""Recognition of a deck's dialect, and its reader."""

import re
from collections.abc import Iterator, Sequence
from dataclasses import replace
from importlib import import_module
from itertools import islice

from ..deck.expansion.includes import is_expandable, refuse_faulty, with_includes
from ..deck.record import Deck, DeckText
from ..deck.text import decode, read_text
from ..deck.words import UNCLOSED, Word, words
from ..errors import DeckError, Fault
from ..memory import without_collector
from . import DIALECTS
from .dialect import Dialect

AUTO = "auto"
CHOOSES = "--dialect chooses one"
_FIRST_LINES = 20  # that are not blank
_FIRST_WORDS = 60  # of a deck with a title


def open_text(
    path: str, dialect: str = AUTO, changes: Sequence[str] = (), text: str | None = None
) -> DeckText:
    """Return the text of the deck at `path`, or `text` as if it stood there.

    It has the files that it includes and the values of its variables.

    `changes` ("NAME=VALUE") may give variables other values.  Raises DeckError for a file that cannot be
    read; what is wrong with variables is raised where the deck is read.
    """
    source = read_text(path) if text is None else decode(path, text.encode())
    if not is_expandable(source.text):
        return source
    from ..deck.expansion.variables import with_variables

    source = with_includes(source, path)
    try:
        name = recognise(source.lines) if dialect == AUTO else dialect
    except DeckError:
        return source  # reading it raises the same
    return with_variables(source, dialect_named(name).by_columns, changes)


def read_deck(source: DeckText, dialect: str = AUTO) -> Deck:
    """Return the deck in the given dialect, or in the one it begins like.

    The warnings about the text stand before those of the reader.  Raises DeckError.
    """
    refuse_faulty(source)
    name = recognise(source.lines) if dialect == AUTO else dialect
    with without_collector():
        deck = dialect_named(name).read(source) if source.expansion is None else _expanded(source, name)
    return replace(deck, warnings=(*source.warnings, *deck.warnings))


def _expanded(source: DeckText, name: str) -> Deck:
    """Return the deck of a text with variables, whole numbers being where its reader wants them."""
    from ..deck.expansion.variables import bound, wanted_whole

    while True:
        deck, failure = None, None
        try:
            deck = dialect_named(name).read(source)
        except DeckError as fault:
            failure = fault
        faults = failure.faults if failure else deck.warnings if deck else ()
        changed = wanted_whole(source, faults)
        if changed is None:
            break
        source = changed
    if deck is None:
        assert failure is not None, "it was not read"
        raise failure
    return bound(deck)


def dialect_named(name: str) -> Dialect:
    """Return the dialect of that name; raises DeckError where there is none."""
    if name not in DIALECTS:
        raise DeckError(
            [Fault("error", f"there is no dialect {name!r}, only {', '.join(DIALECTS)}", id="DECK-014")]
        )
    # A run imports its own dialect only.
    return import_module(DIALECTS[name][0]).DIALECT


def every_dialect() -> Iterator[Dialect]:
    """Yield all dialects in the order in which they are tried."""
    return map(dialect_named, DIALECTS)


def recognise(lines: Sequence[str]) -> str:
    """Name of the dialect that a deck of these lines begins like; raises DeckError when none fits."""
    first_lines = [line.strip() for line in islice(filter(str.strip, lines), _FIRST_LINES)]
    for name, (_, pattern) in DIALECTS.items():
        begins = re.compile(pattern, re.IGNORECASE).match
        if any(map(begins, first_lines)) and dialect_named(name).fits(lines):
            return name
    first = next(words(lines), None)
    if first is None:
        raise DeckError([Fault("error", f"the deck is empty; {_beginnings()}", id="DECK-012")])
    message = f"no dialect begins like this; {_beginnings()}; {CHOOSES}"
    unknown = Fault("error", message, first.place, id="DECK-013")
    raise DeckError([_meant_instead(first, lines) or unknown])


def _meant_instead(first: Word, lines: Sequence[str]) -> Fault | None:
    """Return what a file seems to be that begins like no deck; None where nothing is known."""
    if first.text == UNCLOSED:
        return Fault("error", "a comment is opened here and never closed with }", first.place, id="DECK-060")
    if any("\uff01" <= letter <= "\uff5e" for letter in first.text):
        message = "these are full-width characters; type the deck in plain ASCII ones"
        return Fault("error", message, first.place, id="DECK-061")
    if _is_study(lines):
        message = "this is a study, not a deck; flexmb sweep computes it"
        return Fault("error", message, first.place, id="DECK-062")
    if set(first.text) == {"#"}:
        message = "this is a page of text (Markdown), not a deck"
        return Fault("error", message, first.place, id="DECK-063")
    printed = next((d.title for d in every_dialect() if _is_listing(d, lines)), "")
    if printed:
        message = f"this is a table that a {printed} run printed; give the deck it was computed from"
        return Fault("error", message, first.place, id="DECK-064")
    if _is_title(first, lines):
        message = f"a title stands in braces: {{ {lines[first.place.line - 1].strip()} }}"
        return Fault("error", message, first.place, id="DECK-065")
    return None


def _is_title(first: Word, lines: Sequence[str]) -> bool:
    """Return whether words stand above the counts of a YOUNG deck: a line of eleven or twelve integers."""
    title = first.place.line
    by_line: dict[int, list[str]] = {}
    for word in islice(words(lines), _FIRST_WORDS):
        by_line.setdefault(word.place.line, []).append(word.text)
    later = [texts for line, texts in by_line.items() if line > title]
    return not first.text.isdecimal() and any(
        len(texts) in (11, 12) and all(map(str.isdecimal, texts)) for texts in later
    )


def _is_study(lines: Sequence[str]) -> bool:
    """Return whether these are the lines of a study file, which is TOML and names a deck."""
    # Long lines may hold names of so many parts that TOML is read for hours.
    if len(lines) > 1000 or not all(len(line) < 1000 for line in lines):
        return False
    import tomllib

    try:
        return "deck" in tomllib.loads("\n".join(lines))
    except (ValueError, RecursionError):
        return False


def _is_listing(dialect: Dialect, lines: Sequence[str]) -> bool:
    try:
        return any(dialect.listings("", "\n".join(lines), dialect.listing_readers))
    except DeckError:
        return True


def _beginnings() -> str:
    return ", ".join(f"a {d.title} deck begins with {d.begins}" for d in every_dialect())
