"""Elements of a tree at its start: rest attitudes of bushings, sums of couplings, lines without direction."""

import numpy as np

from ...errors import AnalysisError
from ...kernels.integrators import clock as codes
from ...kernels.integrators import tree_dop853
from ...kernels.laws import COORDINATE, NORMAL
from ...model.arrays.tree_elements import IN_LINE, OF_BUSHING
from ...model.joint_elements import parts_in_arrays
from ...model.laws import BUSHING, CONTACT
from ...model.tree import Tree
from ..constrained.elements_at_start import notes_of_pressed_elements, refuse_undirected_lines
from ..constrained.failures import bushing_failure, crowd_failure, jam_failure
from .state import TreeState


def attach_elements(analysis: TreeState) -> None:
    """Attach bushings and couplings where the state of a TreeState is, whose loops are closed.

    Speeds are brought onto the couplings.  Raises ModelError for lines without a direction, AnalysisError
    for elements without a force or a tree without inertia.
    """
    arrays, n = analysis.arrays, analysis.arrays.given.size
    elements, coupled = arrays.elements, arrays.closures["coupling"] >= 0
    sums = arrays.closures["curve"][coupled] < 0
    _call(analysis, tree_dop853.GO_ON)
    values = arrays.couplings @ analysis.integration.trial[n : 2 * n]
    arrays.closures["value"][coupled] = np.where(sums, values, 0.0)
    axes = analysis.work["axes"].reshape(-1, 3, 3)
    turned = axes[elements["frame_j"]].swapaxes(1, 2) @ axes[elements["frame_i"]]
    elements["turned"] = turned.reshape(-1, 9)
    elements["expected"] = 0.0
    _call(analysis, tree_dop853.CLOSE if coupled.any() else tree_dop853.GO_ON)
    t, lengths = analysis.tree.time.start, arrays.answers[: elements.size, COORDINATE]
    lines = elements["measure"] == IN_LINE
    functions = arrays.curves, arrays.knots
    refuse_undirected_lines(analysis.tree.elements.forces, elements[lines], lengths[lines], functions, t)
    analysis.warnings += notes_of_pressed_elements(analysis.tree.elements, elements, arrays.answers)
    if failure := lost_force(analysis.tree, arrays.answers, t):
        raise failure


def _call(analysis: TreeState, task: int) -> None:
    if analysis.call(task) == codes.NO_INERTIA:
        raise analysis.failure()


def lost_force(tree: Tree, answers: np.ndarray, t: float) -> AnalysisError | None:
    """Return why elements with such answers (E + m, 8) have no force at t: a bushing, or friction."""
    bushings = [k for item, k in parts_in_arrays(tree.elements.forces) if item.law is BUSHING]
    turned = np.flatnonzero(np.isnan(answers[bushings, COORDINATE]))
    if turned.size:
        return bushing_failure(int(turned[0]) // OF_BUSHING, t)
    crowded = [k for item, k in parts_in_arrays(tree.elements.forces) if item.law is CONTACT]
    if np.isnan(answers[crowded, COORDINATE]).any():
        return crowd_failure(t)
    return jam_failure(t) if np.isnan(answers[:, NORMAL]).any() else None
