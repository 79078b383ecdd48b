"""Differences of the echoes of the historic program: Zhao, thesis (1992), appendix C."""

import numpy as np

SINGLE_PRECISION = "the program of 1992 read its deck in single precision"


def single_precision(a: np.ndarray, b: np.ndarray, unit: np.ndarray) -> np.ndarray:
    """Return whether a and b may be one number, printed by its nearest single and by its nearest double."""
    size = np.maximum(np.abs(a), np.abs(b))
    with np.errstate(invalid="ignore"):
        # Each rounding to the printed digits takes half a unit.
        found: np.ndarray = np.abs(a - b) <= np.finfo(np.float32).eps / 2 * size + (1 + 1e-9) * unit
        return found
