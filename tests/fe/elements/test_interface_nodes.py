"""Rigidly carried nodes and mean motions.

Expected: the least strain energy under constraints (Lagrange multipliers) as a second formulation, rigid
motions,
and resultants of forces.
"""

from types import SimpleNamespace

import numpy as np
import pytest

from flexmb_cli.fe.formats.matrix_file import FEFileFault, MatrixFile
from flexmb_cli.fe.input_checks import rigid_motions
from flexmb_cli.fe.interface_nodes import mean_motion, tied
from flexmb_cli.model.flexible_body import InterfaceNode
from tests.fe.formats.bar_files import K, M
from tests.fe.formats.bars import POINTS

POSITIONS = np.array(POINTS)
NUMBERS = np.arange(1, 17)
END = (13, 14, 15, 16)
HUB = np.array([1.0, 0.1, -0.05])
TURN = np.array([[0.36, 0.48, -0.8], [-0.8, 0.6, 0.0], [0.48, 0.64, 0.6]])


def given(*interfaces, axes=None):
    return SimpleNamespace(numbers=NUMBERS, positions=POSITIONS, axes=axes, interfaces=interfaces)


def file_of(matrix):
    rows, columns = np.nonzero(matrix)
    return MatrixFile(len(matrix), rows, columns, matrix[rows, columns], False)


def dense(file):
    full = np.zeros((file.size, file.size))
    full[file.rows, file.columns] = file.values
    return full


def rigid(position, about=(0.0, 0.0, 0.0)):
    """Translation and rotation (6, 6) at a place for those of a body."""
    x, y, z = np.subtract(position, about)
    top = np.hstack([np.eye(3), [[0, z, -y], [-z, 0, x], [y, -x, 0]]])
    return np.vstack([top, np.hstack([np.zeros((3, 3)), np.eye(3)])])


def rigid_rows(equations):
    """Rigid motions (rows, 6) of nodes of the bar and of the interface node."""
    places = dict(zip(NUMBERS.tolist(), POSITIONS, strict=True)) | {99: HUB}
    return np.array([rigid(places[node])[component - 1] for node, component in equations.tolist()])


def test_a_rigid_interface_gives_the_least_energy_under_its_constraints():
    """A moment on the hub of the bar's end, which is held at the other one."""
    hub = InterfaceNode(99, HUB, True, END, (1.0,) * 4)
    stiffness = tied(file_of(K), given(hub))
    load = np.array([300.0, -20.0, 10.0, 4.0, 5.0, -6.0])
    size = stiffness.size - 6
    # Held: nodes 1 to 4; the last six rows are those of the hub.
    held = dense(stiffness)[12:, 12:]
    forces = np.zeros(len(held))
    forces[-6:] = load
    motion = np.linalg.solve(held, forces)[-6:]
    # Second formulation: all nodes, the hub, and multipliers of u_j - u_i - theta x (r_j - r_i) = 0.
    constraints = np.zeros((12, 48 - 12 + 6))
    for j, node in enumerate(END):
        constraints[3 * j : 3 * j + 3, 3 * node - 15 : 3 * node - 12] = np.eye(3)
        constraints[3 * j : 3 * j + 3, -6:] = -rigid(POSITIONS[node - 1], HUB)[:3]
    full = np.zeros((54, 54))
    full[:36, :36] = K[12:, 12:]
    full[42:, :42], full[:42, 42:] = constraints, constraints.T
    right = np.zeros(54)
    right[36:42] = load
    assert motion == pytest.approx(np.linalg.solve(full, right)[36:42], rel=1e-9)
    assert size == 36


@pytest.mark.parametrize("turned", [False, True])
def test_rigid_motions_stay_free_of_strain_and_keep_their_mass(turned):
    """The displacement axes of carried nodes turn with their rows, not the result."""
    axes = np.tile(np.eye(3), (16, 1, 1))
    axes[[13, 15]] = TURN
    turn = np.zeros((48, 48))
    for i in range(16):
        turn[3 * i : 3 * i + 3, 3 * i : 3 * i + 3] = axes[i] if turned else np.eye(3)
    hub = InterfaceNode(99, HUB, True, END, (1.0,) * 4)
    of = given(hub, axes=axes if turned else None)
    stiffness, mass = (tied(file_of(turn.T @ A @ turn), of) for A in (K, M))
    R = rigid_rows(stiffness.equations)
    assert np.abs(dense(stiffness) @ R).max() < 1e-9 * np.abs(K).max()
    whole = rigid_motions(POSITIONS)
    np.testing.assert_allclose(R.T @ dense(mass) @ R, whole.T @ M @ whole, rtol=1e-12, atol=1e-10)


def test_carried_rotations_become_those_of_the_interface_node():
    """A spring of 7 N m about y between two nodes of six rows, of which the hub carries one."""
    labels = np.array([(node, component) for node in (1, 5) for component in range(1, 7)])
    rows = np.array([4, 4, 10, 10])
    spring = MatrixFile(12, rows, np.array([4, 10, 4, 10]), np.array([7.0, -7, -7, 7]), False, labels)
    moved = tied(spring, given(InterfaceNode(99, HUB, True, (5,), (1.0,))))
    assert moved.equations.tolist() == [[n, c] for n in (1, 99) for c in range(1, 7)]
    np.testing.assert_array_equal(dense(moved)[4], 7.0 * (np.eye(12)[4] - np.eye(12)[10]))


def test_a_mean_has_the_rigid_motion_of_its_nodes_and_gives_the_same_resultant():
    one = InterfaceNode(99, HUB, False, END, (1.0, 2.0, 0.5, 3.0))
    places = POSITIONS[[node - 1 for node in END]]
    motion = mean_motion(one, places)
    bodies = np.vstack([rigid(place)[:3] for place in places])
    np.testing.assert_allclose(motion @ bodies, rigid(HUB), rtol=0, atol=1e-12)
    load = np.array([3.0, -2.0, 1.0, 4.0, 5.0, -6.0])
    np.testing.assert_allclose(bodies.T @ (motion.T @ load), rigid(HUB).T @ load, rtol=0, atol=1e-12)


def test_a_mean_is_the_motion_of_least_squares():
    """For displacements that are not rigid: numpy.linalg.lstsq of the weighted residuals."""
    one = InterfaceNode(99, HUB, False, END, (1.0, 2.0, 0.5, 3.0))
    places = POSITIONS[[node - 1 for node in END]]
    moved = np.random.default_rng(4).normal(size=12)
    scale = np.repeat(np.sqrt(one.weights), 3)
    bodies = np.vstack([rigid(place, HUB)[:3] for place in places])
    expected = np.linalg.lstsq(scale[:, None] * bodies, scale * moved, rcond=None)[0]
    assert mean_motion(one, places) @ moved == pytest.approx(expected, rel=1e-9)


@pytest.mark.parametrize(
    ("members", "weights", "words"),
    [((1, 5, 9, 13), (1.0,) * 4, "on one line"), (END, (1.0, 0.0, 1.0, 1.0), "is 0; it must be above zero")],
)
def test_a_mean_without_rotation_is_refused(members, weights, words):
    one = InterfaceNode(99, HUB, False, members, weights)
    with pytest.raises(FEFileFault, match=words):
        mean_motion(one, POSITIONS[[node - 1 for node in members]])


def test_rows_that_a_rigid_interface_cannot_carry_are_refused():
    labels = np.array([(5, component) for component in range(1, 7)])
    file = MatrixFile(6, np.arange(6), np.arange(6), np.ones(6), True, labels)
    with pytest.raises(FEFileFault, match="node 5 has rotations, which interface node 99 must carry"):
        tied(file, given(InterfaceNode(99, HUB, True, (5,), (1.0,), turns=False)))
    labels = np.array([(1, 1), (5, 1), (5, 2)])
    file = MatrixFile(3, np.arange(3), np.arange(3), np.ones(3), True, labels)
    with pytest.raises(FEFileFault, match="interface node 5 has some rows of its own"):
        tied(file, given(InterfaceNode(5, HUB, True, (1,), (1.0,))))
