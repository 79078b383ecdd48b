"""Large decks of every card that may repeat, with as few characters a card as it takes, right or wrong.

The cards are those of the readers' own tables, so that a new card is measured without a word here. What a
card means is not asked: a deck of half a million wrong cards must not take more than a right one.
"""

from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

from flexmb_cli.dialects.dafms.cards import CARDS as DAFMS
from flexmb_cli.dialects.vsdf.cards import CARDS as VSDF
from flexmb_cli.dialects.young.cards import CARDS as YOUNG

# What a deck may hold at most (docs/reference/limits.md), less what the decks have already.
YOUNG_LOADS = 199_990  # dynamic cards besides MASS and VELOCITY
DAFMS_BODIES = 5000
DAFMS_NUMBERS = 345_000  # outside long lists
DAFMS_NUMBERS_OF_BODY = 60  # in a chain of rigid bodies
VSDF_CARDS = 99_990  # of a type other than NODE and TABL
ELEMENTS = 19_990  # and functions
DAFMS_ELEMENTS = 14_000  # elements of 24 numbers
NUMBERS_OF_CARD = 199_990  # of a YOUNG card
DECKS = Path(__file__).parents[2] / "decks"
_MOTION = (
    "2 1 0 0 0 1 0 0 0 0 0 1\n0 0 0 1 0 0 0\n0 0 0 1 0 0 0\n2 6 0 1 0\n"
    "1 2 0 0 0 0 0 0 0 0 1 0 0 1\n1 0 0 0 0 0 0\n0 1 0.1\nDYNAMICS INVERSE\nMASS 2 1 0 0 0 1 1 1\n"
)
_MOST_ENTRIES = 99_999
_LIMITED = tuple(card for card in VSDF if card.word == "JSPR")


def card_kinds(size: int) -> Iterator[tuple[str, Callable[[], str]]]:
    """Yield name and maker of a deck of about so many bytes for every card."""
    text = (DECKS / "vsdf/pendulum.vsdf").read_text().replace(" fe/", f" {DECKS}/vsdf/fe/")
    deck, end = text.split("\nEND", 1)
    for card in VSDF:
        yield f"vsdf all {card.word}", lambda card=card: f"{deck}\n{_of_vsdf(card, size)}END{end}"
    for card in YOUNG:
        words = " ".join("1" for _ in card.columns[: len(card.columns) - card.optional])
        line = f"{card.keyword} {words}\n"
        count = min(YOUNG_LOADS, size // len(line))
        yield f"young all {card.keyword}", lambda line=line, count=count: f"{_MOTION}{line * count}END\n"
    head, rest = (DECKS / "dafms/pendulum.DAT").read_text().rsplit("END ", 1)
    for card in DAFMS.values():
        yield f"dafms all {card.word.strip()}", lambda card=card: f"{head}{_of_dafms(card, size)}END {rest}"


def _of_vsdf(card: Any, size: int) -> str:
    """Data cards of one keyword, by commas, numbered where they must be."""
    required = [column.default is None for column in card.columns]
    shortest = (
        card.columns[: len(required) - required[::-1].index(True)] if any(required) else card.columns[:1]
    )
    values = [
        column.words[0] if column.words else "x" if column.letter == "T" else "1" for column in shortest
    ]
    values += ["1"] if card.more and card.more.default is None else []
    second = "1\n" if card.second else ""
    numbered = card.counted in ("own", "body")
    count = size // (len(",".join(values)) + 2 + len(second) + 5 * numbered)
    if card.section not in ("node", "table"):
        count = min(ELEMENTS if card in _LIMITED else VSDF_CARDS, count)
    rest = ",".join(values[1:])
    lines = (f"{k if numbered else values[0]},{rest}\n {second}" for k in range(1, count + 1))
    return f"{card.word}\n " + "".join(lines).rstrip(" ")


def _of_dafms(card: Any, size: int) -> str:
    """One card with as many entries as it may have, or the card again and again."""
    if card.layout != "entries":
        return f"{card.word}\n{'    1' + chr(10) if card.layout != 'switch' else ''}" * (size // 11)
    entry = f"{1:5d}{1:5d}{1:5d}\n" + ("\n" if card.tail else "")
    count = min(_MOST_ENTRIES, size // len(entry))
    return f"{card.word}\n{count:5d}\n{entry * count}" * max(1, size // (count * len(entry)))
