"""What elements add to the matrices of implicit steps, against differences of their forces by the speeds."""

import numpy as np
import pytest

from flexmb_cli.kernels._jit import interpreting
from flexmb_cli.kernels.constrained.accelerations import evaluate_jacobian
from flexmb_cli.kernels.constrained.body_vectors import geometry_of, move_vectors
from flexmb_cli.kernels.constrained.elements import ELEMENT, add_element, add_unit_friction
from flexmb_cli.kernels.constrained.forces import add_stiff
from flexmb_cli.kernels.laws import DAMPING
from tests.dialects.vsdf.mechanisms import random_state
from tests.kernels.constrained.test_constraint_primitives import FIRST, H
from tests.solvers.constrained.element_decks import ARM, SLIDER, analysis_of, model_of

BALLS = "MASS 2 1 0 0 0 1 1 1\nMASS 3 1 0 0 0 1 1 1\n"
CASES = {
    "angle": (ARM, f"{BALLS}ELEMENTS\n  SPRING tspring-1 at=2.angle stiffness=8 damping=0.4"),
    "line": (
        ARM,
        f"{BALLS}ELEMENTS\n"
        "  SPRING lspring-1 from=0(2,1,0.5) to=3(0.3,0.2,0.1) stiffness=30 rest=0.5 "
        "damping=0.7",
    ),
    "bearing": (
        ARM,
        f"{BALLS}ELEMENTS\n"
        "  FRICTION friction-1 joint=2 dynamic=0.3 static=0.5 stribeck=9 creep=2 radius=0.2",
    ),
    "slide": (
        SLIDER,
        "MASS 2 1 0 0 0 1 1 1\n"
        "ELEMENTS\n"
        "  FRICTION friction-1 joint=1 dynamic=0.3 static=0.5 stribeck=9 creep=2",
    ),
}


NORMAL_FORCE = 5.0  # N: what the equations of motion would find


def forces_at(analysis, q, u):
    """Forces (n,) of the elements; friction has its normal force."""
    system, work, f = analysis.system, analysis.work, np.zeros(u.size)
    evaluate_jacobian(system, work, q)
    move_vectors(geometry_of(system, work), u)
    for k in range(len(system.loads)):
        if system.loads[k]["kind"] == ELEMENT:
            add_element(system, work, k, u, 0.0, f)
        else:
            add_unit_friction(system, work, k, f)
            f, work.responses[k, DAMPING] = NORMAL_FORCE * f, NORMAL_FORCE * work.responses[k, DAMPING]
    return f


@pytest.mark.parametrize(("mechanism", "cards"), CASES.values(), ids=CASES)
def test_the_damping_of_an_element_is_the_slope_of_its_force(mechanism, cards):
    """Central differences of order four by each speed; a bearing of radius r has N mu'(v) r²."""
    with interpreting():
        assert_slopes(analysis_of(model_of(mechanism, "0 1 1", cards)))


def assert_slopes(analysis):
    """Compare the slopes that `add_stiff` uses with differences."""
    system, work = analysis.system, analysis.work
    q, u = random_state(analysis)
    E = np.eye(u.size)
    D = -sum(w * np.array([forces_at(analysis, q, u + k * H * e) for e in E]) for k, w in FIRST.items()).T / H
    assert np.abs(D).max() > 0.01
    forces_at(analysis, q, u)
    for x in np.random.default_rng(2).normal(size=(3, u.size)):
        y = np.ones(u.size)
        add_stiff(system, work, 0.0, 0.6, x, y)
        np.testing.assert_allclose(y - 1.0, 0.6 * D @ x, atol=1e-8)
