"""Rates of joint coordinates at the start, as equations on speeds."""

from collections.abc import Sequence
from typing import Any

import numpy as np

from ...model.equations import Equation
from ...model.joint_elements import JointRate
from ...model.joints import ANGLE
from ...model.mechanism import Joint
from ...model.vectors import rotation_matrix


def rate_equations(
    joints: Sequence[Joint], rates: tuple[JointRate, ...], q: np.ndarray, speeds: int
) -> tuple[np.ndarray, np.ndarray, tuple[Equation, ...]]:
    """Rows (r, n) on speeds, right-hand sides (r,) and names of the joint rates that a deck gives at q.

    For axes in line: the rate of the angle is s · (ω_j - ω_i), that of the stroke s · (v_Pj - v_Pi).
    """
    rows = np.zeros((len(rates), speeds))
    for row, item in zip(rows, rates, strict=True):
        joint = joints[item.joint]
        s_i = np.array(joint.s_i) / np.linalg.norm(joint.s_i)
        A_i, A_j = (_attitude(q, body) for body in (joint.i, joint.j))
        s = A_i @ s_i
        for body, A, P, sign in ((joint.i, A_i, joint.P_i, -1.0), (joint.j, A_j, joint.P_j, 1.0)):
            if body < 0:
                continue
            along, at = A.T @ s, 6 * body
            if item.coordinate == ANGLE:
                row[at + 3 : at + 6] += sign * along
            else:
                row[at : at + 3] += sign * s
                row[at + 3 : at + 6] += sign * np.cross(P, along)
    names = tuple(Equation(item.name, f"rate of the {item.coordinate}", item.place, 1.0) for item in rates)
    return rows, np.array([item.rate for item in rates]), names


def _attitude(q: np.ndarray, body: int) -> Any:
    """Rotation matrix of a body at q; the ground's is 1."""
    return rotation_matrix(q[7 * body + 3 : 7 * body + 7]) if body >= 0 else np.eye(3)
