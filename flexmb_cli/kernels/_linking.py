"""Compilation of kernels as parts that are linked into their callers.

numba by itself optimises each function that a kernel calls, makes machine code of it, and optimises it once
more within every caller: half of the time of a first run.  Here a kernel is brought into LLVM's intermediate
code only; what Python calls is linked with all its parts and optimised once (`_object_code`).
Kernels must not call one another in a circle.
"""

import contextlib
from collections.abc import Callable, Iterator
from typing import Any

from ._numba import (
    PASSES,
    Compiler,
    CPUDispatcher,
    JITCodeLibrary,
    PassManager,
    RuntimeLinker,
    arrayobj,
    types,
)

# The names of functions that come from Python, and of those of numba's memory, begin so.
_MADE_BY_NUMBA = ("_Z", "NRT_")
_LATE = RuntimeLinker.PREFIX  # of what is called before it is compiled: by itself, or in a circle
ENVIRONMENT = "_ZN08NumbaEnv"  # numba's name of the globals that point to a function's constants


class PartLibrary(JITCodeLibrary):
    """The code of a part, which nothing calls before it is linked."""

    def finalize(self) -> None:
        """Leave it as it is; what is linked into it is linked into its callers, see `with_parts_of_parts`."""
        self._finalized = True


def with_parts_of_parts(libraries: Any):
    """Return the libraries with all that they call, each before those that it calls.

    LLVM links such a function only where something that is linked already calls it, and a part may name
    functions that its own code no longer calls.
    """
    parts: set[Any] = set()
    ended: list[Any] = []

    def visit(library: Any) -> None:
        if library not in parts:
            parts.add(library)
            for called in library._linking_libraries if isinstance(library, PartLibrary) else ():
                visit(called)
            ended.append(library)

    for library in libraries:
        visit(library)
    return reversed(ended)


def refuse_missing(module: Any) -> None:
    """Refuse code that lacks a function it calls: it would end the process, and be kept on the disk.

    So would code whose addresses numba fills in late, in the process.
    """
    there = {function.name for function in module.functions if not function.is_declaration}
    called = {function.name for function in module.functions if function.name.startswith(_MADE_BY_NUMBA)}
    late = {variable.name for variable in module.global_variables if variable.name.startswith(_LATE)}
    missing = (called - there) | {name.removeprefix(_LATE) for name in late}
    if missing:
        name = min(missing)
        cause = (
            "does it assign an array to an array? Copy the elements"
            if name.startswith("NRT_")
            else "do kernels call one another in a circle?"
        )
        raise AssertionError(f"{name} was not linked: {cause}")


class PartCompiler(Compiler):
    """numba's compiler for what kernels call."""

    def define_pipelines(self):
        """Return the only way to LLVM's language, without passes that find nothing to do in kernels."""
        way = PassManager("kernels")
        for step in PASSES:
            way.add_pass(step, step.__name__)
        way.finalize()
        return [way]

    def compile_extra(self, func: Any):
        """Compile into a `PartLibrary`; what numba takes for an address is a key to find it by."""
        self.state.library = PartLibrary(self.state.targetctx.codegen(), func.__qualname__)
        self.state.flags.no_compile = True
        result = super().compile_extra(func)
        _refuse_uncounted(func, self.state.flags, result)
        key = object()
        self.state.targetctx.insert_user_function(key, result.fndesc, [result.library])
        return result._replace(entry_point=key)


def _refuse_uncounted(function: Any, flags: Any, result: Any):
    """Refuse a kernel that counts references to arrays and gets one from a kernel that does not, or else.

    The memory of such an array would be given back while it is in use, or never.
    """
    kinds = result.type_annotation.typemap
    for call, signature in result.type_annotation.calltypes.items():
        kind = kinds.get(call.func.name) if getattr(call, "op", "") == "call" else None
        called: Any = getattr(kind, "dispatcher", None)
        takes_arrays = isinstance(called, Part) and _holds_arrays(signature.return_type)
        if takes_arrays and called.targetoptions["_nrt"] != flags.nrt:
            name = called.py_func.__qualname__
            raise TypeError(f"{function.__qualname__} must not take arrays from {name}")


def _holds_arrays(kind: Any):
    """Return whether a type is an array or holds one."""
    if isinstance(kind, types.BaseTuple):
        return any(map(_holds_arrays, kind))  # type: ignore[call-overload]
    return isinstance(kind, types.Array)


class Part(CPUDispatcher):
    """A function as kernels call it."""

    def __init__(self, function: Callable[..., Any], options: dict):
        # Without a word of its own a part would be forced inline where its first caller is.
        common = {"nopython": True, "boundscheck": None, "forceinline": False, "no_cpython_wrapper": True}
        # Earlier versions of numba take no None for the types of locals.
        super().__init__(function, {}, common | options, pipeline_class=PartCompiler)

    def add_overload(self, cres: Any) -> None:
        """Keep what was compiled for kernels; there is nothing that Python could call."""
        self.overloads[tuple(cres.signature.args)] = cres


@contextlib.contextmanager
def quick() -> Iterator[None]:
    """Spare numba what kernels do not need, while they are compiled within the block.

    The type of a sum of two floats was sought thousands of times, a quarter of the time.  No index of a
    kernel counts from the end: without the test of its sign a generalised-α step takes a fifth less time.
    """
    own = types.Function.get_call_type, arrayobj.fix_integer_index
    types.Function.get_call_type, arrayobj.fix_integer_index = _call_types(own[0]), _index  # type: ignore[method-assign]
    try:
        yield
    finally:
        types.Function.get_call_type, arrayobj.fix_integer_index = own  # type: ignore[method-assign]


def _call_types(own: Callable[..., Any]) -> Callable[..., Any]:
    """The signature of a function of numba's for types of arguments, sought once."""
    known: dict[tuple, Any] = {}

    def call_type(self: types.Function, context: Any, arguments: tuple, named: dict) -> Any:
        key = self, tuple(arguments), tuple(named.items())
        if key not in known:
            known[key] = own(self, context, arguments, named)
        return known[key]

    return call_type


def _index(context: Any, builder: Any, kind: Any, value: Any, size: Any) -> Any:
    """The word of an index as it stands; where bounds are checked, one below 0 is out of them."""
    return context.cast(builder, value, kind, types.intp if kind.signed else types.uintp)
