"""Blocks of an input file of Abaqus or CalculiX: a keyword with its options, and its data lines.

Abaqus Analysis User's Guide, "Input syntax rules": keyword lines that end with a comma are continued, options
are NAME or NAME=VALUE in any case, `**` begins a comment; *INCLUDE and INPUT= name other files.
"""

import re
from collections.abc import Iterator
from pathlib import Path
from typing import NamedTuple

from .file_text import integer, real
from .included_files import Inclusion, Line, lines_with_included

_FILE = re.compile(r"""\bINPUT\s*=\s*("[^"]*"|'[^']*'|[^,]*)""", re.IGNORECASE)


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


def words_of(line: Line) -> list[str]:
    """Return the words of a line of data."""
    return [word.strip() for word in line.text.rstrip(" ,").split(",")]


def integers_of(line: Line, words: list[str]) -> list[int]:
    """Return `words` of a line as integers.  Raises FEFileFault."""
    try:
        return [integer(word) for word in words]
    except ValueError:
        read = " ".join(words)[:40]
        raise line.fault(f"whole numbers wanted; read '{read}'", id="FE-100") from None


def reals_of(line: Line, count: int) -> list[float]:
    """Return `count` numbers of a line, 0 for those that are missing or empty.  Raises FEFileFault."""
    try:
        values = [real(word) if word else 0.0 for word in words_of(line)]
    except ValueError:
        values = [0.0] * (count + 1)
    if len(values) > count:
        raise line.fault(f"{count} numbers wanted; read '{line.text.strip()[:40]}'", id="FE-156")
    return values + [0.0] * (count - len(values))


def blocks(path: Path) -> Iterator[Block]:
    """Yield the blocks of `path` and the files that it includes.  Raises FEFileFault."""
    block = None
    for line in lines_with_included(path, inclusion):
        text = line.text.strip()
        if not text or text.startswith("**"):
            continue
        if text.startswith("*"):
            if block:
                yield block
            block = _block(line, text)
        elif block and not block.data and block.line.text.endswith(",") and text[0].isalpha():
            block = _block(block.line._replace(text=block.line.text + text), block.line.text + text)
        elif block:
            block.data.append(line)
    if block:
        yield block


def _block(line: Line, text: str) -> Block:
    keyword, *rest = text.upper().lstrip("* \t").split(",")
    options = [word.partition("=") for word in rest if word.strip()]
    return Block(
        " ".join(keyword.split()),
        {" ".join(name.split()): value.strip(" \t\"'") for name, _, value in options},
        line._replace(text=text),
        [],
    )


def inclusion(lines: list[str], at: int) -> Inclusion | None:
    """Return the file of *INCLUDE, or of *NODE and *ELEMENT with INPUT=."""
    if not lines[at].lstrip().startswith("*") or lines[at].lstrip().startswith("**"):
        return None
    end, text = at + 1, lines[at].strip()
    while text.endswith(",") and end < len(lines) and lines[end].strip()[:1].isalpha():
        text, end = text + lines[end].strip(), end + 1
    keyword = text.upper().lstrip("* \t").split(",")[0].strip()
    found = _FILE.search(text)
    # An encrypted file says nothing; its *INCLUDE is refused as a keyword.
    if found is None or keyword not in ("INCLUDE", "NODE", "ELEMENT") or "PASSWORD" in text.upper():
        return None
    return Inclusion(found[1].strip(" \t\"'"), end - at, keyword != "INCLUDE")
