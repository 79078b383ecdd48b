"""Factors by fronts in nested dissection, and modes by blocks of vectors, beside SciPy's dense routines."""

import numpy as np
import pytest
from scipy.linalg import eigh
from scipy.sparse import csc_matrix, diags_array, eye_array, kron

from flexmb_cli.fe import linear_algebra, multifrontal
from flexmb_cli.fe.linear_algebra import lowest_by_iteration, solver
from flexmb_cli.fe.multifrontal import solver_by_fronts

RANDOM = np.random.default_rng(7)


def grid(*shape):
    """The matrix of a grid, in which nodes are coupled to those of their cells, and the nodes' places."""
    A = eye_array(1)
    for n in shape:
        A = kron(A, diags_array([-1.0, 2.5, -1.0], offsets=[-1, 0, 1], shape=(n, n)))
    places = np.stack(np.meshgrid(*map(np.arange, shape), indexing="ij"), axis=-1).reshape(-1, len(shape))
    return A + 3.0 ** len(shape) * 5 * eye_array(len(places)), np.pad(places, ((0, 0), (0, 3 - len(shape))))


def body(*shape):
    """A positive definite matrix of three coupled rows a node, nodes in any order, some rows missing."""
    scalar, places = grid(*shape)
    half = RANDOM.normal(size=(3, 3))
    order = RANDOM.permutation(len(places))
    K = kron(scalar.tocsr()[order][:, order], half @ half.T + np.eye(3)).tocsr()
    rows = np.setdiff1d(np.arange(K.shape[0]), [0, 1, 2, 10, 11, 50])
    return K[rows][:, rows].tocsc(), np.repeat(places[order], 3, axis=0)[rows].astype(float)


@pytest.mark.parametrize("leaf", [1, 20, 1000])
@pytest.mark.parametrize("width", [None, 1, 4])
def test_solutions_by_fronts_are_those_of_numpy(monkeypatch, leaf, width):
    monkeypatch.setattr(multifrontal, "LEAF", leaf)
    K, places = body(6, 5, 3)
    b = RANDOM.normal(size=(len(places), width or 1))[:, slice(None) if width else 0]
    given = b.copy()
    assert solver_by_fronts(K, places)(b) == pytest.approx(
        np.linalg.solve(K.toarray(), b), rel=1e-10, abs=1e-13
    )
    assert (b == given).all()


def test_two_bodies_in_one_and_all_nodes_at_one_place_are_solved(monkeypatch):
    monkeypatch.setattr(multifrontal, "LEAF", 2)
    K, places = body(4, 4, 2)
    both, b = kron(eye_array(2), K).tocsc(), RANDOM.normal(size=2 * len(places))
    for where in (np.vstack([places, places + 9.0]), np.zeros((len(b), 3))):
        assert solver_by_fronts(both, where)(b) == pytest.approx(np.linalg.solve(both.toarray(), b), rel=1e-9)


@pytest.mark.parametrize("n", [16, 48])
def test_factors_of_a_square_grid_have_fewer_entries_than_by_the_theorem_of_george(monkeypatch, n):
    """SIAM J. Numer. Anal. 10 (1973), 345: at most 31/4 n² log2 n, and terms of lower order, in nested
    dissection; by rows they are n³.
    """
    monkeypatch.setattr(multifrontal, "LEAF", 4)
    fronts = solver_by_fronts(*grid(n, n)).args[0]
    entries = sum(own.shape[0] * (own.shape[0] + 1) // 2 + factor.size for *_, own, factor in fronts)
    assert entries < 31 / 4 * n**2 * np.log2(n)


def test_what_is_not_positive_definite_is_solved_with_pivots():
    K, places = body(5, 4, 2)
    values = eigh(K.toarray(), eigvals_only=True)
    K = (K - (values[10] + values[11]) / 2 * eye_array(len(places))).tocsc()
    with pytest.raises(np.linalg.LinAlgError):
        solver_by_fronts(K, places)
    b = RANDOM.normal(size=len(places))
    assert solver(K, places)(b) == pytest.approx(np.linalg.solve(K.toarray(), b), rel=1e-8)


@pytest.mark.parametrize("block", [2, 8])
def test_modes_by_blocks_are_those_of_scipy_where_many_coincide(monkeypatch, block):
    """A cube has threefold frequencies, more at once than a block of two has vectors."""
    monkeypatch.setattr(linear_algebra, "VECTORS_AT_ONCE", block)
    K, places = grid(5, 5, 5)
    S = (K @ K / 1000 + eye_array(len(places))).tocsc()
    values, vectors = lowest_by_iteration(S, 12, solver_by_fronts(K.tocsc(), places))
    dense = eigh(K.toarray(), S.toarray(), eigvals_only=True)
    assert values == pytest.approx(dense[:12], rel=1e-12)
    assert vectors.T @ (S @ vectors) == pytest.approx(np.eye(12), abs=1e-12)
    assert K @ vectors == pytest.approx(S @ vectors * values, abs=1e-9)


@pytest.mark.parametrize("block", [2, 8])
def test_shapes_without_mass_end_the_search(monkeypatch, block):
    """Of five masses there are five modes, though eight are asked for."""
    monkeypatch.setattr(linear_algebra, "VECTORS_AT_ONCE", block)
    K, places = grid(12, 10)
    masses = np.zeros(len(places))
    masses[[3, 40, 41, 77, 110]] = 1.0, 2.0, 2.0, 1e-3, 5.0
    heavy = masses > 0
    values, vectors = lowest_by_iteration(csc_matrix(np.diag(masses)), 8, solver_by_fronts(K.tocsc(), places))
    flexibility = np.linalg.inv(K.toarray())[np.ix_(heavy, heavy)] * np.sqrt(
        np.outer(masses, masses)[np.ix_(heavy, heavy)]
    )
    assert values == pytest.approx(np.sort(1.0 / np.linalg.eigvalsh(flexibility)), rel=1e-10)
    assert vectors.shape == (len(places), 5)
