"""Blocks of an input file of Abaqus or CalculiX: a keyword with its options, and its data lines.

Abaqus Analysis User's Guide, "Input syntax rules": keyword lines that end with a comma are continued, options
are NAME or NAME=VALUE in any case, `**` begins a comment; *INCLUDE and INPUT= name other files.
"""

import re
from collections.abc import Iterator
from pathlib import Path
from typing import NamedTuple

from .file_text import IncludedLines, Line, integer, real

_INPUT = re.compile(
    r"""\*\s*(INCLUDE|NODE|ELEMENT)\s*,(?:.*,)?\s*INPUT\s*=\s*["']?([^,"']*)""", re.IGNORECASE
)


class Block(NamedTuple):
    """A keyword and what is below it."""

    keyword: str  # in capitals, without its star
    options: dict[str, str]  # values by names, both in capitals
    line: Line  # of the keyword
    data: list[Line]  # none of them blank

    def refuse_others(self, *known: str) -> None:
        """Raise FEFileFault at an option that is not `known`: it might change what is read."""
        for name in self.options:
            if name not in known:
                message = f"the option {name} of *{self.keyword} is not read; write the file without it"
                raise self.line.fault(message, id="FE-153")


def keyword_of(text: str) -> tuple[str, dict[str, str]]:
    """Return the keyword of a line, without its star, and the values of its options by their names."""
    keyword, *rest = text.upper().lstrip("* \t").split(",")
    options = [word.partition("=") for word in rest if word.strip()]
    values = {" ".join(name.split()): value.strip(" \t\"'") for name, _, value in options}
    return " ".join(keyword.split()), values


def words_of(line: Line) -> list[str]:
    """Return the words of a line of data."""
    return [word.strip() for word in line.text.rstrip(", \t").split(",")]


def integers_of(line: Line, words: list[str]) -> list[int]:
    """Return `words` of a line as integers.  Raises FEFileFault."""
    try:
        return [integer(word) for word in words]
    except ValueError:
        message = f"expected whole numbers; read '{' '.join(words)[:40]}'"
        raise line.fault(message, id="FE-100") from None


def reals_of(line: Line, count: int) -> list[float]:
    """Return `count` numbers of a line, 0 for those that are missing or empty.  Raises FEFileFault."""
    try:
        values = [real(word) if word else 0.0 for word in words_of(line)]
    except ValueError:
        values = [0.0] * (count + 1)
    if len(values) > count:
        raise line.fault(f"expected {count} numbers; read '{line.text.strip()[:40]}'", id="FE-156")
    return values + [0.0] * (count - len(values))


def lines(path: Path) -> Iterator[Line]:
    """Yield keywords, whole, and data of a file and those that it includes.  Raises FEFileFault."""
    source = IncludedLines(path)
    for line in source:
        text = line.text.strip()
        if not text.startswith("*"):
            if text:
                yield line
            continue
        if text.startswith("**"):
            continue
        while text.endswith(",") and (more := next(source, None)):
            text += more.text.strip() * (not more.text.startswith("**"))
        match = _INPUT.match(text)
        # An encrypted file says nothing; its keyword is refused.
        is_read = match and "PASSWORD" not in text.upper()
        if match and is_read:
            source.include(match[2].strip(), line)
        if not (match and is_read and match[1].upper() == "INCLUDE"):
            yield line._replace(text=text)


def blocks(path: Path) -> Iterator[Block]:
    """Yield the blocks of a file and those that it includes.  Raises FEFileFault."""
    block = None
    for line in lines(path):
        if line.text.startswith("*"):
            if block:
                yield block
            block = Block(*keyword_of(line.text), line, [])
        elif block:
            block.data.append(line)
    if block:
        yield block
