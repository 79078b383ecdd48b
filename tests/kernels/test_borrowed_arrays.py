"""Kernels borrow the arrays that they are given, and see parts of a row of numbers as matrices.

Expected values are those of numpy's own slices and reshapes, worked out by Python.
"""

import numpy as np
import pytest

from flexmb_cli.kernels import _arguments, _entry, _jit
from flexmb_cli.kernels._jit import allocating, kernel
from flexmb_cli.kernels.linalg.number_rows import block

pytestmark = pytest.mark.skipif(_jit.interpreted(), reason="nothing is compiled")
ROW = _arguments.Array(1, np.dtype(float))


def compiled(function, *parameters):
    """The object of a function that is compiled by itself."""
    (code,) = _entry.Unit("one", {"one": list(parameters)}, function).emit(["x86_64-linux"]).values()
    return code


@kernel
def halves(row):
    """The first and the last numbers of a row, views."""
    middle = row.shape[0] // 2
    return row[:middle], row[middle:]


@kernel
def change_halves(row):
    """Call a kernel that returns views, and one that is not inlined."""
    first, last = halves(row)
    for k in range(first.shape[0]):
        first[k] += last[k]
    return first[0]


def test_no_references_are_counted():
    """A counter of references is a call at every view: 268 in one evaluation of a flexible pendulum."""
    assert b"NRT_" not in compiled(change_halves, ROW)
    row = np.arange(6.0)
    assert change_halves(row) == 3.0 and row.tolist() == [3.0, 5.0, 7.0, 3.0, 4.0, 5.0]


@kernel
def unmarked(n):
    """A kernel that makes an array and does not say so."""
    return np.zeros(n)[0]


@allocating
def mixed_up(n):
    """A kernel that makes an array and lets another one return parts of it."""
    return halves(np.zeros(n))[1][0]


@allocating
def twice(row):
    """Return a new array."""
    return 2.0 * row


@kernel
def forgetful(row):
    """A kernel that never gives back the memory of what it gets."""
    return twice(row)[0]


@pytest.mark.parametrize("function, said", [(unmarked, "zeros"), (mixed_up, "halves"), (forgetful, "twice")])
def test_arrays_that_nobody_or_not_everybody_counts_are_refused(function, said):
    parameter = ROW if function is forgetful else "i"
    with pytest.raises(Exception, match=said):
        compiled(function, parameter)


def test_arrays_for_a_kernel_of_its_own_are_given_back():
    """Two hundred thousand arrays of a megabyte do not fit into the memory together."""

    @allocating
    def last_of_many(n):
        total = 0.0
        for k in range(200_000):
            row = np.empty(n)
            row[n - 1] = k
            total += row[n - 1]
        return total

    assert last_of_many(131_072) == 199_999 * 100_000


@kernel
def entries(flat, first, n):
    """Entries of matrices of two and of three dimensions that begin at `first`."""
    two, three = block(flat, first, (n, 3)), block(flat, first + 1, (2, n, 2))
    two[0, 2] += 100.0
    return two[n - 1, 2], three[1, n - 1, 1], three[0, 1, 1], two.shape[0] * three.shape[2]


def test_a_block_is_a_view_in_the_shape_asked_for():
    def by_numpy(flat, first, n):
        two = flat[first : first + 3 * n].reshape(n, 3)
        three = flat[first + 1 : first + 1 + 4 * n].reshape(2, n, 2)
        two[0, 2] += 100.0
        return two[n - 1, 2], three[1, n - 1, 1], three[0, 1, 1], two.shape[0] * three.shape[2]

    ours, numpys = np.arange(40.0), np.arange(40.0)
    assert entries(ours, 5, 4) == by_numpy(numpys, 5, 4)
    assert ours.tolist() == numpys.tolist()
    assert block(ours, 5, (2, 3)).base is ours


@allocating
def shape_of_new(n):
    """A block keeps the array that it is a part of."""
    view = block(np.full(2 * n, 3.0), n, (n, 1))
    return view[n - 1, 0] + np.full(2 * n, 5.0)[0]


def test_a_block_of_a_new_array_keeps_it():
    assert shape_of_new(1000) == 8.0
