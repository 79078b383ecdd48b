"""Solid elements in the files of node tables: INP *ELEMENT, CDB EBLOCK, BDF CHEXA and CTETRA.

Tetrahedra have 4 or 10 nodes, hexahedra 8 or 20.
"""

import re
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from ...quick_dataclass import dataclass
from .bulk_data import BulkCard, bulk_cards, integer_field
from .file_text import integer, line_fault, lines_of
from .matrix_file import FEFileFault

if TYPE_CHECKING:
    from collections.abc import Iterator


COUNTS = (4, 8, 10, 20)
_KNOWN = "tetrahedra of 4 or 10 and hexahedra of 8 or 20 nodes"
_INP_TYPE = re.compile(r"TYPE\s*=\s*(C3D(4|8|10|20)[A-Z]*)\s*(,|$)")
_CDB_FORMAT = re.compile(r"\(\s*\d+i(\d{1,3})(?!\d)", re.IGNORECASE)
# In EBLOCK eleven integers precede the nodes, the ninth of which counts them.
_CDB_HEAD, _CDB_COUNT = 11, 8
# Nastran numbers the edges along the third direction before those of the upper face.
_FROM_NASTRAN = [*range(12), *range(16, 20), *range(12, 16)]


@dataclass(frozen=True)
class _Element:
    """An element as its file gives it; `kind` is its type in an INP file, "" in others."""

    number: int
    nodes: list[int]
    line: int
    kind: str = ""


@dataclass(frozen=True)
class ElementTable:
    """Node numbers (m, k) of the elements, k 4, 8, 10 or 20, and the numbers of the elements (m,).

    `kind` is their type in an INP file, such as C3D20R; "" in other formats.

    Hexahedra: corners of one face, of the opposite one, then the middles of edges as Abaqus and ANSYS have
    them.  Tetrahedra: corners, then the middles of the edges 1-2, 2-3, 3-1, 1-4, 2-4, 3-4.
    """

    numbers: np.ndarray
    nodes: np.ndarray
    kind: str = ""


def read_elements(path: Path, form: str) -> ElementTable:
    """Return the elements beside the nodes of `path`, in the format INP, CDB or BDF.

    Raises FEFileFault when there are none, others than tetrahedra or hexahedra of one type, or one twice.
    """
    readers = {"INP": _inp_elements, "CDB": _cdb_elements, "BDF": _bdf_elements}
    if form not in readers:
        raise FEFileFault(
            f"{path.name}: a node table of format {form} has no elements; INP, CDB or BDF has", id="FE-019"
        )
    found = list(readers[form](path))
    if not found:
        raise FEFileFault(f"{path.name} holds no elements in format {form}", id="FE-020")
    _check_nodes(path.name, found)
    _check_kinds(path.name, found)
    _check_numbers(path.name, found)
    return ElementTable(
        np.array([element.number for element in found], dtype=np.int64),
        np.array([element.nodes for element in found], dtype=np.int64),
        found[0].kind,
    )


def _check_nodes(name: str, found: list[_Element]) -> None:
    for element in found:
        if len(element.nodes) not in COUNTS or len(set(element.nodes)) < len(element.nodes):
            message = f"element {element.number} has not the different nodes of one of the {_KNOWN}"
            raise line_fault(name, element.line, message, id="FE-097")


def _check_kinds(name: str, found: list[_Element]) -> None:
    counts = {len(element.nodes) for element in found}
    if len(counts) > 1:
        mixed = " and of ".join(map(str, sorted(counts)))
        raise FEFileFault(f"{name} mixes elements of {mixed} nodes; use one type", id="FE-021")
    kinds = sorted({element.kind for element in found})
    if len(kinds) > 1:
        raise FEFileFault(
            f"{name} mixes elements of types {' and '.join(kinds)}; one type is wanted", id="FE-084"
        )


def _check_numbers(name: str, found: list[_Element]) -> None:
    first: dict[int, int] = {}
    for element in found:
        if element.number in first:
            message = f"element {element.number} is given twice, first on line {first[element.number]}"
            raise line_fault(name, element.line, message, id="FE-098")
        first[element.number] = element.line


def _inp_elements(path: Path) -> "Iterator[_Element]":
    """Data lines of *ELEMENT; a line that ends in a comma is continued."""
    words: list[str] = []
    kind, wanted, first = "", 0, 0
    for number, line in enumerate(lines_of(path), start=1):
        if line.startswith("**") or not line.strip():
            continue
        if line.startswith("*"):
            kind, wanted = _inp_type(path, number, line.upper())
            continue
        if not wanted:
            continue
        first = first if words else number
        words += [word for word in map(str.strip, line.split(",")) if word]
        if len(words) > wanted or not line.rstrip().endswith(","):
            values = _integers(path, first, words)
            yield _Element(values[0], values[1:], first, kind)
            words = []


def _inp_type(path: Path, number: int, line: str) -> tuple[str, int]:
    """Return type and nodes of the elements below this keyword, "" and 0 when it is no *ELEMENT."""
    if line.split(",")[0].strip() != "*ELEMENT":
        return "", 0
    kind = _INP_TYPE.search(line)
    if kind is None:
        message = f"stresses are known of {_KNOWN} only, types C3D4, C3D10, C3D8, C3D20 and their variants"
        raise line_fault(path.name, number, message, id="FE-099")
    return kind[1], int(kind[2])


def _integers(path: Path, number: int, words: list[str]) -> list[int]:
    try:
        return [integer(word) for word in words]
    except ValueError:
        message = f"whole numbers wanted; read '{' '.join(words)[:40]}'"
        raise line_fault(path.name, number, message, id="FE-100") from None


def _cdb_elements(path: Path) -> "Iterator[_Element]":
    """EBLOCK, cut by the format below it; nodes that do not fit stand on the next line."""
    lines = lines_of(path)
    start = next((i for i, line in enumerate(lines) if line.upper().startswith("EBLOCK")), None)
    if start is None:
        return
    layout = _CDB_FORMAT.match(lines[start + 1].strip()) if start + 1 < len(lines) else None
    if layout is None:
        raise line_fault(path.name, start + 2, "a format such as (19i9) must follow EBLOCK", id="FE-101")
    words: list[int] = []
    width, first = max(1, int(layout[1])), 0
    for number, line in enumerate(lines[start + 2 :], start=start + 3):
        if line.strip() == "-1":
            return
        first = first if words else number
        line = line.rstrip()
        words += _integers(path, number, [line[i : i + width] for i in range(0, len(line), width)])
        if len(words) >= _CDB_HEAD and len(words) >= _CDB_HEAD + words[_CDB_COUNT]:
            nodes = words[_CDB_HEAD : _CDB_HEAD + words[_CDB_COUNT]]
            yield _Element(words[_CDB_HEAD - 1], nodes, first)
            words = []
    raise FEFileFault(f"{path.name}: EBLOCK does not end with -1; is the file cut off?", id="FE-022")


_SOLIDS = ("CHEXA", "CPENTA", "CTETRA", "CPYRAM", "CHEXA1", "CHEXA2")
# Fields of grid points behind the numbers of element and property.
_MOST_POINTS = {"CHEXA": 20, "CTETRA": 10}


def _bdf_elements(path: Path) -> "Iterator[_Element]":
    for card in bulk_cards(path, _SOLIDS):
        number = integer_field(path, card, 0, "the number of the element")
        if card.name not in _MOST_POINTS:
            message = f"{card.name} {number}: stresses are known of {_KNOWN} only, cards CHEXA and CTETRA"
            raise line_fault(path.name, card.line, message, id="FE-102")
        fields = range(2, 2 + _MOST_POINTS[card.name])
        given = [integer_field(path, card, i, "a grid point") for i in fields if _filled(card, i)]
        nodes = [given[i] for i in _FROM_NASTRAN] if len(given) == 20 else given
        yield _Element(number, nodes, card.line)


def _filled(card: BulkCard, index: int) -> bool:
    return index < len(card.fields) and bool(card.fields[index])
