"""Equilibrium of a mechanism: its independent joint coordinates at rest while its drivers go on."""

from typing import Any

import numpy as np

from ...errors import AnalysisError, Fault

SHORT_STENCIL = ((-1.0, -0.5), (1.0, 0.5))  # of second order, enough to find the way to an equilibrium
MOST_ITERATIONS = 60
LARGEST_MOVE = 0.2  # scaled length of one correction towards equilibrium
NO_STIFFNESS = 1e-10  # of the largest eigenvalue
SMALLEST_CORRECTION = 1e-9  # scaled correction that counts as none


def find_equilibrium(analysis: Any, linearised: type) -> None:
    """Bring a started `analysis` into an equilibrium: the one it stands in, else one it can fall into.

    Drivers keep their speeds: on a turning frame this is the equilibrium relative to the frame.
    Newton's method, with steps reversed along motions that would grow, which lead to unstable positions.
    `linearised`: the class of its `LinearisedMotion`.  Raises AnalysisError when none is found.
    """
    start = linearised(analysis)
    start.stand_at(np.zeros(start.dofs))
    for _ in range(MOST_ITERATIONS):
        motion = linearised(analysis)
        accelerations = motion.standing_accelerations(np.zeros(motion.dofs))
        step = _downhill(motion.standing_stiffness(SHORT_STENCIL), accelerations)
        size = np.max(np.abs(step), initial=0.0)
        motion.stand_at(step * min(1.0, LARGEST_MOVE / size) if size > 0.0 else step)
        if size <= SMALLEST_CORRECTION:
            return
    message = (
        f"no equilibrium was found in {MOST_ITERATIONS} iterations; begin nearer to it, or see "
        "whether drivers or forces keep the mechanism moving"
    )
    raise AnalysisError(Fault("error", message, id="SOLVE-015"), motion.t)


def rest_of(analysis: Any, warnings: list[Fault]) -> np.ndarray:
    """Return the state of an analysis in the equilibrium that it falls into from its start.

    Of a mechanism coordinates and speeds, of a tree the whole state.  Raises as `find_equilibrium`.
    """
    from .constrained import linearised, modes_of

    growing = modes_of(*linearised(analysis, put_at_rest(analysis))).growing
    if growing.size:
        message = (
            f"the equilibrium is unstable: a disturbance grows by e in {1.0 / growing.max():.3g} s; begin "
            "aside of it for one that is stable"
        )
        warnings.append(Fault("warning", message, id="SOLVE-112"))
    return state_of(analysis)


def put_at_rest(analysis: Any) -> type:
    """Start an analysis, or begin at its `rest`, and bring it into an equilibrium.

    Return the class of its `LinearisedMotion`.  Raises as `find_equilibrium`.
    """
    from ..tree.analysis import TreeAnalysis
    from .constrained import ConstrainedLinearised
    from .tree import TreeLinearised, start_tree

    formulation: type = ConstrainedLinearised
    if isinstance(analysis, TreeAnalysis):
        formulation = TreeLinearised
        start_tree(analysis, analysis.tree.time.start)
        if analysis.rest is not None:
            analysis.state[:] = analysis.rest
    else:
        analysis.start()
    find_equilibrium(analysis, formulation)
    return formulation


def state_of(analysis: Any) -> np.ndarray:
    """Return the state of an analysis as `rest_of` does."""
    from ..tree.analysis import TreeAnalysis

    if isinstance(analysis, TreeAnalysis):
        return np.array(analysis.state)
    end = analysis.integration.z.size - analysis.works - 1
    return np.array(analysis.integration.z[:end])


def _downhill(stiffness: np.ndarray, accelerations: np.ndarray) -> np.ndarray:
    """Newton's step, turned round along eigenvectors whose motions grow."""
    if not accelerations.size:
        return accelerations
    values, vectors = np.linalg.eig(stiffness)
    least = NO_STIFFNESS * np.max(np.abs(values), initial=1.0)
    parts = np.linalg.lstsq(vectors, accelerations.astype(complex), rcond=NO_STIFFNESS)[0]
    divisors = np.where(values.real < 0.0, -values, values)
    held = np.abs(values) > least
    # A motion without stiffness nor force stays; one with a force goes as far as one correction may.
    loose = np.where(np.abs(parts) > SMALLEST_CORRECTION * least, LARGEST_MOVE, 0.0) * np.sign(parts.real)
    return (vectors @ np.where(held, parts / np.where(held, divisors, 1.0), loose)).real
