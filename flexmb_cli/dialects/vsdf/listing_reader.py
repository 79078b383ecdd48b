"""Reader of the listing of a VSDF deck (`vsdf.py`): cards, bodies and frequencies, then the rows in time."""

import re

import numpy as np

from ...deck.edit import Edit
from ...deck.fortran_words import is_unreadable, split_fields, unit_of, value_of
from ...deck.listing import EchoLine, Listing, ListingForm, Rows, TableError
from ...errors import Fault, Place
from .listing import ENERGY_FIELDS, FAILED, NODE_FIELDS, TIME_FIELDS

_RULE = "*" * 20
_TIME, _ENERGY = re.compile(r"\s*TIME\s*="), re.compile(r"\s*ENERGY(?=[\s\d*+-])")
FORM = ListingForm("listing of a VSDF deck", FAILED)
_NUMBER = re.compile(
    r"(?<![\w.?])[-+]?([\d?]+\.?[\d?]*|\.[\d?]+)([ED][-+]?[\d?]{1,9})?(?![\w?])", re.IGNORECASE
)

_NODE = ("point_position", "X,Y,Z"), ("point_velocity", "VX,VY,VZ")
_ENERGIES = (("energy", "KINETIC,STRAIN,GRAVITY,SUM"),)


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
    labels = {k: f"body {body} node {node}" for (body, node), k in scan.places.items()}
    sections = {
        "node": scan.nodes.section(_NODE, NODE_FIELDS[2:], labels=labels),
        "energy": scan.energies.section(_ENERGIES, ENERGY_FIELDS),
    }
    present = {title: section for title, section in sections.items() if len(section.line)}
    return Listing(name, tuple(scan.head), time, unit, present, scan.failed, FORM, tuple(scan.words))


class _Scan:
    """Sorts the lines into the head, times, nodes and energies."""

    def __init__(self) -> None:
        self.head: list[EchoLine] = []
        self.times: list[str] = []
        self.nodes, self.energies = Rows(), Rows()
        self.places: dict[tuple[int, int], int] = {}  # numbers of bodies and nodes, in their order
        self.faults: list[Fault] = []
        self.words: list[tuple[int, str]] = []
        self.failed = False
        self._rules = 0

    def take(self, number: int, line: str) -> None:
        """Sort one line."""
        if match := _TIME.match(line):
            words = self._fields(number, line, match.end(), TIME_FIELDS)
            self.times += words
        elif FAILED in line:
            self.failed = True
        elif not self.times:
            self._take_head(number, line)
        elif match := _ENERGY.match(line):
            words = self._fields(number, line, match.end(), ENERGY_FIELDS)
            self.energies.add(number, len(self.times) - 1, words)
        elif line.strip():
            body, node, *words = self._fields(number, line, 0, NODE_FIELDS)
            index = self.places.setdefault((int(body), int(node)), len(self.places) + 1)
            self.nodes.add(number, len(self.times) - 1, words, index)

    def _take_head(self, number: int, line: str) -> None:
        if line.startswith(_RULE):
            self._rules += 1
            return
        if any(character.isalpha() for character in line):
            self.words.append((number, " ".join(_NUMBER.sub("#", line).split())))
        words = [match[0] for match in _NUMBER.finditer(line)]
        if words:
            # Cards stand between the two rules, what became of the bodies after them.
            kind = "modal" if self._rules > 1 else "echo"
            values, units = tuple(map(value_of, words)), tuple(map(unit_of, words))
            self.head.append(EchoLine(number, " ".join(line.split()), values, units, kind=kind))

    def _fields(self, number: int, line: str, start: int, edits: tuple[Edit, ...]) -> list[str]:
        words = split_fields(line[start:], edits)
        if words is None or _is_nameless(words, edits) or (edits is TIME_FIELDS and is_unreadable(words[0])):
            sentence = f"{len(edits)} numbers are expected, read {line[start:].strip()!r}"
            self.faults.append(
                Fault("error", sentence, Place(number, start + 1, max(1, len(line) - start)), id="VSDF-087")
            )
            return ["0"] * len(edits)
        return words


def _is_nameless(words: list[str], edits: tuple[Edit, ...]) -> bool:
    """Return whether stars or `?` stand where the number of a body or node is wanted."""
    return any(edit.kind == "d" and set(word) & {"*", "?"} for word, edit in zip(words, edits, strict=True))
