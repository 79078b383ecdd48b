"""Decorator of kernels: compiled where Python or another kernel calls them, or left as they are.

Whoever builds a system to look at it only, as `check` does, builds and evaluates it within
`interpreting()`: the same kernels then run as plain Python on numpy arrays, and nothing is compiled.
"""

import os
from collections.abc import Callable
from typing import Any

from ._entry import BuiltIn, Entry, PlainEntry, is_ready
from ._interpreted import interpreting as interpreting
from ._interpreted import is_interpreting

# Kernels borrow the arrays that they are given: no references are counted, which was a sixth of the time of
# a step by the generalised-α method, and a tenth of that of compiling it.
OPTIONS = {"error_model": "numpy", "no_cfunc_wrapper": True, "_nrt": False}

_never_compiled = os.environ.get("NUMBA_DISABLE_JIT", "0") not in ("", "0")


def interpreted() -> bool:
    """Return whether kernels that are called here run as plain Python."""
    return _never_compiled or is_interpreting()


def must_compile(name: str) -> bool:
    """Return whether the kernel `name` ("module.function") has to be compiled before its first call."""
    return not interpreted() and not is_ready(name)


def kernel(function: Callable[..., Any], **options: Any) -> Callable[..., Any]:
    """Compile `function` when it is called, or leave it alone when kernels are interpreted."""
    return function if _never_compiled else Entry(function, OPTIONS | options)


def part(function: Callable[..., Any]) -> Callable[..., Any]:
    """A kernel that is forced into its callers: for inner loops, where handing over arrays counts.

    LLVM would leave some apart, and Kane's recursion a third slower; elsewhere that is as quick.
    """
    return kernel(function, forceinline=True)


def allocating(function: Callable[..., Any]) -> Callable[..., Any]:
    """A kernel that makes arrays; only another one may get them from it."""
    return kernel(function, _nrt=True)


def plain(function: Callable[..., Any]) -> Callable[..., Any]:
    """A kernel that Python runs as it is: it only makes or divides arrays, or is called once at the start."""
    return function if _never_compiled else PlainEntry(function, OPTIONS)


def plain_allocating(function: Callable[..., Any]) -> Callable[..., Any]:
    """An `allocating` kernel that Python runs as it is."""
    return function if _never_compiled else PlainEntry(function, OPTIONS | {"_nrt": True})


def built_in(function: Callable[..., Any]) -> Callable[..., Any]:
    """A function that `_values` makes code of itself; Python runs it as it is."""
    return function if _never_compiled else BuiltIn(function, OPTIONS)
