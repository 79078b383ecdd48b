"""Decks, finite-element files and studies by their grammar, with hostile values (strategies of hypothesis).

The cards and sections are those of flexmb's own tables, so that a new card is tried without a word here.
Most values are sound, so that a file gets past the first check; counts lie, cards come twice or not at all,
numbers of bodies and nodes lead nowhere.
"""

import json
import re

import fe_seeds
from damaged_decks import DECKS
from hypothesis import strategies as st

from flexmb_cli.dialects.dafms import cards as dafms_cards
from flexmb_cli.dialects.vsdf import cards as vsdf_cards
from flexmb_cli.dialects.vsdf.card import WIDTHS
from flexmb_cli.dialects.young import cards as young_cards
from flexmb_cli.dialects.young.sections import COUNTS, TIME, YOUNG_SECTIONS

HOSTILE_INTEGERS = (0, -1, 7, 99, 99999, 10**6, 2**31, 10**11, 10**15, 10**18, -(10**9), 10**40)
HOSTILE_REALS = (
    *("0", "-0", "1e308", "-1e308", "1e-308", "5e-324", "1e999", "nan", "inf", "1e18", "1.5D+03", "1.5+3"),
    *("2-1", "1e", ".", "0x3", "1_0", "9" * 30, "1e150", "-1e30", "x"),
)
_SOUND_REALS = ("0", "0", "1", "-1", "0.5", "1.0", "2.25", "0.1", "1e-3", "-3.7")


def mostly(sound, hostile):
    """One of a hundred values is hostile: hypothesis likes the ends of a range, so it is one within."""
    return st.integers(0, 99).flatmap(lambda k: hostile if k == 71 else sound)


small = mostly(st.integers(1, 3), st.sampled_from(HOSTILE_INTEGERS))
counts = mostly(st.integers(0, 3), st.sampled_from(HOSTILE_INTEGERS))
reals = mostly(
    st.sampled_from(_SOUND_REALS), st.one_of(st.sampled_from(HOSTILE_REALS), st.floats().map(repr))
)


@st.composite
def young_decks(draw) -> str:
    """Counts, which may lie, and sections of records; for half of the decks masses and loads behind them."""
    made = {section.name: draw(st.integers(0, 2)) for section in YOUNG_SECTIONS if section.count}
    made["body"] = draw(st.integers(1, 4))
    lines = []
    for section in YOUNG_SECTIONS:
        if section is COUNTS:
            by_count = {other.count: made.get(other.name, 0) for other in YOUNG_SECTIONS}
            stated = [by_count[column.key] for column in COUNTS.columns]
            if draw(st.integers(0, 9)) == 0:
                stated[draw(st.integers(0, len(stated) - 1))] = draw(st.sampled_from(HOSTILE_INTEGERS))
            lines.append(" ".join(map(str, stated)))
        elif section is TIME:
            lines.append(draw(mostly(st.just("0 1 0.1"), st.lists(reals, max_size=4).map(" ".join))))
        else:
            lines += [_young_record(draw, section.columns) for _ in range(made[section.name])]
    if draw(st.booleans()):
        lines += _young_dynamics(draw)
    return "\n".join(disordered(draw, lines)) + "\n"


def _young_record(draw, columns):
    return " ".join(str(draw(small)) if column.is_integer else draw(reals) for column in columns)


def _young_dynamics(draw):
    cards = draw(st.lists(st.sampled_from(young_cards.CARDS), max_size=6))
    lines = [f"{card.keyword} {_young_record(draw, card.columns)}" for card in cards]
    return ["", f"DYNAMICS {draw(st.sampled_from(('forward', 'inverse')))}", *lines, "END"]


def disordered(draw, lines):
    """The lines as they are; or one of them missing, twice, or elsewhere."""
    change = draw(st.integers(0, 11))
    if change > 2 or not lines:
        return lines
    at, to = (draw(st.integers(0, len(lines) - 1)) for _ in range(2))
    if change == 0:
        return lines[:at] + lines[at + 1 :]
    if change == 1:
        return lines[: at + 1] + lines[at:]
    lines = list(lines)
    lines[at], lines[to] = lines[to], lines[at]
    return lines


# These are in every deck; some have them twice by a line that is doubled.
VSDF_CARDS = tuple(card for card in vsdf_cards.CARDS if card.word not in ("BODY", "TIME", "OUTN"))


@st.composite
def vsdf_decks(draw) -> str:
    """Bodies, then cards of all words in any order, fixed columns or commas."""
    bodies = draw(st.integers(1, 3))
    lines = ["VSDF T", "BODY"]
    lines += [f"{k:5d} {draw(st.sampled_from(('RIGD', 'FLEX')))}" for k in range(1, bodies + 1)]
    for k in range(1, bodies + 1):
        if draw(st.integers(0, 3)):
            lines += ["RIGI", f"{k:5d}       2.0", "       0.1       0.2       0.3"]
    for card in draw(st.lists(st.sampled_from(VSDF_CARDS), max_size=8)):
        lines.append(card.word)
        for number in range(1, draw(st.integers(1, 2)) + 1):
            lines += _vsdf_records(draw, card, number)
    lines += draw(
        mostly(st.just(["TIME", "       0.1      0.01", "OUTN", "    1    1", "    1    2"]), st.just([]))
    )
    return "\n".join(disordered(draw, [*lines, "END", "STAR", "STOP"])) + "\n"


def _vsdf_records(draw, card, number):
    columns = [*card.columns, *([card.more] * draw(counts.map(lambda n: n % 12)) if card.more else ())]
    yield _vsdf_line(draw, columns, number if card.counted == "own" else None)
    if card.second:
        yield _vsdf_line(draw, card.second, None)


def _vsdf_line(draw, columns, number):
    free = draw(st.integers(0, 4)) == 0
    fields = []
    for column in columns:
        text = str(number) if number and not fields else draw(_vsdf_value(column))
        width = WIDTHS[column.letter]
        fields.append(text if free or not width else column.skip * " " + text.rjust(width)[:width])
    return ",".join(fields) if free else "".join(fields)


def _vsdf_value(column):
    if column.words:
        return mostly(st.sampled_from(column.words), st.sampled_from(("NONE", "", "12")))
    if column.letter == "T":
        return st.sampled_from((*BRICK_FILES, "nowhere", "../n.txt", "/dev/zero", "."))
    return small.map(str) if column.letter == "I" else reals


BRICK_FILES = sorted({name for names in fe_seeds.files_of_decks().values() for name in names})


def _dafms_systems():
    """The lines before the first card of every deck supplied, and its cards."""
    for path in sorted((DECKS / "dafms").glob("*.DAT")):
        lines = path.read_text().splitlines()
        first = next(k for k, line in enumerate(lines) if line[:4] in dafms_cards.CARDS)
        last = next(k for k, line in enumerate(lines) if line.startswith("END"))
        yield lines[:first], lines[first:last]


DAFMS_SYSTEMS = tuple(_dafms_systems())


@st.composite
def dafms_decks(draw) -> str:
    """The system of a supplied deck with a number exchanged, or none, its cards or none, and others."""
    system, cards = draw(st.sampled_from(DAFMS_SYSTEMS))
    lines = list(system)
    if draw(st.integers(0, 3)) == 0:
        at = draw(st.integers(0, len(lines) - 1))
        lines[at] = re.sub(
            r" *\d+(?!.*\d)", draw(st.sampled_from(HOSTILE_INTEGERS).map(str)).rjust(5), lines[at]
        )
    bodies = int(lines[0][:5]) if lines[0][:5].strip().isdigit() else 2
    words = draw(st.lists(st.sampled_from(list(dafms_cards.CARDS)), max_size=5, unique=True))
    lines += draw(st.sampled_from((cards, cards, ["CONN", f"{0:5d}{1:5d}{1:5d}"[: 5 * bodies]])))
    for word in words:
        lines += [word, *_dafms_records(draw, dafms_cards.CARDS[word], min(bodies, 6))]
    return "\n".join([*disordered(draw, lines), "END ", "STAR", "STOP"]) + "\n"


def _dafms_records(draw, card, bodies):
    if card.layout == "switch":
        return []
    if card.layout == "entries":
        entries = draw(st.integers(0, 2))
        stated = draw(mostly(st.just(entries), st.sampled_from(HOSTILE_INTEGERS)))
        lines = [f"{stated:5d}"]
        for _ in range(entries):
            lines += [_dafms_line(draw, part) for part in (card.format, card.tail) if part]
        return lines
    if card.layout == "bodies":
        numbers = [draw(mostly(st.just(k), small)) for k in range(1, bodies + 1)]
        return [f"{k:5d}" + _dafms_line(draw, card.format)[5:] for k in numbers]
    return [_dafms_line(draw, card.format or "5F10.5") for _ in range(draw(st.integers(1, 3)))]


def _dafms_line(draw, layout):
    """One record under a FORMAT."""
    fields = []
    for repeat, letter, width in re.findall(r"(\d*)([IFE])(\d+)", layout):
        for _ in range(int(repeat or 1)):
            text = str(draw(small)) if letter == "I" else draw(reals)
            fields.append(text.rjust(int(width))[: int(width)])
    return "".join(fields)


@st.composite
def studies(draw) -> str:
    """TOML tables as a study has them: names of the deck, ranges, lists, and things of another type."""
    names = st.sampled_from(
        ("driver.1.B", "body.1.x", "time.end", "time.step", "counts.NBODY", "body.9.x", "", "a\\nb", "1", "*")
    )
    values = st.recursive(
        st.one_of(
            *(st.sampled_from(kind) for kind in ((0, 1, -1, 10**20), (0.5, 1e308, 5e-324), (True, False))),
            st.sampled_from(
                ("grid", "max body.1.z", "series body.1.x", "last", "IN1-3-1.dat", "../x", "/dev/zero")
            ),
            st.sampled_from((_Bare("nan"), _Bare("inf"), _Bare("1979-05-27"), _Bare("9" * 5000))),
        ),
        lambda inner: st.one_of(
            st.lists(inner, max_size=3),
            st.dictionaries(st.sampled_from(("from", "to", "count", "scale", "x")), inner, max_size=4),
        ),
        max_leaves=6,
    )
    ranges = st.fixed_dictionaries(
        {"from": st.sampled_from((0, 1.0, -1)), "to": st.sampled_from((1, 2.5, 1e300))},
        optional={
            "count": st.sampled_from((2, 3, 10**6, 10**12, 0)),
            "scale": st.sampled_from(("log", "linear")),
        },
    )
    head = {"deck": draw(mostly(st.just("IN1-3-1.dat"), values))}
    head |= draw(
        st.fixed_dictionaries(
            {},
            optional={
                "dialect": mostly(st.sampled_from(("auto", "young")), values),
                "sampling": mostly(st.sampled_from(("grid", "together", "latin-hypercube")), values),
                "count": mostly(st.integers(1, 5), values),
                "seed": mostly(st.just(3), values),
                "unknown": values,
            },
        )
    )
    varied = st.one_of(ranges, st.lists(st.sampled_from((0, 1.5, 2)), min_size=1, max_size=3))
    takes = st.sampled_from(("max body.1.z", "series body.1.x", "last body.2.x", "rms time", "mean x"))
    tables = {
        "parameters": draw(st.dictionaries(names, mostly(varied, values), max_size=3)),
        "results": draw(st.dictionaries(names, mostly(takes, values), max_size=3)),
    }
    lines = [f"{key} = {_toml(value)}" for key, value in head.items()]
    for table, entries in tables.items():
        lines += [f"[{table}]", *(f'"{key}" = {_toml(value)}' for key, value in entries.items())]
    return "\n".join(disordered(draw, lines)) + "\n"


class _Bare(str):
    """Text that TOML has without quotes."""


def _toml(value):
    if isinstance(value, _Bare):
        return str(value)
    if isinstance(value, dict):
        return "{" + ", ".join(f"{key} = {_toml(item)}" for key, item in value.items()) + "}"
    if isinstance(value, list):
        return "[" + ", ".join(map(_toml, value)) + "]"
    return json.dumps(value)
