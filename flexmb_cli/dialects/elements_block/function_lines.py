"""Lines FUNCTION of the block ELEMENTS: what defines each function."""

from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from ...deck import number
from ...deck.record import Number
from ...deck.text import read_text
from ...errors import DeckError, Fault, Place
from ...model.diagnostics import Findings
from .line import ElementLine
from .words import POSITIONS

_OF_POINTS = ("table", "spline", "periodic")
_OPTIONAL = "phase"
_OTHER_KEYS = ("file", "number", "points")


@dataclass(frozen=True)
class GivenFunction:
    """A function as its line gives it: what defines it, numbers or, of sums and products, names.

    `place(k)`: where the k-th value stands; `faulty`: it has a fault that was reported.
    """

    line: ElementLine
    values: Sequence[Any]
    place: Callable[[int], Place | None]
    faulty: bool = False

    @property
    def names(self) -> Iterator[tuple[str, Place | None]]:
        """Its name, and its number if it has one, with their places."""
        yield self.line.subject, self.line.place
        if "number" in self.line:
            yield name_of(self.line["number"]), self.line.at("number").place


def given_functions(
    lines: Iterable[ElementLine], folder: Path, findings: Findings, tables: Mapping[int, Any] | None = None
) -> Iterator[GivenFunction]:
    """The functions of lines, as `Functions` takes them."""
    for line in lines:
        if line.word == "FUNCTION":
            _refuse_number_of_table(line, tables or {}, findings)
            values = _values(line, folder, findings, tables)
            yield GivenFunction(line, *(values or ((), lambda _: None, True)))


def _refuse_number_of_table(line: ElementLine, tables: Mapping[int, Any], findings: Findings) -> None:
    """Cards name tables and functions by their numbers in the same field."""
    given = line.at("number") if "number" in line else Number("", line.subject, "", "", line.place)
    if str(given.value) in map(str, tables):
        message = f"{given.value} is a table; functions and tables have numbers of their own"
        findings.error(line.subject, message, given.place, id="VSDF-100")


def _values(line: ElementLine, folder: Path, findings: Findings, tables: Any) -> Any:
    """Values that define a function, and where each part of it stands; None after a fault."""
    own = [one for one in line.numbers if one.key not in _OTHER_KEYS]
    ways = [key for key in ("file", "points") if key in line]
    if len(ways) + bool(own) != 1:
        message = "takes numbers, or file=" + ("" if tables is None else ", or points=")
        findings.error(line.subject, f"{line.kind} {message}, one of them", line.place, id="ELEMENTS-044")
        return None
    if own:
        numbers = _in_order(line, own, findings)
        return numbers and ([one.value for one in numbers], lambda k: numbers[k].place or line.place)
    if line.kind not in _OF_POINTS:
        message = f"{line.kind} takes numbers; files and cards TABL give points of a table or spline"
        findings.error(line.subject, message, line.at(ways[0]).place, id="ELEMENTS-043")
        return None
    in_file = numbers_of_file(line, folder, findings) if "file" in line else _of_table(line, tables, findings)
    return in_file and (in_file, lambda _: line.at(ways[0]).place)


def _in_order(line: ElementLine, own: list[Number], findings: Findings) -> list[Number] | None:
    """Numbers with keys in the order of a function's definition."""
    keys = POSITIONS.get(line.kind)
    if keys is None:
        return own
    missing = [key for key in keys if key not in line and key != _OPTIONAL]
    if missing:
        message = f"{line.kind} takes {' '.join(keys)}; {' and '.join(missing)} must be given"
        findings.error(line.subject, message, line.place, id="ELEMENTS-042")
        return None
    return [line.at(key) for key in keys if key in line]


def _of_table(line: ElementLine, tables: Any, findings: Findings) -> list[float] | None:
    place, count = line.at("points").place, line["points"]
    if not tables or count not in tables:
        why = "only VSDF decks have such tables" if tables is None else "cards TABL give some"
        findings.error(line.subject, f"there is no table {count}; {why}", place, id="VSDF-214")
        return None
    function = tables[count]  # None: it has a fault of its own
    return function and [x for point in zip(function.times, function.values, strict=True) for x in point]


def numbers_of_file(line: ElementLine, folder: Path, findings: Findings) -> list[float] | None:
    """The numbers of a text file, blanks, commas and line ends between them; # begins a comment."""
    place, values = line.at("file").place, []
    try:
        text = read_text(folder / line["file"], "table")
        for n, content in enumerate(text.lines, 1):
            for word in content.partition("#")[0].replace(",", " ").split():
                values.append(_number(word, f"line {n} of {line['file']}"))
    except DeckError as failed:
        findings.faults += [Fault(f.severity, f.message, place, line.subject, id=f.id) for f in failed.faults]
        return None
    except number.Misspelt as fault:
        findings.error(line.subject, str(fault), place, id="ELEMENTS-041")
        return None
    return values


def _number(word: str, where: str) -> float:
    try:
        return number.real(word)[0]
    except number.Misspelt as fault:
        raise number.Misspelt(f"{where} {fault}") from None


def name_of(value: Any) -> str:
    """Return the name of a function, which may be a number."""
    return value if isinstance(value, str) else f"{value:.15g}"
