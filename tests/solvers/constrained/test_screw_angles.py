"""The rate at which a screw between two moving bodies turns, in closed form."""

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from flexmb_cli.kernels.constrained.angle_unwrapping import _add_angles
from flexmb_cli.kernels.linalg.rotation import rotation_matrices
from flexmb_cli.model.loads import DynamicModel
from flexmb_cli.model.mechanism import Joint, Mechanism, TimeGrid
from flexmb_cli.solvers.constrained.young_dynamics import ForwardDynamics
from tests.solvers.constrained.dynamic_runs import AT_REST, GROUND, body, uneven_masses

AXIS = np.array([2.0, -1.0, 2.0]) / 3.0


def screwed_together(attitudes):
    """Two bodies at the given attitudes on a screw along AXIS of the first one."""
    first, second = attitudes
    in_second = second.inv().apply(first.apply(AXIS))
    across = np.cross(AXIS, (0.0, 0.0, 1.0))
    across /= np.linalg.norm(across)
    vectors = tuple(AXIS), tuple(in_second), tuple(across), tuple(second.inv().apply(first.apply(across)))
    screw = Joint("screw", "screw 1", 1, 2, (0.0,) * 3, (0.0,) * 3, *vectors, 0.1)
    parameters = [tuple(a.as_quat()[[3, 0, 1, 2]]) for a in attitudes]
    bodies = GROUND, body(2, p=parameters[0]), body(3, p=parameters[1])
    mechanism = Mechanism(bodies, TimeGrid(0.0, 1.0, 0.5), (screw,), grounds=(AT_REST,))
    return ForwardDynamics(DynamicModel(mechanism, "forward", uneven_masses(3)))


@pytest.mark.parametrize("seed", range(3))
def test_a_screw_turns_by_what_the_second_body_turns_more_about_its_axis(seed):
    """ω_2 = ω_1 + rate times the axis; in h seconds the angle grows by h times the rate."""
    attitudes = Rotation.random(2, random_state=seed)
    analysis = screwed_together(attitudes)
    q = np.concatenate([[*b.r, *b.p] for b in analysis.model.mechanism.bodies])
    rotation_matrices(q, analysis.work.rotations[0])
    common, rate, h = np.array([0.4, -0.7, 1.1]), 3.0, 0.25
    speeds = common, common + rate * attitudes[0].apply(AXIS)
    u = np.zeros(18)
    for k, w in enumerate(speeds):
        u[6 * k + 9 : 6 * k + 12] = attitudes[k].inv().apply(w)
    turns = np.array([0.5])
    _add_angles(analysis.system, analysis.work, u, h, turns)
    assert turns == pytest.approx([0.5 + h * rate], rel=1e-13)
