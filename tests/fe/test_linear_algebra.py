"""Small matrices are arrays, large ones sparse: both give what plain products and SciPy give."""

import tracemalloc

import numpy as np
import pytest
from scipy.linalg import eigh
from scipy.sparse import block_diag, csc_matrix, diags_array, eye_array, kron
from scipy.sparse.linalg import splu

from flexmb_cli.fe import linear_algebra
from flexmb_cli.fe.linear_algebra import (
    Singular,
    as_array,
    condensed_on,
    in_three_directions,
    pencil,
    solver,
    summed,
    turned,
    without_diagonal,
)

RANDOM = np.random.default_rng(5)


@pytest.fixture(params=["array", "sparse"])
def matrix(request, monkeypatch):
    """Makes a matrix of either kind from an array."""
    if request.param == "sparse":
        monkeypatch.setattr(linear_algebra, "DENSE", 0)

    def make(values):
        rows, columns = np.indices(values.shape)
        made = summed(values.ravel(), rows.ravel(), columns.ravel(), len(values))
        assert isinstance(made, np.ndarray) == (request.param == "array")
        return made

    return make


def positive(size):
    half = RANDOM.normal(size=(size, size))
    return half @ half.T + np.eye(size)


def test_what_stands_at_one_place_is_added_up(matrix):
    matrix(np.eye(2))
    found = summed(np.array([1.0, 2.0, 4.0]), np.array([0, 0, 1]), np.array([1, 1, 0]), 2)
    assert as_array(found).tolist() == [[0, 3], [4, 0]]


def test_directions_are_set_apart_and_turned_block_by_block(matrix):
    scalar, K = positive(3), positive(9)
    axes = np.linalg.qr(RANDOM.normal(size=(3, 3)))[0]
    turn = np.kron(np.eye(3), axes)
    assert as_array(in_three_directions(matrix(scalar))) == pytest.approx(np.kron(scalar, np.eye(3)))
    assert as_array(turned(matrix(K), axes)) == pytest.approx(turn.T @ K @ turn, rel=1e-12)
    assert as_array(without_diagonal(matrix(K))) == pytest.approx(K - np.diag(np.diag(K)))


def test_condensing_is_the_schur_complement(matrix):
    """The inverse of the condensed matrix is the outer block of the inverse of the whole."""
    K = positive(8)
    full, outer, inner = matrix(K), np.arange(5), np.arange(5, 8)
    found = condensed_on(full[outer][:, outer], full[inner][:, outer], full[inner][:, inner])
    assert np.linalg.inv(as_array(found)) == pytest.approx(np.linalg.inv(K)[:5, :5], rel=1e-10)


def test_a_singular_system_is_told(matrix):
    with pytest.raises(Singular):
        solver(matrix(np.diag([1.0, 0.0, 2.0])))(np.ones(3))


@pytest.mark.parametrize("largest", [False, True])
def test_a_pencil_has_scipys_eigenvalues_and_unit_vectors(largest):
    A, B = positive(7), positive(7)
    values, vectors = pencil(A, B, 3, largest)
    wanted = eigh(A, B, eigvals_only=True)
    assert values == pytest.approx(wanted[-3:] if largest else wanted[:3], rel=1e-12)
    assert vectors.T @ B @ vectors == pytest.approx(np.eye(3), abs=1e-12)
    assert A @ vectors == pytest.approx(B @ vectors * values, abs=1e-11)


@pytest.mark.parametrize("chosen", [(), np.arange(0.0), [0, 4], np.array([3, 1, 3])])
def test_the_numbers_that_are_not_chosen(chosen):
    assert linear_algebra.all_but(5, chosen).tolist() == sorted(set(range(5)) - set(map(int, chosen)))


@pytest.mark.parametrize("values", [[], [2.0], [3.0, 1.0, 3.0, 2.0, 1.0], [[4, 5], [5, 6]]])
def test_different_numbers_in_order(values):
    found = linear_algebra.distinct(np.array(values))
    assert found.tolist() == sorted(set(np.array(values).ravel().tolist()))


def blocks(sizes):
    """A positive matrix of uncoupled blocks, its rows mixed."""
    A, first = np.zeros((sum(sizes), sum(sizes))), 0
    for size in sizes:
        A[first : first + size, first : first + size] = positive(size)
        first += size
    mixed = RANDOM.permutation(len(A))
    return A[np.ix_(mixed, mixed)]


@pytest.mark.parametrize("largest", [60, 0])
def test_condensing_blocks_is_the_schur_complement_of_numpy(monkeypatch, largest):
    """Blocks of several sizes, inverted singly or, if they are large, solved for a few columns at a time."""
    monkeypatch.setattr(linear_algebra, "LARGEST_BLOCK", largest)
    monkeypatch.setattr(linear_algebra, "COLUMNS_AT_ONCE", 3)
    inner, outer, coupling = blocks([1, 9, 3, 9, 2, 1]), positive(11), RANDOM.normal(size=(25, 11))
    coupling[:, [2, 5]] = 0.0
    found = condensed_on(*map(csc_matrix, (outer, coupling, inner)))
    assert found.toarray() == pytest.approx(outer - coupling.T @ np.linalg.solve(inner, coupling), abs=1e-12)
    inner[3] = inner[:, 3] = 0.0
    with pytest.raises(Singular):
        condensed_on(*map(csc_matrix, (outer, coupling, inner)))


def condensing_peak(count):
    """Most bytes taken at a time to condense a row of `count` elements, of 9 rows inside and 6 shared."""
    inner = block_diag([positive(9)] * count, format="csc")
    rows = np.repeat(np.arange(9 * count), 12)
    columns = (6 * (rows // 9) + np.tile(np.arange(12), 9 * count)).astype(int)
    size = 6 * count + 6
    coupling = csc_matrix((np.ones(len(rows)), (rows, columns)), (9 * count, size))
    tracemalloc.start()
    condensed_on(csc_matrix((size, size)), coupling, inner)
    peak = tracemalloc.get_traced_memory()[1]
    tracemalloc.stop()
    return peak


def test_condensing_elements_takes_memory_in_proportion_to_them():
    """Four times as many take four times as much; dense right-hand sides took sixteen times as much."""
    assert condensing_peak(400) < 6 * condensing_peak(100)


def test_a_stiffness_of_bricks_keeps_its_blocks_and_its_factors_stay_sparse():
    """Equal bricks with their edges along the axes have exact zeros between directions.

    Factors by minimum degree on the pattern of nodes are the reference: three rows for each.
    """
    cells = (12, 8, 8)
    scalar = lattice(cells)
    nodes = scalar.shape[0]
    direction = diags_array([1.0, 2.0, 3.0])
    K = kron(scalar, direction).tocsc()  # no coupling of directions at all
    found = turned(K, np.eye(3))
    assert found.nnz == 9 * scalar.nnz
    assert (found - K).nnz == 0
    pattern = splu(scalar, permc_spec="MMD_AT_PLUS_A", options={"SymmetricMode": True})
    factors = solver(found).__self__
    assert factors.L.nnz + factors.U.nnz < 1.2 * 9 * (pattern.L.nnz + pattern.U.nnz)
    assert nodes == 13 * 9 * 9


def lattice(cells):
    """The matrix of a lattice of bricks, in which every node is coupled to those of its elements."""
    lines = [diags_array([-1.0, 2.5, -1.0], offsets=[-1, 0, 1], shape=(n + 1, n + 1)) for n in cells]
    return kron(kron(lines[0], lines[1]), lines[2]).tocsc() + 30 * eye_array(np.prod(np.array(cells) + 1))
