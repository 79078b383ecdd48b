"""How kernels are compiled: whole where Python calls one, else as parts that are linked into what calls them.

numba by itself optimises each function that a kernel calls, makes machine code of it, and optimises it once
more within every caller: half of the time of a first run.  Here a function that a kernel calls is brought
into LLVM's intermediate code only; what Python calls is linked with all its parts and optimised once.
Kernels must not call one another in a circle.
"""

from numba.core.codegen import JITCodeLibrary, RuntimeLinker
from numba.core.compiler import Compiler, lookup_environment
from numba.core.registry import CPUDispatcher

_MADE_BY_NUMBA = "_Z"  # the names of all functions that come from Python begin so
_LATE = RuntimeLinker.PREFIX  # of what is called before it is compiled: by itself, or in a circle
_ENVIRONMENT = "_ZN08NumbaEnv"  # numba's name of the globals that point to a function's constants


class PartLibrary(JITCodeLibrary):
    """The code of a part, which nothing calls before it is linked."""

    def finalize(self):
        """Leave it as it is; what is linked into it is linked into its callers, see `WholeLibrary`."""
        self._raise_if_finalized()
        self._finalized = True


class WholeLibrary(JITCodeLibrary):
    """Machine code of a kernel with all its parts."""

    def _optimize_final_module(self):
        """Give linked parts internal linkage: LLVM may then change how they are called, or drop them."""
        for function in self._final_module.functions:
            if not function.is_declaration and function.linkage.name == "linkonce_odr":
                function.linkage = "internal"
        super()._optimize_final_module()

    def finalize(self):
        """Link the parts, those of parts too, each once, and optimise the whole."""
        self._linking_libraries = list(_with_parts_of_parts(self._linking_libraries))
        super().finalize()
        _refuse_missing(self._final_module)
        for variable in self._final_module.global_variables:
            constants = lookup_environment(variable.name) if variable.name.startswith(_ENVIRONMENT) else None
            if constants is not None:
                self._codegen.set_env(variable.name, constants)


def _with_parts_of_parts(libraries):
    """All of them, each before those that it calls.

    LLVM links such a function only where something that is linked already calls it, and a part may name
    functions that its own code no longer calls.
    """
    found, ended = {}, []

    def visit(library):
        if library not in found:
            found[library] = None
            for called in library._linking_libraries if isinstance(library, PartLibrary) else ():
                visit(called)
            ended.append(library)

    for library in libraries:
        visit(library)
    return reversed(ended)


def _refuse_missing(module):
    """Code without what it calls would end the process when it runs, and be kept on the disk."""
    there = {function.name for function in module.functions if not function.is_declaration}
    called = {function.name for function in module.functions if function.name.startswith(_MADE_BY_NUMBA)}
    late = {variable.name for variable in module.global_variables if variable.name.startswith(_LATE)}
    missing = (called | {name.removeprefix(_LATE) for name in late}) - there
    if missing:
        raise AssertionError(f"{min(missing)} was not linked: do kernels call one another in a circle?")


class WholeCompiler(Compiler):
    """numba's compiler for what Python calls."""

    def compile_extra(self, func):
        """Compile into a `WholeLibrary`, which can be kept on the disk."""
        self.state.library = WholeLibrary(self.state.targetctx.codegen(), func.__qualname__)
        self.state.library.enable_object_caching()
        return super().compile_extra(func)


class PartCompiler(Compiler):
    """numba's compiler for what kernels call."""

    def compile_extra(self, func):
        """Compile into a `PartLibrary`; what numba takes for an address is a key to find it by."""
        self.state.library = PartLibrary(self.state.targetctx.codegen(), func.__qualname__)
        self.state.flags.no_compile = True
        result = super().compile_extra(func)
        key = object()
        self.state.targetctx.insert_user_function(key, result.fndesc, [result.library])
        return result._replace(entry_point=key)


class Part(CPUDispatcher):
    """A function as kernels call it."""

    def add_overload(self, cres):
        """Keep what was compiled for kernels; there is nothing that Python could call."""
        self.overloads[tuple(cres.signature.args)] = cres


class Kernel(CPUDispatcher):
    """A function that is compiled whole when Python calls it, and as a part when another kernel does."""

    def __init__(self, function, locals=None, targetoptions: dict | None = None):
        # Without a word of its own a part would be forced inline where its first caller is.
        options = {"nopython": True, "boundscheck": None, "forceinline": False} | (targetoptions or {})
        super().__init__(function, locals, options, pipeline_class=WholeCompiler)
        options = options | {"no_cpython_wrapper": True}
        self.part = Part(function, locals, options, pipeline_class=PartCompiler)

    @property
    def _numba_type_(self):
        """What the function is to numba, where a kernel names it."""
        return self.part._numba_type_
