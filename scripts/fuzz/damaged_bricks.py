"""Finite-element files: one of those that a deck names is damaged, and its body is reduced."""

import json
import os

import fe_seeds
from answer import answered
from damage import damaged_bytes, damaged_text


def modes_of_brick(chance, seeds, work):
    deck = chance.choice(sorted(seeds.glob("*.vsdf")))
    files = json.loads((seeds / "files.json").read_text())
    victim = chance.choice([*files[deck.name], deck.name] if chance.random() < 0.1 else files[deck.name])
    for name in (deck.name, *files[deck.name]):
        if name != victim:
            os.link(seeds / name, work / name)
    raw = (seeds / victim).read_bytes()
    other = (seeds / chance.choice(sorted({n for names in files.values() for n in names}))).read_bytes()
    damaged = damaged_bytes if victim.endswith(".bin") else damaged_text
    (work / victim).write_bytes(damaged(chance, raw, other))
    return answered(["modes", str(work / deck.name), *chance.choice(([], ["--json"]))])


def brick_seeds(folder):
    (folder / "files.json").write_text(json.dumps(fe_seeds.write_seeds(folder)))
