"""Kinematic analysis of a mechanism: rows of positions, velocities and accelerations, block by block."""

from collections.abc import Iterator

import numpy as np

from ..kernels import kinematic_march
from ..model.arrays import KinematicArrays, kinematic_arrays
from ..model.mechanism import Mechanism
from .kinematic_system import dense_system, rows_of
from .rows import Rows

BLOCK = 1024  # rows handed on at a time; small enough to lose little, large enough to write fast


def analyse(mechanism: Mechanism) -> Iterator[Rows]:
    """Yield the report rows of `mechanism` in blocks.

    Raises AnalysisError when a position cannot be reached; all rows before it have been yielded.
    """
    arrays = kinematic_arrays(mechanism)
    yield from _march(mechanism, arrays)


def _march(mechanism: Mechanism, arrays: KinematicArrays) -> Iterator[Rows]:
    system = dense_system(arrays)
    grid = mechanism.time
    state = np.zeros((3, arrays.q.size))
    state[0] = arrays.q
    motion = np.zeros((arrays.screw_angles.size, 3))
    motion[:, 0] = arrays.screw_angles
    clock = np.array([grid.time(0), 0.0])
    for first in range(0, grid.rows, BLOCK):
        last = min(first + BLOCK, grid.rows)
        times = np.array([grid.time(k) for k in range(first, last)])
        out = np.zeros((times.size, 3, arrays.q.size))
        audit = np.zeros((times.size, 3))
        reached = kinematic_march.march(system, state, motion, clock, times, out, audit)
        if reached:
            yield rows_of(mechanism, times[:reached], out[:reached], audit[:reached])
        if reached < times.size:
            raise RuntimeError(("fail", times[reached], clock))
