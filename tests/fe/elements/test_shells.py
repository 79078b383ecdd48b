"""Shells MITC4: rigid motions, published deflections and frequencies, mass.

Expected: MacNeal and Harder, Finite Elements in Analysis and Design 1 (1985), 3-20 (roof, cylinder, twisted
beam); Timoshenko and Woinowsky-Krieger, Theory of Plates and Shells (1959), tables 8 and 35; Leissa,
Vibration of Plates (1969), free plates.
"""

import numpy as np
import pytest
import scipy.sparse
import scipy.sparse.linalg

from flexmb_cli.fe.elements.shells import shell_mass, shell_stiffness

WARPED = np.array([[[0, 0, 0], [1, 0.1, 0.2], [1.1, 0.9, -0.1], [-0.1, 1.2, 0.1]]], float)


def grid(nx, ny, place):
    """Positions of nodes at `place` of shares of both sides, and corners of the shells between them."""
    positions = np.array([place(i / nx, j / ny) for j in range(ny + 1) for i in range(nx + 1)], float)
    first = np.array([j * (nx + 1) + i for j in range(ny) for i in range(nx)])
    return positions, np.stack([first, first + 1, first + nx + 2, first + nx + 1], axis=1)


def assembled(blocks, rows):
    """A sparse matrix of six rows a node."""
    own = (6 * rows[:, :, None] + np.arange(6)).reshape(len(rows), 24)
    at = np.repeat(own, 24, axis=1).ravel(), np.tile(own, (1, 24)).ravel()
    return scipy.sparse.csc_matrix((blocks.ravel(), at))


def stiffness(positions, rows, thickness, young, poisson):
    blocks = shell_stiffness(positions[rows], np.full(len(rows), thickness), young, poisson)
    return assembled(blocks, rows)


def held(positions, conditions):
    """Rows that are held: axis, coordinate and components of nodes there."""
    return np.unique(
        [
            6 * k + c
            for axis, value, components in conditions
            for k in np.flatnonzero(np.abs(positions[:, axis] - value) < 1e-9 * np.abs(positions).max())
            for c in components
        ]
    ).astype(int)


def deflection(K, fixed, load):
    free = np.setdiff1d(np.arange(K.shape[0]), fixed)
    found = np.zeros(K.shape[0])
    found[free] = scipy.sparse.linalg.spsolve(K[free][:, free], load[free])
    return found


def uniform(positions, rows, pressure, component=2):
    """The load of a pressure, N/m², along an axis."""
    load = np.zeros(6 * len(positions))
    corners = positions[rows]
    areas = np.linalg.norm(np.cross(corners[:, 2] - corners[:, 0], corners[:, 3] - corners[:, 1]), axis=1) / 2
    np.add.at(load, 6 * rows + component, (pressure * areas / 4)[:, None])
    return load


def rigid(positions):
    found = np.zeros((len(positions), 6, 6))
    found[:, :3, :3] = found[:, 3:, 3:] = np.eye(3)
    found[:, :3, 3:] = np.cross(np.eye(3), positions[:, None]).swapaxes(1, 2)
    return found.reshape(-1, 6)


def test_a_warped_shell_has_six_rigid_motions_and_no_others():
    K = shell_stiffness(WARPED, np.array([0.1]), 1.0, 0.3)[0]
    assert np.abs(K @ rigid(WARPED[0])).max() < 1e-14 * np.abs(K).max()
    values = np.linalg.eigvalsh(K)
    assert np.abs(values[:6]).max() < 1e-14 and values[6] > 1e-7


@pytest.mark.parametrize("case", ["membrane", "bending", "shear"])
def test_constant_strains_of_a_patch_are_exact(case):
    """Patch of MacNeal and Harder: five shells, the outer nodes moved by constant strain or curvature."""
    inner = [(0.04, 0.02), (0.18, 0.03), (0.16, 0.08), (0.08, 0.08)]
    outer = [(0.0, 0.0), (0.24, 0.0), (0.24, 0.12), (0.0, 0.12)]
    positions = np.array([(*p, 0.0) for p in outer + inner])
    rows = np.array([[0, 1, 5, 4], [1, 2, 6, 5], [2, 3, 7, 6], [3, 0, 4, 7], [4, 5, 6, 7]])
    x, y, _ = positions.T
    field = np.zeros((8, 6))
    if case == "membrane":
        field[:, 0], field[:, 1] = 1e-3 * (x + y / 2), 1e-3 * (y + x / 2)
    elif case == "shear":
        field[:, 0], field[:, 1], field[:, 5] = 1e-3 * y, -2e-3 * x, -1.5e-3
    else:
        field[:, 2] = 1e-3 * (x**2 + x * y + y**2) / 2
        field[:, 3], field[:, 4] = 1e-3 * (y + x / 2), -1e-3 * (x + y / 2)
    K = stiffness(positions, rows, 0.001, 1e6, 0.25)
    edge, free = np.arange(24), np.arange(24, 48)
    found = scipy.sparse.linalg.spsolve(K[free][:, free], -K[free][:, edge] @ field.ravel()[edge])
    assert np.abs(found - field.ravel()[free]).max() < 1e-12


@pytest.mark.parametrize(("clamped", "expected"), [(False, 0.00406235), (True, 0.00126532)])
def test_a_square_plate_under_pressure(clamped, expected):
    positions, rows = grid(12, 12, lambda a, b: (a, b, 0.0))
    young, poisson, thickness = 1e6, 0.3, 0.01
    edge = range(6) if clamped else [2]
    sides = [(axis, value, edge) for axis in (0, 1) for value in (0.0, 1.0)]
    fixed = np.union1d(held(positions, sides), [0, 1, 5, 7])
    K = stiffness(positions, rows, thickness, young, poisson)
    moved = deflection(K, fixed, uniform(positions, rows, 1.0))[2::6]
    assert moved.max() * young * thickness**3 / 12 / (1 - poisson**2) == pytest.approx(expected, rel=5e-3)


def test_the_roof_of_scordelis_and_lo():
    """A quarter of 8 x 8 shells; 0.3024 at the middle of the free edge."""
    angle = np.radians(40)
    positions, rows = grid(8, 8, lambda a, b: (25 * np.sin(angle * a), 25 * b, 25 * np.cos(angle * a)))
    symmetric = [(0, 0.0, (0, 4, 5)), (1, 0.0, (1, 3, 5)), (1, 25.0, (0, 2))]
    K = stiffness(positions, rows, 0.25, 4.32e8, 0.0)
    moved = deflection(K, held(positions, symmetric), uniform(positions, rows, -90.0))
    assert moved[6 * 8 + 2] == pytest.approx(-0.3024, rel=0.01)


def test_the_pinched_cylinder_with_end_diaphragms():
    """An eighth of 30 x 30 shells; 1.8248e-5 under the unit load."""
    quarter = np.pi / 2
    place = lambda a, b: (300 * np.sin(a * quarter), 300 * b, 300 * np.cos(a * quarter))  # noqa: E731
    positions, rows = grid(30, 30, place)
    symmetric = [(0, 0.0, (0, 4, 5)), (1, 0.0, (1, 3, 5)), (2, 0.0, (2, 3, 4)), (1, 300.0, (0, 2))]
    load = np.zeros(6 * len(positions))
    load[2] = -0.25
    K = stiffness(positions, rows, 3.0, 3e6, 0.3)
    assert deflection(K, held(positions, symmetric), load)[2] == pytest.approx(-1.8248e-5, rel=0.02)


@pytest.mark.parametrize(("component", "expected"), [(2, 5.424e-3), (1, 1.754e-3)])
def test_the_twisted_beam(component, expected):
    """Turned by 90° over its length, 12 x 2 warped shells; in-plane and out-of-plane loads on the end."""

    def place(a, b):
        return 12 * a, 1.1 * (b - 0.5) * np.cos(a * np.pi / 2), 1.1 * (b - 0.5) * np.sin(a * np.pi / 2)

    positions, rows = grid(12, 2, place)
    tip = np.flatnonzero(np.abs(positions[:, 0] - 12) < 1e-9)
    load = np.zeros(6 * len(positions))
    load[6 * tip + component] = 0.25, 0.5, 0.25
    K = stiffness(positions, rows, 0.32, 29e6, 0.22)
    moved = deflection(K, held(positions, [(0, 0.0, range(6))]), load)
    assert moved[6 * tip[1] + component] == pytest.approx(expected, rel=0.02)


def test_frequencies_of_a_free_square_plate():
    """λ = ω a² √(ρ t/D) = 13.468, 19.596, 24.270 at ν = 0.3; Leissa's Ritz values lie up to 1 % above."""
    positions, rows = grid(20, 20, lambda a, b: (a, b, 0.0))
    thickness, young, poisson, density = 0.005, 7e10, 0.3, 2700.0
    K = stiffness(positions, rows, thickness, young, poisson)
    blocks = shell_mass(positions[rows], np.full(len(rows), thickness), density, np.zeros(len(rows)))
    M = assembled(blocks, rows)
    shift = -1e2
    values = np.sort(scipy.sparse.linalg.eigsh(K, 9, M, sigma=shift, return_eigenvectors=False))
    bending = young * thickness**3 / 12 / (1 - poisson**2)
    found = np.sqrt(values[6:9] * density * thickness / bending)
    assert np.abs(values[:6]).max() < 1e-3 * values[6]
    assert found == pytest.approx([13.468, 19.596, 24.270], rel=0.01)


def test_mass_and_inertia_of_a_plate():
    """m = (ρ t + μ) a b, about the normal m (a² + b²)/3, in the plane m b²/3 and ρ t³ a b/12."""
    positions, rows = grid(2, 3, lambda a, b: (0.3 * a, 0.2 * b, 0.0))
    thickness, density, extra, area = 0.01, 2700.0, 5.0, 0.06
    blocks = shell_mass(positions[rows], np.full(6, thickness), density, np.full(6, extra))
    R = rigid(positions)
    found = np.diag(R.T @ (assembled(blocks, rows) @ R))
    m, rotary = (density * thickness + extra) * area, density * thickness**3 / 12 * area
    expected = [m, m, m, m * 0.04 / 3 + rotary, m * 0.09 / 3 + rotary, m * 0.13 / 3 + 1e-3 * rotary]
    assert found == pytest.approx(expected, rel=1e-12)
