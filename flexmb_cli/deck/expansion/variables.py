"""Variables of a deck in the places of its numbers: `$b`, or a formula `$(a/2)`; `$$` is a dollar.

In free text the value has all its digits.  In cards read by columns the other columns stay: the value ends
where the variable ends, takes blanks to its left, then to its right, and is at most ten columns wide; the
digits that do not fit are computed with all the same.
"""

import re
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import replace

from ...errors import DeckError, Fault, Place
from ..fortran_fields import filled
from ..number import Misspelt, real
from ..record import Deck, DeckText, Number
from .expressions import FORMULA, Formula, WrongFormula, evaluated, formula
from .includes import code_lines, unread, with_text
from .origins import Expansion, Piece

WIDEST = 10  # columns of a field
ROUNDED = 1e-6  # of the value: digits that do not fit
_USE = re.compile(r"\$\$|(?:(?<![\w.])(?P<sign>[+-]))?\$(?:(?P<name>[A-Za-z_]\w*)|(?P<open>\())")
_BLOCK = re.compile(r"ELEMENTS\s*", re.IGNORECASE)


def with_variables(source: DeckText, by_columns: bool, changes: Iterable[str]) -> DeckText:
    """Return the text with the values of its variables; `changes` ("NAME=VALUE") may give some other values.

    `by_columns`: the dialect reads cards by columns.  Faults are added to those of the expansion.
    """
    assert source.expansion is not None, "it begins with a statement"
    pairs = (change.partition("=") for change in changes)
    chosen = {name.strip(): word.strip() for name, _, word in pairs}
    variables = source.expansion.definitions
    writer = _Writer(source.expansion, {name: word for name, word in chosen.items() if name in variables})
    in_block, lines = False, []
    for number, (text, code) in enumerate(code_lines(source, source.expansion), 1):
        if code.strip() and not code[0].isspace():
            in_block = bool(_BLOCK.fullmatch(code))
        # A comma makes a card one of free form.
        aligned = by_columns and not in_block and "," not in re.sub(r"\$\([^()]*\)", "", code)
        lines.append(writer.line(number, text, code, aligned) if "$" in code else text)
    expansion = replace(
        source.expansion,
        values=writer.values,
        pieces=tuple(writer.pieces),
        faults=(*source.expansion.faults, *writer.faults),
    )
    return with_text(source, "\n".join(lines), expansion)


class _Writer:
    """The values of the variables, and the pieces of text written so far."""

    def __init__(self, expansion: Expansion, chosen: Mapping[str, str]):
        self.faults: list[Fault] = []
        self.pieces: list[Piece] = []
        self.values: dict[str, float] = {}
        numbers: dict[str, float] = {}
        for name, word in chosen.items():
            try:
                numbers[name] = real(word)[0]
            except Misspelt as fault:
                self.faults.append(Fault("error", f"--set {name}={word}: a variable {fault}", id="DECK-088"))
                numbers[name] = 0.0
        for name, value in evaluated(dict(expansion.definitions), numbers):
            if isinstance(value, str):
                self.faults.append(
                    Fault("error", f"the variable {name} {value}", expansion.places[name], id="DECK-089")
                )
                value = 1.0
            self.values[name] = value
        self.definitions = expansion.definitions

    def line(self, number: int, text: str, code: str, aligned: bool) -> str:
        """Return a line with values in the places of its variables."""
        written, end = "", 0
        for use in _uses(code):
            start, stop, inside = use
            if start < end:
                continue
            written += text[end:start]
            end = stop
            if inside == "$":
                written += "$"
                continue
            parsed = self._formula(number, start, text, inside)
            if parsed is None:
                written += text[start:stop]
                continue
            value = float(parsed.value(self.values.__getitem__))
            if aligned:
                room = len(text[stop:]) - len(text[stop:].lstrip(" ")) if text[stop:].strip() else WIDEST
                written, spelled, end = self._fitted(number, value, written, stop, stop - start, room)
            else:
                spelled = _spelled(value)
            self.pieces.append(
                Piece(number, len(written) + 1, spelled, start + 1, stop - start, parsed, aligned)
            )
            written += spelled
        return written + text[end:]

    def _formula(self, number: int, start: int, text: str, inside: str) -> Formula | None:
        """Return the formula of a variable, None where it is wrong."""
        place = Place(number, start + 1, max(1, len(inside)))
        try:
            parsed = formula(inside)
        except WrongFormula as fault:
            message = f"this is not a formula: {fault}"
            self.faults.append(Fault("error", message, place, inside, id="DECK-090"))
            return None
        unknown = [name for name in parsed.names if name not in self.definitions]
        if unknown:
            names = ", ".join(self.definitions) or "none"
            message = f"no line SET defines {unknown[0]}; the deck has {names}"
            self.faults.append(Fault("error", message, place, id="DECK-091"))
            return None
        value = float(parsed.value(self.values.__getitem__))
        if not abs(value) < float("inf"):
            message = f"is {value}, which no deck may hold"
            self.faults.append(Fault("error", message, place, inside, id="DECK-092"))
            return None
        return parsed

    def _fitted(
        self, number: int, value: float, written: str, stop: int, width: int, right: int
    ) -> tuple[str, str, int]:
        """Return the line before a value, the value in its columns, and where the line continues."""
        whole = _spelled(value, point=True)
        columns = min(max(len(whole), width), WIDEST)
        left = min(len(written) - len(written.rstrip(" ")), columns - width) if columns > width else 0
        right = min(right, max(0, columns - width - left))
        room = width + left + right
        spelled = whole if len(whole) <= room else filled(value, room)
        if not spelled or abs(float(spelled) - value) > ROUNDED * abs(value):
            message = f"{whole} needs more than {room} columns; write it at the right end of its columns"
            self.faults.append(Fault("error", message, Place(number, stop - width + 1, width), id="DECK-093"))
            spelled = "0."
        before = written[: len(written) - left]
        # At the right end of what it takes, as cards have it.
        return before + " " * (room - len(spelled)), spelled, stop + right


def _valueless(name: str, why: str, expansion: Expansion) -> Fault:
    return Fault("error", f"the variable {name} {why}", expansion.places[name], id="DECK-089")


def _uses(code: str) -> Iterator[tuple[int, int, str]]:
    """Yield begin and end of the variables in a line, and the formula there, "$" for a dollar."""
    for match in _USE.finditer(code):
        if match[0] == "$$":
            yield match.start(), match.end(), "$"
            continue
        stop = _closing(code, match.end()) if match["open"] else match.end()
        inside = code[match.start("open") : stop] if match["open"] else match["name"]
        yield match.start(), stop, f"{match['sign'] or ''}{inside}"


def _closing(code: str, start: int) -> int:
    """Return where the parenthesis that is open ends."""
    depth = 1
    for place in range(start, len(code)):
        depth += (code[place] == "(") - (code[place] == ")")
        if depth == 0:
            return place + 1
    return len(code)


def _spelled(value: float, point: bool = False) -> str:
    """Return a number with all its digits; `point`: with a decimal point in any case."""
    if value.is_integer() and abs(value) < 1e15:
        return f"{int(value)}{'.' * point}"
    return repr(value)


def wanted_whole(source: DeckText, faults: tuple[Fault, ...]) -> DeckText | None:
    """Return the text with whole numbers where a reader wants some, by its faults; None for no change.

    In cards read by columns numbers have a decimal point, which a field of integers refuses.
    """
    assert source.expansion is not None, "it has variables"
    refused = {fault.place[:2] for fault in faults if fault.place and "integer" in fault.message}
    lines, pieces = source.text.split("\n"), []
    for piece in source.expansion.pieces:
        line, first, last = piece.line - 1, piece.column - 1, piece.column - 1 + len(piece.text)
        there = lines[line][first:last] == piece.text  # not in another model, whose lines are blank
        if there and piece.aligned and piece.text[-1] == "." and (piece.line, piece.column) in refused:
            lines[line] = f"{lines[line][: last - 1]} {lines[line][last:]}"
            piece = piece._replace(text=piece.text[:-1])
        pieces.append(piece)
    if tuple(pieces) == source.expansion.pieces:
        return None
    return with_text(source, "\n".join(lines), replace(source.expansion, pieces=tuple(pieces)))


def bound(deck: Deck) -> Deck:
    """Return the deck with all digits of its variables, and with the formulas of its numbers.

    Raises DeckError for a variable that stands where no number is read.
    """
    expansion = deck.source.expansion
    assert expansion is not None, "it has variables"
    lines = deck.source.lines
    pieces = {
        (piece.line, piece.column): piece
        for piece in expansion.pieces
        if lines[piece.line - 1][piece.column - 1 :].startswith(piece.text)
    }
    formulas: dict[str, Formula] = {}
    exact: dict[str, float | str] = {}
    for name, number in deck.numbers():
        piece = pieces.get(number.place[:2]) if number.place else None
        if piece and number.text == piece.text and not isinstance(number.value, str):
            pieces.pop((piece.line, piece.column))
            formulas[name] = piece.formula
            if piece.aligned and isinstance(number.value, float):
                exact[name] = float(piece.formula.value(expansion.values.__getitem__))
        elif number.key == FORMULA and number.place:
            exact[name] = _with_names(number, pieces)
    if pieces:
        raise DeckError(unread(piece, "") for piece in pieces.values())
    deck = deck.with_values(exact) if exact and isinstance(deck.records, tuple) else deck
    variables = {name: _variable(name, value, expansion) for name, value in expansion.values.items()}
    return replace(deck, variables=variables, formulas=formulas)


def _with_names(number: Number, pieces: dict[tuple[int, int], Piece]) -> str:
    """Return the formula of an output with its variables in the places of their values."""
    text, place = str(number.value), number.place
    assert place is not None, "it is read"
    for at in sorted(pieces, reverse=True):
        start = at[1] - place.column
        if at[0] == place.line and 0 <= start < len(text):
            piece = pieces.pop(at)
            text = f"{text[:start]}({piece.formula.text}){text[start + len(piece.text) :]}"
    return text


def _variable(name: str, value: float, expansion: Expansion) -> Number:
    text = _spelled(value)
    return Number(name, value, "variable of the deck", "", expansion.places[name], text)


def changed_by(deck: Deck, chosen: Mapping[str, float]) -> dict[str, float]:
    """Return the values of the numbers that depend on variables once some of these are chosen.

    Raises DeckError where a variable has none.
    """
    expansion = deck.source.expansion
    assert expansion is not None, "it has variables"
    values: dict[str, float] = {}
    for name, value in evaluated(dict(expansion.definitions), dict(chosen)):
        if isinstance(value, str):
            raise DeckError(
                [Fault("error", f"the variable {name} {value}", expansion.places[name], id="DECK-089")]
            )
        values[name] = value
    return {name: float(one.value(values.__getitem__)) for name, one in deck.formulas.items()}
