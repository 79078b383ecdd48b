"""VSDF decks in tests: a small one of two rigid bodies, and what reading and building find in it."""

from pathlib import Path

from flexmb_cli.deck.record import DeckText
from flexmb_cli.dialects.vsdf.build import build_vsdf
from flexmb_cli.dialects.vsdf.reader import read_vsdf
from flexmb_cli.errors import DeckError

DECKS = Path(__file__).parents[3] / "decks" / "vsdf"

RIGID = """\
VSDF TWO LINKS
BODY
    1 RIGD
    2 RIGD
RIGI
    1       2.0       0.5
       0.1       0.2       0.2
    2       1.0      0.25
      0.05       0.1       0.1
POSI
    2       1.0
NODE
    0    1       0.0       0.0       0.0
    0    2       0.0       0.0       1.0
    1    1       0.0       0.0       0.0
    1    2       0.0       0.0       1.0
    1    3       1.0       0.0       0.0
    1    4       1.0       0.0       1.0
    2    1       0.0       0.0       0.0
    2    2       0.0       0.0       1.0
    2    3       0.5       0.0       0.0
JOIN
    1 REVO    0    1    2    1    1    2
    2 REVO    1    3    4    2    1    2
GRAV
       0.0     -9.81       0.0
TIME
       1.0      0.01
OUTN
    2    3
END
STAR
STOP
"""


def changed(*changes, text=RIGID):
    """The deck with each `old` replaced once by `new`."""
    for old, new in changes:
        assert text.count(old) >= 1, f"{old!r} is not in the deck"
        text = text.replace(old, new, 1)
    return text


def supplied(name, *changes):
    """Text of a supplied deck with changes."""
    return changed(*changes, text=(DECKS / f"{name}.vsdf").read_text())


def read(text):
    return read_vsdf(DeckText("x.vsdf", text, ""))


def build(text):
    return build_vsdf(read(text), DECKS)[0]


def reported(text):
    """All faults of reading and building, as "line:column: severity: sentence"."""
    try:
        deck = read(text)
        faults = [*deck.warnings, *build_vsdf(deck, DECKS)[1]]
    except DeckError as stopped:
        faults = stopped.faults
    return [_line(fault) for fault in faults]


def _line(fault):
    place = f"{fault.place.line}:{fault.place.column}: " if fault.place else ""
    return f"{place}{fault.severity}: {fault.sentence}"
