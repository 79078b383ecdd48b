"""Places of the names of a study: tomllib does not give them."""

import re
from collections.abc import Iterable, Iterator

TABLES = ("parameters", "results")
_HEAD = re.compile(r"\s*\[\s*[\"']?([^][\"']*?)[\"']?\s*\]")
_BEFORE_KEY = re.compile(r"\s*\[?\s*")
_BEFORE_KEY_OF_TABLE = re.compile(r"\s*(\w+)\s*\.\s*")
_END = re.compile(r"[]=]")
_MOST_ENDS = 3  # a quoted name may hold an end, or two


def key_places(lines: Iterable[str]) -> dict[tuple[str, str], tuple[int, int]]:
    """Line and column of each name where it first stands as a key.

    By ("", name) anywhere, by (table, name) in one of `TABLES`.  All lines are looked
    through once, however many names there are.
    """
    places: dict[tuple[str, str], tuple[int, int]] = {}
    table = ""
    for number, line in enumerate(lines, 1):
        if line.lstrip().startswith("["):
            head = _HEAD.match(line)
            table = head[1] if head else ""
        for owner, start in _starts(line, table):
            for name, column in _names(line, start):
                places.setdefault((owner, name), (number, column))
    return places


def _starts(line: str, table: str) -> Iterator[tuple[str, int]]:
    """Return where a name may begin, and the table it would be in."""
    before = _BEFORE_KEY.match(line)
    assert before is not None, "it matches nothing, too"
    yield "", before.end()
    if table in TABLES:
        yield table, len(line) - len(line.lstrip())
    dotted = _BEFORE_KEY_OF_TABLE.match(line)
    if dotted and dotted[1] in TABLES:
        yield dotted[1], dotted.end()


def _names(line: str, start: int) -> Iterator[tuple[str, int]]:
    """Return what may be a name there, without quotes, and its column."""
    start += line[start : start + 1] in ('"', "'")
    for _, end in zip(range(_MOST_ENDS), _END.finditer(line, start), strict=False):
        name = line[start : end.start()].rstrip()
        yield name[:-1] if name.endswith(('"', "'")) else name, start + 1
