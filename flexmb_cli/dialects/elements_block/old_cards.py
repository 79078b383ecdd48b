"""Cards of elements that the block ELEMENTS replaces: the line of the block that says the same as a card.

Numbers stay as they are spelt.  A card of elements is named as in results of earlier versions, with a hyphen:
the first card TSPRING becomes `tspring-1`; functions keep their numbers as names.
"""

from collections.abc import Callable, Iterable, Iterator, Sequence

from ...errors import Fault, Place
from .text import BLOCK

# Parts of a line in the order of the card's fields; what they take is in `_PARTS`.
_CURVES = "curve damper"
_LAWS = {
    "SPRING": f"stiffness rest damping preload {_CURVES}",
    "STOP": "lower upper stiffness damping",
    "CABLE": "stiffness rest damping",
    "BUSHING": "k() kr() c() cr()",
    "FRICTION": "joint dynamic static stribeck creep radius preload",
}
_FUNCTIONS = ("table", "spline", "polynomial", "sine", "ramp", "step", "sum", "product")
_LINKS = {"REVCYL": "axis_from() axis_to()", "REVSPH": "axis_from() length", "SPHSPH": "length"}
_NOTHING = ""  # no line: all results hold joint coordinates


def _of_joints(letters: dict[str, str], ends: str) -> dict[str, str]:
    """Lines of cards of joints by the words of the cards, given by the first letters and the law."""
    lines = {}
    for coordinate, letter in (("angle", "T"), ("stroke", "A")):
        lines[letter + letters["MOTOR"]] = f"MOTOR at.{coordinate} effort"
        lines[letter + letters["SPRING"]] = f"SPRING at.{coordinate} {_LAWS['SPRING']}"
        lines[letter + letters["STOP"]] = f"STOP at.{coordinate} {_LAWS['STOP']}"
    lines["L" + letters["SPRING"]] = f"SPRING {ends} {_LAWS['SPRING']}"
    for word in ("CABLE", "BUSHING"):
        lines[letters[word]] = f"{word} {ends} {_LAWS[word]}"
    lines[letters["FRICTION"]] = f"FRICTION {_LAWS['FRICTION']}"
    lines["RATE"] = "START joint.coordinate rate"
    return lines


_WHOLE = {word: word for word in ("MOTOR", "SPRING", "STOP", "CABLE", "BUSHING", "FRICTION")}
_SHORT = {
    "MOTOR": "MOT",
    "SPRING": "SPR",
    "STOP": "STO",
    "CABLE": "CABL",
    "BUSHING": "BUSH",
    "FRICTION": "FRIC",
}
LINES = {
    "young": {
        **{kind.upper(): f"FUNCTION {kind} *" for kind in _FUNCTIONS},
        "DRIVE": "DRIVE driver follows",
        "SUPPORT": "SUPPORT simplified value",
        "ANGLE": "DRIVE at.angle follows",
        "STROKE": "DRIVE at.stroke follows",
        **_of_joints(_WHOLE, "ends"),
        "COUPLING": "COUPLING terms",
        **{word: f"JOINT {word.lower()} ends {parts}" for word, parts in _LINKS.items()},
        "JOINTS": _NOTHING,
    },
    "vsdf": {
        "FUNC": "FUNCTION kind *",
        "SUPP": "SUPPORT pin x y z",
        **_of_joints(_SHORT, "nodes"),
        "COUP": "COUPLING terms",
        "OUTJ": _NOTHING,
    },
    "dafms": {
        "FUNC": "FUNCTION kind *",
        "MOTF": "MOTOR hinge effort",
        "PREF": "DRIVE hinge follows",
        "HSPR": f"SPRING hinge {_LAWS['SPRING']}",
        "HSTO": f"STOP hinge {_LAWS['STOP']}",
        "LSPR": "SPRING line stiffness rest damping preload",
        "CABL": f"CABLE points {_LAWS['CABLE']}",
        "BUSH": f"BUSHING points {_LAWS['BUSHING']}",
        "COUP": "COUPLING hinges",
        "FRIC": f"FRICTION {_LAWS['FRICTION']}",
    },
}
_KINDS = {
    **{kind[:4].upper(): kind for kind in _FUNCTIONS},
    **{str(k): kind for k, kind in enumerate(_FUNCTIONS, 1)},
}  # of cards FUNC
_OPTIONAL = ("rest", "damping", "preload", "curve", "damper", "radius", "x", "y", "z")  # 0 where left out
_COORDINATES = {"1": "angle", "2": "stroke"}
_ZEROS = ("", "0", "0.", "0.0", "+0", "-0")
_REMOVE = "remove it; all results hold joint coordinates"
_MOST_WORDS = 30  # of a line in a message
# Letters of the fields of VSDF cards: I of 5 columns, F of 10, A a blank and 4.
VSDF_FIELDS = {
    "FUNC": "IA",  # and as many F as follow
    "SUPP": "IIII",
    **dict.fromkeys(("TMOT", "AMOT"), "II"),
    **dict.fromkeys(("TSPR", "ASPR"), "IFFFFII"),
    **dict.fromkeys(("TSTO", "ASTO"), "IFFFF"),
    "LSPR": "IIIIFFFFII",
    "CABL": "IIIIFFF",
    "BUSH": "IIII" + 12 * "F",
    "COUP": "IIIF",
    "FRIC": "IFFFFFF",
    "RATE": "IIF",
    "OUTJ": "I",
}
# FORMATs of an entry of DAFMS cards, and how many fields follow in records of the second.
DAFMS_FORMATS = {
    "FUNC": ("3I5", "4E20.10", 0),  # so many as the third number says
    "MOTF": ("3I5", "", 0),
    "PREF": ("4I5", "", 0),
    "HSPR": ("2I5,4F10.5,2I5", "", 0),
    "HSTO": ("2I5,4F10.5", "", 0),
    "LSPR": ("6I5", "6F10.5", 10),
    "CABL": ("4I5", "6F10.5", 9),
    "BUSH": ("4I5", "6F10.5", 18),
    "COUP": ("3I5,F10.5", "", 0),
    "FRIC": ("I5,6F10.5", "", 0),
}


def refused(
    dialect: str, word: str, cards: Sequence[tuple[Place | None, list[str]]], counts: dict[str, int]
) -> Iterator[Fault]:
    """Refuse cards of one word, each a place and its fields; a fault gives the line of the block.

    `counts`: how many cards of each word the deck had before.
    """
    for k, line in new_lines(dialect, word, [fields for _, fields in cards], counts):
        words = line.split(" ")
        shown = " ".join([*words[:_MOST_WORDS], *["..."] * (len(words) > _MOST_WORDS)])
        instead = f"write in a block {BLOCK}: {shown}" if line else _REMOVE
        message = f"{word} is no longer a card; {instead}"
        yield Fault("error", message, cards[k][0], f"{word.lower()}-{counts[word]}", id="ELEMENTS-064")


def new_lines(
    dialect: str, word: str, cards: Sequence[list[str]], counts: dict[str, int]
) -> Iterator[tuple[int, str]]:
    """Yield a line for each card, "" where none is needed, and which of the cards it is, from 0.

    Terms of one coupling are one card.
    """
    fields_of_card = dict(enumerate(cards))
    if word == "COUP":
        first: dict[str, int] = {}
        for k, (number, *term) in fields_of_card.copy().items():
            if first.setdefault(number, k) != k:
                fields_of_card[first[number]] = [*fields_of_card[first[number]], *term]
                del fields_of_card[k]
        fields_of_card = {k: fields[1:] for k, fields in fields_of_card.items()}
    for k, fields in fields_of_card.items():
        counts[word] = counts.get(word, 0) + 1
        yield k, _line_of(LINES[dialect][word], word, fields, counts[word])


def _line_of(form: str, word: str, fields: Sequence[str], number: int) -> str:
    """The line for a card, the `number`-th of its word; how such lines are written where fields lack."""
    # Few decks have old cards, of which only the words need to be known.
    from .words import BY_WORD, usage

    if not form:
        return ""
    first, *parts = form.split()
    rest = [field.strip() for field in fields]
    name = f" {word.lower()}-{number}" if first != "START" else ""
    kind = f" {parts.pop(0)}" if first == "JOINT" else ""
    try:
        if not any(rest):
            return usage(BY_WORD[first])
        if first == "FUNCTION":
            return _function(parts[0], rest)
        return f"{first}{name}{kind} {' '.join(_keys(parts, rest))}".rstrip()
    except (ValueError, IndexError):
        return usage(BY_WORD[first])


def _function(kind: str, fields: list[str]) -> str:
    name, *values = fields
    if kind == "kind":
        kind, *values = values
        kind = _KINDS.get(kind.upper(), kind)
        if kind in ("table", "spline") and len(values) == 1:
            return f"FUNCTION {name} {kind} points={values[0]}"
    if kind in ("sum", "product"):
        values = [_whole(value) for value in values]  # numbers of functions, reals on cards of DAFMS
    return f"FUNCTION {name} {kind} {' '.join(values)}"


def _whole(text: str) -> str:
    """The spelling of a number without its point; other texts as they are."""
    try:
        return f"{float(text):g}"
    except ValueError:
        return text


def _keys(parts: Iterable[str], rest: list[str]) -> Iterable[str]:
    for part in parts:
        if not rest:
            return
        if part in _PARTS:
            yield from _PARTS[part](rest)
        elif part.startswith("at."):
            yield f"at={rest.pop(0)}.{part[3:]}"
        elif part.endswith("()"):
            values, rest[:3] = [value or "0" for value in rest[:3]], []
            yield f"{part[:-2]}=({','.join(values)})"
        elif (text := rest.pop(0)) and not (part in _OPTIONAL and text in _ZEROS):
            yield f"{part}={text}"


def _follows(rest: list[str]) -> list[str]:
    function, *by_rate = rest[:2]
    rest[:2] = []
    return [f"{'rate' if by_rate == ['1'] else 'value'}={function}"]


def _ends(rest: list[str]) -> list[str]:
    i, j, *points = rest[:8]
    rest[:8] = []
    return [f"from={i}({','.join(points[:3])})", f"to={j}({','.join(points[3:])})"]


def _nodes(rest: list[str]) -> list[str]:
    a, na, b, nb = (text or "0" for text in rest[:4])
    rest[:4] = []
    return [f"from={a}:{na}", f"to={b}:{nb}"]


def _points(rest: list[str]) -> list[str]:
    ka, na, kb, nb, *points = (text or "0" for text in rest[:10])
    rest[:10] = []
    ends = ((ka, na, points[:3]), (kb, nb, points[3:]))
    shown = [f"{k}({','.join(p)})" if n in _ZEROS else f"{k}:{n}" for k, n, p in ends]
    return [f"from={shown[0]}", f"to={shown[1]}"]


def _line(rest: list[str]) -> list[str]:
    """Ends of the card LSPR of DAFMS, whose curve and damper stand before the points."""
    curves = [f"{key}={text}" for key, text in zip(("curve", "damper"), rest[4:6], strict=True)
              if text not in _ZEROS]  # fmt: skip
    rest[4:6] = []
    return [*_points(rest), *curves]


def _hinge(rest: list[str]) -> str:
    body, axis = rest[:2]
    rest[:2] = []
    return (
        f"{body}.r{axis}"
        if axis in ("1", "2", "3")
        else f"{body}.t{int(axis) - 3 if axis.isdigit() else axis}"
    )


def _coordinate(rest: list[str]) -> str:
    joint, code = rest[:2]
    rest[:2] = []
    if not (joint and code):
        raise ValueError("fields are empty")
    return f"{joint}.{_COORDINATES.get(code, code)}"


def _terms(named: Callable[[list[str]], str]) -> Callable[[list[str]], list[str]]:
    def terms(rest: list[str]) -> list[str]:
        terms_of_line = []
        while len(rest) > 2:
            coordinate = named(rest)
            terms_of_line.append(f"{coordinate}={rest.pop(0)}")
        return terms_of_line

    return terms


_PARTS: dict[str, Callable[[list[str]], list[str]]] = {
    "follows": _follows,
    "ends": _ends,
    "nodes": _nodes,
    "points": _points,
    "line": _line,
    "hinge": lambda rest: [f"at={_hinge(rest)}"],
    "joint.coordinate": lambda rest: [f"at={_coordinate(rest)}"],
    "terms": _terms(_coordinate),
    "hinges": _terms(_hinge),
}
