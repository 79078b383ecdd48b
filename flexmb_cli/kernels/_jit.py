"""How a function becomes a kernel: compiled where Python or another kernel calls it, or left as it is.

`check` and other commands that only look at a deck call `interpret()` first: the same kernels then
run as plain Python on numpy arrays, and nothing is compiled.
"""

import os

from ._entry import BuiltIn, Entry, PlainEntry, is_ready

# Kernels borrow the arrays that they are given: no references are counted, which was a sixth of the time of
# a step by the generalised-α method, and a tenth of that of compiling it.
OPTIONS = {"error_model": "numpy", "no_cfunc_wrapper": True, "_nrt": False}

_interpreted = os.environ.get("NUMBA_DISABLE_JIT", "0") not in ("", "0")


def interpret() -> None:
    """Leave the kernels that are imported from now on uncompiled."""
    global _interpreted
    _interpreted = True


def interpreted() -> bool:
    """Return whether kernels run as plain Python."""
    return _interpreted


def must_compile(name: str) -> bool:
    """Return whether the kernel `name` ("module.function") has to be compiled before its first call."""
    return not _interpreted and not is_ready(name)


def kernel(function, **options):
    """Compile `function` when it is called, or leave it alone when kernels are interpreted."""
    return function if _interpreted else Entry(function, OPTIONS | options)


def part(function):
    """A kernel that is forced into its callers: for inner loops, where handing over arrays counts.

    LLVM would leave some apart, and Kane's recursion a third slower; elsewhere that is as quick.
    """
    return kernel(function, forceinline=True)


def allocating(function):
    """A kernel that makes arrays; only another one may get them from it."""
    return kernel(function, _nrt=True)


def plain(function):
    """A kernel that only makes or divides arrays, which no object can return: Python runs it as it is."""
    return function if _interpreted else PlainEntry(function, OPTIONS)


def plain_allocating(function):
    """An `allocating` kernel that Python runs as it is."""
    return function if _interpreted else PlainEntry(function, OPTIONS | {"_nrt": True})


def built_in(function):
    """A function that `_linking` makes code of itself; Python runs it as it is."""
    return function if _interpreted else BuiltIn(function, OPTIONS)
