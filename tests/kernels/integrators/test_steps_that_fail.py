"""Steps of implicit and explicit methods: what a try finds, when it is refused, what an iteration leaves."""

import math

import numpy as np
import pytest

from flexmb_cli.kernels._jit import interpreting
from flexmb_cli.kernels.integrators import generalised_alpha_step, radau5_step
from flexmb_cli.kernels.integrators.constrained_dop853 import _finish
from flexmb_cli.kernels.integrators.sdirk4 import _attempt, implicit_work
from flexmb_cli.kernels.integrators.singular_ahead import _expected
from flexmb_cli.model.integrators import Integrator
from flexmb_cli.solvers.constrained.flexible_dynamics import FlexibleDynamics
from flexmb_cli.solvers.tree.analysis import TreeAnalysis
from tests.kernels.integrators.test_sdirk4 import damped_mass
from tests.solvers.constrained.element_decks import ARM, ROTOR, analysis_of, model_of
from tests.solvers.singular.test_singular_positions import Parallelogram

ARMS = "MASS 2 2 0.5 0 0 0.01 0.2 0.2\nMASS 3 1 0.4 0 0 0.01 0.1 0.1\n"
ONE = "MASS 2 1 0 0 0 1 1 1\n"


def started(mechanism, cards, end=1.0):
    analysis = analysis_of(model_of(mechanism, f"0 {end:g} {end:g}", cards))
    analysis.start()
    return analysis


def test_free_motions_at_a_stage_of_radaus_method_are_those_of_the_hinges():
    """Two links along x, the second hinged 1 m out, turn about z; v of the second is ω of the first."""
    with interpreting():
        analysis = started(ARM, f"{ARMS}RAD5\n")
        integration, system, work = analysis.integration, analysis.system, analysis.work
        assert radau5_step._evaluate(system, work, integration, 1, 0.0) == radau5_step.SOLVED
    free = system.speed_scale.size - work.rank[0]
    speeds = (integration.motions[1] * system.speed_scale[:, None])[:, :free].T.reshape(free, 3, 6)
    wanted = np.zeros_like(speeds)
    wanted[:, 1, 5], wanted[:, 2, 5] = speeds[:, 1, 5], speeds[:, 2, 5]
    wanted[:, 2, 1] = speeds[:, 1, 5]
    np.testing.assert_allclose(speeds, wanted, atol=1e-15)
    assert np.linalg.matrix_rank(speeds[:, 1:, 5]) == free == 2


def test_a_step_of_sdirk4_is_made_within_the_tolerance_and_tried_again_beyond_it():
    """The mass swings with 5 rad/s: 1e-3 s are a small part of that, a second is not."""
    analysis = TreeAnalysis(damped_mass())
    arrays = analysis.arrays
    s = implicit_work(analysis.clock, analysis.state.copy(), 1, arrays.closures, len(arrays.answers))
    with interpreting():
        for h, made in ((1e-3, True), (1.0, False)):
            factor = _attempt(s, h, analysis.arrays, analysis.work, analysis.coordinates)
            assert (s.clock["error"][0] < 1.0, factor > 0.0) == (made, made)


def test_a_step_of_dop853_that_ends_in_line_is_tried_again_shorter():
    """The constraint Jacobian has lost a rank there: no accelerations are found."""
    inclined, in_line = (
        FlexibleDynamics(Parallelogram(angle, 1.5, 2.0, 1.0, (1.0, 1.0, 1.0)).mechanism(Integrator("RK45")))
        for angle in (0.5, 0.0)
    )
    with interpreting():
        inclined.start()
        integration, q = inclined.integration, in_line.arrays.q
        integration.trial[: q.size] = q
        factor = _finish(integration, 0.3, inclined.system, inclined.work)
    assert integration.clock["fault"][0] != radau5_step.SOLVED
    assert -1.0 < factor < 0.0


@pytest.mark.parametrize("method", ["GALF 0.001 0.9", "RAD5"])
def test_an_iteration_whose_corrections_halve_leaves_as_much_as_the_last_one(method, monkeypatch):
    """1/2 + 1/4 + …: the sum of the geometric series."""
    step = radau5_step if method == "RAD5" else generalised_alpha_step
    sizes = iter(0.5 ** np.arange(40.0))
    if method == "RAD5":
        monkeypatch.setattr(step, "predict", lambda *_: None)
        monkeypatch.setattr(step, "place_stages", lambda *_: next(sizes))
    else:
        monkeypatch.setattr(step, "_correct", lambda *_: (next(sizes), 0.0))
    with interpreting():
        analysis = started(ROTOR, f"{ONE}{method}\n")
        integration = analysis.integration
        step.solve_step(analysis.system, analysis.work, integration, 1e-3)
    assert integration.memory["left"][0] == 1.0


def test_a_pivot_that_has_declined_evenly_vanishes_when_the_line_through_it_does():
    """From 1 to 0.6 in 0.2 s: 0.3 s are left."""
    with interpreting():
        analysis = started(ROTOR, ONE)
        clock, work = analysis.integration.clock[0], analysis.work
        work.pivots[:] = work.diagonal
        clock["pivot_order"], clock["pivot_time"], clock["t"] = work.quality[0], 0.5, 0.7
        assert _expected(clock, work) == math.inf
        work.diagonal[2] *= 0.6
        assert _expected(clock, work) == pytest.approx(0.3, rel=1e-12)
