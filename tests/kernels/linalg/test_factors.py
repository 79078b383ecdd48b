"""Factors of a matrix whose last columns depend on those before, against numpy's dense solution."""

import numpy as np
import pytest

from flexmb_cli.kernels.linalg.lu import factorise, substitute


@pytest.mark.parametrize("rank", [4, 6])
def test_memory_of_an_earlier_matrix_does_not_matter_to_one_of_lower_rank(rank):
    """Unknowns from the rank on are 0; the others solve the leading block."""
    random, n = np.random.default_rng(7), 6
    order, pattern, x = np.arange(n), np.zeros((n, n + 1), np.int64), np.empty(n)
    assert factorise(random.normal(size=(n, n)), order, pattern, 1e-9, n) != 0
    wide = random.normal(size=(n, n))
    leading = wide[:rank, :rank].copy()
    wide[rank:], wide[:, rank:] = 0.0, random.normal(size=(n, n - rank))
    wide[rank:] = 0.0
    order[:], b = np.arange(n), np.append(random.normal(size=rank), np.zeros(n - rank))
    assert factorise(wide, order, pattern, 1e-9, rank) != 0
    substitute(wide, order, pattern, b, x)
    np.testing.assert_allclose(x[:rank], np.linalg.solve(leading, b[:rank]), rtol=1e-11)
    assert not x[rank:].any()
