"""Report rows of a tree with elements at its hinges."""

import numpy as np

from ...kernels.constrained.report import Report
from ...model.element_names import names_of
from ...model.tree import Tree
from ...quick_dataclass import dataclass, fields
from ..tree.rows import TreeRows
from .element_rows import element_answers


@dataclass(frozen=True)
class TreeElementRows(TreeRows):
    """Rows with what every element does, as those of `ElementRows`."""

    element_coordinate: np.ndarray  # (T, elements)
    element_rate: np.ndarray  # (T, elements)
    element_effort: np.ndarray  # (T, elements)
    element_power: np.ndarray  # (T, elements)
    element_energy: np.ndarray  # (T, elements)


def with_elements(tree: Tree, rows: TreeRows, report: Report) -> TreeElementRows:
    """The rows with the elements, whose loads stand behind those of the tree."""
    kept = {field.name: getattr(rows, field.name) for field in fields(TreeRows)}
    behind = len(list(names_of(tree.elements)))
    first = report.responses.shape[1] - behind
    found = element_answers(report, first, tree.elements, 0)
    own = {name: value for name, value in found.items() if name.startswith("element")}
    return TreeElementRows(**kept, **own)  # type: ignore[arg-type]
