"""Blocks of rows of a DAFMS deck from its other formulation, in absolute coordinates."""

from collections.abc import Iterator

from ..model.tree import Tree
from ..solvers.compilation import tell_of_compiling
from .energy_drift import EnergyDrift
from .outcome import Listener


class AbsoluteMarch:
    """The blocks of one run, which cannot be resumed.  Raises ModelError for what is not carried over."""

    stopped_at = None
    estimate = None

    def __init__(self, tree: Tree, listener: Listener):
        from ..solvers.constrained.tree import AbsoluteTree

        self.tree = tree
        self.listener = listener
        self.analysis = AbsoluteTree(tree)
        self.drift = EnergyDrift()

    def blocks(self, _resume: bool = False) -> Iterator[dict]:
        """Yield report rows by the paths of their datasets."""
        from ..results.hdf5.tree import tree_values
        from ..solvers.tree.points import point_motion

        tell_of_compiling(self.listener, "integrators.constrained_dop853.march_rows")
        for rows in self.analysis.rows():
            values = tree_values(self.tree, rows, point_motion(self.tree, rows))
            self.drift.add(values)
            yield values

    @property
    def statistics(self) -> str:
        """Return what -v prints."""
        clock = self.analysis.clock[0]
        counts = f"{clock['evaluations']} evaluations, {clock['rejections']} rejected steps"
        return f"absolute coordinates: {counts}; {self.drift}"
