"""Compilation of kernels as parts that are linked into their callers.

numba by itself optimises each function that a kernel calls, makes machine code of it, and optimises it once
more within every caller: half of the time of a first run.  Here a kernel is brought into LLVM's intermediate
code only; what Python calls is linked with all its parts and optimised once (`_object_code`).
Kernels must not call one another in a circle.
"""

from typing import TYPE_CHECKING, Any

from ._front_end import ShortPipeline
from ._numba import (
    Compiler,
    CPUDispatcher,
    JITCodeLibrary,
    RuntimeLinker,
    types,
)

if TYPE_CHECKING:
    from collections.abc import Callable

_MADE_BY_NUMBA = "_Z"  # the names of all functions that come from Python begin so
_LATE = RuntimeLinker.PREFIX  # of what is called before it is compiled: by itself, or in a circle
ENVIRONMENT = "_ZN08NumbaEnv"  # numba's name of the globals that point to a function's constants


class PartLibrary(JITCodeLibrary):
    """The code of a part, which nothing calls before it is linked."""

    def finalize(self) -> None:
        """Leave it as it is; what is linked into it is linked into its callers, see `with_parts_of_parts`."""
        self._raise_if_finalized()
        self._finalized = True


def with_parts_of_parts(libraries: Any):
    """Return the libraries with all that they call, each before those that it calls.

    LLVM links such a function only where something that is linked already calls it, and a part may name
    functions that its own code no longer calls.
    """
    found: set[Any] = set()
    ended: list[Any] = []

    def visit(library: Any) -> None:
        if library not in found:
            found.add(library)
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
        raise AssertionError(f"{min(missing)} was not linked: do kernels call one another in a circle?")


class PartCompiler(Compiler):
    """numba's compiler for what kernels call."""

    def define_pipelines(self):
        """Return the only way from text to LLVM's language."""
        return [ShortPipeline()]

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
        called = getattr(kind, "dispatcher", None)
        if not isinstance(called, Part) or not _holds_arrays(signature.return_type):
            continue
        if called.targetoptions["_nrt"] != flags.nrt:
            raise TypeError(
                f"{function.__qualname__} must not take arrays from {called.py_func.__qualname__}"
            )


def _holds_arrays(kind: Any):
    """Return whether a type is an array or holds one."""
    if isinstance(kind, types.BaseTuple):
        return any(map(_holds_arrays, kind))  # type: ignore[call-overload]
    return isinstance(kind, types.Array)


class Part(CPUDispatcher):
    """A function as kernels call it."""

    def __init__(self, function: "Callable[..., Any]", options: dict):
        # Without a word of its own a part would be forced inline where its first caller is.
        common = {"nopython": True, "boundscheck": None, "forceinline": False, "no_cpython_wrapper": True}
        # Earlier versions of numba take no None for the types of locals.
        super().__init__(function, {}, common | options, pipeline_class=PartCompiler)

    def add_overload(self, cres: Any) -> None:
        """Keep what was compiled for kernels; there is nothing that Python could call."""
        self.overloads[tuple(cres.signature.args)] = cres
