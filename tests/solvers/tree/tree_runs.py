"""Trees from the supplied decks, and their rows joined to one block."""

from dataclasses import fields, replace
from pathlib import Path

import numpy as np

from flexmb_cli.deck.text import read_text
from flexmb_cli.dialects.dafms.build import build_dafms
from flexmb_cli.dialects.dafms.reader import read_dafms
from flexmb_cli.solvers.tree.analysis import TreeAnalysis
from flexmb_cli.solvers.tree.rows import TreeRows

DECKS = Path(__file__).parents[3] / "decks" / "dafms"


def deck_tree(name, tolerance=1e-10, **changes):
    """The tree of a supplied deck, integrated to `tolerance`."""
    tree, _ = build_dafms(read_dafms(read_text(DECKS / f"{name}.DAT")))
    settings = replace(tree.integration, rtol=tolerance, atol=tolerance)
    return replace(tree, integration=settings, **changes)


def joined(blocks):
    """One TreeRows of several."""
    values = [[getattr(block, item.name) for block in blocks] for item in fields(TreeRows)]
    return TreeRows(
        *(
            tuple(map(np.concatenate, zip(*parts, strict=True)))
            if isinstance(parts[0], tuple)
            else np.concatenate(parts)
            for parts in values
        )
    )


def run(tree):
    """All report rows of a tree."""
    return joined(list(TreeAnalysis(tree).rows()))
