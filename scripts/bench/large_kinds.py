"""Large legal decks by kinds: each is filled with one sort of card, up to a size or to the format's limit."""

from collections.abc import Callable, Iterator
from pathlib import Path

from large_card_kinds import DAFMS_NUMBERS, ELEMENTS, VSDF_CARDS, YOUNG_LOADS
from large_element_kinds import element_kinds

DECKS = Path(__file__).parents[2] / "decks"

_BODY = "0 0 0 1 0 0 0\n"
_JOINT = "1 {} 0 0 0 0 0 0 0 0 1 0 0 1\n"
# A ground, and a body that turns on it.
_COUNTS = "2 1 {points} 0 0 1 0 0 0 0 0 1\n"
_MECHANISM = "0 0 0 1 0 0 0\n0 0 0 1 0 0 0\n2 6 0 1 0\n"
_END = _JOINT.format(2) + "1 0 0 0 0 0 0\n0 1 0.1\n"
_YOUNG = _COUNTS.format(points=0) + _MECHANISM + _END
_MASSES = "MASS 2 1 0 0 0 1 1 1\n"
_FREE = "2 0 0 0 0 1 0 0 0 0 0 1\n" + _BODY * 2 + _END


def kinds(megabytes: float) -> dict[str, Callable[[], str]]:
    """Return functions that make a deck of about so many million bytes, by the kind of what fills it."""
    size = int(megabytes * 10**6)
    return dict((*_young(size), *_young_dynamics(size), *_dafms(size), *_vsdf(size), *element_kinds(size)))


def _filled(text, size, most=10**9):
    return text * min(most, size // len(text))


def _young(size) -> Iterator[tuple[str, Callable[[], str]]]:
    def points():
        count = size // 8
        return _COUNTS.format(points=count) + _MECHANISM + count * "1 0 0 0\n" + _END

    def held(body, ground, per_body, counts="{n} 0 0 0 0 0 0 0 0 0 0 {n}\n"):
        count = size // per_body
        grounds = "".join(ground.format(k) for k in range(1, count + 1))
        return f"{counts.format(n=count)}{count * body}{grounds}0 1 1\n"

    def turning(per_body=75):
        count = size // per_body
        drivers = "".join(f"{k} 6 0 1 0\n" for k in range(2, count + 2))
        joints = "".join(_JOINT.format(k) for k in range(2, count + 2))
        counts = f"{count + 1} {count} 0 0 0 {count} 0 0 0 0 0 1\n"
        return f"{counts}{(count + 1) * _BODY}{drivers}{joints}1 0 0 0 0 0 0\n0 1 1\n"

    def rows(counts, line, per_body):
        """Bodies whose six coordinates are each given by a line of its own."""
        count = size // per_body
        lines = "".join(line.format(k, d) for k in range(2, count + 2) for d in range(1, 7))
        ends = "1 0 0 0 0 0 0\n0 1 1\n"
        return f"{counts.format(bodies=count + 1, rows=6 * count)}{(count + 1) * _BODY}{lines}{ends}"

    def driven(per_body=94):
        """Bodies driven along x, y, z, their attitudes held."""
        count = size // per_body
        bodies = range(2, count + 2)
        drivers = "".join(f"{k} {d} 0 1 0\n" for k in bodies for d in (1, 2, 3))
        held = "".join(f"{k} {d} 0\n" for k in bodies for d in (4, 5, 6))
        counts = f"{count + 1} {3 * count} 0 0 0 0 0 0 0 {3 * count} 0 1\n"
        return f"{counts}{(count + 1) * _BODY}{drivers}{held}1 0 0 0 0 0 0\n0 1 1\n"

    yield "young bodies", lambda: held(_BODY, "{} 0 0 0 0 0 0\n", 35)
    yield "young points", points
    yield (
        "young eleven counts",
        lambda: held("0 0 0\n", "{} 0 0 0 0 0 0\n", 27, "{n} 0 0 0 0 0 0 0 0 0 {n}\n"),
    )
    yield "young joints", turning
    yield "young simplified", lambda: rows("{bodies} 0 0 0 0 0 0 0 0 {rows} 0 1\n", "{} {} 0\n", 81)
    yield "young distances", lambda: rows("{bodies} 0 0 0 0 0 0 0 0 0 {rows} 1\n", "{} 1 {} 0\n", 93)
    yield "young drivers", driven
    yield "young blank lines", lambda: _filled("\n", size) + _YOUNG
    yield "young long comment", lambda: "{" + _filled("a ", size) + "}\n" + _YOUNG
    yield "young comment lines", lambda: _filled("{ a comment }\n", size) + _YOUNG
    yield "young words after", lambda: _YOUNG + _filled("some words ", size)
    yield "young lines after", lambda: _YOUNG + _filled("a\n", size)
    yield "young other letters", lambda: "{ 𝛼 }\n" + _filled("\n", size) + _YOUNG


def _young_dynamics(size):
    def cards(line, deck=_YOUNG, analysis="INVERSE"):
        return f"{deck}DYNAMICS {analysis}\n{_MASSES}{_filled(line, size, YOUNG_LOADS)}END\n"

    def of_bodies(line, per_body):
        count = size // per_body
        bodies = f"{count} 0 0 0 0 0 0 0 0 0 0 {count}\n{count * _BODY}"
        grounds = "".join(f"{k} 0 0 0 0 0 0\n" for k in range(1, count + 1))
        lines = "".join(line.format(k) for k in range(1, count + 1))
        return f"{bodies}{grounds}0 1 1\nDYNAMICS INVERSE\n{lines}END\n"

    force, spring = "FORCE 2 0 0 0 1 0 0\n", "SPRING 1 2 1 0 0 0 1 0 10 1\n"
    yield "young forces", lambda: cards(force)
    yield "young forces forward", lambda: cards(force, _FREE, "FORWARD")
    yield "young torques", lambda: cards("TORQUE 2 0 0 1\n")
    yield "young springs", lambda: cards(spring)
    yield "young springs forward", lambda: cards(spring, _FREE, "FORWARD")
    yield "young dampers", lambda: cards("DAMPER 1 2 1 0 0 0 1 0 10\n")
    yield "young masses", lambda: of_bodies("MASS {} 1 0 0 0 1 1 1\n", 58)
    yield "young velocities", lambda: of_bodies("VELOCITY {} 0 0 0\n", 55)


def _dafms(size):
    head, deck = f"{1:5d}{2:5d}\n", (DECKS / "dafms/pendulum.DAT").read_text().split("\n", 1)[1]

    def with_card(card):
        return head + deck.replace("END \n", f"{card}END \n")

    def entries(word, line, numbers):
        count = min(99_999, DAFMS_NUMBERS // (1 + numbers), size // len(line))
        return with_card(f"{word}\n{count:5d}\n{count * line}")

    def table(word):
        points = min(99_999, size // 21)
        times = "".join(f"{k * 1e-3:10.3f}{k % 7:10.1f}\n" for k in range(points))
        count = size // len(times)
        return with_card(f"{word}\n{count:5d}\n" + count * f"{1:5d}{1:5d}{points:5d}\n{times}")

    def models():
        return head + _filled("\n", size) + deck.removesuffix("STOP\n") + deck

    yield "dafms blank lines", lambda: head + _filled("\n", size) + deck
    yield "dafms skipped cards", lambda: head + _filled("card\n", size) + deck
    yield "dafms models", models
    yield "dafms full stiffness", lambda: _full(size)
    yield "dafms tables", lambda: table("TABL")
    yield "dafms motor tables", lambda: table("TABM")
    yield "dafms springs", lambda: entries("SPRI", f"{1:5d}{1:5d}{1.0:10.2f}{0.0:10.2f}\n", 4)
    yield "dafms motors", lambda: entries("MOTR", f"{1:5d}{1:5d}{1.0:10.2f}\n", 3)


def _full(size):
    """A body whose stiffness, its whole upper triangle, fills the deck."""
    nodes = min(148, int((2 * size / 13) ** 0.5 / 3))  # addresses have five digits
    count, entries = 3 * nodes, []
    for column in range(count):
        entries += ["0.0".rjust(13)] * column + ["1.0E3".rjust(13)]
    vector = "       0.0       0.0"
    parts = [
        f"{1:5d}{3:5d}", "DFMB", "    1    0    0    0    0", "    1    1    1    0    0",
        f"{nodes:5d}", f"{3:5d}", "    2", "       .01",
        *(f"{k:5d}{k * 1e-3:10.4f}{vector}" for k in range(1, nodes + 1)),
        *(f"{k:5d}       0.0{vector}" for k in range(1, nodes + 1)),
        f"{count:5d}", *_lines([f"{k:5d}" for k in range(1, count + 1)], 10),
        *_lines([f"{k * (k + 1) // 2:5d}" for k in range(1, count + 1)], 10), *_lines(entries, 6),
        *_lines(["      .001"] * nodes, 10),
        "CONN", "    0", "MASS", f"    1{2.0 * nodes * 1e-3:10.4f}",
        "INER", "    1       1.0       1.0       1.0",
        "Q(k)", f"    1       0.0{vector}", "EULT", f"    1{vector}       0.0       1.0",
        "EULL", f"    1{vector}       0.0       1.0", "END ", "STAR", "STOP", "",
    ]  # fmt: skip
    return "\n".join(parts)


def _lines(fields, each):
    return ["".join(fields[k : k + each]) for k in range(0, len(fields), each)]


def _vsdf(size):
    text = (DECKS / "vsdf/pendulum.vsdf").read_text().replace(" fe/", f" {DECKS}/vsdf/fe/")
    deck, end = text.split("\nEND", 1)

    def cards(word, line, most=VSDF_CARDS):
        count = min(most, size // len(line.format(k=4_000_000, t=1, f=1)))
        lines = "".join(line.format(k=k, t=k * 1e-3, f=k % 7) for k in range(1, count + 1))
        return f"{deck}\n{word}\n{lines}END{end}"

    table = "    1{t:10.3f}{f:10.1f}\n"
    yield "vsdf blank lines", lambda: f"{deck}{_filled(chr(10), size)}\nEND{end}"
    yield "vsdf comments", lambda: f"{deck}\n{_filled('* a comment' + chr(10), size)}END{end}"
    yield "vsdf table", lambda: cards("TABL", table, 10**9)
    yield "vsdf table by commas", lambda: cards("TABL", "1,{k},{f}\n", 10**9)
    yield "vsdf nodes", lambda: cards("NODE", "0,{k},1.0,0.0,0.0\n", 10**9)
    yield "vsdf forces", lambda: cards("FORC", "    1   51       1.0       0.0       0.0\n")
    yield "vsdf output nodes", lambda: cards("OUTN", "    1   51\n")
    spring = "NODE\n    0    1       9.0\nSPRI", "{k},0,1,1,51,1.0\n"
    yield "vsdf springs", lambda: cards(*spring, most=ELEMENTS)
    yield "vsdf node sets", lambda: cards("NSET", "1,9{k:06d},1,2,3\n")
