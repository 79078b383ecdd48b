"""Inputs and outputs of the linearised motion of a tree in absolute coordinates, in the terms of the tree."""

from typing import TYPE_CHECKING, Any, cast

import numpy as np

from ...model.tree import ELASTIC, INERTIAL, ROTATION
from ..tree.points import point_motion, point_names
from .constrained_responses import AXES, ConstrainedResponses
from .state_space import MOVED_POINT, Signal

if TYPE_CHECKING:
    from ..constrained.tree import AbsoluteTree
    from ..constrained.tree_element_rows import TreeElementRows
    from .constrained import ConstrainedLinearised


class AbsoluteTreeResponses(ConstrainedResponses):
    """Responses about a ConstrainedLinearised whose analysis is an AbsoluteTree with elements.

    Outputs are hinge coordinates and their rates, then points along axes of their bodies, forces of
    closures, efforts of drivers.
    """

    analysis: "AbsoluteTree"

    def __init__(self, motion: "ConstrainedLinearised"):
        self.tree = cast("AbsoluteTree", motion.analysis).tree
        self._rigid = [m for m, c in enumerate(self.tree.coordinates) if c.motion != ELASTIC]
        self._bodies = [hinge.parent for hinge in self.tree.hinges]
        for k, body in enumerate(self.tree.bodies):
            self._bodies += [k] * (len(body.elastic.masses) if body.elastic else 0)
        super().__init__(motion)
        self.relative = [
            Signal(c.name, "rad" if c.motion == ROTATION else "m")
            for c in (self.tree.coordinates[m] for m in self._rigid)
        ]

    def _observed(self) -> list[Signal]:
        names = [name for name, body in zip(point_names(self.tree), self._bodies, strict=True) if body >= 0]
        points = [(name, *what) for name in names for what in MOVED_POINT]
        closures = [(closure.name, "force", "N") for closure in self.tree.closures]
        vectors = [Signal(f"{n} {what} {axis}", unit) for n, what, unit in points + closures for axis in AXES]
        drivers = [Signal(f"{n} effort", "N" if long else "N m") for n, long in self.terms.drivers]
        return vectors + drivers

    # Its analysis makes rows of no other class.
    def _outputs(self, rows: "TreeElementRows") -> np.ndarray:  # type: ignore[override]
        """Observed outputs of a row."""
        motion = point_motion(self.tree, rows)
        found = [
            self._along(body, part[0, k])
            for k, body in enumerate(self._bodies) if body != INERTIAL
            for part in motion
        ]  # fmt: skip
        return np.concatenate([*found, rows.closure_force[0].ravel(), rows.driver_effort[0]])

    def _functionals(self, q: np.ndarray) -> Any:
        """Rates of the hinge coordinates (r, n) by the speeds at the position q."""
        z = self.analysis.integration.z
        kept = z[: q.size].copy()
        z[: q.size] = q
        try:
            return self.analysis.hinge_coordinates()[1][self._rigid]
        finally:
            z[: q.size] = kept
