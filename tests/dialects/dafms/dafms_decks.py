"""Decks of decks/dafms with a change made to them, and the faults that reading and building find."""

from pathlib import Path

from flexmb_cli.deck.record import DeckText
from flexmb_cli.dialects.dafms.build import build_dafms
from flexmb_cli.dialects.dafms.reader import read_dafms
from flexmb_cli.errors import DeckError

DECKS = Path(__file__).parents[3] / "decks" / "dafms"


def deck_text(name, *changes):
    """Text of a supplied deck with each `old` replaced once by `new`."""
    text = (DECKS / f"{name}.DAT").read_text()
    for old, new in changes:
        assert text.count(old) >= 1, f"{old!r} is not in {name}"
        text = text.replace(old, new, 1)
    return text


def read(text):
    return read_dafms(DeckText("x.DAT", text, ""))


def build(text):
    return build_dafms(read(text))


def faults(text):
    """All faults of a deck: those of a DeckError, or the warnings of a deck that can be run."""
    try:
        deck = read(text)
        return [*deck.warnings, *build_dafms(deck)[1]]
    except DeckError as stopped:
        return list(stopped.faults)


def reported(text):
    """The faults as "line:column: severity: sentence"."""
    return [f"{f.place.line}:{f.place.column}: {f.severity}: {f.sentence}" for f in faults(text)]
