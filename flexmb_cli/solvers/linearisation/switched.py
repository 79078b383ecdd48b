"""The state with which a motion continues when joints and drivers are caught or let go.

An inelastic impulse takes the speeds u to those of least kinetic energy of the difference,

    (v - u)ᵀ M (v - u) = min    with    J v = rates of drivers,

so that momentum along all motions Z that stay free (J Z = 0) is kept: v = v0 + Z (Zᵀ M Z)⁻¹ Zᵀ M (u - v0).
"""

from collections.abc import Mapping
from typing import Any

import numpy as np

from ...kernels.constrained.angle_unwrapping import EXPECTED
from ...kernels.tree.composite_mass import set_mass
from ...model.arrays.system import SystemArrays
from ...model.arrays.tree_elements import TURN_ROW, VECTOR_ROW
from ...model.joints import DEPENDENT
from ..constrained.start import struck_speeds
from ..tree.analysis import TreeAnalysis
from ..tree.loop_assembly import jacobian_of_gaps, measured, prescribe
from .tree import hold_functions_at

OF_TREES = ("bushing_axes", "bushing_angles", "coupling_values", "parameters")


def memory_of(analysis: Any) -> dict[str, np.ndarray]:
    """Return what an analysis keeps of the motion so far besides its state, by names."""
    if isinstance(analysis, TreeAnalysis):
        elements, lasting = analysis.arrays.elements, analysis.arrays.closures[_lasting(analysis)]
        arrays = (elements["turned"], elements["expected"], lasting["value"], lasting["parameter"])
        return {name: values.copy() for name, values in zip(OF_TREES, arrays, strict=True)}
    return {"angles": analysis.integration.angles[EXPECTED].copy()}


def remember(analysis: Any, memory: Mapping[str, np.ndarray]) -> None:
    """Have an analysis of the same parts continue with what `memory_of` gave."""
    if not isinstance(analysis, TreeAnalysis):
        analysis.first_angles = memory["angles"]
        return
    elements, rows = analysis.arrays.elements, np.flatnonzero(_lasting(analysis))
    elements["turned"], elements["expected"] = memory["bushing_axes"], memory["bushing_angles"]
    analysis.arrays.closures["value"][rows] = memory["coupling_values"]
    analysis.arrays.closures["parameter"][rows] = memory["parameters"]


def _lasting(analysis: TreeAnalysis) -> np.ndarray:
    """Return which closed directions (R,) are not those of general joints."""
    return ~np.isin(analysis.arrays.closures["type"], (VECTOR_ROW, TURN_ROW))


def memory_for(before: Any, after: Any) -> dict[str, np.ndarray]:
    """Return what the analysis `after`, which has other joints and drivers, keeps of the motion before."""
    memory = memory_of(before)
    if isinstance(after, TreeAnalysis):
        return memory
    known: dict[Any, list[float]] = {}
    for key, angle in zip(_angle_keys(before.arrays), memory["angles"].tolist(), strict=True):
        known.setdefault(key, []).append(angle)
    angles = after.arrays.angles.copy()
    for k, key in enumerate(_angle_keys(after.arrays)):
        if known.get(key):
            angles[k] = known[key].pop(0) if len(known[key]) > 1 else known[key][0]
    return {"angles": angles}


def _angle_keys(arrays: SystemArrays) -> list[Any]:
    """Return by what the angles that count turns differ: the directions that they are between."""
    keys: list[Any] = list(range(len(arrays.angles)))  # numbers where no primitive has them
    for records, vectors in (
        (arrays.primitives, arrays.body_vectors),
        (arrays.joint_coordinates, arrays.joint_vectors),
    ):
        for record in records[records["turn"] >= 0]:
            ends = [vectors[record[name]] for name in ("f", "g", "h") if record[name] >= 0]
            keys[record["turn"]] = tuple((int(end["body"]), end["c"].tobytes()) for end in ends)
    return keys


def driver_gap(analysis: Any, driver: Any) -> float:
    """Return how far the coordinate of a driver is beyond its function at the `rest` of an analysis."""
    if isinstance(analysis, TreeAnalysis):
        names = [(c.body, f"{c.motion} {c.axis}") for c in analysis.tree.coordinates]
        coordinate = names.index((driver.joint, driver.coordinate))
        assert analysis.rest is not None, "it continues a motion"
        place = len(names) + coordinate
        return float(analysis.rest[place] - driver.function.at(analysis.tree.time.start)[0])
    row = [equation.owner for equation in analysis.arrays.equations].index(driver.name)
    q = analysis.rest[: analysis.arrays.coordinate_scale.size]
    gaps = analysis.gaps.residual(q, analysis.grid.start, analysis.first_angles)
    return float(gaps[row] * analysis.arrays.row_scale[row])


def struck(analysis: Any) -> np.ndarray:
    """Return the `rest` of an analysis with the speeds after an inelastic impulse of its joints and drivers.

    Raises ModelError when drivers ask for speeds that the joints forbid.
    """
    if isinstance(analysis, TreeAnalysis):
        return _struck_tree(analysis)
    analysis.start_position()
    state: np.ndarray = analysis.rest.copy()
    n, end = analysis.arrays.coordinate_scale.size, analysis.arrays.speeds
    end += n
    state[n:end] = struck_speeds(analysis, state[:n], state[n:end].copy(), analysis.grid.start)
    return state


def _struck_tree(analysis: TreeAnalysis) -> np.ndarray:
    assert analysis.rest is not None, "it continues a motion"
    t, z = analysis.tree.time.start, analysis.rest.copy()
    analysis.state[:] = z
    hold_functions_at(analysis, t)
    free = ~analysis.arrays.given
    u = z[: free.size].copy()
    prescribe(analysis, z, t)
    J = jacobian_of_gaps(analysis, z)[:, free]
    met, Z = z[: free.size].copy(), np.eye(free.size)[:, free]
    if len(J):
        met[free] -= np.linalg.pinv(J, DEPENDENT) @ measured(analysis, z)["rate"]
        _, sizes, rows = np.linalg.svd(J)
        Z = Z @ rows[int(np.sum(sizes > DEPENDENT * sizes.max(initial=0.0))) :].T
    M = np.zeros((free.size, free.size))
    set_mass(analysis.arrays, analysis.work, analysis.coordinates, z, M)
    ZM = Z.T @ (np.triu(M) + np.triu(M, 1).T)
    z[: free.size] = met + Z @ np.linalg.solve(ZM @ Z, ZM @ (u - met))
    return z
