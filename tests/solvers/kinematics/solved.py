"""Mechanisms read from the decks, and all report rows of a run in one block."""

from dataclasses import fields, replace
from functools import cache
from pathlib import Path

import numpy as np
import pytest

from flexmb_cli.dialects.recognise import open_text, read_deck
from flexmb_cli.dialects.young.build import build_young
from flexmb_cli.errors import FlexmbError
from flexmb_cli.model.mechanism import Mechanism, TimeGrid
from flexmb_cli.solvers.kinematics.analysis import KinematicAnalysis
from flexmb_cli.solvers.kinematics.rows import Rows

REPOSITORY = Path(__file__).parents[3]
DECKS = sorted(path.stem for path in (REPOSITORY / "decks/young").glob("*.dat"))
PUBLISHED = REPOSITORY / "tests/published/young"


@cache
def mechanism_of(deck: str) -> Mechanism:
    """The mechanism that the deck decks/young/<deck>.dat describes."""
    return build_young(read_deck(open_text(str(REPOSITORY / f"decks/young/{deck}.dat"))))[0]


@cache
def rows_of_deck(deck: str) -> Rows:
    """All report rows of a deck."""
    return solved(mechanism_of(deck))


def solved(mechanism: Mechanism) -> Rows:
    """All report rows of a run from beginning to end."""
    return joined(list(KinematicAnalysis(mechanism).rows()))


def until_failure(mechanism: Mechanism) -> tuple[Rows | None, FlexmbError]:
    """The rows before the failure that a run must end with, None if there are none, and the failure."""
    blocks = []
    with pytest.raises(FlexmbError) as caught:
        for block in KinematicAnalysis(mechanism).rows():
            blocks.append(block)
    return (joined(blocks) if blocks else None), caught.value


def joined(blocks: list[Rows]) -> Rows:
    """One block of rows from several."""
    return Rows(**{f.name: np.concatenate([getattr(b, f.name) for b in blocks]) for f in fields(Rows)})


def at_times(mechanism: Mechanism, start: float, step: float, rows: int) -> Mechanism:
    """The same mechanism with `rows` report times from `start` on."""
    return replace(mechanism, time=TimeGrid(start, start + (rows - 1) * step, step))


def coordinates(rows: Rows, derivative: int = 0) -> np.ndarray:
    """All coordinates (T, bodies, 7), or their first or second derivatives."""
    names = (
        ("position", "euler_parameters"),
        ("velocity", "euler_parameter_rates"),
        ("acceleration", "euler_parameter_accelerations"),
    )
    return np.concatenate([getattr(rows, name) for name in names[derivative]], axis=2)
