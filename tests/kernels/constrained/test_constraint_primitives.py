"""Equations at deformable points: rows and right-hand sides against differences, and rigid motions.

With constant speeds (v, body-fixed ω, η̇) the coordinates move along a known path, so that the rows must
give the first, and the right-hand sides minus the second derivative of Φ along it.
"""

from dataclasses import replace

import numpy as np
import pytest

from flexmb_cli.kernels.constrained import time_functions
from flexmb_cli.kernels.constrained.accelerations import evaluate_jacobian, fill_forces
from flexmb_cli.kernels.constrained.mass_matrix import mass_matrices
from flexmb_cli.kernels.constrained.projection import fill_nu
from flexmb_cli.kernels.constrained.system import FORCES, GAMMA
from flexmb_cli.model import time_functions as motion_law
from flexmb_cli.model.fe_model import BodyTorque
from flexmb_cli.model.flexible_mechanism import PointForce
from flexmb_cli.model.joints import ANGLE, STROKE
from flexmb_cli.model.laws import At, Line, spring
from flexmb_cli.model.time_functions import Motion, MotionFunction, table_function
from flexmb_cli.solvers.constrained.system import dense_jacobian
from tests.dialects.vsdf.mechanisms import (
    KINDS,
    SINE,
    analysis_of,
    joint,
    moved,
    multiplied,
    node,
    pin,
    random_state,
    sample,
    unit,
    with_joint,
)

PAIRS = ((0, 2), (0, 1), (1, 2), (-1, 2), (2, -1))
H = 1e-3
FIRST = {-2: 1 / 12, -1: -2 / 3, 1: 2 / 3, 2: -1 / 12}
SECOND = {-2: -1 / 12, -1: 4 / 3, 0: -5 / 2, 1: 4 / 3, 2: -1 / 12}


def residual(analysis, q, t=0.7):
    """Φ (m,) in m and rad."""
    near = analysis.arrays.angles
    return analysis.gaps.residual(q, t, near) * analysis.arrays.row_scale


def along(analysis, q, u, weights, power, moves_time=False):
    values = [
        w * residual(analysis, moved(analysis.arrays, q, u, k * H), 0.7 + moves_time * k * H)
        for k, w in weights.items()
    ]
    return np.sum(values, axis=0) / H**power


def assert_rows_and_right_sides(analysis, moves_time=False):
    q, u = random_state(analysis)
    residual(analysis, q)
    analysis.arrays.angles[:] = analysis.screw_angles(q)
    evaluate_jacobian(analysis.system, analysis.work, q)
    J = dense_jacobian(analysis.work) * analysis.arrays.row_scale[:, None] / analysis.arrays.speed_scale
    nu = np.zeros(len(J))
    fill_nu(analysis.system, 0.7, nu)
    found = J @ u - (nu if moves_time else 0.0)
    np.testing.assert_allclose(found, along(analysis, q, u, FIRST, 1, moves_time), atol=1e-9)
    evaluate_jacobian(analysis.system, analysis.work, q)
    mass_matrices(analysis.system, analysis.work, q)
    fill_forces(analysis.system, analysis.work, q, u, 0.7)
    gamma = analysis.work.rows[GAMMA].copy()
    wanted = -along(analysis, q, u, SECOND, 2, moves_time)
    np.testing.assert_allclose(gamma, wanted, atol=3e-7 * max(1.0, np.abs(gamma).max()))


@pytest.mark.parametrize("pair", PAIRS, ids=str)
@pytest.mark.parametrize("kind", KINDS)
def test_joints_have_the_derivatives_of_their_equations(tmp_path, kind, pair):
    assert_rows_and_right_sides(analysis_of(with_joint(tmp_path, kind, *pair)))


@pytest.mark.parametrize(
    "function", [SINE, MotionFunction(1, (0.3, 0.2, -0.4, 0.1)), MotionFunction(2, (2.0, 3.0, 0, 0))]
)
@pytest.mark.parametrize(
    ("kind", "target", "of_joint"),
    [(k, 2, None) for k in ("TRAX", "TRAY", "TRAZ", "ROTX", "ROTY", "ROTZ")]
    + [("ANGL", 0, k) for k in ("revolute", "cylindrical", "screw")]
    + [("STRK", 0, k) for k in ("translational", "cylindrical", "screw")],
)
def test_motions_have_the_derivatives_of_their_equations(tmp_path, kind, target, of_joint, function):
    mechanism = with_joint(tmp_path, of_joint or "spherical", 0, 2)
    mechanism = replace(mechanism, motions=(Motion("motion 1", kind, target, function),))
    assert_rows_and_right_sides(analysis_of(mechanism), moves_time=True)


def test_held_turns_and_pins_have_the_derivatives_of_their_equations(tmp_path):
    mechanism = sample(tmp_path)
    still = MotionFunction(1)
    motions = [Motion(f"motion {k}", f"ROT{k}", 2, SINE if k == "Y" else still) for k in "XYZ"]
    mechanism = replace(mechanism, motions=tuple(motions), pins=(pin(mechanism.bodies, 0, 14),))
    assert_rows_and_right_sides(analysis_of(mechanism), moves_time=True)


@pytest.mark.parametrize("kind", KINDS)
def test_joints_do_not_feel_a_rigid_motion_of_the_whole(tmp_path, kind):
    """Components of gaps turn with the mechanism, all else stays."""
    analysis = analysis_of(with_joint(tmp_path, kind, 0, 2))
    q, _ = random_state(analysis)
    turn, shift = unit(np.array([0.4, -0.3, 0.7, 0.5])), np.array([0.3, 1.2, -0.8])
    e0, e = turn[0], turn[1:]
    other = q.copy()
    for k in range(3):
        r = q[7 * k : 7 * k + 3]
        other[7 * k : 7 * k + 3] = shift + r + 2 * np.cross(e, np.cross(e, r) + e0 * r)
        other[7 * k + 3 : 7 * k + 7] = multiplied(turn, q[7 * k + 3 : 7 * k + 7])
    before, after = residual(analysis, q), residual(analysis, other)
    names = [equation.part for equation in analysis.arrays.equations]
    gaps = np.array([name in ("x", "y", "z") for name in names])
    np.testing.assert_allclose(after[~gaps], before[~gaps], atol=1e-12)
    assert np.linalg.norm(after[gaps]) == pytest.approx(np.linalg.norm(before[gaps]), abs=1e-12)
    assert np.abs(before).max() > 1e-2


def test_forces_are_those_of_their_energy(tmp_path):
    """-d/dx of weights, springs in line and in joints, and strain energy along every speed, at rest."""
    mechanism = sample(tmp_path)
    bodies = mechanism.bodies
    joints = (joint(bodies, "cylindrical", 0, 2), joint(bodies, "translational", 1, 2, "joint 2"))
    springs = (
        spring("spring 1", Line(0, 2, node(bodies, 0, 13), node(bodies, 2, 17)), 30.0, 0.4),
        spring("s", At(0, ANGLE), 20.0, 0.3),
        spring("s", At(1, STROKE), 25.0, 0.1),
    )
    analysis = analysis_of(replace(mechanism, joints=joints, springs=springs))
    q, _ = random_state(analysis)
    arrays = analysis.arrays
    analysis.work.angles[:] = analysis.screw_angles(q)
    rest = np.zeros(arrays.speeds)
    forces = forces_at(analysis, q, rest)
    for k in range(arrays.speeds):
        u = np.zeros(arrays.speeds)
        u[k] = 1.0
        slope = sum(w * energy(analysis, moved(arrays, q, u, j * H)) for j, w in FIRST.items()) / H
        assert forces[k] == pytest.approx(-slope, abs=1e-7), arrays.speed_name(k)


def energy(analysis, q):
    from flexmb_cli.kernels.constrained.forces import spring_energy
    from flexmb_cli.kernels.constrained.mass_matrix import strain_energy, weight_energy

    forces_at(analysis, q, np.zeros(analysis.arrays.speeds))
    potential = weight_energy(analysis.system, analysis.work, q)
    return potential + spring_energy(analysis.system, analysis.work) + strain_energy(analysis.system, q)


def forces_at(analysis, q, u, t=0.7):
    evaluate_jacobian(analysis.system, analysis.work, q)
    mass_matrices(analysis.system, analysis.work, q)
    fill_forces(analysis.system, analysis.work, q, u, t)
    return analysis.work.vectors[FORCES][: u.size].copy()


def test_forces_do_the_work_of_their_points(tmp_path):
    """The generalized forces times the speeds are force times velocity and torque times angular velocity."""
    mechanism = sample(tmp_path)
    bodies, function = mechanism.bodies, table_function((0.0, 1.0, 2.0), (1.0, 3.0, -1.0))
    F, T = np.array([1.0, -2.0, 0.5]), np.array([0.3, 0.7, -0.4])
    forces = (
        PointForce("force 1", node(bodies, 0, 13), tuple(F), False, function),
        PointForce("force 2", node(bodies, 2, 17), tuple(F), True),
    )
    torques = (BodyTorque("torque 1", 1, tuple(T), False), BodyTorque("torque 2", 1, tuple(T), True))
    bare = analysis_of(replace(mechanism, gravity=(0.0,) * 3))
    loaded = analysis_of(replace(mechanism, gravity=(0.0,) * 3, forces=forces, torques=torques))
    q, u = random_state(loaded)
    added = forces_at(loaded, q, u) - forces_at(bare, q, u)
    arrays = loaded.arrays
    outputs = replace(mechanism, outputs=(forces[0].point, forces[1].point))
    velocities = [slope_of_point(outputs, arrays, q, u, k) for k in range(2)]
    A = [np.array(loaded.work.rotations[0, k]) for k in range(3)]
    power = function.at(0.7)[0] * F @ velocities[0] + (A[2] @ F) @ velocities[1]
    w = u[9:12]
    power += T @ (A[1] @ w) + T @ w
    assert added @ u == pytest.approx(power, rel=1e-9)


def slope_of_point(mechanism, arrays, q, u, k):
    """Velocity of output k by differences of its position along constant speeds."""
    point = mechanism.outputs[k]
    b, first = point.body, 7 * 3 + sum(body.modes for body in mechanism.bodies[: point.body])

    def place(x):
        eta = x[first : first + point.shape.shape[1]]
        s = point.r0 + point.shape @ eta
        e0, e = x[7 * b + 3], x[7 * b + 4 : 7 * b + 7]
        return x[7 * b : 7 * b + 3] + s + 2 * np.cross(e, np.cross(e, s) + e0 * s)

    return sum(w * place(moved(arrays, q, u, j * H)) for j, w in FIRST.items()) / H


@pytest.mark.parametrize(
    "function",
    [
        MotionFunction(1, (0.3, 0.2, -0.4, 0.1)),
        MotionFunction(2, (6.0, 1.5, 0.0, 0.0)),
        SINE,
        table_function((0.0, 0.3, 0.9, 1.4), (0.5, -1.0, 2.0, 0.3)),
        table_function((0.0, 0.3, 0.9, 1.4), (0.5, -1.0, 2.0, 0.3)).of_factor,
    ],
)
def test_kernels_and_model_have_the_same_laws(tmp_path, function):
    mechanism = replace(sample(tmp_path), motions=(Motion("motion 1", "TRAX", 0, function),))
    system = analysis_of(mechanism).system
    for t in (-0.2, 0.0, 0.1, 0.3, 0.75, 1.4, 1.6, 2.5):
        found = time_functions.function_values(system.functions, system.knots, 0, t)
        assert found == pytest.approx(function.at(t), rel=1e-12, abs=1e-12)


def test_kernels_and_model_call_the_kinds_of_laws_by_the_same_codes():
    for name in ("POLYNOMIAL", "SPIN_UP", "SINE", "TABLE", "HELD_TABLE"):
        assert getattr(time_functions, name) == getattr(motion_law, name)
