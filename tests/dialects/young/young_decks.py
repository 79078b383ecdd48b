"""YOUNG decks for the tests, and the text that a user would see of their faults."""

from flexmb_cli.deck.text import decode
from flexmb_cli.dialects.recognise import read_deck
from flexmb_cli.dialects.young.build import build_young
from flexmb_cli.errors import DeckError, compiler_style

PENDULUM = """2 1 0 0 0 1 0 0 0 0 0 1
0 0 0 1 0 0 0
0 1 0 1 0 0 0
2 4 0 1.047 0
1 2 0 0 0 0 -1 0 1 0 0 -1 -1 0
1 0 0 0 0 0 0
0 6 1
"""


def pendulum(line: int, instead: str) -> str:
    """The pendulum's deck with another text in place of one line, counted from 1."""
    lines = PENDULUM.split("\n")
    lines[line - 1] = instead
    return "\n".join(lines)


def one_body(drivers=(), simplified=(), grounds=()) -> str:
    """A deck of one body and these lines, the first of them on line 3."""
    counts = f"1 {len(drivers)} 0 0 0 0 0 0 0 {len(simplified)} 0 {len(grounds)}"
    return "\n".join([counts, "0 0 0 1 0 0 0", *drivers, *simplified, *grounds, "0 1 0.5", ""])


def read(text: str | bytes):
    """The deck of a YOUNG text."""
    raw = text if isinstance(text, bytes) else text.encode()
    return read_deck(decode("IN.dat", raw), "young")


def faults(text: str | bytes) -> list:
    """All faults and warnings of a text, read and built."""
    try:
        deck = read(text)
        return [*deck.warnings, *build_young(deck)[1]]
    except DeckError as error:
        return list(error.faults)


def shown(text: str) -> str:
    """What a user sees of a deck's faults."""
    lines = decode("IN.dat", text.encode()).lines
    return compiler_style("IN.dat", faults(text), lines)
