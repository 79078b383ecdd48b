"""Decks: read, built and listed in this process, a thousand a second, or given to `flexmb check`."""

import traceback
import warnings
from importlib import import_module
from pathlib import Path

from answer import Answer, answered
from damage import damaged_text

from flexmb_cli.deck.text import decode
from flexmb_cli.dialects.recognise import read_deck
from flexmb_cli.errors import DONE, FlexmbError, compiler_style

DECKS = Path(__file__).parents[2] / "decks"


def _decks(*dialects):
    found = [path for name in dialects for path in sorted((DECKS / name).rglob("*"))]
    return [path for path in found if path.suffix.lower() in (".dat", ".vsdf")]


def read_deck_of(dialect, chance, seeds, work):
    decks = _decks(dialect)
    path = chance.choice(decks)
    other = chance.choice(decks if chance.random() < 0.8 else _decks("young", "dafms", "vsdf"))
    raw = damaged_text(chance, path.read_bytes(), other.read_bytes())
    (work / path.name).write_bytes(raw)
    return built(path.name, raw, path.parent)


def built(name, raw, folder) -> Answer:
    """Read, build and list a deck."""
    from flexmb_cli.results.texts.echo import echo

    lines, faults, reported = [], (), ""
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("error")
            source = decode(name, raw)
            lines = source.lines
            deck = read_deck(source)
            reported = echo(deck)
            faults = (*deck.warnings, *_model(deck, folder))
    except FlexmbError as refused:
        return Answer(refused.exit_code, reported, "", unfit(name, refused.faults, lines))
    except Exception:
        return Answer(None, reported, "", traceback.format_exc())
    return Answer(DONE, reported, "", unfit(name, faults, lines))


def _model(deck, folder):
    """The warnings of the model that a deck describes."""
    name = f"build_{deck.dialect}"
    build = getattr(import_module(f"flexmb_cli.dialects.{deck.dialect}.build"), name)
    return build(deck, folder)[1] if deck.dialect == "vsdf" else build(deck)[1]


def unfit(name, faults, lines):
    """What is wrong with faults as they are shown: each is a sentence without unprintable characters."""
    for line in compiler_style(name, faults, lines).split("\n"):
        if not all(char.isprintable() or char == "\t" for char in line):
            return f"unprintable character in {line!r}"
        if "Traceback" in line or "None" in line.partition("; read")[0]:
            return f"no sentence: {line!r}"
    return ""


def check_deck(chance, seeds, work):
    decks = _decks("young", "dafms")
    path = chance.choice(decks)
    raw = damaged_text(chance, path.read_bytes(), chance.choice(decks).read_bytes())
    (work / path.name).write_bytes(raw)
    options = chance.choice(([], ["--json"], ["--jacobian", "estimate"]))
    return answered(["check", str(work / path.name), *options])
