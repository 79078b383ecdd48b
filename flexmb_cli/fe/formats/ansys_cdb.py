"""Nodes of an ANSYS archive (CDWRITE): the NBLOCK, cut by the format line below its heading."""

import re
from collections.abc import Iterator
from pathlib import Path
from typing import Any

from .file_text import integer, line_fault, lines_of, real

_FORMAT = re.compile(r"\(\s*(\d+)i(\d+)\s*,\s*(\d+)e(\d+)", re.IGNORECASE)


def cdb_nodes(path: Path) -> Iterator[tuple[int, list[float], int]]:
    """Number, position and line of every node; trailing zeros may be left out of a line."""
    lines = lines_of(path)
    start = next((i for i, line in enumerate(lines) if line.upper().startswith("NBLOCK")), None)
    if start is None:
        return
    layout = _FORMAT.match(lines[start + 1].strip()) if start + 1 < len(lines) else None
    if layout is None:
        raise line_fault(
            path.name, start + 2, "a format such as (3i9,6e20.13) must follow NBLOCK", id="FE-090"
        )
    integers, width, _, digits = _widths(path.name, start + 2, layout.groups())
    for number, line in enumerate(lines[start + 2 :], start=start + 3):
        if line.upper().startswith("N,") or line.strip() == "-1" or not line[:width].strip():
            return
        yield _node(path.name, number, line.rstrip(), integers * width, width, digits)


def _widths(name: str, number: int, texts: Any) -> list[int]:
    """Counts and widths of a format's fields; a field has at least one column."""
    found = [int(text) if len(text) < 4 else 0 for text in texts]
    if 0 in found:
        raise line_fault(
            name, number, "a format such as (3i9,6e20.13) wanted, counts and widths 1 to 999", id="FE-091"
        )
    return found


def _node(
    name: str, number: int, line: str, first: int, width: int, digits: int
) -> tuple[int, list[float], int]:
    cells = [line[i : i + digits] for i in range(first, len(line), digits)]
    try:
        node = integer(line[:width])
        values = [real(cell) if cell.strip() else 0.0 for cell in cells]
    except ValueError:
        raise line_fault(
            name, number, f"a line of NBLOCK wanted; read '{line.strip()[:40]}'", id="FE-092"
        ) from None
    if any(values[3:]):
        message = f"the axes of node {node} are rotated; matrices in rotated nodal axes cannot be used"
        raise line_fault(name, number, message, id="FE-093")
    return node, (values + [0.0] * 3)[:3], number
