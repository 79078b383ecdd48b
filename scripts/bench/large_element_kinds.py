"""Large legal decks of functions, elements, shapes and bodies, by kinds."""

from collections.abc import Callable, Iterator
from pathlib import Path

from large_card_kinds import (
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
_SHAPES = {
    "young": "GEOM 2 1 1 1 1\n",
    "dafms": f"{0:5d}{1:5d}{1.0:10.2f}{1.0:10.2f}{1.0:10.2f}\n\n",
    "vsdf": "    0 BOX        1.0       1.0       1.0\n",
}
# Lines of the block by the number of a line; {at}, {i} and {j}: a coordinate and two ends of the dialect.
_LINES = {
    "springs": "  SPRING s{k} at={at} stiffness=10\n",
    "stops": "  STOP s{k} at={at} lower=-9 upper=9 stiffness=10\n",
    "line springs": "  SPRING s{k} from={i} to={j} stiffness=10 rest=1\n",
    "cables": "  CABLE s{k} from={i} to={j} stiffness=10 rest=9\n",
    "bushings": "  BUSHING s{k} from={i} to={j} k=(1,1,1) kr=(0,0,0)\n",
    "motors": "  MOTOR s{k} at={at} effort=1\n",
    "tables": "  FUNCTION f{k} table 0 1 1 2\n",
    "sines": "  FUNCTION f{k} sine 0 1 1\n",
    "sums": "  FUNCTION f{k} sum 1 1\n",
}
_MEASURES = {
    "young": {"at": "1.angle", "i": "1(1,0,0)", "j": "2(0,1,0)"},
    "dafms": {"at": "1.r1", "i": "0(1,1,1)", "j": "1:1"},
    "vsdf": {"at": "1.angle", "i": "0:1", "j": "1:51"},
}


def element_kinds(size: int) -> Iterator[_KIND]:
    """Yield name and maker of every kind, of about so many bytes."""
    vsdf = (DECKS / "vsdf/pendulum.vsdf").read_text().replace(" fe/", f" {DECKS}/vsdf/fe/")
    deck, end = vsdf.split("\nEND", 1)
    head, rest = (DECKS / "dafms/pendulum.DAT").read_text().rsplit("END ", 1)
    ends = {"young": "END\n", "dafms": f"END {rest}", "vsdf": f"END{end}"}
    heads = {"young": _YOUNG, "dafms": head, "vsdf": f"{deck}\nNODE\n    0    1       9.0\n"}
    for dialect, measures in _MEASURES.items():
        for name, line in _LINES.items():
            yield (
                f"{dialect} {name}",
                lambda d=dialect, m=measures, line=line: (
                    f"{heads[d]}{_SINE}{_filled(line, m, size)}{ends[d]}"
                ),
            )
        for kind in ("table", "spline", "polynomial"):
            yield (
                f"{dialect} one {kind}",
                lambda d=dialect, m=measures, kind=kind: (
                    f"{heads[d]}{_SINE}  FUNCTION 2 {kind} {_points(size)}\n"
                    f"  MOTOR m at={m['at']} effort=2\n{ends[d]}"
                ),
            )
    yield from _cards(size, heads, ends)
    yield "dafms bodies", lambda: _chain(size)
    yield from _vsdf(size, deck, end)


_SINE = "ELEMENTS\n  FUNCTION 1 sine 0 1 1\n"


def _filled(line: str, measures: dict[str, str], size: int) -> str:
    count = min(ELEMENTS, size // len(line.format(k=10_000, **measures)))
    return "".join(line.format(k=k, **measures) for k in range(1, count + 1))


def _points(size: int) -> str:
    """Times and values of one long table."""
    return " ".join(f"{k} {k % 7}" for k in range(min(NUMBERS_OF_CARD // 2, size // 9)))


def _cards(size: int, heads: dict[str, str], ends: dict[str, str]) -> Iterator[_KIND]:
    """Shapes, of which a deck has one a line."""
    for dialect, line in _SHAPES.items():
        count = min(DAFMS_ELEMENTS if dialect == "dafms" else ELEMENTS, size // len(line))
        word = {"young": "", "dafms": f"GEOM\n{count:5d}\n", "vsdf": "GEOM\n"}[dialect]
        yield (
            f"{dialect} shapes",
            lambda d=dialect, line=line, word=word, count=count: f"{heads[d]}{word}{line * count}{ends[d]}",
        )


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


def _vsdf(size: int, deck: str, end: str) -> Iterator[_KIND]:
    yield "vsdf one output", lambda: f"{deck}\nOUTN\n1,{'51,' * min(99_990, size // 3)}51\nEND{end}"
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
