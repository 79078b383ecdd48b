"""Large legal decks of functions, elements, shapes and bodies, by kinds."""

from collections.abc import Callable, Iterator
from pathlib import Path

from large_limits import (
    DAFMS_BODIES,
    DAFMS_ELEMENTS,
    DAFMS_NUMBERS,
    DAFMS_NUMBERS_OF_BODY,
    ELEMENTS,
    NUMBERS_OF_CARD,
    VSDF_CARDS,
)

DECKS = Path(__file__).parents[2] / "decks"
_KIND = tuple[str, Callable[[], str]]

# A ground, and a body that turns on it and is driven; joint 1 is the hinge.
_YOUNG = (
    "2 1 0 0 0 1 0 0 0 0 0 1\n0 0 0 1 0 0 0\n0 0 0 1 0 0 0\n2 6 0 1 0\n"
    "1 2 0 0 0 0 0 0 0 0 1 0 0 1\n1 0 0 0 0 0 0\n0 1 0.1\nDYNAMICS INVERSE\nMASS 2 1 0 0 0 1 1 1\n"
)
_SINE = "SINE 1 0 1 1\n"
_YOUNG_CARDS = {
    "tsprings": "TSPRING 1 10\n",
    "stops": "TSTOP 1 -9 9 10\n",
    "line springs": "LSPRING 1 2 1 0 0 0 1 0 10 1\n",
    "cables": "CABLE 1 2 1 0 0 0 1 0 10 9\n",
    "bushings": "BUSHING 1 2 1 0 0 0 1 0 1 1 1 0 0 0\n",
    "motors": "TMOTOR 1 1\n",
    "shapes": "GEOM 2 1 1 1 1\n",
}
_HINGE = f"{1:5d}{1:5d}"
_ENDS = f"{0:5d}{0:5d}{1:5d}{1:5d}"
_POINTS = 6 * f"{1.0:10.2f}"
_SINE_OF_DAFMS = f"FUNC\n{1:5d}\n{1:5d}{4:5d}{3:5d}\n{0.0:20.2f}{1.0:20.2f}{1.0:20.2f}\n"
_DAFMS_CARDS = {
    "MOTF": f"{_HINGE}{1:5d}\n",
    "HSPR": f"{_HINGE}{1.0:10.2f}\n",
    "HSTO": f"{_HINGE}{-9.0:10.2f}{9.0:10.2f}{1.0:10.2f}\n",
    "LSPR": f"{_ENDS}\n{_POINTS}\n{1.0:10.2f}{1.0:10.2f}\n",
    "CABL": f"{_ENDS}\n{_POINTS}\n{1.0:10.2f}{9.0:10.2f}\n",
    "BUSH": f"{0:5d}{0:5d}{1:5d}{0:5d}\n{_POINTS}\n{_POINTS}\n\n",
    "GEOM": f"{0:5d}{1:5d}{1.0:10.2f}{1.0:10.2f}{1.0:10.2f}\n\n",
}
_VSDF_CARDS = {
    "TMOT": "    1    1\n",
    "TSPR": "    1      10.0\n",
    "TSTO": "    1      -9.0       9.0      10.0\n",
    "LSPR": "    0    1    1   51       1.0\n",
    "CABL": "    0    1    1   51       1.0       9.0\n",
    "BUSH": "    0    1    1   51       1.0\n",
    "GEOM": "    0 BOX        1.0       1.0       1.0\n",
}


def element_kinds(size: int) -> Iterator[_KIND]:
    """Yield name and maker of every kind, of about so many bytes."""
    yield from _young(size)
    yield from _dafms(size)
    yield from _vsdf(size)


def _filled(text: str, size: int) -> str:
    return text * min(ELEMENTS, size // len(text))


def _points(size: int, separator: str = " ") -> str:
    """Times and values of one long table."""
    return separator.join(f"{k}{separator}{k % 7}" for k in range(min(NUMBERS_OF_CARD // 2, size // 9)))


def _functions(size: int, line: str, first: int = 1) -> str:
    return "".join(line.format(k) for k in range(first, first + min(ELEMENTS, size // len(line))))


def _young(size: int) -> Iterator[_KIND]:
    def cards(text: str, function: str = _SINE) -> str:
        return f"{_YOUNG}{function}DRIVE 1 1\n{text}END\n"

    for name, card in _YOUNG_CARDS.items():
        yield f"young {name}", lambda card=card: cards(_filled(card, size))
    used = "FORCE 2 0 0 0 1 0 0 0 2\n"
    for word in ("TABLE", "SPLINE"):
        yield f"young one {word}", lambda word=word: cards(f"{word} 2 {_points(size)}\n{used}")
    ones = "1 " * min(NUMBERS_OF_CARD, size // 2)
    yield "young polynomial", lambda: cards(f"POLYNOMIAL 2 {ones}\n{used}")
    yield "young tables", lambda: cards(_functions(size, "TABLE {} 0 1 1 2\n", 2))
    yield "young sines", lambda: cards(_functions(size, "SINE {} 0 1 1\n", 2))
    yield "young sums", lambda: cards(_functions(size, "SUM {} 1 1\n", 2))


def _dafms(size: int) -> Iterator[_KIND]:
    head, end = (DECKS / "dafms/pendulum.DAT").read_text().rsplit("END ", 1)

    def entries(word: str, entry: str) -> str:
        count = min(DAFMS_ELEMENTS, size // len(entry))
        return f"{head}{_SINE_OF_DAFMS}{word}\n{count:5d}\n{count * entry}END {end}"

    for word, entry in _DAFMS_CARDS.items():
        yield f"dafms {word}", lambda word=word, entry=entry: entries(word, entry)
    yield "dafms bodies", lambda: _chain(size)
    yield "dafms function", lambda: _one_function(size, head, end)
    yield "dafms functions", lambda: _many_functions(size, head, end)


def _one_function(size: int, head: str, end: str) -> str:
    points = min(99_998, size // 20) // 2
    numbers = [f"{number:20.6f}" for k in range(points) for number in (k, k % 7)]
    lines = "\n".join("".join(numbers[k : k + 4]) for k in range(0, len(numbers), 4))
    motor = f"MOTF\n{1:5d}\n{_HINGE}{1:5d}\n"
    return f"{head}FUNC\n{1:5d}\n{1:5d}{1:5d}{2 * points:5d}\n{lines}\n{motor}END {end}"


def _many_functions(size: int, head: str, end: str) -> str:
    count = min(ELEMENTS, size // 76)
    entries = "".join(f"{k:5d}{4:5d}{3:5d}\n{0.0:20.2f}{1.0:20.2f}{1.0:20.2f}\n" for k in range(1, count + 1))
    return f"{head}FUNC\n{count:5d}\n{entries}END {end}"


def _chain(size: int) -> str:
    """A chain of rigid bodies with an angle each."""
    count = min(DAFMS_BODIES, DAFMS_NUMBERS // DAFMS_NUMBERS_OF_BODY, size // 240)
    bodies = range(1, count + 1)

    def each(word: str, line: str) -> list[str]:
        return [word, *(line.format(k) for k in bodies)]

    def tens(values: Iterator[str] | list[str]) -> list[str]:
        found = list(values)
        return ["".join(found[k : k + 10]) for k in range(0, len(found), 10)]

    zeros = tens(["    0"] * count)
    lines = [
        f"{count:5d}{2:5d}", "DFMB", *(f"{k:5d}{0:5d}{0:5d}{0:5d}{0:5d}" for k in bodies),
        *(f"{k:5d}{1:5d}{1:5d}{0:5d}{0:5d}" for k in bodies), *zeros, *zeros, f"{1:5d}", "       .01",
        "CONN", *tens([f"{k - 1:5d}" for k in bodies]), *each("MASS", "{:5d}       1.0"),
        *each("INER", "{:5d}       1.0       1.0       1.0"),
        *each("Q(k)", "{:5d}       0.0       1.0       0.0"),
        *each("EULT", "{:5d}       0.0       0.0       0.0       1.0"),
        *each("EULL", "{:5d}       0.0       0.0       0.0       1.0"), "END ", "STAR", "STOP", "",
    ]  # fmt: skip
    return "\n".join(lines)


def _vsdf(size: int) -> Iterator[_KIND]:
    text = (DECKS / "vsdf/pendulum.vsdf").read_text().replace(" fe/", f" {DECKS}/vsdf/fe/")
    deck, end = text.split("\nEND", 1)
    ground = "NODE\n    0    1       9.0\nFUNC\n    1 SINE       0.0       1.0       1.0\n"

    def cards(text: str) -> str:
        return f"{deck}\n{ground}{text}END{end}"

    for word, line in _VSDF_CARDS.items():
        yield f"vsdf {word}", lambda word=word, line=line: cards(f"{word}\n{_filled(line, size)}")
    yield "vsdf functions", lambda: cards("FUNC\n" + _functions(size, "{},SINE,0,1,1\n", 2))
    yield (
        "vsdf one function",
        lambda: cards(f"FUNC\n2,TABL,{_points(min(size, 440_000), ',')}\nTMOT\n    1    2\n"),
    )
    yield "vsdf one output", lambda: cards(f"OUTN\n1,{'51,' * min(99_990, size // 3)}51\n")
    yield "vsdf balls", lambda: _balls(size)
    yield "vsdf moving bodies", lambda: _rigid_bodies(size, deck, end, moving=True)
    yield "vsdf loads at nodes", lambda: _balls(size, loads=True)
    yield "vsdf rigid bodies", lambda: _rigid_bodies(size, deck, end)
    yield "vsdf chain", lambda: vsdf_chain(size)


def _rigid_bodies(size: int, deck: str, end: str, moving: bool = False) -> str:
    """Free rigid bodies; moving ones have a place, an attitude and velocities each."""
    count = min(VSDF_CARDS, size // (190 if moving else 45))
    numbers = range(2, count + 2)
    heads = "".join(f"{k},RIGD\n" for k in numbers)
    masses = "".join(f"{k},1\n 1,1,1\n" for k in numbers)
    if not moving:
        return f"{deck}\nBODY\n{heads}RIGI\n{masses}END{end}"
    places = "".join(f"{k},{k}.5,0.25,0.5\n" for k in numbers)
    attitudes = "".join(f"{k},0.6,0.8,0.0,0.0\n" for k in numbers)
    speeds = "".join(f"{k},1.5,2.5,3.5,4.5,5.5,6.5\n" for k in numbers)
    more = f"POSI\n{places}EULP\n{attitudes}VELO\n{speeds}"
    return f"{deck}\nBODY\n{heads}RIGI\n{masses}{more}END{end}"


def _balls(size: int, loads: bool = False) -> str:
    """Bodies on a string, one node each, by the shortest cards; `loads`: with a force at each node."""
    count = max(2, min(VSDF_CARDS, size // (115 if loads else 75)))
    bodies = range(1, count + 1)

    def each(line: str) -> str:
        return "".join(line.format(k=k, before=k - 1) for k in bodies)

    joints = "1,SPHE,0,0,,1,1\n" + each("{k},DIST,{before},1,,{k},1,,,,1\n").split("\n", 1)[1]
    forces, outputs = each("{k},1,1,0,0\n"), each("{k},1\n")
    acting = f"FORC\n{forces}OUTN\n{outputs}" if loads else ""
    heads, masses, nodes = each("{k},RIGD\n"), each("{k},1\n 1,1,1\n"), each("{k},1,0,0,0\n")
    return (
        f"VSDF BALLS\nBODY\n{heads}RIGI\n{masses}NODE\n{nodes}JOIN\n{joints}{acting}"
        "GRAV\n 0,0,-9.81\nTIME\n 0.1,0.01\nEND\nSTAR\nSTOP\n"
    )


def vsdf_chain(size: int) -> str:
    """Rigid bars hinged to one another."""
    bodies = range(1, max(2, min(VSDF_CARDS, size // 131)) + 1)

    def each(line: str) -> str:
        return "".join(line.format(k=k, before=k - 1) for k in bodies)

    nodes = each(" {k},1,0,0,0\n {k},2,0,1,0\n {k},3,1,0,0\n {k},4,1,1,0\n")
    heads, masses = each(" {k},RIGD\n"), each(" {k},1,0.5,0,0\n 0.1,0.1,0.1\n")
    places = each(" {k},{before},0,0\n")
    hinges = each(" {k},REVO,{before},3,4,{k},1,2\n").split("\n", 1)[1]
    return (
        f"VSDF CHAIN\nBODY\n{heads}RIGI\n{masses}NODE\n{nodes}"
        f"POSI\n{places}JOIN\n 1,REVO,0,0,0,1,1,2\n{hinges}"
        "GRAV\n 0,0,-9.81\nTIME\n 0.1,0.01\nEND\nSTAR\nSTOP\n"
    )
