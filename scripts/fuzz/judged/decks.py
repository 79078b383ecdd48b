"""Small decks to be solved, and damage that leaves most of them legal: a number for a number."""

import random
import re
from dataclasses import dataclass
from pathlib import Path

from damage import damaged_text

from .young_text import COUNTED

DECKS = Path(__file__).parents[3] / "decks"
SEEDS = Path(__file__).parents[1] / "seeds"  # functions and elements, which few supplied decks have
WORDS_FIRST = {"body": 0, "point": 1, "distance": 3, "ground": 1}  # else two: bodies, or body and direction
# Decks that a process solves in about a twentieth of a second, their share, and what keeps a run short.
# Rows and steps of VSDF decks are short enough that the highest modes show in the differences of rows.
QUICK = (
    ("young/IN[12]-*.dat", 63, ()),
    ("young/IN[-45]*.dat", 4, ()),
    ("young/dynamics/IN4-BAR-MASS.dat", 3, ("time.end=0.1", "time.step=0.05")),
    ("young/[de]*.dat", 4, ()),
    ("dafms/elements.DAT", 3, ()),
    ("dafms/elements_coupled.DAT", 1, ()),
    ("vsdf/elements.vsdf", 3, ()),
    ("vsdf/coupled.vsdf", 1, ()),
    ("dafms/[ps]*.DAT", 17, ("time.IT=8",)),
    ("vsdf/[!ce]*.vsdf", 3, ("time.end=0.001", "time.output=5e-5", "time.step=5e-5")),
)
# Those with springs, bushings, friction, stops, cables and couplings.
ELEMENTS = tuple(kind for kind in QUICK if "[de]" in kind[0] or "elements" in kind[0] or "coupled" in kind[0])
# Stiff or large: half a second a deck.
LEFT_OUT = (
    "shaft_beam_n5",
    "shaft_beam_n10",
    "shaft_beam_n10_unco",
    "stiff_arm",
    "slider_crank_flex",
    "spatial_flex",
    "pendulum_op4",
    "pendulum_dmig",
)
NUMBER = re.compile(rb"(?<![\w.])[-+]?(?:\d+\.?\d*|\.\d+)(?:[eEdD][-+]?\d+)?(?![\w.])")
CARELESS = 0.02  # share of decks that are damaged like those of fuzz.py: few of them stay legal
COUNTS = 0.03  # share of changes to counts, numbers of bodies and directions: the same


@dataclass(frozen=True)
class Damaged:
    """A deck to be solved: its bytes, the supplied one from which it is, the changes of `--set`."""

    name: str
    raw: bytes
    folder: Path
    changes: tuple[str, ...]


def damaged(chance: random.Random, dialect: str = "", elements: bool = False) -> Damaged:
    """A damaged deck of some dialect, or of the one named; of those with elements at joints, if wanted."""
    kinds = [kind for kind in (ELEMENTS if elements else QUICK) if kind[0].startswith(dialect)]
    pattern, _, changes = chance.choices(kinds, [share for _, share, _ in kinds])[0]
    found = [*sorted(DECKS.glob(pattern)), *sorted(SEEDS.glob(pattern))]
    decks = [path for path in found if path.stem not in LEFT_OUT]
    path = chance.choice(decks)
    raw = path.read_bytes()
    if chance.random() < CARELESS:
        raw = damaged_text(chance, raw, chance.choice(decks).read_bytes())
    else:
        for _ in range(chance.choice((1, 1, 2, 3))):
            raw = _other_number(chance, raw, path.suffix == ".dat")
    return Damaged(path.name, raw, path.parent, changes)


def _other_number(chance, raw, is_young):
    """One number becomes another, in fixed columns one that fits them."""
    found = [match for match in NUMBER.finditer(raw) if not _in_comment(raw, match.start())]
    counts = _counts(found) if is_young else {k for k, match in enumerate(found) if b"." not in match[0]}
    values = [match for k, match in enumerate(found) if k not in counts]
    chosen = [found[k] for k in counts] if chance.random() < COUNTS else values
    if not chosen:
        return raw
    match = chance.choice(chosen)
    new = _changed(chance, match[0], chance.choice(chosen)[0], chosen is values)
    if is_young:
        return raw[: match.start()] + new + raw[match.end() :]
    start = match.end() - max(len(match[0]), len(new))
    if raw[start : match.start()].strip(b" ") or raw[start - 1 : start].strip():
        return raw  # no room for it
    return raw[:start] + new.rjust(match.end() - start) + raw[match.end() :]


def _counts(found):
    """Indices of the numbers of a YOUNG deck that count, name bodies and directions, or make the time."""
    kinds, at = set(range(12)), 12
    for (name, width), match in zip(COUNTED, found[:12], strict=False):
        for _ in range(int(match[0])):
            kinds |= set(range(at, at + WORDS_FIRST.get(name, 2)))
            at += width
    return (kinds | set(range(at, at + 3))) & set(range(len(found)))


def _in_comment(raw, at):
    return raw.rfind(b"{", 0, at) > raw.rfind(b"}", 0, at)


def _changed(chance, word, other, is_value):
    if not is_value and re.fullmatch(rb"\d+", word):
        return chance.choice((b"0", b"1", b"2", b"3", other, str(int(word[:9]) + 1).encode()))
    value = float(word.replace(b"D", b"e").replace(b"d", b"e"))
    factor = chance.choice((-1.0, 0.0, 0.5, 0.9, 0.99, 0.999, 1.001, 1.01, 1.1, 2.0))
    added = chance.choice((0.0, 0.0, 0.01, -0.1, 1e-3, 1e-6))
    return f"{value * factor + added:.6g}".encode()
