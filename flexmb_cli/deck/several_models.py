"""Several models in one FMBD.DAT: the 1992 program continues after STAR with the next DFMB card, until STOP.

The models share the record N, NDM.  Model k of a deck is named `k:DECK`, its numbers in `--set` `k:NAME`.
Each is read by itself: what the cards of an earlier model gave is not kept, other than in 1992.
"""

import os
import re
from collections.abc import Iterable
from dataclasses import replace

from ..errors import DeckError, Fault
from .record import DeckText, Lines
from .text import LARGEST_DECK, STANDARD_INPUT, first_bytes

MODEL, END, STOP = "DFMB", "END ", "STOP"
MOST_MODELS = 100  # each reads the whole deck
_NAMED = re.compile(r"([1-9][0-9]{0,5}):(.+)", re.DOTALL)


def model_starts(lines: Iterable[str]) -> list[int]:
    """Return where the DFMB cards of the models stand: the first, and those after END and before STOP."""
    starts, ended = [], True
    for k, line in enumerate(lines):
        word = line[:4].ljust(4)
        if word == STOP and ended:
            break
        if word == MODEL and ended:
            starts.append(k)
            ended = False
        ended = ended or word == END
    return starts


def named_model(deck: str) -> tuple[str, int]:
    """Return the path and the model that `k:PATH` names; 0 where `deck` is a path."""
    match = _NAMED.fullmatch(deck)
    if match is None or os.path.exists(deck):
        return deck, 0
    return match[2], int(match[1])


def models_of(deck: str) -> list[str]:
    """Return the names of the models in a deck with several of them, else `deck` itself.

    So it does for more than `MOST_MODELS`, which the reader refuses.
    """
    if deck == STANDARD_INPUT or not os.path.isfile(deck):
        return [deck]
    try:
        with open(deck, "rb") as file:
            raw = first_bytes(file, LARGEST_DECK)
    except OSError:
        return [deck]
    if raw.count(MODEL.encode()) < 2:
        return [deck]
    count = len(model_starts(Lines(raw.decode("latin-1"))))
    return [f"{k}:{deck}" for k in range(1, count + 1)] if 1 < count <= MOST_MODELS else [deck]


def only_model(source: DeckText, model: int) -> DeckText:
    """Return the deck with the lines of all other models blank; raises DeckError for a number it lacks."""
    lines = Lines(source.text)  # not kept: they take four times a deck of blank lines
    starts = model_starts(lines)
    if not 1 <= model <= len(starts):
        message = f"there is no model {model}: the deck holds {len(starts) or 'none'}"
        raise DeckError([Fault("error", message, id="DAFMS-043")])
    last = next((k for k in range(starts[-1], len(lines)) if lines[k].startswith(STOP)), len(lines))
    ends = [*starts[1:], last]
    first, end = starts[model - 1], ends[model - 1]
    parts = (
        *(lines.between(0, starts[0]), "\n" * (first - starts[0])),
        *(lines.between(first, end), "\n" * (last - end), lines.between(last, len(lines))),
    )
    return replace(source, text="".join(parts))


def changes_of(changes: tuple[str, ...], source: DeckText, model: int) -> list[str]:
    """Return the settings `NAME=VALUE` of a model: those that name it, and those that name none.

    Raises DeckError for a setting of a model that the deck lacks.
    """
    named = [(change, _NAMED.fullmatch(change)) for change in changes]
    if not any(match for _, match in named):
        return list(changes)
    refuse_strange(changes, max(1, len(model_starts(Lines(source.text)))))
    own = max(model, 1)
    return [match[2] if match else change for change, match in named if not match or int(match[1]) == own]


def refuse_strange(changes: tuple[str, ...], count: int) -> None:
    """Raise DeckError for settings of a model beyond the `count` that a deck holds."""
    matches = [(change, _NAMED.fullmatch(change)) for change in changes]
    strange = [change for change, named in matches if named and int(named[1]) > count]
    if strange:
        holds = "one model" if count == 1 else f"{count} models"
        raise DeckError(
            [Fault("error", f"--set {change}: the deck holds {holds}", id="DAFMS-044") for change in strange]
        )
