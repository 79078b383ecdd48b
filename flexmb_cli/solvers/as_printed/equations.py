"""Equations of the joints as the program evaluates them, with the errors that are requested.

Liang Yong (1996), section 4.2 and Appendix A, units YOUNG_3 and YOUNG_4.  Vectors along the axis keep the
length that the deck gives them.  Without errors the equations are those of the text, corrected as in the
errata, and give the motion that the kernels give.
"""

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from .errors import OVERRUN, TRANSPOSED, WRONG_INDEX
from .vectors import dot, g_matrix, product, tilde, turned, turned_slope

if TYPE_CHECKING:
    from ...model.mechanism import Joint


MOST_BODIES = 10  # rows of the program's arrays M10X7
EYE = np.eye(3)


@dataclass
class State:
    """Coordinates (n, 7), their rates, and what the program keeps from one evaluation to the next.

    The row of an orthogonality adds up in HQI and HQJ, of three elements each, and is cleared there only: the
    fourth of HQI is the first of HQJ, the fourth of HQJ the x component of A_i P_i, both from the evaluation
    before (`behind_i`, `behind_j`).
    """

    q: np.ndarray
    qd: np.ndarray
    errors: frozenset[str]
    behind_i: float = 0.0
    behind_j: float = 0.0

    @property
    def motion(self) -> tuple[np.ndarray, np.ndarray]:
        """Coordinates and rates."""
        return self.q, self.qd

    def p(self, body: int) -> np.ndarray:
        """Euler parameters of a body."""
        return self.q[body, 3:]

    def pd(self, body: int) -> np.ndarray:
        """Their rates."""
        return self.qd[body, 3:]

    def vector(self, body: int, s: Any) -> np.ndarray:
        """A s, global axes."""
        return turned(self.p(body), s)

    def slope(self, body: int, s: Any) -> np.ndarray:
        """∂(A s)/∂p (3, 4)."""
        return 2.0 * turned_slope(self.p(body), s)

    def remainder(self, body: int, s: Any) -> np.ndarray:
        """The part of d²(A s)/dt² without second derivatives of p."""
        return 2.0 * turned(self.pd(body), s)

    def omega(self, body: int) -> np.ndarray:
        """Angular velocity 2 G ṗ (3.35), global axes."""
        return 2.0 * product(g_matrix(self.p(body)), self.pd(body))

    def rate(self, body: int, s: np.ndarray | tuple[float, float, float]) -> np.ndarray:
        """d(A s)/dt, to which the program adds a velocity with its indices exchanged."""
        rate = product(tilde(self.omega(body)), self.vector(body, s))
        return rate + self._phantom(body) if TRANSPOSED in self.errors else rate

    def _phantom(self, body: int) -> np.ndarray:
        memory = np.zeros(7 * (MOST_BODIES + 1))
        memory[: self.qd.size] = self.qd.ravel()
        return memory[body : body + 21 : 7]


@dataclass
class Rows:
    """Equations of a joint: residuals, Jacobian of bodies i and j (rows, 7), right-hand sides.

    `gamma` is that of the accelerations; that of the velocities is zero but for drivers.
    """

    residual: np.ndarray
    of_i: np.ndarray
    of_j: np.ndarray
    gamma: np.ndarray

    def chosen(self, rows: list[int]) -> "Rows":
        """Some of the rows."""
        return Rows(self.residual[rows], self.of_i[rows], self.of_j[rows], self.gamma[rows])


def stacked(*parts: Rows) -> Rows:
    """The rows of several parts."""
    return Rows(
        np.concatenate([part.residual for part in parts]),
        np.concatenate([part.of_i for part in parts]),
        np.concatenate([part.of_j for part in parts]),
        np.concatenate([part.gamma for part in parts]),
    )


def coincident(state: State, joint: "Joint") -> Rows:
    """P_i and P_j coincide, (4.7) to (4.13)."""
    i, j = joint.i, joint.j
    gap = state.q[i, :3] + state.vector(i, joint.P_i) - state.vector(j, joint.P_j) - state.q[j, :3]
    of_i = np.concatenate([EYE, state.slope(i, joint.P_i)], axis=1)
    of_j = -np.concatenate([EYE, state.slope(j, joint.P_j)], axis=1)
    gamma = state.remainder(j, joint.P_j) - state.remainder(i, joint.P_i)
    return Rows(gap, of_i, of_j, gamma)


def scalar_product(
    state: State,
    i: int,
    j: int,
    u_i: np.ndarray | tuple[float, float, float],
    u_j: np.ndarray | tuple[float, float, float],
) -> Rows:
    """u_i · u_j, (4.16) to (4.19)."""
    a, b = state.vector(i, u_i), state.vector(j, u_j)
    of_i, of_j = np.zeros((1, 7)), np.zeros((1, 7))
    of_i[0, 3:] = product(b[None, :], state.slope(i, u_i))[0]
    of_j[0, 3:] = product(a[None, :], state.slope(j, u_j))[0]
    gamma = -dot(a, state.remainder(j, u_j)) - dot(b, state.remainder(i, u_i))
    gamma -= 2.0 * dot(state.rate(i, u_i), state.rate(j, u_j))
    return Rows(np.array([dot(a, b)]), of_i, of_j, np.array([gamma]))


def orthogonal(
    state: State, i: int, j: int, u_i: tuple[float, float, float], u_j: tuple[float, float, float]
) -> Rows:
    """u_i · u_j = 0, where the program's columns of e3 overrun their arrays."""
    rows = scalar_product(state, i, j, u_i, u_j)
    if OVERRUN in state.errors:
        rows.of_i[0, 6] += state.behind_i
        rows.of_j[0, 6] += state.behind_j
        state.behind_i, state.behind_j = rows.of_j[0, 3], rows.of_j[0, 6]
    return rows


def parallel(state: State, joint: "Joint", indices_wrong: bool) -> Rows:
    """s_i × s_j = 0, (4.22) to (4.25): three rows, of which two are used."""
    i, j, s_i, s_j = joint.i, joint.j, joint.s_i, joint.s_j
    a, b = tilde(state.vector(i, s_i)), tilde(state.vector(j, s_j))
    still = np.zeros((3, 3))
    of_i = np.concatenate([still, -product(b, state.slope(i, s_i))], axis=1)
    of_j = np.concatenate([still, product(a, state.slope(j, s_j))], axis=1)
    multiply = _row_sums if indices_wrong else product
    gamma = (
        0.0  # no component is -0
        + multiply(a, -state.remainder(j, s_j))
        + multiply(b, state.remainder(i, s_i))
        + multiply(tilde(state.rate(i, s_i)), -2.0 * state.rate(j, s_j))
    )
    return Rows(product(a, state.vector(j, s_j)), of_i, of_j, gamma)


def _row_sums(matrix: np.ndarray, vector: np.ndarray) -> np.ndarray:
    """Return what the program has in place of a product: component M of the vector where N is meant."""
    return (matrix[:, 0] + matrix[:, 1] + matrix[:, 2]) * vector


def along(state: State, joint: "Joint") -> Rows:
    """s_i × d = 0, (4.28) to (4.31): three rows, of which two are used.

    With WRONG_INDEX the cylindrical joint takes s_j for s_i in the derivative with respect to p_i; the
    translational joint lacks the term of dd/dt.
    """
    i, j, s_i = joint.i, joint.j, joint.s_i
    a, d = tilde(state.vector(i, s_i)), separation(state, joint)
    wrong = WRONG_INDEX in state.errors
    taken = joint.s_j if wrong and joint.kind == "cylindrical" else s_i
    turning = -product(a, state.slope(i, joint.P_i)) - product(tilde(d), state.slope(i, taken))
    of_i = np.concatenate([-a, turning], axis=1)
    of_j = np.concatenate([a, product(a, state.slope(j, joint.P_j))], axis=1)
    gamma = product(a, state.remainder(i, joint.P_i) - state.remainder(j, joint.P_j))
    gamma += product(tilde(d), state.remainder(i, s_i))
    if not (wrong and joint.kind == "translational"):
        gamma -= 2.0 * product(tilde(state.rate(i, s_i)), separation_rate(state, joint, wrong))
    return Rows(product(a, d), of_i, of_j, gamma)


def separation(state: State, joint: "Joint") -> np.ndarray:
    """d (3,), the vector from P_i to P_j, m, global axes."""
    i, j = joint.i, joint.j
    return state.q[j, :3] + state.vector(j, joint.P_j) - state.q[i, :3] - state.vector(i, joint.P_i)


def separation_rate(state: State, joint: "Joint", wrong: bool = False) -> np.ndarray:
    """dd/dt (3,), for which the program takes x, y, z, e0 in place of the four Euler parameters."""
    taken = slice(0, 4) if wrong else slice(3, 7)
    i, j = joint.i, joint.j
    ends = [
        state.qd[k, :3] + product(state.slope(k, P), state.qd[k, taken])
        for k, P in ((i, joint.P_i), (j, joint.P_j))
    ]
    return ends[1] - ends[0]
