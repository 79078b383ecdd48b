"""Bringing the state that Radau's method tries onto positions and speeds, and its accelerations on theirs.

The shortest way in the metric of the matrix of the step: stiff motions stay at rest.
"""

from typing import TYPE_CHECKING

import numpy as np

from .._jit import allocating, kernel
from ..constrained.accelerations import accelerations, factorise_constraints
from ..constrained.angle_unwrapping import EXPECTED
from ..constrained.mass_matrix import mass_matrices
from ..constrained.projection import close_gaps, close_rates
from ..constrained.report import coordinates_and_speeds
from ..constrained.speeds import coordinate_accelerations, coordinate_rates, normalise, speeds_of_rates
from ..constrained.system import SOLVED, System, Work
from ..linalg.copying import copy
from .constrained_equations import works_between
from .error_norm import scaled_norm
from .hermite import cubic, quintic
from .radau5_step import LAST_STEP, START
from .radau5_table import STAGES, TIMES

if TYPE_CHECKING:
    from .radau5 import RadauIntegration


@kernel
def close_trial(system: System, work: Work, integration: "RadauIntegration", t: float) -> int:
    """Bring `trial`, near to which factors and mass matrices are, onto positions and speeds at t; a code.

    They then are those of the end.
    """
    newton, bodies = integration.newton, system.masses.shape[0]
    q, u = coordinates_and_speeds(system, integration.trial)
    normalise(bodies, q)
    close_gaps(system, work, newton, q, t, integration.angles[EXPECTED])
    code = factorise_constraints(system, work, q)
    if code == SOLVED:
        mass_matrices(system, work, q)
        close_rates(system, work, newton, u, t)
    return code


@kernel
def moved(integration: "RadauIntegration", found: np.ndarray) -> float:
    """Return by how many tolerances `trial` was moved from found (N,), which becomes the difference."""
    for i in range(found.shape[0]):
        found[i] = integration.trial[i] - found[i]
    return scaled_norm(integration, integration.trial, found)


@kernel
def project_state(
    system: System, work: Work, integration: "RadauIntegration", t: float, ud: np.ndarray
) -> tuple[int, float]:
    """Bring `trial` onto everything at t and fill ud (n,); returns (code, power).

    The matrix of the last step serves: where other speeds have become free it is one more metric.
    """
    for s in range(work.angles.shape[0]):
        work.angles[s] = integration.angles[EXPECTED, s]
    q, u = coordinates_and_speeds(system, integration.trial)
    code = factorise_constraints(system, work, q)
    if code == SOLVED:
        mass_matrices(system, work, q)
        code = close_trial(system, work, integration, t)
    return accelerations(system, work, q, u, t, ud) if code == SOLVED else (code, 0.0)


@kernel
def place_row(system: System, integration: "RadauIntegration", t: float):
    """Bring `trial` to a time up to the present one; return the fraction of the last step."""
    clock, x = integration.clock[0], 1.0
    copy(integration.z, integration.trial)
    if t < clock["t"]:
        x = (t - clock["step_start"]) / clock["step_length"]
        between(system, integration, x, integration.trial)
    return x


@kernel
def accelerations_between(integration: "RadauIntegration", x: float, ud: "np.ndarray") -> None:
    """Fill ud (n,) at the fraction x of the last step, through those of its start and its stages."""
    for k in range(ud.shape[0]):
        ud[k] = 0.0
    for node in range(STAGES + 1):
        weight = 1.0
        for other in range(STAGES + 1):
            if other != node:
                weight *= (x - _node_time(other)) / (_node_time(node) - _node_time(other))
        for k in range(ud.shape[0]):
            ud[k] += weight * integration.rates[LAST_STEP + node, k]


@kernel
def _node_time(node: int):
    return TIMES[node - 1] if node > 0 else 0.0


@allocating
def between(system: System, integration: "RadauIntegration", x: float, point: "np.ndarray") -> None:
    """Fill point with the state at the fraction x of the last step."""
    clock, old, z, n = integration.clock[0], integration.old, integration.z, system.speed_scale.shape[0]
    bodies, h = system.masses.shape[0], clock["step_length"]
    nq = n + bodies
    rates = np.empty((5, nq))
    coordinate_rates(bodies, old[:nq], old[nq : nq + n], rates[0])
    coordinate_accelerations(bodies, old[:nq], old[nq : nq + n], integration.rates[LAST_STEP], rates[1])
    coordinate_rates(bodies, z[:nq], z[nq : nq + n], rates[2])
    coordinate_accelerations(bodies, z[:nq], z[nq : nq + n], integration.rates[START], rates[3])
    for i in range(nq):
        point[i], rates[4, i] = quintic(
            x, old[i], z[i], h * rates[0, i], h * rates[2, i], h * h * rates[1, i], h * h * rates[3, i]
        )
        rates[4, i] /= h
    speeds_of_rates(bodies, point[:nq], rates[4], point[nq : nq + n])
    last = nq + n
    point[last] = cubic(
        x, old[last], z[last], h * integration.memory[0]["old_power"], h * integration.memory[0]["power"]
    )
    works_between(integration, x, h, point)
