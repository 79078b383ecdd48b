"""Small decks to be solved, and damage that leaves most of them legal: a number for a number."""

import random
import re
from dataclasses import dataclass
from pathlib import Path

from damage import damaged_text

DECKS = Path(__file__).parents[2] / "decks"
# Deck, share, and what keeps a run short.
SHORT = {
    "young": ("young/IN*.dat", 60, ()),
    "dynamics": ("young/dynamics/IN*-*.dat", 15, ("time.end=0.2", "time.step=0.05")),
    "dafms": ("dafms/*.DAT", 20, ("time.IT=10",)),
    "vsdf": ("vsdf/*.vsdf", 5, ("time.end=0.02", "time.step=0.01")),
}
# Stiff or large: seconds a deck.
LEFT_OUT = (
    "shaft_beam_n10",
    "shaft_beam_n10_unco",
    "stiff_arm",
    "two_link_n4",
    "arm_nrot",
    "pendulum_op4",
    "pendulum_dmig",
    "IN-ANDREWS",
)
NUMBER = re.compile(rb"(?<![\w.])[-+]?\d*\.?\d+(?:[eEdD][-+]?\d+)?(?![\w.])")
CARELESS = 0.25  # share of decks that are damaged like those of fuzz.py: few of them stay legal


@dataclass(frozen=True)
class Damaged:
    """A deck to be solved: its bytes, the supplied one from which it is, the changes of `--set`."""

    name: str
    raw: bytes
    folder: Path
    changes: tuple[str, ...]


def damaged(chance: random.Random) -> Damaged:
    """A damaged deck of some dialect."""
    pattern, _, changes = SHORT[chance.choices(list(SHORT), [share for _, share, _ in SHORT.values()])[0]]
    decks = [path for path in sorted(DECKS.glob(pattern)) if path.stem not in LEFT_OUT]
    path = chance.choice(decks)
    raw = path.read_bytes()
    if chance.random() < CARELESS:
        raw = damaged_text(chance, raw, chance.choice(decks).read_bytes())
    else:
        for _ in range(chance.choice((1, 1, 2, 3))):
            raw = _other_number(chance, raw)
    return Damaged(path.name, raw, path.parent, changes)


def _other_number(chance, raw):
    """One number becomes another of the same width where it can, so that fixed columns stay."""
    found = [match for match in NUMBER.finditer(raw) if not _in_comment(raw, match.start())]
    if not found:
        return raw
    match = chance.choice(found)
    word = match[0]
    new = _changed(chance, word, chance.choice(found)[0])
    if len(new) < len(word):
        new = new.rjust(len(word))
    return raw[: match.start()] + new + raw[match.end() :]


def _in_comment(raw, at):
    return raw.rfind(b"{", 0, at) > raw.rfind(b"}", 0, at)


def _changed(chance, word, other):
    if re.fullmatch(rb"\d+", word):
        return chance.choice((b"0", b"1", b"2", b"3", other, str(int(word[:9]) + 1).encode()))
    try:
        value = float(word.replace(b"D", b"e").replace(b"d", b"e"))
    except ValueError:
        return other
    factor = chance.choice((-1.0, 0.0, 0.5, 0.9, 0.999, 1.001, 1.1, 2.0, 10.0, 1e3, 1e-3))
    return f"{value * factor + chance.choice((0.0, 0.0, 0.01, -0.1)):.6g}".encode()
