"""Nodes of an ANSYS archive (CDWRITE): NBLOCK, cut by the format line below it, and N.

ANSYS Mechanical APDL Command Reference, CDWRITE, NBLOCK, N.
"""

import re
from collections.abc import Iterator
from pathlib import Path
from typing import Any

from .file_text import integer, line_fault, lines_of, real
from .included_files import Line
from .node_table import Node, node_of

_FORMAT = re.compile(r"\(\s*(\d+)i(\d+)\s*,\s*(\d+)e(\d+)", re.IGNORECASE)
# Commands that make, move, turn or remove nodes, or read them from elsewhere, by their first four letters.
_REFUSED = (
    *("NGEN", "FILL", "NSYM", "NSCA", "NROT", "NMOD", "NANG", "NKPT", "NREA", "NUMM", "NUMC", "NDEL", "MOVE"),
    *("TRAN", "UPGE", "UPCO", "/INP", "*USE", "*DO", "*REP", "CDRE"),
)
# Commands that make another coordinate system the active one.
_ACTIVATING = ("CSYS", "LOCA", "CLOC", "CS", "CSKP", "CSWP")


def cdb_nodes(path: Path) -> Iterator[Node]:
    """Number, position and line of every node; trailing zeros may be left out of a line."""
    lines = lines_of(path)
    at, system = 0, ""
    while at < len(lines):
        line, at = Line(path.name, at + 1, lines[at]), at + 1
        command, *words = map(str.strip, line.text.upper().split("!")[0].split(","))
        if command[:4] in _ACTIVATING and not words[:1] == ["R5.0"]:
            system = "" if command[:4] == "CSYS" and words[:1] in ([], [""], ["0"]) else f"{command},{words[0]}"
        elif command[:4] in _REFUSED:
            message = f"{command} changes nodes, and is not read; let CDWRITE write them"
            raise line.fault(message, id="FE-176")
        elif command in ("N", "NBLOCK") and system:
            message = f"nodes in the coordinates of {system}; write the archive after CSYS,0"
            raise line.fault(message, id="FE-177")
        elif command == "N":
            yield from _command(line, words)
        elif command == "NBLOCK":
            block = list(_block(path.name, lines, at))
            yield from block
            at += 1 + len(block)


def _command(line: Line, words: list[str]) -> Iterator[Node]:
    """Yield the node of N, or of N,R5.3,LOC,..., which ends with -1; N,R5.3,ANG,... turns its axes."""
    node, *values = words[2:] if words[:1] and words[0].startswith("R") else words
    values = [value or "0" for value in values]
    if words[1:2] == ["ANG"]:
        node_of(line, [node, "0", "0", "0", *values])
    elif node != "-1":
        yield *node_of(line, [node, *values]), line


def _block(name: str, lines: list[str], at: int) -> Iterator[Node]:
    """Yield the nodes of the block whose format is line `at`, counted from 0."""
    layout = _FORMAT.match(lines[at].strip()) if at < len(lines) else None
    if layout is None:
        raise line_fault(name, at + 1, "a format such as (3i9,6e20.13) must follow NBLOCK", id="FE-090")
    integers, width, _, digits = _widths(name, at + 1, layout.groups())
    for number, text in enumerate(lines[at + 1 :], start=at + 2):
        if text.upper().startswith("N,") or text.strip() == "-1" or not text[:width].strip():
            return
        yield _node(Line(name, number, text.rstrip()), integers * width, width, digits)


def _widths(name: str, number: int, texts: Any) -> list[int]:
    """Counts and widths of a format's fields; a field has at least one column."""
    found = [int(text) if len(text) < 4 else 0 for text in texts]
    if 0 in found:
        raise line_fault(
            name, number, "a format such as (3i9,6e20.13) wanted, counts and widths 1 to 999", id="FE-091"
        )
    return found


def _node(line: Line, first: int, width: int, digits: int) -> tuple[int, list[float], Line]:
    cells = [line.text[i : i + digits] for i in range(first, len(line.text), digits)]
    try:
        node = integer(line.text[:width])
        values = [real(cell) if cell.strip() else 0.0 for cell in cells]
    except ValueError:
        raise line.fault(f"a line of NBLOCK wanted; read '{line.text.strip()[:40]}'", id="FE-092") from None
    if any(values[3:]):
        message = f"the axes of node {node} are rotated; matrices in rotated nodal axes cannot be used"
        raise line.fault(message, id="FE-093")
    return node, (values + [0.0] * 3)[:3], line
