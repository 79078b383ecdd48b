"""Geometric stiffness and viscous damping of files for bodies with rotations.

Expected: flapwise frequencies of rotating cantilevers (Wright, Smith, Thresher and Wang, J. Appl. Mech. 49
(1982), 197); D = Φ' B Φ of B in proportion to K; a damper that resists a rigid rotation resists nothing else.
"""

import tracemalloc

import numpy as np
import pytest
from numpy.polynomial import Polynomial
from scipy.linalg import eigh

from flexmb_cli.errors import ModelError
from flexmb_cli.fe.formats.matrix_file import MatrixFile
from flexmb_cli.fe.rows import in_rows
from tests.fe.elements.test_beams import matrices
from tests.fe.row_bodies.row_decks import FILES, body_of, free_deck, market_deck
from tests.fe.trusses import write_matrix

CELLS = 16
AREA, BENDING, STRONG = 1e-6, 1e-14, 4e-14  # of a thin blade, m² and m⁴; rotary inertia is of the order 1e-8
ELASTIC = (7e10, 0.33, 2700.0)
FLAPWISE = {1.0: 3.6816, 2.0: 4.1373, 6.0: 7.3604, 12.0: 13.1702}  # ω and Ω by √(E I/(ρ A L⁴))


def blade(folder):
    """Positions, K and M of beams along x from the axis of rotation to 1 m."""
    grids = "".join(f"GRID,{k + 1},,{k / CELLS!r},0.,0.\n" for k in range(CELLS + 1))
    bars = "".join(f"CBAR,{k + 1},1,{k + 1},{k + 2},0.,1.,0.\n" for k in range(CELLS))
    section = f"PBAR,1,1,{AREA!r},{STRONG!r},{BENDING!r},{STRONG!r}\nMAT1,1,7.+10,,.33,2700.\n"
    K, M = matrices(folder, grids + bars + section, ELASTIC)
    return np.column_stack([np.arange(CELLS + 1) / CELLS, *np.zeros((2, CELLS + 1))]), K, M


def stiffness_of_pull(pull):
    """K_G (6 n, 6 n) of an axial force, N, a polynomial of x: the integral of it by squares of slopes."""
    h, s = 1.0 / CELLS, Polynomial([0.0, 1.0])
    # Hermite's cubics on an element: displacements and slopes of both ends.
    shapes = [1 - 3 * s**2 + 2 * s**3, h * (s - 2 * s**2 + s**3), 3 * s**2 - 2 * s**3, h * (s**3 - s**2)]
    slopes = [shape.deriv() / h for shape in shapes]
    KG = np.zeros((6 * CELLS + 6, 6 * CELLS + 6))
    for k in range(CELLS):
        along = pull(h * (k + s))
        part = np.array([[h * ((along * a * b).integ()(1.0)) for b in slopes] for a in slopes])
        for shift, turn, sign in ((1, 5, 1.0), (2, 4, -1.0)):  # θ_z = y', θ_y = -z'
            rows = 6 * k + np.array([shift, turn, 6 + shift, 6 + turn])
            signs = np.array([1.0, sign, 1.0, sign])
            KG[np.ix_(rows, rows)] += signs[:, None] * part * signs
    return KG


@pytest.mark.parametrize("speed", FLAPWISE)
def test_a_blade_with_its_geometric_stiffness_turns_as_in_print(tmp_path, speed):
    """The load xx of amplitude 1 presses: -ρ A x along x; turning about z has (w~ w~)_xx = -Ω²."""
    X, K, M = blade(tmp_path)
    x = Polynomial([0.0, 1.0])
    write_matrix(tmp_path / "KG.mtx", stiffness_of_pull(-0.5 * ELASTIC[2] * AREA * (1.0 - x**2)))
    cards = f"CLMP\n    1,1,\nGEOS\n    1,1,\nFEMG\n    1,4,MM,{tmp_path}/KG.mtx\n"
    body, _ = body_of(market_deck(tmp_path, X, M, K, more=cards))
    unit = np.sqrt(ELASTIC[0] * BENDING / (ELASTIC[2] * AREA))
    spin = np.cross(np.eye(3), [0.0, 0.0, speed * unit])
    stiffness = body.Kr + np.einsum("ij,ijkl->kl", spin @ spin, body.KG)
    (lowest,) = eigh(stiffness, body.Mff, subset_by_index=[0, 0], eigvals_only=True)
    assert np.sqrt(lowest) / unit == pytest.approx(FLAPWISE[speed], abs=1e-4)


def frame_files(folder, B):
    """The L-frame of rows without labels, with the damping matrix B."""
    stored = np.load(FILES / "frame_cb.npz")
    write_matrix(folder / "B.mtx", B(stored["K"]))
    cards = f"FEMD\n    1,MM,{folder}/B.mtx\n"
    return market_deck(folder, stored["X"], stored["M"], stored["K"], more=cards)


def test_damping_of_a_file_in_proportion_to_the_stiffness_keeps_rigid_motions_free(tmp_path):
    body, _ = body_of(frame_files(tmp_path, lambda K: 2e-4 * K))
    np.testing.assert_allclose(body.Dr, 2e-4 * body.Kr, rtol=0, atol=1e-9 * np.abs(body.Dr).max())


@pytest.mark.parametrize("component", range(6))
def test_a_damper_from_a_node_to_the_ground_is_refused(tmp_path, component):
    """Every component of the second node: three displacements and three rotations; it is B R, not K R."""

    def grounded(K):
        B = 2e-4 * K
        B[6 + component, 6 + component] += 0.01 * np.abs(B).max()
        return B

    with pytest.raises(ModelError) as refused:
        body_of(frame_files(tmp_path, grounded))
    assert [fault.id for fault in refused.value.faults if fault.severity == "error"] == ["FE-302"]


def test_a_damper_between_two_nodes_must_turn_with_them(tmp_path):
    """Along y between nodes 1 and 7, 0.4 m apart along x: a rotation about z stretches it."""

    def across(K):
        B = np.zeros_like(K)
        ends = [1, 7]
        B[np.ix_(ends, ends)] = 5.0 * np.array([[1.0, -1.0], [-1.0, 1.0]])
        return B

    with pytest.raises(ModelError, match="the damping matrix resists rigid motion"):
        body_of(frame_files(tmp_path, across))


def test_rows_of_a_damper_that_the_body_lacks_are_named(tmp_path):
    """In `beam_n6` node 103 has no rotations."""
    damper = "DMIG,BAAX,0,6,2,0,,,1\nDMIG,BAAX,103,5,,103,5,2.5\n"
    (tmp_path / "B.pch").write_text(damper)
    cards = f"FEMD\n    1,DMIG,{tmp_path}/B.pch\n"
    files = "BDF beam_n6.pch", "DMIG beam_n6.pch", "DMIG beam_n6.pch"
    with pytest.raises(ModelError, match="1 rows that mass and stiffness lack: node 103, component 5"):
        body_of(free_deck(FILES, *files, more=cards))


def test_a_damper_in_a_file_of_many_empty_rows_takes_little_memory():
    """A file of 120,000 rows, one of which holds a number, for a body with the rows of two nodes."""
    numbers = np.arange(1, 20_001)
    labels = np.array([(n, c) for n in (1, 2) for c in range(1, 7)])
    file = MatrixFile(120_000, np.array([7]), np.array([7]), np.array([3.5]), True)
    tracemalloc.start()
    damping, _ = in_rows("B.mtx", file, numbers, labels)
    _, peak = tracemalloc.get_traced_memory()
    tracemalloc.stop()
    assert damping[7, 7] == damping.sum() == 3.5
    assert peak < 100e6
