"""numba's way from a function's text to LLVM's language, without what kernels do not need.

Two thirds of a first run are numba's own work in Python.  Half of it went into passes that find nothing to do
in kernels (closures, `with` blocks, array expressions) and into questions asked before: the type of a sum of
two floats was sought thousands of times.

No index of a kernel counts from the end: without the test of its sign, which numba adds to every access,
steps of the generalised-α method take a fifth less time.
"""

import contextlib
from typing import TYPE_CHECKING, Any

from ._numba import PASSES, PassManager, arrayobj, pass_of, types

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator


class ShortPipeline(PassManager):
    """The passes that kernels need, run without numba's events and times."""

    def __init__(self) -> None:
        super().__init__("kernels")
        for kind in PASSES:
            self.add_pass(kind, kind.__name__)
        self.finalize()

    def run(self, state: Any) -> None:
        """Compile the function of a state."""
        for kind, _ in self.passes:
            step = pass_of(kind)
            step.analysis = self._analysis
            step.run_initialization(state)
            step.run_pass(state)
            step.run_finalizer(state)


@contextlib.contextmanager
def quick() -> "Iterator[None]":
    """Spare numba what kernels do not need, while they are compiled within the block."""
    own = types.Function.get_call_type, arrayobj.fix_integer_index
    types.Function.get_call_type, arrayobj.fix_integer_index = _call_types(own[0]), _index  # type: ignore[method-assign]
    try:
        yield
    finally:
        types.Function.get_call_type, arrayobj.fix_integer_index = own  # type: ignore[method-assign]


def _call_types(own: "Callable[..., Any]") -> "Callable[..., Any]":
    """The signature of a function of numba's for types of arguments, sought once."""
    known: dict[tuple, Any] = {}

    def call_type(self: types.Function, context: Any, arguments: tuple, named: dict) -> Any:
        if named:
            return own(self, context, arguments, named)
        key = self, tuple(arguments)
        if key not in known:
            known[key] = own(self, context, arguments, named)
        return known[key]

    return call_type


def _index(context: Any, builder: Any, kind: Any, value: Any, size: Any) -> Any:
    """The word of an index as it stands; where bounds are checked, one below 0 is out of them."""
    return context.cast(builder, value, kind, types.intp if kind.signed else types.uintp)
