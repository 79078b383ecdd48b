"""Untrusted TOML texts: those that would take tomllib hours are refused before they are parsed."""

import json
import os
import re
from collections.abc import Mapping
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
        match = _SYNTAX.match(str(fault))
        place = Place(int(match[2]), int(match[3])) if match else None
        raise TomlError(match[1] if match else str(fault), place) from None


def toml_text(table: Mapping[str, Any]) -> str:
    """Return a table as TOML; arrays of numpy become lists.  Raises TypeError for what TOML has not."""
    return "".join(f"{json.dumps(name)} = {_toml_value(value)}\n" for name, value in table.items())


def _toml_value(value: Any) -> str:
    if hasattr(value, "tolist"):
        value = value.tolist()
    if isinstance(value, Mapping):
        return f"{{ {', '.join(f'{json.dumps(name)} = {_toml_value(one)}' for name, one in value.items())} }}"
    if isinstance(value, list | tuple):
        return f"[{', '.join(map(_toml_value, value))}]"
    # Strings, numbers and truth values are spelled as in JSON, but for nan and inf, which studies refuse.
    return json.dumps(os.fspath(value) if isinstance(value, os.PathLike) else value)


def _refuse_deep_names(source: DeckText) -> None:
    for number, line in enumerate(source.lines, 1):
        if line.count(".") > DEEPEST_NAME and any(map(_is_deep, _BETWEEN_NAMES.split(line))):
            raise DeepNameError(f"a name of more than {DEEPEST_NAME} parts", Place(number, 1))


def _is_deep(piece: str) -> bool:
    return sum(bool(part.strip()) for part in piece.split(".")) > DEEPEST_NAME
