#!/usr/bin/env python3
"""Damage the supplied decks at random, and see that flexmb reads or refuses each, fast and in words.

Example: scripts/mutate_decks.py --count 10000 --seed 1
Exit 1 when a deck ends in a traceback, in a warning of Python, or takes more than two seconds.
"""

import argparse
import random
import sys
import time
import traceback
import warnings
from collections import Counter
from dataclasses import replace
from importlib import import_module
from pathlib import Path

from flexmb_cli.errors import DeckError, FlexmbError, compiler_style
from flexmb_cli.read.dialects import read_deck, recognise
from flexmb_cli.read.text import decode
from flexmb_cli.read.young_dynamics import analysis_of

DECKS = Path(__file__).parents[1] / "decks"
SLOW = 2.0
MOST_SOLVED_ROWS = 50

BUILDERS = {"young": "build_young", "dafms": "build_dafms"}
NASTY = [
    *[
        "",
        "0",
        "-1",
        "1",
        "2.0",
        "7",
        "1e308",
        "-1e308",
        "1e-300",
        "5e-324",
        "1e999",
        "nan",
        "inf",
        "-0",
        "0x3",
    ],
    *["1_000", "1,5", "1.5D+03", "1.5+3", "2-1", "O", "l", "99999999999", "9" * 400, "{", "}", "{ a }", "#"],
    *[
        "\t",
        "\r",
        "\n",
        "\0",
        "\x1a",
        "\x1b[2J",
        "é",
        "−1",
        "３",
        "\ufeff",
        "\u2028",
        "DFMB",
        "END",
        "STOP",
        "VSDF",
    ],
]


def main() -> int:
    options = _options()
    chance = random.Random(options.seed)
    decks = [path for path in sorted(DECKS.rglob("*")) if path.suffix.lower() in (".dat", ".vsdf")]
    outcomes, faults = Counter(), 0
    for number in range(options.count):
        path = chance.choice(decks)
        raw = mutated(chance, path.read_bytes(), chance.choice(decks).read_bytes())
        outcome = tried(path.name, raw, options.solve)
        outcomes[outcome.partition("\n")[0]] += 1
        if outcome.startswith("FAULT"):
            faults += 1
            print(f"deck {number} (from {path.name}): {outcome}\n{raw[:2000]!r}\n", file=sys.stderr)
    for outcome, count in outcomes.most_common():
        print(f"{count:8d}  {outcome}")
    return 1 if faults else 0


def _options():
    parser = argparse.ArgumentParser(description=__doc__.partition("\n")[0])
    parser.add_argument("--count", type=int, default=10_000)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--solve", action="store_true", help="also solve the first rows of YOUNG decks")
    return parser.parse_args()


def mutated(chance: random.Random, raw: bytes, other: bytes) -> bytes:
    """`raw` after one to four damages."""
    for _ in range(chance.choice((1, 1, 1, 2, 3, 4))):
        raw = chance.choice(DAMAGES)(chance, raw, other)
    return raw


def tried(name: str, raw: bytes, with_solver: bool) -> str:
    """What became of a deck, in one line; further lines only after "FAULT"."""
    start = time.perf_counter()
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("error")
            outcome, model = _read_and_build(name, raw)
            took = time.perf_counter() - start
            if with_solver and model is not None and outcome.startswith("young: built"):
                outcome = f"young: {solved(model)}"
    except Exception:
        return f"FAULT traceback\n{traceback.format_exc()}"
    return f"FAULT slow\n{took:.2f} s" if took > SLOW else outcome


def _read_and_build(name, raw):
    """Outcome in words, and the model, None where there is none or where forces move it."""
    lines, dialect, stage = [], "no dialect", "reader"
    try:
        source = decode(name, raw)
        lines = source.lines
        dialect = recognise(lines)
        deck = read_deck(source)
        stage = "builder"
        model, doubts = _built(deck)
        doubts = (*deck.warnings, *doubts)
        _check_shown(compiler_style(name, doubts, lines), doubts)
        driven = model if analysis_of(deck) is None else None
        return f"{dialect}: built with warnings" if doubts else f"{dialect}: built", driven
    except DeckError as refused:
        _check_shown(compiler_style(name, refused.faults, lines), refused.faults)
        return f"{dialect}: refused by the {stage}", None


def _built(deck):
    """Model and doubts; a dialect without a builder is only read."""
    if deck.dialect not in BUILDERS:
        return None, ()
    builder = BUILDERS[deck.dialect]
    return getattr(import_module(f"flexmb_cli.model.{builder}"), builder)(deck)


def _check_shown(text, faults):
    """Every fault is a sentence: it has words, no Python names and no unprintable characters."""
    for fault in faults:
        assert fault.message.strip() and fault.severity in ("error", "warning", "note"), fault
    for line in text.split("\n"):
        assert "Traceback" not in line and "None" not in line.partition("; read")[0], text
        assert all(char.isprintable() or char == "\t" for char in line), repr(line)


def solved(mechanism) -> str:
    """The first rows of the motion; refusals are outcomes, tracebacks are faults."""
    from flexmb_cli.solve.kinematics import KinematicAnalysis

    grid = mechanism.time
    end = min(grid.end, grid.start + MOST_SOLVED_ROWS * grid.step)
    try:
        for _ in KinematicAnalysis(replace(mechanism, time=replace(grid, end=end))).rows():
            pass
    except FlexmbError as refused:
        return f"solver exit {refused.exit_code}"
    return "solved"


def _drop_word(chance, raw, _other):
    words = raw.split(b" ")
    del words[chance.randrange(len(words))]
    return b" ".join(words)


def _replace_word(chance, raw, _other):
    words = raw.split(b" ")
    words[chance.randrange(len(words))] = chance.choice(NASTY).encode()
    return b" ".join(words)


def _insert(chance, raw, _other):
    at = chance.randrange(len(raw) + 1)
    return raw[:at] + chance.choice(NASTY).encode() + raw[at:]


def _change_digit(chance, raw, _other):
    digits = [at for at, byte in enumerate(raw) if byte in b"0123456789"]
    if not digits:
        return raw
    at = chance.choice(digits)
    return raw[:at] + bytes([chance.choice(b"0123456789-. ")]) + raw[at + 1 :]


def _change_byte(chance, raw, _other):
    at = chance.randrange(len(raw) + 1)
    return raw[:at] + bytes([chance.randrange(256)]) + raw[at + 1 :]


def _truncate(chance, raw, _other):
    return raw[: chance.randrange(len(raw) + 1)]


def _drop_line(chance, raw, _other):
    lines = raw.split(b"\n")
    del lines[chance.randrange(len(lines))]
    return b"\n".join(lines)


def _double_line(chance, raw, _other):
    lines = raw.split(b"\n")
    at = chance.randrange(len(lines))
    return b"\n".join(lines[: at + 1] + lines[at:])


def _swap_lines(chance, raw, _other):
    lines = raw.split(b"\n")
    a, b = (chance.randrange(len(lines)) for _ in range(2))
    lines[a], lines[b] = lines[b], lines[a]
    return b"\n".join(lines)


def _splice(chance, raw, other):
    return raw[: chance.randrange(len(raw) + 1)] + other[chance.randrange(len(other) + 1) :]


def _line_ends(chance, raw, _other):
    return raw.replace(b"\n", chance.choice((b"\r\n", b"\r", b" ", b"\n\n")))


DAMAGES = (
    *(_drop_word, _replace_word, _insert, _change_digit, _change_digit, _change_byte, _truncate),
    *(_drop_line, _double_line, _swap_lines, _splice, _line_ends),
)

if __name__ == "__main__":
    sys.exit(main())
