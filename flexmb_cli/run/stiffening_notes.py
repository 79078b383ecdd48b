"""Notes on flexible bodies that turn fast for their frequencies and have no geometric stiffness."""

from collections.abc import Iterable, Mapping
from typing import NamedTuple

import numpy as np

from ..errors import Fault, Place

# Share of the deformation, (ω/ω₁)², from which a note is given: that of a beam across its axis of rotation.
NOTED = 0.05


class SoftBody(NamedTuple):
    """A flexible body without geometric stiffness: its place among the bodies and lowest frequency, rad/s."""

    row: int  # among the bodies of results, from 0
    name: str  # in messages
    lowest: float  # its lowest circular frequency, rad/s
    place: Place | None  # of its card, None: not known


class SpinCount:
    """The largest angular speeds of bodies over the rows; `remedy` ends the notes."""

    def __init__(self, bodies: Iterable[SoftBody] = (), remedy: str = ""):
        self.bodies, self.remedy = list(bodies), remedy
        self.fastest = np.zeros(len(self.bodies))

    def add(self, values: Mapping[str, np.ndarray]) -> None:
        """Take in a block of rows, by the paths of their datasets."""
        if self.bodies:
            turning = values["body/angular_velocity"][:, [body.row for body in self.bodies]]
            self.fastest = np.maximum(self.fastest, np.linalg.norm(turning, axis=2).max(axis=0))

    @property
    def notes(self) -> tuple[Fault, ...]:
        """Return a note for each body whose missing stiffness changes its deformation."""
        return tuple(
            Fault(
                "note",
                f"it turns with {speed:.3g} rad/s, and its lowest frequency is {body.lowest:.3g} rad/s: "
                "geometric stiffness, which it lacks, would change its deformation by a share of about "
                f"{(speed / body.lowest) ** 2:.2g}, the square of their ratio; {self.remedy}",
                body.place,
                body.name,
                id="SOLVE-250",
            )
            for body, speed in zip(self.bodies, self.fastest, strict=True)
            if speed**2 > NOTED * body.lowest**2
        )
