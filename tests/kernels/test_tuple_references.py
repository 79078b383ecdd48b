"""Named tuples of Python's in compiled kernels: one address, and the right number at every place.

Expected values are those of the same function run by Python, and counts of arguments by hand.
"""

from collections import namedtuple

import numpy as np
import pytest

from flexmb_cli.kernels import _arguments, _entry, _jit, _linking, _numba, _values
from flexmb_cli.kernels._jit import kernel

pytestmark = pytest.mark.skipif(_jit.interpreted(), reason="nothing is compiled")
RECORD = np.dtype([("count", np.int64), ("place", np.float64, 3)])
Inner = namedtuple("Inner", "phases marks")
Outer = namedtuple("Outer", "number length wanted matrix inner records row")
Few = namedtuple("Few", "row")


def outer():
    inner = Inner(np.array([1.0 + 2.0j, 3.0 - 1.0j]), np.array([[[7, 8], [9, 10]]]))
    records = np.zeros(2, RECORD)
    records["count"], records["place"][:, 2] = (3, 4), (0.25, 0.5)
    return Outer(5, 0.125, True, np.arange(6.0).reshape(2, 3), inner, records, np.arange(4.0))


@kernel
def inner_sum(inner, k):
    """A tuple within a tuple is handed on by its own address."""
    return inner.phases[1].real * inner.marks[0, k, 1] + inner.marks.shape[1]


@kernel
def mixed_sum(given):
    """Every kind of field, read and written."""
    given.row[2] = given.length
    total = given.matrix[1, 2] + given.matrix.shape[0] + given.records[1]["place"][2]
    if given.wanted:
        total += 1000.0 * given.number + given.records[0]["count"]
    return total + inner_sum(given.inner, 1), given.wanted


def test_every_field_is_read_from_its_place():
    one, other = outer(), outer()
    assert mixed_sum(one) == mixed_sum.interpreted(other) == (5 + 2 + 0.5 + 5000 + 3 + 3 * 10 + 2, True)
    assert one.row.tolist() == other.row.tolist() == [0.0, 1.0, 0.125, 3.0]


def type_of(values):
    """numba's type of a tuple of Python's."""
    return _values.numba_type(_arguments.describe(values))


def test_a_tuple_is_one_argument():
    """A mechanism and its work were 300 numbers at every call of a kernel, most of what LLVM had to read."""
    kind = type_of(outer())
    mixed_sum.part.compile((kind,))
    compiled = mixed_sum.part.overloads[(kind,)]
    convention = _numba.cpu_target.target_context.call_conv
    declared = convention.get_function_type(compiled.signature.return_type, compiled.signature.args)
    assert len(declared.args) == 3  # of the call itself: place of the result, place of an error


def test_tuples_of_other_fields_are_other_types():
    """Equal names with other arrays would share one function, and read the wrong words."""
    float_row, integer_row = Few(np.zeros(2)), Few(np.zeros(2, np.int64))
    assert type_of(float_row) == type_of(Few(np.ones(5)))
    assert type_of(float_row) != type_of(integer_row)
    assert str(type_of(float_row)) != str(type_of(integer_row))


@kernel
def misspelled(given):
    """A field that the tuple does not have."""
    return given.rwo[0]


def test_a_field_that_is_not_there_is_named():
    with pytest.raises(Exception, match="rwo"):
        misspelled.part.compile((type_of(Few(np.zeros(1))),))


def test_numbas_own_answers_are_back_after_a_compilation():
    """Others in the process compile with numba too."""
    before = _numba.types.Function.get_call_type, _numba.arrayobj.fix_integer_index
    with pytest.raises(ZeroDivisionError), _linking.quick():
        assert _numba.types.Function.get_call_type is not before[0]
        1 / 0  # noqa: B018
    assert (_numba.types.Function.get_call_type, _numba.arrayobj.fix_integer_index) == before


def test_numbas_whole_pipeline_gives_the_same_numbers(monkeypatch):
    """What the short pipeline leaves out finds nothing to do in kernels."""

    def made():
        @kernel
        def root(x, n):
            total = 0.0
            for k in range(n):
                total += x**0.5 / (k + 1.0) if k % 2 else -(x**2) * k
            return total, n // 3, x > total

        return root

    short = made()(1.7, 41)
    monkeypatch.setattr(_linking.PartCompiler, "define_pipelines", _numba.Compiler.define_pipelines)
    monkeypatch.setattr(_entry, "_loaded", {})
    monkeypatch.setattr(_entry._cache, "content", lambda name: None)
    assert made()(1.7, 41) == short
