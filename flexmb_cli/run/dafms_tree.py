"""The tree of a DAFMS deck as the options of a run want it integrated."""

from dataclasses import replace

from ..model.build_dafms import build_dafms
from ..model.tree import Tree
from ..read.deck import Deck
from .outcome import Outcome, RunOptions, refuse_warnings


def tree_of(deck: Deck, options: RunOptions, outcome: Outcome) -> Tree:
    """The tree of `deck`, to be integrated as `options` say; its warnings go into `outcome`."""
    tree, warnings = build_dafms(deck)
    outcome.faults += warnings
    refuse_warnings(outcome, options)
    return replace(tree, integration=replace(tree.integration, **options.integration))
