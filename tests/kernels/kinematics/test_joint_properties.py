"""Properties of every constraint type, at random positions and along random motions.

Expected derivatives are differences of the residual itself: central ones, extrapolated to step zero
(L. F. Richardson, 1911), which is exact for the polynomials that all residuals but the screw's are.
"""

from itertools import pairwise
from pathlib import Path

import numpy as np
import pytest

from flexmb_cli.kernels.kinematics import constraints as equations
from flexmb_cli.model.joints import BY_NAME, JOINT_TYPES
from tests.kernels.kinematics.random_joints import CONSTRAINTS, JOINTS, SingleConstraint, any_position, moved
from tests.solvers.kinematics.geometry import axes, euler_parameters, product, unit

SEEDS = range(6)


def extrapolated(difference, step=0.02, levels=5):
    """The limit of difference(step) for step -> 0, an even series in the step."""
    table = [difference(step / 2**k) for k in range(levels)]
    for order in range(1, levels):
        table = [(4**order * b - a) / (4**order - 1) for a, b in pairwise(table)]
    return table[0]


def slope(f):
    return extrapolated(lambda h: (f(h) - f(-h)) / (2.0 * h))


def curvature(f):
    return extrapolated(lambda h: (f(h) - 2.0 * f(0.0) + f(-h)) / h**2, step=0.08)


def assert_same(found, expected, allowed):
    assert float(np.max(np.abs(found - expected))) <= allowed * (1.0 + float(np.max(np.abs(expected))))


def clock(one, q):
    """Components of a screw's h_j along h_i and across it, zeros for other constraints."""
    k = one.arrays.constraints[0]
    h_j = axes(unit(q[3:7])) @ k["h_j"]
    A = axes(unit(q[17:21]))
    return (A @ k["h_i"]) @ h_j, (A @ k["g_i"]) @ h_j


def screw_angle(one, q):
    """The angle to stay near to, so that no difference is taken across a whole turn."""
    x, y = clock(one, q)
    return float(np.arctan2(y, x))


def position_for(one, random):
    """Any position, but for a screw none with h_j along the axis, where its angle has no meaning."""
    q = any_position(random)
    while one.arrays.screw_angles.size and np.hypot(*clock(one, q)) < 0.5:
        q = any_position(random)
    return q


@pytest.mark.parametrize("seed", SEEDS)
def test_a_screw_turns_at_the_rate_of_its_angle(seed):
    """Along q + h q̇ + h² q̈ / 2, with the whole turns that are asked for."""
    random = np.random.default_rng([seed, 8])
    one = SingleConstraint("screw", random)
    states = np.array([position_for(one, random), *random.uniform(-1.0, 1.0, (2, 21))])
    start, motion = screw_angle(one, states[0]), np.zeros((1, 3))

    def turned(h):
        there = screw_angle(one, states[0] + h * states[1] + 0.5 * h**2 * states[2])
        return start + (there - start + np.pi) % (2.0 * np.pi) - np.pi

    rotations, near = one._rotations(states[0], states[1]), np.array([start + 4.0 * np.pi + 1.0])
    equations.screw_motion(one.arrays.constraints, states, rotations, near, motion)
    assert_same(motion[0], [start + 4.0 * np.pi, slope(turned), curvature(turned)], 1e-9)


@pytest.mark.parametrize("seed", SEEDS)
@pytest.mark.parametrize("label", CONSTRAINTS)
def test_jacobian_is_the_derivative_of_the_residual(label, seed):
    random = np.random.default_rng([seed, 4])
    one = SingleConstraint(label, random)
    q = position_for(one, random)
    near, unit_steps = screw_angle(one, q), np.eye(q.size)
    columns = [slope(lambda h, e=e: one.residual(q + h * e, near=near)) for e in unit_steps]
    assert_same(one.jacobian(q), np.stack(columns, 1), 1e-10)


@pytest.mark.parametrize("seed", SEEDS)
@pytest.mark.parametrize("label", CONSTRAINTS)
def test_right_hand_sides_are_derivatives_along_a_motion(label, seed):
    """Along q + h q̇ at the times t + h: dΦ/dh = Φ_q q̇ - ν and d²Φ/dh² = -γ, for q̈ = 0."""
    random = np.random.default_rng([seed, 5])
    one = SingleConstraint(label, random)
    q = position_for(one, random)
    qd, t, near = random.uniform(-1.0, 1.0, q.size), 0.7, screw_angle(one, q)

    def along(h):
        return one.residual(q + h * qd, t + h, near)

    assert_same(one.jacobian(q) @ qd - one.velocity_side(t), slope(along), 1e-10)
    assert_same(-one.acceleration_side(q, qd, t), curvature(along), 1e-8)


@pytest.mark.parametrize("seed", SEEDS)
@pytest.mark.parametrize("label", CONSTRAINTS)
def test_gamma_is_minus_the_rate_of_the_jacobian_times_the_velocity(label, seed):
    random = np.random.default_rng([seed, 6])
    one = SingleConstraint(label, random)
    q = position_for(one, random)
    qd = random.uniform(-1.0, 1.0, q.size)
    rate = slope(lambda h: one.jacobian(q + h * qd) @ qd)
    time_part = slope(lambda h: one.velocity_side(0.7 + h))
    assert_same(one.acceleration_side(q, qd, 0.7), time_part - rate, 1e-10)


@pytest.mark.parametrize("seed", SEEDS)
@pytest.mark.parametrize("label", JOINTS)
def test_a_joint_does_not_notice_that_the_whole_mechanism_is_moved(label, seed):
    """The gap between coincident points turns with the mechanism, all other rows stay as they are."""
    random = np.random.default_rng([seed, 7])
    one = SingleConstraint(label, random)
    q = position_for(one, random)
    turn = euler_parameters(unit(random.standard_normal(3)), random.uniform(-3.0, 3.0))
    A, near = axes(turn), screw_angle(one, q)
    before, after = (one.residual(x, near=near) for x in (q, moved(q, turn, random.uniform(-3, 3, 3), A)))
    expected = before.copy()
    if label in ("spherical", "universal", "revolute"):
        expected[:3] = A @ before[:3]
    assert_same(after, expected, 1e-13)


@pytest.mark.parametrize("seed", SEEDS)
@pytest.mark.parametrize("label", JOINTS)
def test_a_joint_does_not_notice_the_sign_of_the_euler_parameters(label, seed):
    random = np.random.default_rng([seed, 8])
    one = SingleConstraint(label, random)
    q = position_for(one, random)
    other = q.copy()
    other[17:21] *= -1.0
    assert_same(one.residual(other), one.residual(q), 1e-15)


@pytest.mark.parametrize("label", ["revolute", "cylindrical", "translational", "screw"])
@pytest.mark.parametrize("sense", [1.0, -1.0])
def test_parallel_vectors_never_lose_a_row(label, sense):
    """Body i turned into 200 attitudes, j turned with it: the rows' own rank stays far from lost."""
    random = np.random.default_rng(9)
    parallel = slice(3, 5) if label == "revolute" else slice(0, 4)
    smallest = np.inf
    for _ in range(200):
        one = SingleConstraint(label, random)
        q = in_line(one, random, sense)
        assert_same(one.residual(q)[parallel], 0.0, 1e-14)
        smallest = min(smallest, np.linalg.svd(one.jacobian(q)[parallel])[1][-1])
    assert smallest > 0.2


def in_line(one, random, sense) -> np.ndarray:
    """A position with s_i along sense · s_j, and P_j on the axis of i."""
    k = one.arrays.constraints[0]
    p_i = euler_parameters(unit(random.standard_normal(3)), random.uniform(-3.0, 3.0))
    spin = euler_parameters(k["s_i"], random.uniform(-3.0, 3.0))
    p_j = product(product(p_i, spin), aligning(k["s_j"], sense * k["s_i"]))
    q = any_position(random)
    q[17:21], q[3:7] = p_i, p_j
    slide = random.uniform(-2.0, 2.0) * k["s_i"]
    q[:3] = q[14:17] + axes(p_i) @ (k["P_i"] + slide) - axes(p_j) @ k["P_j"]
    return q


def aligning(a, b) -> np.ndarray:
    """Euler parameters of the turn that carries the unit vector a into b."""
    half = unit(a + b)
    return np.array([half @ a, *np.cross(a, half)])


def test_the_table_of_joint_types_the_files_and_the_codes_are_one():
    """Equations: the count of YOUNG's own check, dissertation chapter 5 (6 NBODY = 3 NSPHER + …)."""
    counts = {"spherical": 3, "universal": 4, "revolute": 5, "cylindrical": 4, "translational": 5, "screw": 5}
    assert counts.items() <= {kind.name: kind.equations for kind in JOINT_TYPES}.items()
    folder = Path(equations.__file__).parent / "joints"
    coded = {name: kind for name, kind in BY_NAME.items() if kind.code}
    assert {path.stem for path in folder.glob("*.py")} - {"__init__"} == set(coded)
    for name, kind in coded.items():
        assert kind.equations == getattr(equations, name).EQUATIONS
        assert getattr(equations, name.upper()) == kind.code
    assert len({kind.code for kind in coded.values()}) == len(coded)
    for kind in JOINT_TYPES:
        assert len(kind.parts) == kind.equations


@pytest.mark.parametrize("label", CONSTRAINTS)
def test_no_kernel_writes_outside_its_own_rows(label):
    """Rows of the other constraints of the same system are as they would be without this one."""
    random = np.random.default_rng(10)
    one = SingleConstraint(label, random)
    q = position_for(one, random)
    everything = slice(0, len(one.arrays.equations))
    others = [row for row in range(everything.stop) if row not in range(one.rows.start, one.rows.stop)]
    one.rows = everything
    lengths = np.sum(q.reshape(-1, 7)[:, 3:] ** 2, axis=1) - 1.0
    kept = [int(b) for b in one.arrays.bodies_of[others, 0]]
    assert_same(one.residual(q)[others], lengths[kept], 1e-15)
