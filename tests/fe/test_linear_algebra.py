"""Small matrices are arrays, large ones sparse: both give what plain products and SciPy give."""

import numpy as np
import pytest
from scipy.linalg import eigh

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
