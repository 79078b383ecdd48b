"""Report rows of a tree: what is found at the states of the report times."""

from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from .._jit import kernel
from ..linalg.number_rows import copy
from ..signals import VALUE
from .energy import energies
from .hinge_forces import set_reactions
from .motion import parts
from .projection import largest_gap, largest_rate

if TYPE_CHECKING:
    from ...model.arrays.tree import TreeArrays


class Report(NamedTuple):
    """Report rows of one call: T times and what is found at them."""

    times: np.ndarray  # (T,) s
    rows: np.ndarray  # (T, n) states: m, rad, m/s, rad/s, J
    frames: np.ndarray  # (T, F) FRAME_WORK records
    rates: np.ndarray  # (T, NS) y', m/s² or rad/s²
    closures: np.ndarray  # (T, R) CLOSURE_ROW records
    audit: np.ndarray  # (T, 5) kinetic, potential, strain energy, J, largest gap, m, its rate, m/s
    answers: np.ndarray  # (T, E, 8) of the elements, SI units
    drives: np.ndarray  # (T, prescribed) efforts along prescribed coordinates, N or N m
    signals: np.ndarray  # (T, S) values of signals, SI units
    reactions: np.ndarray  # (T, F, 6) force of its hinge on every frame, N, and moment about its origin, N m


@kernel
def observe(
    tree: "TreeArrays", work: np.ndarray, coordinates: np.ndarray, z: np.ndarray, report: Report, row: int
) -> None:
    """Fill a report row from the state z, which has just been evaluated."""
    copy(z, report.rows[row])
    for k in range(work.shape[0]):
        report.frames[row, k] = work[k]
    for m in range(coordinates.shape[0]):
        report.rates[row, m] = coordinates[m]["rate"]
    for j in range(tree.closures.shape[0]):
        report.closures[row, j] = tree.closures[j]
    for i in range(tree.answers.shape[0]):
        copy(tree.answers[i], report.answers[row, i])
    for i in range(tree.signals.values.shape[0]):
        report.signals[row, i] = tree.signals.values[i, VALUE]
    for i in range(tree.prescribed.shape[0]):
        report.drives[row, i] = coordinates[tree.prescribed[i]["coordinate"]]["drive"]
    if not tree.one_way:
        set_reactions(tree, work)
    for k in range(tree.reactions.shape[0]):
        copy(tree.reactions[k], report.reactions[row, k])
    y, q, _attitudes = parts(tree, z)
    audit = report.audit[row]
    audit[0], audit[1], audit[2] = energies(tree, work, q, y)
    audit[3], audit[4] = largest_gap(tree.closures), largest_rate(tree.closures)
