"""Hinges of a tree as the joints of its elements."""

import numpy as np

from ..arrays.constraint_table import PrimitiveTable
from ..tree import Tree
from .frames import Frames
from .hinges import coordinate_primitive


class HingeJoints:
    """Hinges, numbered as their bodies, with coordinates "rotation 1" to "translation 3"."""

    def __init__(self, table: PrimitiveTable, tree: Tree, frames: Frames):
        self.table, self.tree, self.frames = table, tree, frames

    def start(self, joint: int, coordinate: str) -> float:
        """A coordinate at the start."""
        return float(
            next(
                q
                for c, q in zip(self.tree.coordinates, self.tree.q, strict=True)
                if (c.body, f"{c.motion} {c.axis}") == (joint, coordinate)
            )
        )

    def primitive(self, joint: int, coordinate: str, expected: float = 0.0) -> np.ndarray:
        """The primitive of a hinge coordinate, which begins with that of the tree."""
        motion, axis = coordinate.split()
        first = self.start(joint, coordinate)
        return coordinate_primitive(self.table, self.tree, self.frames, joint, motion, int(axis), first)

    def bodies(self, joint: int) -> tuple[int, int]:
        """The body of its base, and its own."""
        return self.frames.bases[joint].body, joint

    def axis(self, joint: int) -> int:
        """The body vector along the only axis that its hinge is free about or along."""
        hinge, base = self.tree.hinges[joint], self.frames.bases[joint]
        axis = (*hinge.rotations, *hinge.translations)[0]
        return self.table.body_vector(base.body, base.axes[:, axis - 1])

    def sliding(self, joint: int) -> tuple[str | None, str | None]:
        """Its rotation and its translation."""
        hinge = self.tree.hinges[joint]
        turn, slide = (
            f"{motion} {axes[0]}" if axes else None
            for motion, axes in (("rotation", hinge.rotations), ("translation", hinge.translations))
        )
        return turn, slide

    def pitch(self, joint: int) -> float:
        """No hinge is a screw."""
        return 0.0
