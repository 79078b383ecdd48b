"""YOUNG decks with one moving body, or two, and cards of elements at joints."""

from dataclasses import fields

import numpy as np

from flexmb_cli.deck.text import decode
from flexmb_cli.dialects.recognise import read_deck
from flexmb_cli.dialects.young.build_dynamics import build_young_dynamics
from flexmb_cli.solvers.constrained.element_rows import ElementRows
from flexmb_cli.solvers.constrained.young_dynamics import DrivenDynamics, ForwardDynamics

# Body 1 is the ground; body 2 is free.
FREE = "2 0 0 0 0 0 0 0 0 0 0 1\n0 0 0 1 0 0 0\n0 0 0 1 0 0 0\n1 0 0 0 0 0 0\n"
# Body 1 is the ground; body 2 turns about z, or slides along x.
ROTOR = """2 0 0 0 0 1 0 0 0 0 0 1
0 0 0 1 0 0 0
0 0 0 1 0 0 0
1 2 0 0 0 0 0 0 0 0 1 0 0 1
1 0 0 0 0 0 0
"""
SLIDER = """2 0 0 0 0 0 0 1 0 0 0 1
0 0 0 1 0 0 0
0 0 0 1 0 0 0
1 2 0 0 0 0 0 0 1 0 0 1 0 0 0 1 0 0 0 1
1 0 0 0 0 0 0
"""
# Bodies 2 and 3 turn about z, the second on the end of the first, 1 m away.
ARM = """3 0 0 0 0 2 0 0 0 0 0 1
0 0 0 1 0 0 0
0 0 0 1 0 0 0
1 0 0 1 0 0 0
1 2 0 0 0 0 0 0 0 0 1 0 0 1
2 3 1 0 0 0 0 0 1 0 1 0 0 1
1 0 0 0 0 0 0
"""
# Bodies 2 and 3 turn about z beside each other on the ground.
TWO_ROTORS = """3 0 0 0 0 2 0 0 0 0 0 1
0 0 0 1 0 0 0
0 0 0 1 0 0 0
1 0 0 1 0 0 0
1 2 0 0 0 0 0 0 0 0 1 0 0 1
1 3 1 0 0 0 0 0 1 0 1 0 0 1
1 0 0 0 0 0 0
"""
METHODS = {"DOP853": "", "RAD5": "RAD5\n", "GALF": "GALF 0 0.9\nTOLERANCE 1e-6\n"}


def model_of(mechanism, times, cards, analysis="forward"):
    """The model of a deck with "start end step" and cards."""
    text = f"{mechanism}{times}\nDYNAMICS {analysis}\n{cards}\nEND\n"
    return build_young_dynamics(read_deck(decode("test.dat", text.encode())))[0]


def analysis_of(model):
    return DrivenDynamics(model) if model.analysis == "inverse" else ForwardDynamics(model)


def rows_of(mechanism, times, cards, analysis="forward") -> ElementRows:
    """All rows of a deck with elements."""
    blocks = list(analysis_of(model_of(mechanism, times, cards, analysis)).rows())
    return ElementRows(
        **{f.name: np.concatenate([getattr(b, f.name) for b in blocks]) for f in fields(ElementRows)}
    )
