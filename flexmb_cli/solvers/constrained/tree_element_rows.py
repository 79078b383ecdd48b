"""Report rows of trees with elements, by both formulations."""

from dataclasses import dataclass
from typing import Any

import numpy as np

from ...kernels.constrained.report import Report
from ...model.arrays.system import SystemArrays
from ...model.arrays.tree_elements import TURN_ROW
from ...model.joint_elements import names_of
from ...model.tree import Tree
from ..tree.rows import TreeRows
from .element_rows import (
    ElementAnswers,
    answers_of,
    coupling_efforts,
    curve_motion,
    element_answers,
    general_forces,
    joined,
)


@dataclass(frozen=True)
class TreeElementRows(ElementAnswers, TreeRows):
    """Rows with what every element does."""

    driver_effort: np.ndarray  # (T, drivers) along the prescribed coordinates


def with_elements(tree: Tree, arrays: SystemArrays, rows: TreeRows, report: Report) -> TreeElementRows:
    """The rows with the elements, whose loads stand behind those of the tree."""
    behind = len(list(names_of(tree.elements))) + len(tree.elements.curves)
    first = report.responses.shape[1] - behind
    return joined(
        TreeElementRows,
        rows,
        **element_answers(report, first, tree.elements),
        driver_effort=report.multipliers[:, rows_of_drivers(tree, arrays)].copy(),
        coupling_effort=coupling_efforts(report, arrays, tree.elements, len(tree.closures)),
        **track_forces(tree, rows),
        **general_forces(report, _first_general(tree, len(arrays.groups)), tree.elements.generals),
    )


def rows_of_drivers(tree: Tree, arrays: SystemArrays) -> np.ndarray:
    """Numbers (drivers,) of the equations of prescribed coordinates, then of those that follow functions.

    Their groups stand behind the hinges and before the closures, couplings between them.
    """
    prescribed, couplings = len(tree.prescribed), len(tree.elements.couplings)
    end = len(arrays.groups) - len(tree.closures)
    functions = np.arange(end - len(tree.elements.drivers), end)
    first = end - functions.size - couplings - prescribed
    groups = np.concatenate([np.arange(first, first + prescribed), functions])
    return arrays.groups["first_row"][groups]


def track_forces(tree: Tree, rows: TreeRows) -> dict[str, np.ndarray]:
    """Forces (T, rolls or curves, 3) on what rolls and on points on curves, general joints between them."""
    end = len(tree.closures)
    first, curves = _first_general(tree, end), end - len(tree.elements.curves)
    rolls = slice(first - len(tree.elements.rolls), first)
    return {"roll_force": rows.closure_force[:, rolls], "curve_force": rows.closure_force[:, curves:]}


def _first_general(tree: Tree, end: int) -> int:
    """Number of the first general joint among closures that end there, before those of curves."""
    return end - len(tree.elements.curves) - len(tree.elements.generals)


def _forces_of_generals(tree: Tree, rows: TreeRows, closures: np.ndarray) -> dict[str, np.ndarray]:
    """Forces and torques (T, general joints, 3) on their second bodies, from their rows (T, R)."""
    first = _first_general(tree, len(tree.closures))
    end = first + len(tree.elements.generals)
    turning = (
        np.where(closures["type"] == TURN_ROW, closures["force"], 0.0)[..., None] * closures["direction"]
    )
    owners = [k for k, closure in enumerate(tree.closures) for _ in closure.directions]
    torque = np.zeros((len(closures), end - first, 3))
    for row, owner in enumerate(owners):
        if first <= owner < end:
            torque[:, owner - first] += turning[:, row]
    return {"general_force": rows.closure_force[:, first:end], "general_torque": torque}


def rows_of_curves(tree: Tree) -> list[int]:
    """Number of the first closed direction of each curve."""
    owners = [closure.curve for closure in tree.closures for _ in closure.directions]
    return [k for k, curve in enumerate(owners) if curve][::2]


def with_answers(tree: Tree, rows: TreeRows, report: Any) -> TreeElementRows:
    """The rows by Kane's equations with what the elements answered; energy of elements is no work."""
    end, count = report.rows.shape[1] - 1, report.answers.shape[1]
    works = report.rows[:, end - count : end]
    scales = np.array([item.scale for item in tree.elements.couplings])
    tracks = report.closures[:, rows_of_curves(tree)]
    return joined(
        TreeElementRows,
        rows,
        **answers_of(tree.elements, report.answers, works, report.signals),
        coupling_effort=report.closures["force"][:, len(report.closures[0]) - len(scales) :] / scales,
        **curve_motion(tree.elements, tracks["parameter"], tracks["advance"]),
        **track_forces(tree, rows),
        **_forces_of_generals(tree, rows, report.closures),
        driver_effort=report.drives,
    )
