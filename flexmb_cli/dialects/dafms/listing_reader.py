"""Readers of what DAFMS wrote, ours and historic: the echo FMBD.OUT and the time series of units 2 and 3.

The layouts are those of `dafms.py`.  Lines that are no part of them (the ==WKD== lines of the debugging
program, blank lines) are passed over.
"""

import os
import re
from dataclasses import dataclass
from typing import Any

import numpy as np

from ...deck.edit import E, Edit, F, I
from ...deck.fortran_words import is_unreadable, split_fields, split_list, unit_of, value_of
from ...deck.listing import EchoLine, Listing, ListingForm, Rows, TableError
from ...errors import Fault, Place
from .listing import BODY_LINES, SERIES_FIELDS

SINGLE_PRECISION = "the program of 1992 read its deck in single precision"


def single_precision(a: np.ndarray, b: np.ndarray, unit: np.ndarray) -> np.ndarray:
    """Return whether a and b may be one number, printed by its nearest single and by its nearest double."""
    size = np.maximum(np.abs(a), np.abs(b))
    with np.errstate(invalid="ignore"):
        # Each rounding to the printed digits takes half a unit.
        return np.abs(a - b) <= np.finfo(np.float32).eps / 2 * size + (1 + 1e-9) * unit


ECHO = ListingForm(
    "echo of a DAFMS deck",
    "a note of failure",
    has_rows=False,
    by_titles=True,
    echo_error=(SINGLE_PRECISION, single_precision),
)
SERIES = ListingForm("DAFMS time series", "the note of a stop")


@dataclass(frozen=True)
class _Tag:
    """A line of the echo: what stands after its tag; `columns` empty: a list of `edits[0]`."""

    name: str
    kind: str
    edits: tuple[Edit, ...]
    columns: tuple[str, ...] = ()


def _vector(name: str, kind: str, *indices: Any) -> _Tag:
    edits = (*len(indices) * (I(5),), *3 * (F(10, 5),))
    return _Tag(name, kind, edits, (*indices, "axis 1", "axis 2", "axis 3"))


_DOFS = ("body", "number", "axis 1", "axis 2", "axis 3")
# Tags as printed, but for blanks; FMBD.OUT, thesis (Zhao, 1992), appendix C.
TAGS = {
    "==N==NDM==": _Tag("counts", "count", (I(5), I(5)), ("N", "NDM")),
    "NUMBEROFDOFOFTRANSLATION=": _Tag("translations", "count", 5 * (I(5),), _DOFS),
    "NUMBEROFDOFOFROTATION=": _Tag("rotations", "count", 5 * (I(5),), _DOFS),
    "NUMBEROFNODESINBODYK=": _Tag("nodes of bodies", "count", (I(5),)),
    "NUMBEROFDOFOFNODEINBK=": _Tag("directions of nodes", "count", (I(5),)),
    "AMOUNTOFINTEGRALSTEP=": _Tag("steps", "count", (I(5),), ("IT",)),
    "LENGTHOFTIMEOFONESTEP=": _Tag("step", "time", (F(10, 5),), ("H",)),
    "DOFOFTHESYSTEM=": _Tag("coordinates of the system", "count", (I(5),), ("NS",)),
    "COOR": _vector("COOR", "length", "body", "node"),
    "=PI=": _vector("=PI=", "force", "body", "node"),
    "NEQ=": _Tag("NEQ=", "count", (I(5),), ("equations",)),
    "=ID=": _Tag("=ID=", "count", (I(5),)),
    "JDIA": _Tag("JDIA", "count", (I(5),)),
    "BKCP": _Tag("BKCP", "stiffness", (E(12, 4),)),
    "====K====": _Tag("====K====", "count", (I(5),), ("body",)),
    "BMI=": _Tag("BMI=", "mass", (F(10, 5),)),
    "PIP=": _vector("PIP=", "force", "body", "node"),
    "=BK=": _Tag("=BK=", "stiffness", (E(12, 4),)),
    "LC==": _Tag("LC==", "count", (I(5),)),
    **{
        tag: _Tag(tag, kind, edits, ("body", *names.split(",")))
        for tag, edits, kind, names in BODY_LINES.values()
    },
    "X(L)": _Tag("X(L)", "coordinate", (F(10, 5),)),
    "Y(L)": _Tag("Y(L)", "state", (F(10, 5),)),
}
_TAGGED = re.compile(r"\s*(" + "|".join(r"\s*".join(map(re.escape, tag)) for tag in TAGS) + ")")
_HEADING = "DFMB"


def parse_echo(name: str, text: str) -> Listing | None:
    """The echo of a DAFMS deck in `text`; None when it holds none.

    Raises `TableError` with the place of every line that cannot be read.
    """
    lines = text.split("\n")
    if not any("==N==NDM==" in line for line in lines[:50]):
        return None
    echo: list[EchoLine] = []
    words: list[tuple[int, str]] = []
    faults: list[Fault] = []
    for number, line in enumerate(lines, 1):
        if line.startswith(_HEADING):
            words.append((number, " ".join(line.split())))
        elif match := _TAGGED.match(line):
            read = _echo_line(number, line, match, faults)
            if read is not None:  # else there is a fault
                echo.append(read)
    if faults:
        raise TableError(name, faults, lines)
    empty = np.empty(0)
    return Listing(name, tuple(echo), empty, 1.0, {}, form=ECHO, words=tuple(words))


def _echo_line(number: int, line: str, match: re.Match[str], faults: list[Fault]) -> EchoLine | None:
    tag = TAGS["".join(match[1].split())]
    rest = line[match.end() :]
    words = split_fields(rest, tag.edits) if tag.columns else split_list(rest, tag.edits[0])
    if words is None:
        faults.append(_fault(number, line, match.end(), tag))
        return None
    values, units = tuple(map(value_of, words)), tuple(map(unit_of, words))
    edits = tag.edits if tag.columns else len(words) * tag.edits
    return EchoLine(number, tag.name, values, units, tag.columns, tag.kind, edits)


def _fault(number: int, line: str, start: int, tag: _Tag) -> Fault:
    expected = f"{len(tag.columns)} numbers are expected" if tag.columns else "numbers are expected"
    read = line[start:].strip()
    column = start + 1 + len(line[start:]) - len(line[start:].lstrip())
    return Fault(
        "error",
        f"{expected}, read {read!r}",
        Place(number, column, max(1, len(read))),
        tag.name,
        id="DAFMS-042",
    )


# Y holds the NS speeds, then the NS coordinates.
_COLUMNS = {
    "2": (("last speed", "speed"), ("coordinate 1", "coordinate"), ("coordinate 2", "coordinate")),
    "3": (("coordinate 3", "coordinate"), ("coordinate 5", "coordinate"), ("coordinate 6", "coordinate")),
}
_UNKNOWN = tuple((f"value {number}", "state") for number in range(1, 7))
_FIRST_ROW = re.compile(r"\s*[-+]?\d*\.\d{7}(?=[-+*\s]|\d*\.|$)")
_NOTES = ("TOL,XEND,H", "**Y**", "444-444-444")


def parse_series(name: str, text: str) -> Listing | None:
    """The time series of unit 2 (<name>.T2, fort.2) or unit 3 in `text`; None when it holds none.

    Raises `TableError` with the place of every line that cannot be read.
    """
    lines = text.split("\n")
    rows = [n for n, line in enumerate(lines) if line.strip() and not line.lstrip().startswith(_NOTES)]
    if not rows or not _FIRST_ROW.match(lines[rows[0]]):
        return None
    read_rows, faults, width = Rows(), [], 0
    times: list[float] = []
    for step, row in enumerate(rows):
        words = _series_words(lines[row], width)
        if words is None or is_unreadable(words[0]):
            numbers = f"{width or 'some'} numbers under FORMAT(2F12.7,5E15.6)"
            sentence = f"{numbers} are expected, read {lines[row].strip()!r}"
            place = Place(row + 1, 1, max(1, len(lines[row])))
            faults.append(Fault("error", sentence, place, id="DAFMS-075"))
        else:
            width = len(words)
            times.append(value_of(words[0]))
            read_rows.add(row + 1, step, words[1:])
    if faults:
        raise TableError(name, faults, lines)
    columns = _COLUMNS.get(_unit_number(name), _UNKNOWN)[: width - 1]
    groups = tuple((kind, title) for title, kind in columns)
    section = read_rows.section(groups, SERIES_FIELDS[1:width])
    failed = len(rows) < sum(bool(line.strip()) for line in lines)
    return Listing(name, (), np.array(times), 1e-7, {"series": section}, failed, SERIES)


def _unit_number(name: str) -> str:
    match = re.fullmatch(r".*\.(?:T|)([23])", os.path.basename(name), re.IGNORECASE)
    return match[1] if match else ""


def _series_words(line: str, width: int) -> list[str] | None:
    widths = [width] if width else range(len(SERIES_FIELDS), 0, -1)
    return next((words for n in widths if (words := split_fields(line, SERIES_FIELDS[:n]))), None)
