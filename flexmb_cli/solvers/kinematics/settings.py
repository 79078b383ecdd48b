"""Solver settings of a kinematic analysis that a user may override."""

from dataclasses import dataclass


@dataclass(frozen=True)
class KinematicSettings:
    """Limits of Newton's method.

    `tolerance`: scaled residual at which iteration ends early; 0 continues to round-off (YOUNG's FEPS
    was 1e-4).  `smallest_pivot`: scaled pivot below which a position counts as singular (EPSLU, 1e-5).
    `most_iterations`: for the assembly of the estimates (NRMAX, 250).  `most_ranked`: equations among which
    those that repeat others are looked for, by singular values: some minutes for 5,000.
    """

    tolerance: float = 0.0
    smallest_pivot: float = 1e-13
    most_iterations: int = 250
    most_ranked: int = 10_000
