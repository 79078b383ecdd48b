"""The state of the motion of a tree, which its assembly and its integrators read and move."""

from abc import ABC, abstractmethod

import numpy as np

from ...errors import AnalysisError, Fault
from ...kernels.integrators import tree_dop853
from ...kernels.tree.work import tree_work
from ...model.arrays.tree import TreeArrays, initial_attitudes, tree_arrays
from ...model.joint_elements import names_of
from ...model.signals import initial_states
from ...model.tree import Tree


class TreeState(ABC):
    """Arrays of a tree, and how far the integration of its equations has come."""

    def __init__(self, tree: Tree):
        self.tree = tree
        self.arrays: TreeArrays = tree_arrays(tree)
        self.work, self.coordinates = tree_work(len(self.arrays.frames), len(tree.coordinates))
        start = initial_state(tree, len(self.arrays.signals.states))
        self.coordinates["held"] = self.arrays.given
        works = 1 + len(self.arrays.answers)
        if works > 1 and self.arrays.given.all() and tree.integration.method == "dop853":
            works = 0  # where nothing is free to move, errors of works alone show what a step passes over
        self.integration = tree_dop853.new_integration(start.size, works)
        self.integration.z[:] = start
        self.clock = self.integration.clock
        self.clock["t"] = self.clock["step_start"] = tree.time.start
        self.clock["rtol"], self.clock["atol"] = tree.integration.rtol, tree.integration.atol
        self.row = 0
        self.attitude: np.ndarray | None = None  # (N, 4) Euler parameters of the last row
        self.repeated: np.ndarray | None = None  # (R,) closed directions that depend on others at the start
        self.warnings: list[Fault] = []  # fills at the start
        self.loop_note: Fault | None = None  # on loops that close only nearly
        self.resumed = False
        self.sampled_at = np.nan  # time of the last samples of signals, s

    @property
    def state(self) -> np.ndarray:
        """State (n,) at the end of the last step: speeds, coordinates, Euler parameters, work."""
        return self.integration.z

    @abstractmethod
    def failure(self) -> AnalysisError:
        """Return what the clock says went wrong."""

    def call(self, task: int) -> int:
        """Have the kernel do one of the tasks of `tree_dop853` that make no steps; its code."""
        return int(tree_dop853.begin(task, self.arrays, self.work, self.coordinates, self.integration))


def initial_state(tree: Tree, states: int = 0) -> np.ndarray:
    """State (n,) at the start: speeds, coordinates, Euler parameters, so many states of bristles and signals,
    works of elements, applied work.
    """
    works = np.zeros(1 + len(list(names_of(tree.elements))))
    of_signals = initial_states(tree.elements.signals)
    bristles = np.zeros(max(states - of_signals.size, 0))
    attitudes = initial_attitudes(tree).ravel()
    return np.concatenate([tree.y, tree.q, attitudes, bristles, of_signals, works])
