"""The motion at which a conversion takes a model, and joint coordinates counted from a deck's positions."""

import math
from dataclasses import dataclass
from typing import Any

import numpy as np

from .rigid_model import across


@dataclass(frozen=True, eq=False)
class Start:
    """Bodies at the first time, as solved: r, v, omega (bodies, 3), p (bodies, 4), and coordinates q."""

    r: np.ndarray
    p: np.ndarray
    v: np.ndarray
    omega: np.ndarray
    q: np.ndarray


@dataclass(frozen=True, eq=False)
class Pair:
    """Bodies i and j of a joint: origins r (3,) and rotation matrices A (3, 3)."""

    r_i: np.ndarray
    A_i: np.ndarray
    r_j: np.ndarray
    A_j: np.ndarray


def angle_between(s_i: tuple[float, float, float], first: Pair, now: Pair) -> float:
    """Angle of body j against body i about the axis s_i of i, 0 in the first positions."""
    s = np.array(s_i, float) / np.linalg.norm(s_i)
    f = across(s)
    h = now.A_j @ first.A_j.T @ first.A_i @ f
    return math.atan2(h @ (now.A_i @ np.cross(s, f)), h @ (now.A_i @ f))


def stroke_between(
    s_i: tuple[float, float, float],
    P_i: tuple[float, float, float],
    P_j: tuple[float, float, float],
    first: Pair,
    now: Pair,
) -> float:
    """Advance of P_j from P_i along the axis s_i of body i since the first positions."""
    s = np.array(s_i, float) / np.linalg.norm(s_i)

    def advance(at: Pair) -> Any:
        return (at.r_j + at.A_j @ np.array(P_j) - at.r_i - at.A_i @ np.array(P_i)) @ (at.A_i @ s)

    return float(advance(now) - advance(first))
