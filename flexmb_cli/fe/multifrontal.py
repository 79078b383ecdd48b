"""Cholesky factors of a large stiffness by the multifrontal method, in an order of nested dissection.

George, SIAM J. Numer. Anal. 10 (1973), 345-363: the nodes of a half that touch the other half are eliminated
after both.  Duff and Reid, ACM Trans. Math. Softw. 9 (1983), 302-325: a part is eliminated in a dense front
of its rows and of those after it that they reach.  Dense products make it as fast as CHOLMOD and PARDISO.
"""

from collections.abc import Callable, Iterator
from functools import partial
from typing import Any

import numpy as np
from scipy import sparse
from scipy.linalg import blas, lapack

# Nodes of a part that is not halved again.
LEAF = 60

# First and last row of a part, the rows after it that it reaches, the inverse of its diagonal factor, and
# the factor of those rows.
Front = tuple[int, int, np.ndarray, np.ndarray, np.ndarray]


def solver_by_fronts(A: Any, places: np.ndarray) -> Callable[[np.ndarray], np.ndarray]:
    """The function b → x of A x = b, A (size, size) sparse, its rows at `places` (size, 3), node by node.

    Raises numpy's LinAlgError unless A is positive definite.
    """
    begins = np.append(True, (places[1:] != places[:-1]).any(axis=1))
    node, ones = np.cumsum(begins) - 1, np.ones(max(A.nnz, len(places)), dtype=np.int32)
    members = sparse.csc_matrix((ones[: len(node)], node, np.arange(len(node) + 1)))
    pattern = sparse.csc_matrix((ones[: A.nnz], A.indices, A.indptr), A.shape)
    graph = (members @ pattern @ members.T).tocsr()
    parts, counts = zip(*_dissected(graph, places[begins], np.arange(graph.shape[0])), strict=True)
    rank = np.argsort(np.concatenate(parts))[node]
    order = np.argsort(rank, kind="stable")
    bounds = np.searchsorted(rank[order], np.cumsum([0, *map(len, parts)])).tolist()
    lower = sparse.tril(A.tocsc()[:, order][order]).tocsc()
    fronts = list(_fronts(lower, bounds, counts))
    return partial(_solution, fronts, order)


def _dissected(graph: Any, places: np.ndarray, nodes: np.ndarray) -> Iterator[tuple[np.ndarray, int]]:
    """Parts of `nodes` in the order of elimination, and how many parts before each it joins."""
    if len(nodes) <= LEAF:
        yield nodes, 0
        return
    axis = int(np.argmax(np.ptp(places[nodes], axis=0)))
    halves = np.array_split(nodes[np.argsort(places[nodes, axis], kind="stable")], 2)
    touching = [_touching(graph, *halves), _touching(graph, *halves[::-1])]
    thinner = int(touching[1].sum() < touching[0].sum())
    near, half = touching[thinner], halves[thinner]
    yield from _dissected(graph, places, half[~near])
    yield from _dissected(graph, places, halves[1 - thinner])
    yield half[near], 2


def _touching(graph: Any, nodes: np.ndarray, others: np.ndarray) -> np.ndarray:
    """Return which of `nodes` have an edge to one of `others`."""
    among = np.zeros(graph.shape[0], dtype=np.int32)
    among[others] = 1
    return graph[nodes] @ among > 0


def _fronts(lower: Any, bounds: list[int], counts: tuple[int, ...]) -> Iterator[Front]:
    """Eliminate part by part; `counts`: of how many parts before the updates enter, the last ones first."""
    updates: list[tuple[np.ndarray, np.ndarray]] = []
    place = np.zeros(lower.shape[0], dtype=np.int64)
    for k, count in enumerate(counts):
        a, b = bounds[k : k + 2]
        joined = updates[len(updates) - count :]
        del updates[len(updates) - count :]
        entries = slice(lower.indptr[a], lower.indptr[b])
        reached = np.unique(np.concatenate([lower.indices[entries], *(rows for rows, _ in joined)]))
        reached = reached[reached >= b]
        place[a:b], place[reached] = np.arange(b - a), np.arange(b - a, b - a + len(reached))
        front = np.zeros((b - a + len(reached),) * 2, order="F")
        columns = np.repeat(np.arange(b - a), np.diff(lower.indptr[a : b + 1]))
        front[place[lower.indices[entries]], columns] = lower.data[entries]
        while joined:
            _add(front, place, *joined.pop())
        inverse, factor, update = _eliminated(front, b - a)
        updates.append((reached, update))
        yield a, b, reached, inverse, factor


def _add(front: np.ndarray, place: np.ndarray, rows: np.ndarray, update: np.ndarray) -> None:
    """Add the `update` of the `rows` of the matrix to a front, both in columns."""
    at = place[rows]
    np.add.at(front.T.reshape(-1), (at[:, None] * len(front) + at).ravel(), update.T.ravel())


def _eliminated(front: np.ndarray, count: int) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Return the inverse factor of the first `count` rows, the factor of the others, and these updated.

    Of symmetric matrices the lower triangle counts.  Raises LinAlgError.
    """
    own, coupling, others = front[:count, :count], front[count:, :count], front[count:, count:]
    if not count:
        return own, coupling, others
    diagonal, failed = lapack.dpotrf(own, lower=1)
    if failed:
        raise np.linalg.LinAlgError
    inverse = lapack.dtrtri(diagonal, lower=1)[0]
    if not len(others):
        return inverse, coupling, others
    factor = blas.dtrmm(1.0, inverse, coupling, side=1, lower=1, trans_a=1)
    return inverse, factor, blas.dsyrk(-1.0, factor, beta=1.0, c=others, lower=1)


def _solution(fronts: list[Front], order: np.ndarray, b: np.ndarray) -> np.ndarray:
    x = b[order]
    for first, last, rest, inverse, factor in fronts:
        x[first:last] = inverse @ x[first:last]
        x[rest] -= factor @ x[first:last]
    for first, last, rest, inverse, factor in reversed(fronts):
        x[first:last] = inverse.T @ (x[first:last] - factor.T @ x[rest])
    solution: np.ndarray = np.empty_like(x)
    solution[order] = x
    return solution
