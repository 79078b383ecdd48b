"""Untrusted TOML texts: those that would take tomllib hours are refused before they are parsed."""

import re
from typing import Any

from ..errors import Place
from .record import DeckText

DEEPEST_NAME = 64  # parts
_BETWEEN_NAMES = re.compile(r"[][,={}]")
_SYNTAX = re.compile(r"(.*) \(at line (\d+), column (\d+)\)")


class TomlError(ValueError):
    """A text is not TOML; `place` is None where it is unknown."""

    def __init__(self, message: str, place: Place | None = None):
        super().__init__(message)
        self.place = place


class DeepNameError(TomlError):
    """A name of so many parts that tomllib would take hours for it."""


def toml_table(source: DeckText) -> dict[str, Any]:
    """Return the table of a TOML text; raises TomlError."""
    # `diff` needs it for a file of tolerances only.
    import tomllib

    _refuse_deep_names(source)
    try:
        return tomllib.loads(source.text.replace("\r\n", "\n"))
    except (ValueError, RecursionError) as fault:
        # tomllib leaves integers of thousands of digits to int(), which refuses them without a place.
        found = _SYNTAX.match(str(fault))
        place = Place(int(found[2]), int(found[3])) if found else None
        raise TomlError(found[1] if found else str(fault), place) from None


def _refuse_deep_names(source: DeckText) -> None:
    for number, line in enumerate(source.lines, 1):
        if line.count(".") > DEEPEST_NAME and any(map(_is_deep, _BETWEEN_NAMES.split(line))):
            raise DeepNameError(f"a name of more than {DEEPEST_NAME} parts", Place(number, 1))


def _is_deep(piece: str) -> bool:
    return sum(bool(part.strip()) for part in piece.split(".")) > DEEPEST_NAME
