"""Reader of the listing of a VSDF deck (`vsdf.py`): cards, bodies and frequencies, then the rows in time."""

import re
from dataclasses import dataclass, field

import numpy as np

from ...deck.fortran_format import Edit, I, P
from ...deck.fortran_words import is_unreadable, split_fields, unit_of, value_of
from ...deck.listing import EchoLine, Listing, ListingForm, Section, TableError
from ...errors import Fault, Place

_RULE = "*" * 20
_TIME, _ENERGY = re.compile(r"\s*TIME\s*="), re.compile(r"\s*ENERGY(?=[\s\d*+-])")
_FAILED = "THE RUN ENDED BEFORE THE LAST TIME"
FORM = ListingForm("listing of a VSDF deck", _FAILED)
_NUMBER = re.compile(
    r"(?<![\w.?])[-+]?([\d?]+\.?[\d?]*|\.[\d?]+)([ED][-+]?[\d?]{1,9})?(?![\w?])", re.IGNORECASE
)

_PLACE = ("point_position", "X Y Z"), ("point_velocity", "VX VY VZ")
_ENERGIES = (("energy", "KINETIC STRAIN GRAVITY SUM"),)
_NODE_EDITS = (I(10), I(8), *6 * (P(13, 5),))
_TIME_EDITS = (P(13, 5),)
_ENERGY_EDITS = 4 * (P(13, 5),)


@dataclass
class _Gathered:
    """The lines of one section while the file is read: place, row and spellings of the numbers."""

    lines: list[int] = field(default_factory=list)
    steps: list[int] = field(default_factory=list)
    words: list[list[str]] = field(default_factory=list)

    def add(self, line: int, step: int, words: list[str]) -> None:
        self.lines.append(line)
        self.steps.append(step)
        self.words.append(words)


def parse_vsdf(name: str, text: str) -> Listing | None:
    """The listing of a VSDF deck in `text`; None when it is none.

    Raises `TableError` with the place of every line that cannot be read.
    """
    lines = text.split("\n")
    if not lines[0].startswith(_RULE) or not any(line.startswith("VSDF") for line in lines[1:3]):
        return None
    scan = _Scan()
    for number, line in enumerate(lines, 1):
        scan.take(number, line)
    if scan.faults:
        raise TableError(name, scan.faults, lines)
    time = np.array([value_of(word) for word in scan.times])
    unit = max(map(unit_of, scan.times), default=1.0)
    sections = {"node": _nodes(scan.nodes), "energy": _section(scan.energies, _ENERGIES, _ENERGY_EDITS)}
    present = {title: section for title, section in sections.items() if len(section.line)}
    return Listing(name, tuple(scan.head), time, unit, present, scan.failed, FORM, tuple(scan.words))


class _Scan:
    """Sorts the lines into the head, times, nodes and energies."""

    def __init__(self) -> None:
        self.head: list[EchoLine] = []
        self.times: list[str] = []
        self.nodes, self.energies = _Gathered(), _Gathered()
        self.faults: list[Fault] = []
        self.words: list[tuple[int, str]] = []
        self.failed = False
        self._rules = 0

    def take(self, number: int, line: str) -> None:
        """Sort one line."""
        if match := _TIME.match(line):
            words = self._fields(number, line, match.end(), _TIME_EDITS)
            self.times += words
        elif _FAILED in line:
            self.failed = True
        elif not self.times:
            self._take_head(number, line)
        elif match := _ENERGY.match(line):
            self.energies.add(
                number, len(self.times) - 1, self._fields(number, line, match.end(), _ENERGY_EDITS)
            )
        elif line.strip():
            self.nodes.add(number, len(self.times) - 1, self._fields(number, line, 0, _NODE_EDITS))

    def _take_head(self, number: int, line: str) -> None:
        if line.startswith(_RULE):
            self._rules += 1
            return
        if any(character.isalpha() for character in line):
            self.words.append((number, " ".join(_NUMBER.sub("#", line).split())))
        words = [match[0] for match in _NUMBER.finditer(line)]
        if words:
            # Cards stand between the two rules, what became of the bodies behind them.
            kind = "modal" if self._rules > 1 else "echo"
            values, units = tuple(map(value_of, words)), tuple(map(unit_of, words))
            self.head.append(EchoLine(number, " ".join(line.split()), values, units, kind=kind))

    def _fields(self, number: int, line: str, start: int, edits: tuple[Edit, ...]) -> list[str]:
        words = split_fields(line[start:], edits)
        if words is None or _is_nameless(words, edits) or (edits is _TIME_EDITS and is_unreadable(words[0])):
            sentence = f"{len(edits)} numbers are expected, read {line[start:].strip()!r}"
            self.faults.append(
                Fault("error", sentence, Place(number, start + 1, max(1, len(line) - start)), id="VSDF-087")
            )
            return ["0"] * len(edits)
        return words


def _is_nameless(words: list[str], edits: tuple[Edit, ...]) -> bool:
    """Return whether stars or `?` stand where the number of a body or node is wanted."""
    return any(edit.kind == "d" and set(word) & {"*", "?"} for word, edit in zip(words, edits, strict=True))


def _nodes(gathered: _Gathered) -> Section:
    numbers = [(int(words[0]), int(words[1])) for words in gathered.words]
    places = {pair: k for k, pair in enumerate(dict.fromkeys(numbers), 1)}
    rest = _Gathered(gathered.lines, gathered.steps, [words[2:] for words in gathered.words])
    labels = {k: f"body {body} node {node}" for (body, node), k in places.items()}
    return _section(rest, _PLACE, _NODE_EDITS[2:], [places[pair] for pair in numbers], labels)


def _section(
    gathered: _Gathered,
    groups: tuple[tuple[str, str], ...],
    edits: tuple[Edit, ...],
    index: list[int] | None = None,
    labels: dict[int, str] | None = None,
) -> Section:
    shape = (len(gathered.words), len(edits))
    return Section(
        tuple(column for _, columns in groups for column in columns.split()),
        tuple(kind for kind, columns in groups for _ in columns.split()),
        np.array(gathered.steps, dtype=np.int64),
        np.array(index or np.ones(shape[0]), dtype=np.int64),
        np.array(gathered.lines, dtype=np.int64),
        np.array([[value_of(word) for word in words] for words in gathered.words]).reshape(shape),
        np.array([[unit_of(word) for word in words] for words in gathered.words]).reshape(shape),
        "",
        edits,
        labels or {},
    )
