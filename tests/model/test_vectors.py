"""Vectors of rows against numpy's own functions."""

import numpy as np
import pytest

from flexmb_cli.model.vectors import cross, cross_rows


@pytest.mark.parametrize("shapes", [((3,), (3,)), ((5, 3), (5, 3)), ((4, 1, 3), (6, 3)), ((0, 3), (0, 3))])
def test_vector_products_have_the_digits_of_numpy(shapes):
    chance = np.random.default_rng(5)
    a, b = (chance.uniform(-1, 1, shape) * 10.0 ** chance.integers(-9, 9, shape) for shape in shapes)
    assert cross_rows(a, b).tobytes() == np.cross(a, b).tobytes()


def test_a_single_vector_product_has_the_digits_of_numpy():
    chance = np.random.default_rng(6)
    for _ in range(200):
        a, b = (chance.uniform(-1, 1, 3) * 10.0 ** chance.integers(-9, 9, 3) for _ in range(2))
        assert cross(a, b).tobytes() == np.cross(a, b).tobytes()
