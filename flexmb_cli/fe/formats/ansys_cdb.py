"""Nodes of an ANSYS archive (CDWRITE): NBLOCK, cut by the format line below it, and N.

ANSYS Mechanical APDL Command Reference, CDWRITE, NBLOCK, N.
"""

import re
from collections.abc import Iterator
from pathlib import Path

from .file_text import Line, integer, lines_of, real
from .matrix_file import FEFileFault
from .node_table import Node, node_of, placed

_FORMAT = re.compile(r"\(\s*(\d+)i(\d+)\s*,\s*(\d+)e(\d+)", re.IGNORECASE)
# The first four letters of commands that make, move, turn or remove nodes, or read them from elsewhere.
_OF_NODES = (
    "NGEN FILL NSYM NSCA NROT NMOD NANG NKPT NREA NUMM NUMC NDEL MOVE TRAN UPGE UPCO /INP *USE *DO CDRE"
)
# Commands that make another coordinate system the active one.
_ACTIVATING = ("CSYS", "LOCA", "CLOC", "CS", "CSKP", "CSWP")


def commands(path: Path, refused: str) -> Iterator[tuple[Line, str, list[str], list[str]]]:
    """Yield line, command and words of an archive, in capitals, and the lines that follow.

    Raises FEFileFault at a command that begins with one of the words `refused`.
    """
    lines, words_refused = lines_of(path), refused.split()
    for number, text in enumerate(lines, start=1):
        line = Line(path.name, number, text)
        command, *words = map(str.strip, text.upper().split("!")[0].split(","))
        if command[:4] in words_refused:
            message = (
                f"{command} makes or changes nodes or elements, and is not read; let CDWRITE write blocks"
            )
            raise line.fault(message, id="FE-176")
        yield line, command, [*words, "", "", ""], lines[number:] if "BLOCK" in command else []


def cdb_nodes(path: Path) -> Iterator[Node]:
    """Number, position and line of every node; trailing zeros may be left out of a line."""
    system = ""
    for line, command, words, below in commands(path, _OF_NODES):
        if command[:4] in _ACTIVATING and words[0] != "R5.0":
            system = "" if command == "CSYS" and words[0] in ("", "0") else f"{command},{words[0]}"
        elif command in ("N", "NBLOCK") and system:
            message = f"nodes in the coordinates of {system}; write the archive after CSYS,0"
            raise line.fault(message, id="FE-177")
        elif command == "N":
            node, *values = words[2:] if words[0].startswith("R") else words
            turned = words[1] == "ANG"
            node_fields = node_of(line, [node, *["0"] * 3 * turned, *(value or "0" for value in values)])
            if not turned and node_fields[0] != -1:
                yield *node_fields, line
        elif command == "NBLOCK":
            yield from _block(line, below)


def _block(heading: Line, lines: list[str]) -> Iterator[Node]:
    """Yield the nodes of a block by its format and the lines below it."""
    second = Line(heading.name, heading.number + 1, "")
    layout = _FORMAT.match(lines[0].strip()) if lines else None
    if layout is None:
        raise second.fault("a format such as (3i9,6e20.13) must follow NBLOCK", id="FE-090")
    # A field has at least one column.
    integers, width, _, digits = (int(text) if len(text) < 4 else 0 for text in layout.groups())
    if 0 in (integers, width, int(layout[3]), digits):
        message = "expected a format such as (3i9,6e20.13), counts and widths 1 to 999"
        raise second.fault(message, id="FE-091")
    for number, text in enumerate(lines[1:], start=second.number + 1):
        if text.upper().startswith("N,") or text.strip() == "-1":
            return
        if not text.strip():
            continue
        line, text = Line(heading.name, number, text), text.rstrip()
        cells = [text[i : i + digits] for i in range(integers * width, len(text), digits)]
        try:
            yield (
                *placed(line, integer(text[:width]), [real(cell) if cell.strip() else 0.0 for cell in cells]),
                line,
            )
        except ValueError:
            raise line.fault(f"expected a line of NBLOCK; read '{text.strip()[:40]}'", id="FE-092") from None
    raise FEFileFault(f"{heading.name}: NBLOCK does not end with -1; is the file cut off?", id="FE-200")
