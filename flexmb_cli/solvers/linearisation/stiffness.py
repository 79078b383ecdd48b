"""Stiffness of a mechanism in equilibrium, in its independent joint coordinates."""

from dataclasses import dataclass
from typing import Any

import numpy as np

from .motion import STENCIL, LinearisedMotion

SAME_SIZE = 1e-7  # of the largest eigenvalue: what is smaller is none, but for the error of differences


@dataclass(frozen=True)
class Stiffness:
    """Stiffness of f independent coordinates y in equilibrium.

    `names`, `units`, `relative_to` (f,): of the coordinates, and the bodies that they are relative to;
    `matrix` (f, f): -dQ/dy of their generalised forces Q, units of Q over those of y; `eigenvalues` (f,):
    of its product with the inverse mass matrix, 1/s², smallest first.  A negative one is that of a motion
    that grows: an equilibrium at rest is then unstable.
    """

    names: tuple[str, ...]
    units: tuple[str, ...]
    relative_to: tuple[str, ...]
    matrix: np.ndarray
    eigenvalues: np.ndarray

    @property
    def lowest(self) -> float:
        """Return the lowest eigenvalue, 1/s²; nan where nothing can move."""
        return float(self.eigenvalues[0]) if self.eigenvalues.size else float("nan")

    @property
    def stability(self) -> str:
        """Return "stable", "unstable", "neutral", or "fixed" where nothing can move."""
        if not self.eigenvalues.size:
            return "fixed"
        if self.lowest < 0.0:
            return "unstable"
        return "neutral" if self.lowest == 0.0 else "stable"


def stiffness_of(motion: LinearisedMotion) -> Stiffness:
    """Return the stiffness about the equilibrium in which the analysis of `motion` stands."""
    from .constrained_responses import constrained_signals
    from .tree import TreeLinearised
    from .tree_responses import tree_signals

    signals: Any = tree_signals if isinstance(motion, TreeLinearised) else constrained_signals
    states = signals(motion)
    Z, units = motion.Z, motion.units
    mass = Z.T @ motion.mass_times(Z)
    rates = motion.standing_stiffness(STENCIL)  # of scaled accelerations
    values = np.sort(np.linalg.eigvals(-rates).real)
    values[np.abs(values) <= SAME_SIZE * np.max(np.abs(values), initial=0.0)] = 0.0
    states = states[: motion.dofs]
    return Stiffness(
        tuple(state.name for state in states),
        tuple(state.unit for state in states),
        tuple(state.relative_to for state in states),
        -mass @ (units[:, None] * rates / units),
        values + 0.0,
    )
