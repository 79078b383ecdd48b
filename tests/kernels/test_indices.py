"""Indices of kernels count from the front: compiled code takes them as they are, whatever their sign.

numpy's -1 would be the number before an array; numba tests every index for it, and steps of the generalised-α
method took a fifth longer.  With NUMBA_BOUNDSCHECK=1 it is refused (`test_kernel_cache`).
"""

import ast
from pathlib import Path

import numpy as np
import pytest

from flexmb_cli.kernels import _arguments, _jit, _linking, _values
from flexmb_cli.kernels._jit import kernel

KERNELS = Path(_jit.__file__).parent


@kernel
def taken(rows, i, j):
    """One number of a table."""
    return rows[i, j]


@pytest.mark.skipif(_jit.interpreted(), reason="nothing is compiled")
def test_an_index_is_not_tested_for_its_sign():
    kinds = tuple(map(_values.numba_type, (_arguments.Array(2, np.dtype(float)), "i", "i")))
    with _linking.quick():
        taken.part.compile(kinds)
    text = taken.part.overloads[kinds].library.get_llvm_str()
    assert "getelementptr" in text
    assert "icmp slt" not in text and "select" not in text


def is_negative(index):
    """Whether an index is spelled with a minus sign; the end of a slice may be."""
    return isinstance(index, ast.UnaryOp) and isinstance(index.op, ast.USub)


def from_the_end(path):
    """Lines that index from the end within the kernels of a file."""
    for function in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
        marks = function.decorator_list if isinstance(function, ast.FunctionDef) else ()
        if not {ast.unparse(mark) for mark in marks} & {"kernel", "part", "allocating"}:
            continue
        for node in ast.walk(function):
            if isinstance(node, ast.Subscript):
                parts = node.slice.elts if isinstance(node.slice, ast.Tuple) else [node.slice]
                if any(map(is_negative, parts)):
                    yield f"{path.name}:{node.lineno}: {ast.unparse(node)}"


def test_no_kernel_counts_from_the_end(tmp_path):
    (tmp_path / "kernel.py").write_text("@kernel\ndef last(a):\n    return a[0, -1] + a[-1] + a[1:-1]\n")
    assert len(list(from_the_end(tmp_path / "kernel.py"))) == 2
    assert [line for path in KERNELS.rglob("*.py") for line in from_the_end(path)] == []
