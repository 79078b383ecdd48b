"""DAFMS decks read without flexmb: the records whose numbers a judge of results needs, by their columns.

The formats are those of decks/dafms/FORMAT.md (Zhao, thesis, appendix C); cards that are not read are named.
"""

import re
from dataclasses import dataclass

import numpy as np

# Records of one body each: number of reals behind its number.
BODIES = {"MASS": 1, "INER": 3, "PROD": 3, "RC(K": 3}
# Not read: they act on the motion, and most of them on its energies.
UNREAD = {
    "FORC", "TOQU", "DESN", "UNCO", "LOOP", "DAMP", "MOTR", "TABM", "TABL", "PRES", "ELDA", "NROT", "GSTF",
    "ELEM",
}  # fmt: skip
EXPONENT = re.compile(r"(?<=[\d.])(?:[eEdD]([-+]?)|([-+]))(?=\d)")


@dataclass(frozen=True)
class DafmsText:
    """A model: flags of its hinges, its elastic bodies, values by card and body, springs, gravity, rows."""

    translations: list[list[int]]
    rotations: list[list[int]]
    nodes: list[int]
    freedoms: list[int]
    rows: int
    interval: float
    elastic: dict[int, tuple[np.ndarray, np.ndarray, np.ndarray]]  # places along the body, stiffness, masses
    cards: dict[str, dict[int, list[float]]]
    springs: list[tuple[int, int, float, float]]
    gravity: np.ndarray
    unread: tuple[str, ...]


class _Lines:
    """Records in turn."""

    def __init__(self, text):
        self.lines, self.at = text.splitlines(), 0

    def next(self):
        """Return the next line."""
        self.at += 1
        return self.lines[self.at - 1]

    def integers(self, count):
        """Return a list in I5, ten a record."""
        found = []
        while len(found) < count:
            line = self.next()
            found += [_integer(line[5 * k : 5 * k + 5]) for k in range(min(10, count - len(found)))]
        return found

    def reals(self, count, width, each):
        """Return a list of reals in columns of that width, so many a record."""
        found = []
        while len(found) < count:
            line = self.next()
            places = range(min(each, count - len(found)))
            found += [_real(line[width * k : width * k + width]) for k in places]
        return found

    def record(self, integers, reals):
        """Return numbers of one record: integers in I5, then reals in F10.5."""
        line = self.next()
        found = [_integer(line[5 * k : 5 * k + 5]) for k in range(integers)]
        start = 5 * integers
        return found + [_real(line[start + 10 * k : start + 10 * k + 10]) for k in range(reals)]


def _integer(word):
    return int(word.replace(" ", "") or 0)


def _real(word):
    word = word.replace(" ", "")
    value = float(EXPONENT.sub(r"e\1\2", word) or 0)
    return value if "." in word else value * 1e-5


def read_dafms_text(text: str) -> DafmsText | None:
    """Return the first model of a deck; None where a column holds no number."""
    try:
        return _read(_Lines(text))
    except (ValueError, IndexError):
        return None


def _read(lines):
    count, dimension = lines.integers(2)
    while lines.next()[:4] != "DFMB":
        pass
    translations, rotations = ([lines.record(5, 0)[2:] for _ in range(count)] for _ in range(2))
    nodes, freedoms = lines.integers(count), lines.integers(count)
    (rows,), (interval,) = lines.integers(1), lines.reals(1, 10, 1)
    elastic = {
        k + 1: _block(lines, nodes[k], nodes[k] * freedoms[k], dimension) for k in range(count) if nodes[k]
    }
    cards, springs, gravity, unread = _cards(lines, count)
    head = (translations, rotations, nodes, freedoms, rows, interval, elastic)
    return DafmsText(*head, cards, springs, gravity, tuple(sorted(unread)))


def _block(lines, nodes, size, dimension):
    """Return places of the nodes, their stiffness matrix (skyline by columns) and masses."""
    places = np.zeros((nodes, 3))
    for k in range(1, nodes + 1):
        node, *place = lines.record(1, dimension)
        places[(node or k) - 1, 3 - dimension :] = place
    for _ in range(nodes):
        lines.next()  # constant forces: their work is that of a load
    lines.integers(1)
    lines.integers(size)
    diagonal = lines.integers(size)
    entries = lines.reals(diagonal[-1], 13, 6)
    stiffness, start = np.zeros((size, size)), 0
    for column, end in enumerate(diagonal):
        height = end - start
        stiffness[column + 1 - height : column + 1, column] = entries[start:end]
        stiffness[column, column + 1 - height : column + 1] = entries[start:end]
        start = end
    return places, stiffness, np.array(lines.reals(nodes, 10, 10))


def _cards(lines, count):
    cards, springs, gravity, unread = {}, [], np.array([0.0, 9.8, 0.0]), set()
    while (word := lines.next()[:4].strip()) != "END":
        if word in BODIES:
            read = [lines.record(1, BODIES[word]) for _ in range(count)]
            # The program reads records in their order; flexmb warns where their number is blank.
            cards[word] = {body or k: values for k, (body, *values) in enumerate(read, 1)}
        elif word == "GRAV":
            gravity = np.array(lines.record(1, 3)[1:])
        elif word == "SPRI":
            springs = [tuple(lines.record(2, 2)) for _ in range(lines.integers(1)[0])]
        elif word in UNREAD:
            unread.add(word)
    return cards, springs, gravity, unread
