"""Reader of the block ELEMENTS: lines `WORD name key=value ...` to records, with all faults placed.

A fault names the line's element, and what stands there; messages of unknown words and keys name the nearest.
"""

import re
from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass, field
from typing import Any

from ...deck import number
from ...deck.expansion.expressions import FORMULA
from ...deck.record import Lines, Number
from ...deck.units import UNITS as SYSTEMS
from ...deck.words import Word
from ...errors import Fault, FaultList, Place
from ...model.laws import VECTOR
from .line import EQUILIBRIUM, MASS, MOST_ELEMENTS, OUTPUT, SECTION, UNITS, ElementLine
from .text import BLOCK, statements
from .words import (
    AXIS,
    BY_WORD,
    COORDINATE,
    END,
    FILE,
    FUNCTION,
    NUMBER,
    NUMBERS,
    OUTPUTS,
    POINT,
    POSITIONS,
    SIGNALS,
    STL,
    WHOLE,
    BlockWord,
    Key,
    usage,
)

MOST_NUMBERS_OF_BLOCKS = 200_000  # of the blocks of a deck; longer tables stand in files
NAME = re.compile(r"[A-Za-z0-9_-]+")
COORDINATES = re.compile(r"([0-9]{1,9})\.(angle[12]?|stroke|[rt][1-3])", re.IGNORECASE)
_SIGNAL = re.compile(r"[A-Za-z0-9_-]+(?:\.[A-Za-z0-9]+){0,2}")
_NUMBER = re.compile(r"[-+]?\.?[0-9][0-9.eEdD+-]*")
_END_AT_POINT = re.compile(r"([0-9]{1,9})(?:-([0-9]{1,9}))?\(([^()]*)\)")
_END_AT_NODE = re.compile(r"([0-9]{1,9})(?:-([0-9]{1,9}))?:([0-9]{1,9})(?:-([0-9]{1,9}))?")
_MEANINGS = {
    "mean": ("mean value", ""),
    "amplitude": ("amplitude", ""),
    "omega": ("angular frequency", "rad/s"),
    "phase": ("phase at t = 0", "rad"),
    "start": ("time up to which the first value holds", "s"),
    "from": ("first value", ""),
    "end": ("time from which the last value holds", "s"),
    "to": ("last value", ""),
    "t": ("time of a point", "s"),
    "v": ("value there", ""),
    "c": ("coefficient of the next power of time", ""),
    "f": ("name of a function above", ""),
}
_OF_VALUES = {"table": "tv", "spline": "tv", "periodic": "tv", "polynomial": "c", "sum": "f", "product": "f"}


class _Wrong(ValueError):
    """The text is not what is wanted there."""


@dataclass
class BlockReader:
    """Reads the blocks of a deck; `code` gives lines without comments, `reserved` names are no elements'."""

    lines: Lines
    code: Callable[[Lines, int], Iterator[str]]
    reserved: Iterable[str] = ()
    records: list[ElementLine] = field(default_factory=list)
    faults: list[Fault] = field(default_factory=FaultList)
    numbers: int = 0

    def __post_init__(self) -> None:
        self._first: dict[str, ElementLine] = {}  # by their names in small letters
        self._reserved = frozenset(name.partition(".")[0].lower() for name in self.reserved)

    def read(self, opening: int) -> int:
        """Read the block that line `opening` opens; return the number of the line that ends it."""
        end_line = opening + 1
        for words, end in statements(self.code(self.lines, opening), opening + 1):
            end_line = end
            if len(self.records) >= MOST_ELEMENTS or self.numbers > MOST_NUMBERS_OF_BLOCKS:
                self._error(
                    words[0] if words else Word(BLOCK, opening, 1), "", self._too_many(), id="ELEMENTS-047"
                )
                return len(self.lines) + 1
            if words:
                self._read_line(words)
        return end_line

    def _too_many(self) -> str:
        if self.numbers > MOST_NUMBERS_OF_BLOCKS:
            most = MOST_NUMBERS_OF_BLOCKS
            return f"the deck has more than {most} numbers in blocks; long tables stand in file="
        return f"a deck has at most {MOST_ELEMENTS} functions and elements"

    def _error(
        self, word: Word, subject: str, message: str, column: int = 0, width: int = 0, *, id: str
    ) -> None:
        place = Place(word.line, column or word.column, width or len(word.text))
        self.faults.append(Fault("error", message, place, subject, id=id))

    def _read_line(self, words: list[Word]) -> None:
        first, *rest = words
        word = BY_WORD.get(first.text.upper())
        if word is None:
            hint = nearest(first.text.upper(), BY_WORD, "a line begins with")
            message = f"there is no {number.shown(first.text)} in {BLOCK}{hint}"
            self._error(first, "", message, id="ELEMENTS-048")
            return
        if word.word == OUTPUT and self._read_formula(word, first, rest):
            return
        lone = next((piece for piece in words if piece.text in "()"), None)
        if lone is not None:
            self._error(lone, "", "each parenthesis is closed on the line where it opens", id="ELEMENTS-049")
            return
        name, rest = self._name(word, first, rest)
        kind, rest = self._kind(word, first, name, rest)
        if name and (kind or not word.kinds):
            line = _Line(self, word, first, name, kind)
            line.read(rest)
            self._keep(line)

    def _read_formula(self, word: BlockWord, first: Word, rest: list[Word]) -> bool:
        """Read `OUTPUT name = formula`; return whether the line is one."""
        text = ""
        for piece in rest:
            # Blanks stay, so that places do.
            text = text.ljust(piece.column - rest[0].column if piece.line == rest[0].line else len(text) + 1)
            text += piece.text
        name, equals, spelled = text.partition("=")
        if not equals or len(name.split()) != 1:
            return False
        start = len(text) - len(spelled.lstrip())
        line = _Line(self, word, first, name.strip(), FORMULA)
        piece = Word(spelled.strip(), rest[0].line, rest[0].column + start)
        if self._is_name(word, Word(line.name, rest[0].line, rest[0].column)):
            line.take_formula(piece)
            self._keep(line)
        return True

    def _name(self, word: BlockWord, first: Word, rest: list[Word]) -> tuple[str, list[Word]]:
        """The name of an element and the pieces after it; "" after a fault."""
        if word.kinds and len(rest) > 1 and rest[0].text.lower() in word.kinds and "=" not in rest[1].text:
            rest = [rest[1], rest[0], *rest[2:]]  # JOINT revcyl name, as well as JOINT name revcyl
        if not rest or "=" in rest[0].text:
            if word.unnamed:
                count = sum(record.word == word.word for record in self.records)
                return f"{word.word.lower()}-{count + 1}", rest
            self._error(first, "", f"{word.word} wants a name: {usage(word)}", id="ELEMENTS-050")
            return "", rest
        name = rest[0].text
        if not self._is_name(word, rest[0]):
            return "", rest[1:]
        return name, rest[1:]

    def _is_name(self, word: BlockWord, piece: Word) -> bool:
        name = piece.text
        if not NAME.fullmatch(name):
            message = f"a name is of letters, digits, _ and -; read {number.shown(name)}"
        elif name.isdigit() and word.word != "FUNCTION":
            message = f"{name} is a number, which names functions only; begin the name with a letter"
        elif word.word == UNITS and name.lower() not in SYSTEMS:
            message = f"UNITS is followed by one of {', '.join(SYSTEMS)}; read {number.shown(name)}"
        elif word.word == UNITS and any(record.word == UNITS for record in self.records):
            message = "the deck has said its units already; remove one of the lines"
        elif name.lower() in self._reserved:
            message = f"{name} names numbers of the deck; take another name"
        elif name.lower() in self._first:
            other = self._first[name.lower()]
            line = other.begins.line if other.begins else 0
            message = f"{other.subject} on line {line} has this name; take another"
        else:
            return True
        self._error(piece, word.word, message, id="ELEMENTS-051")
        return False

    def _kind(self, word: BlockWord, first: Word, name: str, rest: list[Word]) -> tuple[str, list[Word]]:
        if not word.kinds or not name:
            return "", rest
        if rest and rest[0].text.lower() in word.kinds:
            return rest[0].text.lower(), rest[1:]
        piece = rest[0] if rest else first
        rest_of_line = f"; read {number.shown(piece.text)}" if rest else ""
        message = f"{word.word} name is followed by {_listed(word.kinds)}{rest_of_line}"
        self._error(piece, name, message, id="ELEMENTS-052")
        return "", rest

    def _keep(self, line: "_Line") -> None:
        record = line.record(len(self.records) + 1)
        self.numbers += len(record.numbers)
        self._first[record.subject.lower()] = record
        self.records.append(record)


class _Line:
    """One element as it is read."""

    def __init__(self, reader: BlockReader, word: BlockWord, first: Word, name: str, kind: str):
        self.reader, self.word, self.first, self.name, self.kind = reader, word, first, name, kind
        self.given: dict[str, list[Number]] = {}
        self.turning = False
        self.values = 0

    def record(self, count: int) -> ElementLine:
        """Return the record of all that was read, with defaults for what was not."""
        place, numbers = self.first.place, [*self.given.pop("", ())]
        for key in self.word.keys:
            numbers += self.given.pop(key.name, self._default(key))
        numbers += [number for group in self.given.values() for number in group]
        fields = SECTION, count, self.name, tuple(self._in_units(numbers))
        return ElementLine(*fields, self.word.word, self.kind, place)

    def _in_units(self, numbers: list[Number]) -> Iterator[Number]:
        """Give numbers the units of an angle where the element acts on one."""
        units = {key.name: key.units[self.turning] for key in self.word.keys}
        for one in numbers:
            unit = units.get(one.key, one.unit)
            yield Number(one.key, one.value, one.meaning, unit, one.place, one.text)

    def _default(self, key: Key) -> list[Number]:
        if key.default is None:
            return []
        if key.kind != VECTOR:
            return [Number(key.name, key.default, key.meaning, "", self.first.place)]
        parts = zip("xyz", key.default, strict=True)
        return [
            Number(f"{key.name}.{axis}", x, f"{key.meaning}, {axis}", key.units[0], self.first.place)
            for axis, x in parts
        ]

    def error(self, piece: Word, message: str, offset: int = 0, *, id: str) -> None:
        """Report what is wrong in a piece, from a character on."""
        width = max(1, len(piece.text) - offset)
        self.reader._error(piece, self.name, message, piece.column + offset, width, id=id)

    def read(self, pieces: list[Word]) -> None:
        """Take the pieces after name and type."""
        for piece in pieces:
            key, equals, text = piece.text.partition("=")
            if not equals:
                self._take_value(piece)
            elif not key or not text:
                message = f"no blank may stand beside '=', and a value follows it: {usage(self.word)}"
                self.error(piece, message, id="ELEMENTS-053")
            else:
                self._take_key(piece, key, text)
        self._check_complete()

    def take_formula(self, piece: Word) -> None:
        """Take the formula of an output."""
        # Few decks have any.
        from ...deck.expansion.expressions import WrongFormula, formula

        try:
            formula(piece.text)
        except WrongFormula as fault:
            self.error(piece, f"this is not a formula: {fault}", fault.offset, id="ELEMENTS-180")
        meaning = OUTPUTS[FORMULA][0]
        self.given[""] = [Number(FORMULA, piece.text, meaning, "", piece.place, piece.text)]

    def _take_value(self, piece: Word) -> None:
        """Take a number of a function, or a name of those that it combines."""
        if self.word.word == "SIGNAL" and self.kind in ("sum", "product"):
            self._take_term(piece)
            return
        if not self.kind or self.word.word != "FUNCTION":
            message = f"{number.shown(piece.text)} belongs to no key: {usage(self.word)}"
            self.error(piece, message, id="ELEMENTS-054")
            return
        positions = POSITIONS.get(self.kind)
        keys = _OF_VALUES.get(self.kind, "")
        if positions:
            if self.values >= len(positions):
                message = f"{self.kind} takes {' '.join(positions)}; this is one number too many"
                self.error(piece, message, id="ELEMENTS-055")
                return
            key = meaning = positions[self.values]
        else:
            meaning = keys[self.values % len(keys)]
            key = f"{meaning}{self.values // len(keys) + 1}"
        self.values += 1
        self._add("", piece, key, _MEANINGS[meaning], FUNCTION if meaning == "f" else NUMBER, piece.text)

    def _take_term(self, piece: Word) -> None:
        """Take a term of a sum, 0.8, 2.angle, -u or 0.5*u, or a factor of a product, 0.8, u or /u."""
        self.values += 1
        text, count = piece.text, self.values
        if _NUMBER.fullmatch(text):
            self._add_parts("", piece, [(f"c{count}", "constant", NUMBER, text, 0)])
            return
        factor, star, name = text.rpartition("*")
        if self.kind == "product":
            name, share = text.removeprefix("/"), "-1" if text.startswith("/") else "1"
            of_name = (f"power{count}", "power of the next signal", NUMBER, share, 0)
        else:
            if not star and name[:1] in ("+", "-"):
                factor, name = name[:1], name[1:]
            share = f"{factor}1" if factor in ("", "+", "-") else factor
            of_name = (f"factor{count}", "factor of the next signal", NUMBER, share, 0)
        signal = (f"term{count}", "signal", SIGNALS, name, len(text) - len(name))
        self._add_parts("", piece, [of_name, signal])

    def _take_list(self, piece: Word, key: Key, text: str, offset: int) -> None:
        """Take numbers or signals, (1,2,3), or a single one without parentheses."""
        inside = text[1:-1] if text.startswith("(") and text.endswith(")") else text
        first, kind = offset + (inside != text), NUMBER if key.kind == NUMBERS else key.kind
        items = enumerate(re.finditer(r"[^\s,]+", inside), 1)
        parts = [(f"{key.name}.{k}", key.meaning, kind, part[0], first + part.start()) for k, part in items]
        self.given[key.name] = []
        self._add_parts(key.name, piece, parts)
        if not parts:
            self.error(piece, f"{key.name} has no {key.kind}", offset, id="ELEMENTS-080")

    def _add_parts(self, group: str, piece: Word, parts: Iterable[tuple[str, str, str, str, int]]) -> None:
        """Add numbers and signals of a piece: key, meaning, type, text and where it begins."""
        for part, meaning, kind, text, offset in parts:
            self._add(group, piece, part, (meaning, ""), kind, text, offset)

    def _add(
        self, group: str, piece: Word, key: str, label: Any, kind: str, text: str, offset: int = 0
    ) -> None:
        try:
            value = self._value(kind, text)
        except (number.Misspelt, _Wrong) as fault:
            self.error(piece, f"{key} {fault}", offset, id="ELEMENTS-056")
            value = "" if kind in (FUNCTION, FILE, COORDINATE, SIGNALS, AXIS) else 0
        place = Place(piece.line, piece.column + offset, len(text))
        meaning, unit = label
        self.given.setdefault(group, []).append(Number(key, value, meaning, unit, place, text))

    def _value(self, kind: str, text: str) -> Any:
        if kind in (NUMBER, WHOLE, VECTOR):
            value, warning = number.integer(text) if kind == WHOLE else number.real(text)
            if warning:
                raise _Wrong(warning)
            return value
        if kind == FUNCTION and not NAME.fullmatch(text):
            raise _Wrong(f"must be the name of a function; read {number.shown(text)}")
        if kind == SIGNALS and not _SIGNAL.fullmatch(text):
            raise _Wrong(f"must be a signal, such as u, 2.angle or 2.angle.rate; read {number.shown(text)}")
        if kind == AXIS and text.lower() not in ("x", "y", "z"):
            raise _Wrong(f"must be x, y or z; read {number.shown(text)}")
        if kind == COORDINATE and not COORDINATES.fullmatch(text):
            raise _Wrong(
                f"must be a coordinate, such as 2.angle, 2.stroke, 3.r1 or 3.t2; read {number.shown(text)}"
            )
        return text.lower() if kind == COORDINATE else text

    def _take_key(self, piece: Word, name: str, text: str) -> None:
        offset = len(name) + 1
        if self.word.word == "COUPLING" and COORDINATES.fullmatch(name):
            name = name.lower()
            key: Key | None = Key(name, "factor of this coordinate in the sum")
        else:
            name = name.lower()
            key = self.word.key(name) or self._of_position(name)
        if key is None:
            keys = [*(one.name for one in self.word.keys), *POSITIONS.get(self.kind, ())]
            message = f"{self.word.word} has no key {number.shown(name)}{nearest(name, keys, 'it has')}"
            self.error(piece, message, id="ELEMENTS-057")
            return
        if name in self.given:
            self.error(piece, f"{name} is given twice; remove one", id="ELEMENTS-058")
            return
        if key.kind == END:
            self._take_end(piece, key, text, offset)
        elif key.kind in (NUMBERS, SIGNALS):
            self._take_list(piece, key, text, offset)
        elif key.kind == VECTOR:
            self._take_vector(piece, key, text, offset)
        else:
            self._add(name, piece, name, (key.meaning, key.units[0]), key.kind, text, offset)
            if key.kind == COORDINATE and name != "from":  # a cam's, whose follower has the units
                self.turning = is_turning(text)

    def _of_position(self, name: str) -> Key | None:
        """Return the key of a number of a function that may stand by its place, too."""
        if name not in POSITIONS.get(self.kind, ()):
            return None
        meaning, unit = _MEANINGS[name]
        return Key(name, meaning, units=(unit, unit))

    def _take_end(self, piece: Word, key: Key, text: str, offset: int) -> None:
        node, point = _END_AT_NODE.fullmatch(text), _END_AT_POINT.fullmatch(text)
        if body := node or point:
            self._part(piece, key, "body", body[1], offset, ("number of the body, 0: the ground", ""))
            if body[2]:
                self._part(piece, key, "last", body[2], offset + body.start(2), ("last body of many", ""))
        if node:
            self._part(piece, key, "node", node[3], offset + node.start(3), ("number of the node", ""))
            if node[4]:
                self._part(
                    piece, key, "last_node", node[4], offset + node.start(4), ("last node of many", "")
                )
        elif point:
            self._take_components(
                piece, key, point[3], offset + point.start(3), ("its point in body axes", "m")
            )
        else:
            message = f"{key.name} must be body(x,y,z) or body:node; read {number.shown(text)}"
            self.error(piece, message, offset, id="ELEMENTS-059")
            self.given[key.name] = []

    def _take_vector(self, piece: Word, key: Key, text: str, offset: int) -> None:
        if not (text.startswith("(") and text.endswith(")")):
            message = f"{key.name} must be (x,y,z); read {number.shown(text)}"
            self.error(piece, message, offset, id="ELEMENTS-060")
            self.given[key.name] = []
            return
        self._take_components(piece, key, text[1:-1], offset + 1, (key.meaning, key.units[0]))

    def _take_components(self, piece: Word, key: Key, text: str, offset: int, label: tuple[str, str]) -> None:
        components = list(re.finditer(r"[^\s,]+", text))
        if len(components) != 3 or text.count(",") not in (0, 2):
            message = f"{key.name} takes three numbers (x,y,z); read {number.shown(text)}"
            self.error(piece, message, offset, id="ELEMENTS-061")
            self.given[key.name] = []
            return
        for axis, part in zip("xyz", components, strict=True):
            self._part(piece, key, axis, part[0], offset + part.start(), (f"{label[0]}, {axis}", label[1]))

    def _part(self, piece: Word, key: Key, name: str, text: str, offset: int, label: tuple[str, str]) -> None:
        kind = WHOLE if name in ("body", "last", "node", "last_node") else NUMBER
        self._add(key.name, piece, f"{key.name}.{name}", label, kind, text, offset)

    def _check_complete(self) -> None:
        missing = [key.name for key in self.word.keys if key.needed and key.name not in self.given]
        at_rest = self.word.word == "START" and self.name.lower() == EQUILIBRIUM and not self.given
        if missing and not at_rest:
            message = f"{' and '.join(missing)} must be given: {usage(self.word)}"
            self.error(self.first, message, id="ELEMENTS-062")
        if self.word.word == OUTPUT:
            self._check_output()
        if self.word.word == MASS:
            self._check_solid()
        for groups in self.word.choices:
            complete = [group for group in groups if all(key in self.given for key in group)]
            some = [group for group in groups if any(key in self.given for key in group)]
            if len(complete) != 1 or len(some) != 1:
                ways = " or ".join(" and ".join(f"{key}=" for key in group) for group in groups)
                self.error(self.first, f"either {ways} must be given: {usage(self.word)}", id="ELEMENTS-063")

    def _check_solid(self) -> None:
        """Check that a mass has the keys of its type, and no other."""
        required = {POINT: (), STL: ("file",)}.get(self.kind, ("size",))
        others = ("size", "file", "unit", "density", "angles") if self.kind == POINT else ("size", "file")
        if wrong := [key for key in others if (key in self.given) != (key in required)]:
            message = f"{self.kind} takes {' and '.join(required) or 'mass'}=; correct {' and '.join(wrong)}"
            self.error(self.first, message, id="ELEMENTS-189")

    def _check_output(self) -> None:
        """Check that an output has the keys of its type, and no other."""
        required = OUTPUTS[self.kind][3]
        if wrong := [key for key in ("from", "to", "body") if (key in self.given) != (key in required)]:
            which = " and ".join(f"{key}=" for key in required)
            message = f"{self.kind} takes {which}, and axes=; correct {' and '.join(wrong)}"
            self.error(self.first, message, id="ELEMENTS-181")
        nodes = [n for key in required for n in self.given.get(key, ()) if n.key.endswith(".node")]
        for node in nodes:
            message = f"an output is of a point of a body; write {node.key.partition('.')[0]}=body(x,y,z)"
            self.error(self.first, message, id="ELEMENTS-182")


def is_turning(coordinate: str) -> bool:
    """Return whether the spelling of a coordinate names an angle."""
    kind = coordinate.rpartition(".")[2].lower()
    return kind.startswith(("angle", "r"))


def nearest(word: str, known: Iterable[str], all_of_them: str) -> str:
    """Return what may have been meant, or what there is."""
    from difflib import get_close_matches

    names = list(known)
    close = get_close_matches(word, names, n=1, cutoff=0.5)
    if close:
        return f"; is {close[0]} meant?"
    return f"; {all_of_them} {_listed(names)}" if names else ""


def _listed(words: Iterable[str]) -> str:
    *others, last = words
    return f"{', '.join(others)} or {last}" if others else last
