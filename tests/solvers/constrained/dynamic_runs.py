"""Runs from beginning to end in one block, and mechanisms of the decks with masses given here."""

from dataclasses import fields
from pathlib import Path

import numpy as np

from flexmb_cli.deck.text import read_text
from flexmb_cli.dialects.recognise import read_deck
from flexmb_cli.dialects.young.build import build_young
from flexmb_cli.model.loads import DynamicModel, MassProperties
from flexmb_cli.model.mechanism import Body, Ground
from flexmb_cli.solvers.constrained.rows import DynamicRows
from flexmb_cli.solvers.constrained.young_dynamics import ForwardDynamics
from flexmb_cli.solvers.kinematics.inverse_dynamics import InverseDynamics

DECKS = Path(__file__).parents[3] / "decks/young"
GROUND = Body("body 1", (0.0, 0.0, 0.0), (1.0, 0.0, 0.0, 0.0))
AT_REST = Ground("ground 1", 0, (0.0,) * 6)


def mechanism_of(deck):
    return build_young(read_deck(read_text(str(DECKS / f"{deck}.dat"))))[0]


def run(model: DynamicModel) -> DynamicRows:
    """All rows of an inverse or forward run."""
    analysis = InverseDynamics(model) if model.analysis == "inverse" else ForwardDynamics(model)
    return joined(list(analysis.rows()))


def joined(blocks):
    kept = {f.name: np.concatenate([getattr(b, f.name) for b in blocks]) for f in fields(DynamicRows)}
    return DynamicRows(**kept)


def uneven_masses(bodies):
    """Masses with all elements different from zero and from each other."""
    return tuple(
        MassProperties(
            f"mass {b + 1}",
            b,
            1.3 + 0.7 * b,
            (0.11 - 0.03 * b, -0.07 + 0.02 * b, 0.05 * b + 0.02),
            (0.31 + 0.1 * b, 0.42 + 0.1 * b, 0.53 + 0.1 * b, 0.021, -0.034, 0.045),
        )
        for b in range(bodies)
    )


def body(number, r=(0.0, 0.0, 0.0), p=(1.0, 0.0, 0.0, 0.0)):
    return Body(f"body {number}", r, p)
