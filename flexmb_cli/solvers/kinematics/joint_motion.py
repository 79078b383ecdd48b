"""Joint coordinates of a mechanism by the positions of its bodies: angle and stroke of body J against body I.

They are those of `model.arrays.node_joints`, for points of rigid bodies over many rows.
"""

import math
from collections.abc import Iterable, Iterator, Mapping
from typing import Any

import numpy as np

from ...model.joint_elements import COORDINATES_OF
from ...model.joints import ANGLE
from ...model.mechanism import Joint, Mechanism
from ...model.vectors import cross, dot, rotation_matrix, unit
from ...model.vectors import rotated as turned
from ..checkpoint import taken
from .rows import Rows, rotated

MISSED_AXIS = 1e-9  # of a length: what decks and assembly round off


class JointMotion:
    """Coordinates (J,) of all joints, in their order, 0 at the estimates."""

    def __init__(self, mechanism: Mechanism):
        named = [(joint, name) for joint in mechanism.joints for name in COORDINATES_OF[joint.kind]]
        self.turning = np.array([name == ANGLE for _, name in named], bool)
        self._i, self._j = (np.array([getattr(joint, k) for joint, _ in named], np.int64) for k in "ij")
        vectors = [_vectors(mechanism, joint) for joint, _ in named]
        self._of_i = np.array([v[:4] for v in vectors], float).reshape(-1, 4, 3)
        self._of_j = np.array([v[4:6] for v in vectors], float).reshape(-1, 2, 3)
        self._slide = np.array([v[6] for v in vectors], float)

    def of(self, rows: Rows) -> tuple[np.ndarray, np.ndarray]:
        """Return coordinates, angles of up to half a turn, and rates (T, J)."""
        (f, g, s, a), (df, dg, ds, da) = self._placed(rows, self._i, self._of_i)
        (h, b), (dh, db) = self._placed(rows, self._j, self._of_j)
        x, y = _dot(f, h), _dot(g, h)
        spin = x * (_dot(dg, h) + _dot(g, dh)) - y * (_dot(df, h) + _dot(f, dh))
        d = rows.position[:, self._j] + b - rows.position[:, self._i] - a
        dd = rows.velocity[:, self._j] + db - rows.velocity[:, self._i] - da
        return (
            np.where(self.turning, np.arctan2(y, x), _dot(d, s) - self._slide),
            np.where(self.turning, spin / (x * x + y * y), _dot(dd, s) + _dot(d, ds)),
        )

    def with_turns(self, rows: Rows) -> tuple[np.ndarray, np.ndarray]:
        """Return them with whole turns, counted anew where times do not rise."""
        values, rates = self.of(rows)
        return WholeTurns(self.turning).counted(rows.time, values, rates), rates

    def continued(self, blocks: Iterable[Rows], turns: "WholeTurns") -> Iterator[Rows]:
        """Yield blocks of rows, whose angles go on counting the turns of those before."""
        for rows in blocks:
            rows.__dict__["joint_coordinate"] = turns.counted(
                rows.time, rows.joint_coordinate, rows.joint_rate
            )
            yield rows

    @staticmethod
    def _placed(rows: Rows, bodies: np.ndarray, vectors: np.ndarray) -> Iterator[list[np.ndarray]]:
        """Vectors (J, n, 3) of bodies (J,) in global axes, a list of n arrays (T, J, 3), then their rates."""
        p, rate = rows.euler_parameters[:, bodies], rows.euler_parameter_rates[:, bodies]
        own = [vectors[:, k] for k in range(vectors.shape[1])]
        yield [rotated(p, p, v) for v in own]
        yield [2.0 * rotated(p, rate, v) for v in own]


def _dot(a: np.ndarray, b: np.ndarray) -> np.ndarray:
    return np.sum(a * b, axis=-1)


def _vectors(mechanism: Mechanism, joint: Joint) -> Any:
    """F, G, S and P_i in axes of body I, H and P_j in those of body J, and the slide at the estimates."""
    I, J = mechanism.bodies[joint.i], mechanism.bodies[joint.j]
    A_i, A_j = rotation_matrix(I.p), rotation_matrix(J.p)
    P_i, P_j = np.asarray(joint.P_i, float), np.asarray(joint.P_j, float)
    s = unit(joint.s_i)
    f = unit(cross(s, np.eye(3)[int(np.argmin(np.abs(s)))]))
    h, own = turned(A_j.T, turned(A_i, f)), np.asarray(joint.s_j, float)
    own = unit(own) if own.any() else own
    if MISSED_AXIS < abs(dot(h, own)) < 1.0 - MISSED_AXIS:
        h = h - dot(h, own) * own
    gap = np.add(J.r, turned(A_j, P_j)) - np.add(I.r, turned(A_i, P_i))
    return f, cross(s, f), s, P_i, h, P_j, dot(gap, turned(A_i, s))


class WholeTurns:
    """Counts the turns of coordinates (J,) from row to row, of which those are angles that `turning` says.

    Positions do not show whole turns: between two rows an angle turns by the mean of its rates at both, to
    less than half a turn.
    """

    def __init__(self, turning: np.ndarray):
        self.turning = turning
        self.last = np.full((3, turning.size), np.nan)  # time, value and rate of the last row

    def counted(self, times: np.ndarray, values: np.ndarray, rates: np.ndarray) -> np.ndarray:
        """Return values (T, J) of the next rows with their turns; rates (T, J), times (T,).

        Times that do not rise begin anew.
        """
        now = np.broadcast_to(times[:, None], values.shape)
        if np.isnan(self.last).any():
            self.last = np.stack([now[0], values[0], rates[0]])
        t, x, v = (
            np.vstack([last, part]) for last, part in zip(self.last, (now, values, rates), strict=True)
        )
        h = np.diff(t, axis=0)
        missing = np.round((0.5 * h * (v[1:] + v[:-1]) - np.diff(x, axis=0)) / math.tau)
        turns = np.cumsum(np.where(h >= 0.0, missing, 0.0), axis=0)
        begins = np.maximum.accumulate(np.where(h[:, :1] < 0.0, np.arange(len(h))[:, None], 0), axis=0)
        turns -= np.where(begins > 0, np.take_along_axis(turns, np.broadcast_to(begins, turns.shape), 0), 0.0)
        counted_values: np.ndarray = values + math.tau * np.where(self.turning, turns, 0.0)
        self.last = np.stack([now[-1], counted_values[-1], rates[-1]])
        return counted_values

    @property
    def checkpoint(self) -> dict[str, np.ndarray]:
        """Return what the next rows need."""
        return {"turns": self.last}

    def restore(self, checkpoint: Mapping[str, np.ndarray]) -> None:
        """Go on after the rows counted before a checkpoint."""
        self.last = np.array(taken(checkpoint, "turns", self.last.shape))
