"""FMBD.DAT → Tree: what the cards of DAFMS mean (thesis of Zhao, 1992, chapter 2 and appendix C)."""

import numpy as np

from ..errors import Fault, ModelError
from ..read.deck import Deck
from .dafms_bodies import build_bodies
from .dafms_hinges import build_hinges
from .dafms_laws import build_closures, build_laws
from .dafms_start import build_integration, build_start, build_time
from .deck_values import DeckValues
from .findings import Findings
from .moving_inertia import check_inertia
from .tree import Tree

GRAVITY = (0.0, 9.8, 0.0)


def build_dafms(deck: Deck) -> tuple[Tree, list[Fault]]:
    """The tree that `deck` describes, and what was doubtful; `ModelError` with every error found."""
    values, findings = DeckValues(deck), Findings()
    bodies = build_bodies(values, findings)
    hinges = build_hinges(values, bodies, findings)
    time = build_time(values, findings)
    integration = build_integration(values, findings)
    _stop_at_errors(findings)
    laws = build_laws(values, bodies, hinges, findings)
    closures = build_closures(values, bodies, findings)
    _stop_at_errors(findings)
    q, y = build_start(values, bodies, hinges, laws["prescribed"], findings)
    one_way = values.record("one_way") is not None
    gravity = tuple(values.values("gravity", 0, (0, *GRAVITY))[1:])
    tree = Tree(
        bodies,
        hinges,
        q,
        y,
        time,
        gravity,
        closures=closures,
        one_way=one_way,
        integration=integration,
        **laws,
    )
    check_inertia(tree, values, findings)
    _check_finite(tree, findings)
    _stop_at_errors(findings)
    return tree, findings.faults


def _stop_at_errors(findings):
    if findings.errors:
        raise ModelError(findings.faults)


def _check_finite(tree, findings):
    """`--set` may bring numbers that no card can hold."""
    if not (np.isfinite(tree.q).all() and np.isfinite(tree.y).all()):
        findings.error("Y(L)", "an initial coordinate or speed is not finite", None)
