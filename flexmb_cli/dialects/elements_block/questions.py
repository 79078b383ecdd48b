"""Lines of the block ELEMENTS as `flexmb new` asks for them, one after the other until an empty answer."""

from collections.abc import Generator, Sequence
from itertools import count
from typing import Any

from ...deck.dialogue import Line, named
from ...deck.questions import TEXT, Cell, Entry
from ...deck.record import Record
from .text import BLOCK
from .words import BY_WORD, Key, usage

SECTION = "element_line"


def element_entries() -> Generator[Entry, Record, None]:
    """Yield a question for a line until one is answered by nothing."""
    cell = Cell("line", "a function or an element, Enter after the last", letter=TEXT, default="")
    for k in count(1):
        record = yield Entry(SECTION, k, f"line {k} of {BLOCK}", (cell,), True, explained)
        if not record["line"]:
            return


def block_lines(records: Sequence[Record]) -> list[Line]:
    """Return the block that the answers make."""
    lines = [record for record in records if record.section == SECTION and record["line"]]
    return [[(BLOCK, "")], *([("  ", ""), *named(record)] for record in lines)] if lines else []


def explained(word: str) -> str:
    """Return how lines of a word are written, with its keys; without a word how those of all are."""
    form = BY_WORD.get(word.upper())
    if form is None:
        lines = [f"{usage(each)}: {each.meaning}" for each in BY_WORD.values()]
        return "\n".join([*lines, "? SPRING explains the keys of SPRING"])
    return "\n".join([f"{usage(form)}: {form.meaning}", *map(_key, form.keys)])


def _key(key: Key) -> str:
    unit = " or ".join(dict.fromkeys(filter(None, reversed(key.units))))
    default: Any = "" if key.default is None else f"; {key.default} if not given"
    return f"  {key.name}: {key.meaning}{', ' if unit else ''}{unit}{default}"
