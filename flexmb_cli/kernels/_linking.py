"""How kernels are compiled: whole where Python calls one, else as parts that are linked into what calls them.

numba by itself optimises each function that a kernel calls, makes machine code of it, and optimises it once
more within every caller: half of the time of a first run.  Here a function that a kernel calls is brought
into LLVM's intermediate code only; what Python calls is linked with all its parts and optimised once.
Kernels must not call one another in a circle.
"""

import importlib
import itertools
from typing import TYPE_CHECKING, Any, NamedTuple

import llvmlite.binding as llvm
from llvmlite import ir
from numba import from_dtype
from numba.core import cgutils, types
from numba.core.codegen import JITCodeLibrary, RuntimeLinker
from numba.core.compiler import Compiler, lookup_environment
from numba.core.compiler_lock import global_compiler_lock
from numba.core.imputils import impl_ret_borrowed
from numba.core.registry import CPUDispatcher, cpu_target
from numba.core.runtime.nrtdynmod import create_nrt_module
from numba.extending import intrinsic
from numba.np.arrayobj import make_array, populate_array

from ._allocator import WORD, add_allocator
from ._arguments import NotDescribedError, described_dtype
from ._objects import OF_C

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator


_MADE_BY_NUMBA = "_Z"  # the names of all functions that come from Python begin so
_LATE = RuntimeLinker.PREFIX  # of what is called before it is compiled: by itself, or in a circle
_ENVIRONMENT = "_ZN08NumbaEnv"  # numba's name of the globals that point to a function's constants


class PartLibrary(JITCodeLibrary):
    """The code of a part, which nothing calls before it is linked."""

    def finalize(self) -> None:
        """Leave it as it is; what is linked into it is linked into its callers, see `WholeLibrary`."""
        self._raise_if_finalized()
        self._finalized = True


class WholeLibrary(JITCodeLibrary):
    """Machine code of a kernel with all its parts."""

    def _optimize_final_module(self) -> None:
        """Give linked parts internal linkage: LLVM may then change how they are called, or drop them."""
        for function in self._final_module.functions:
            if not function.is_declaration and function.linkage.name == "linkonce_odr":
                function.linkage = "internal"
        super()._optimize_final_module()

    def finalize(self) -> None:
        """Link the parts, those of parts too, each once, and optimise the whole."""
        self._linking_libraries = list(_with_parts_of_parts(self._linking_libraries))
        super().finalize()
        _refuse_missing(self._final_module)
        for variable in self._final_module.global_variables:
            constants = lookup_environment(variable.name) if variable.name.startswith(_ENVIRONMENT) else None
            if constants is not None:
                self._codegen.set_env(variable.name, constants)  # type: ignore[attr-defined]


def _with_parts_of_parts(libraries):
    """All of them, each before those that it calls.

    LLVM links such a function only where something that is linked already calls it, and a part may name
    functions that its own code no longer calls.
    """
    found, ended = {}, []  # type: ignore[var-annotated]

    def visit(library) -> None:
        if library not in found:
            found[library] = None
            for called in library._linking_libraries if isinstance(library, PartLibrary) else ():
                visit(called)
            ended.append(library)

    for library in libraries:
        visit(library)
    return reversed(ended)


def _refuse_missing(module) -> None:
    """Code without what it calls would end the process when it runs, and be kept on the disk.

    So would code that numba is to bind late, when the process knows all addresses.
    """
    there = {function.name for function in module.functions if not function.is_declaration}
    called = {function.name for function in module.functions if function.name.startswith(_MADE_BY_NUMBA)}
    late = {variable.name for variable in module.global_variables if variable.name.startswith(_LATE)}
    missing = (called - there) | {name.removeprefix(_LATE) for name in late}
    if missing:
        raise AssertionError(f"{min(missing)} was not linked: do kernels call one another in a circle?")


class WholeCompiler(Compiler):
    """numba's compiler for what Python calls."""

    def compile_extra(self, func):
        """Compile into a `WholeLibrary`, which can be kept on the disk."""
        self.state.library = WholeLibrary(self.state.targetctx.codegen(), func.__qualname__)
        self.state.library.enable_object_caching()
        result = super().compile_extra(func)
        _refuse_uncounted(func, self.state.flags, result)
        if not self.state.flags.nrt and _holds_arrays(result.signature.return_type):
            raise TypeError(f"{func.__qualname__} returns arrays to Python: mark it as `plain`")
        return result


class PartCompiler(Compiler):
    """numba's compiler for what kernels call."""

    def compile_extra(self, func):
        """Compile into a `PartLibrary`; what numba takes for an address is a key to find it by."""
        self.state.library = PartLibrary(self.state.targetctx.codegen(), func.__qualname__)
        self.state.flags.no_compile = True
        result = super().compile_extra(func)
        _refuse_uncounted(func, self.state.flags, result)
        key = object()
        self.state.targetctx.insert_user_function(key, result.fndesc, [result.library])
        return result._replace(entry_point=key)


def _refuse_uncounted(function, flags, result):
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


def _holds_arrays(kind):
    """Return whether a type is an array or holds one."""
    if isinstance(kind, types.BaseTuple):
        return any(map(_holds_arrays, kind))  # type: ignore[call-overload]
    return isinstance(kind, types.Array)


class Part(CPUDispatcher):
    """A function as kernels call it."""

    def add_overload(self, cres) -> None:
        """Keep what was compiled for kernels; there is nothing that Python could call."""
        self.overloads[tuple(cres.signature.args)] = cres


class Kernel(CPUDispatcher):
    """A function that is compiled whole when Python calls it, and as a part when another kernel does."""

    def __init__(self, function: "Callable[..., Any]", locals: Any = None, targetoptions: dict | None = None):
        # Without a word of its own a part would be forced inline where its first caller is.
        options = {"nopython": True, "boundscheck": None, "forceinline": False, "_nrt": True}
        options |= targetoptions or {}
        # Earlier versions of numba take no None for them.
        locals = locals or {}
        super().__init__(function, locals, options, pipeline_class=WholeCompiler)
        options = options | {"no_cpython_wrapper": True}
        self.part = Part(function, locals, options, pipeline_class=PartCompiler)

    @property
    def _numba_type_(self):
        """Return what the function is to numba, where a kernel names it."""
        return self.part._numba_type_


class Entry(NamedTuple):
    """A kernel that Python calls."""

    name: str  # "module.function"
    kernel: Kernel  # the Python function
    parameters: list  # as `_arguments` describes them


def this_machine() -> tuple[str, str]:
    """Return LLVM's name of this process's system, and that of the oldest processor of its kind."""
    return llvm.get_process_triple(), "generic"


def emit_object(unit: str, entries: list[Entry], machines: dict) -> dict:
    """Return (what the object's head tells of its entries, object) for each target of `machines`.

    The parts of all entries are linked once, and only the entries can be seen from outside.
    """
    with global_compiler_lock:
        module, reported = _linked(unit, entries)
        return {target: (reported, _machine_code(module, *machine)) for target, machine in machines.items()}


def _linked(unit, entries):
    """LLVM's code of all entries with their parts, and what tells of each."""
    context = cpu_target.target_context
    library = context.codegen().create_library(unit)
    wrappers = library.create_ir_module(unit)
    reported, called = [], []
    for number, entry in enumerate(entries):
        types_ = tuple(map(_numba_type, entry.parameters))
        entry.kernel.part.compile(types_)
        compiled = entry.kernel.part.overloads[types_]
        symbol = f"flexmb_{number}_{entry.name.replace('.', '_')}"
        _add_wrapper(context, wrappers, symbol, compiled)
        result = _result(compiled.signature.return_type)
        reported.append(
            {"name": entry.name, "symbol": symbol, "parameters": entry.parameters, "result": result}
        )
        called.append(compiled.library)
    add_allocator(wrappers)
    module = llvm.parse_assembly(str(wrappers))
    for part in _with_parts_of_parts(called):
        module.link_in(part._get_module_for_linking(), preserve=True)
    module.link_in(llvm.parse_assembly(str(create_nrt_module(context)[0])))
    _hide_all_but(module, {one["symbol"] for one in reported})
    _refuse_missing(module)
    return module.as_bitcode(), reported


def _hide_all_but(module, symbols) -> None:
    """Leave nothing else to be seen: LLVM may then change how functions are called, or drop them."""
    for function in module.functions:
        if not function.is_declaration and function.name not in symbols:
            function.linkage = "internal"
    for variable in module.global_variables:
        # Constants that a traceback in Python would ask for.
        if variable.name.startswith(_ENVIRONMENT):
            variable.linkage = "internal"


def _machine_code(bitcode, triple, processor):
    """Position-independent object of LLVM's code; nothing allows a fused multiply-add."""
    llvm.initialize_all_targets()
    llvm.initialize_all_asmprinters()
    module = llvm.parse_bitcode(bitcode)
    machine = llvm.Target.from_triple(triple).create_target_machine(
        cpu=processor, features="", opt=3, reloc="pic", codemodel="default"
    )
    module.triple = triple
    module.data_layout = str(machine.target_data)
    # numba's two rounds: the first brings together the counts of references that the second prunes.
    for speed in (0, 3):
        options = llvm.create_pipeline_tuning_options(speed_level=speed)
        options.loop_vectorization = options.slp_vectorization = False
        builder = llvm.create_pass_builder(machine, options)
        passes = builder.getModulePassManager()
        if speed == 0:
            passes.add_loop_rotate_pass()
            passes.add_instruction_combine_pass()
            passes.add_jump_threading_pass()
        passes.add_refprune_pass()
        passes.run(module, builder)
    _refuse_foreign(module)
    return machine.emit_object(module)


def _refuse_foreign(module) -> None:
    """Return what neither the object nor the C library has would be called at address 0."""
    called = {function.name for function in module.functions if function.is_declaration}
    foreign = {name for name in called if not name.startswith("llvm.")} - OF_C
    if foreign:
        raise AssertionError(f"compiled kernels call {sorted(foreign)}")


def _numba_type(parameter: Any):
    """numba's type of a parameter."""
    if parameter[0] == "a":
        return types.Array(from_dtype(described_dtype(parameter[2])), parameter[1], "C")
    if parameter[0] == "t":
        module, _, name = parameter[1].partition(":")
        kind = getattr(importlib.import_module(module), name) if name else tuple
        return types.BaseTuple.from_types([_numba_type(part) for part in parameter[2]], kind)
    return {"i": types.int64, "f": types.float64, "b": types.boolean}[parameter]


def _result(kind):
    """Return how `_arguments` describes what a kernel returns; raises NotDescribedError for arrays."""
    if isinstance(kind, types.BaseTuple):
        return ["t", "", [_result(part) for part in kind]]  # type: ignore[attr-defined]
    for number, letter in ((types.Boolean, "b"), (types.Integer, "i"), (types.Float, "f")):
        if isinstance(kind, number):
            return letter
    if kind is types.none:
        return "n"
    raise NotDescribedError(str(kind))


def _add_wrapper(context, module, symbol, compiled) -> None:
    """Define int symbol(int64 *words, int64 *results), which calls a part; not 0 where that failed."""
    _result(compiled.signature.return_type)
    code = ir.IntType(32)
    function = ir.Function(module, ir.FunctionType(code, [WORD.as_pointer()] * 2), symbol)
    builder = ir.IRBuilder(function.append_basic_block())
    words = _words_at(builder, function.args[0])
    signature = compiled.signature
    values = [_value(context, builder, words, kind) for kind in signature.args]
    part = context.declare_function(module, compiled.fndesc)
    call = context.call_conv.call_function
    status, result = call(builder, part, signature.return_type, signature.args, values)
    with builder.if_then(builder.not_(status.is_ok), likely=False):
        builder.ret(code(1))
    _store_result(builder, signature.return_type, result, function.args[1], 0)
    builder.ret(code(0))


def _words_at(builder, pointer) -> "Iterator[Any]":
    for k in itertools.count():
        yield builder.load(builder.gep(pointer, [WORD(k)]))


def _value(context, builder, words, kind):
    """numba's value of the type `kind` from the next words."""
    if isinstance(kind, types.Array):
        return _array(context, builder, words, kind)
    if isinstance(kind, types.BaseTuple):
        return context.make_tuple(builder, kind, [_value(context, builder, words, part) for part in kind])  # type: ignore[attr-defined]
    word = next(words)
    if isinstance(kind, types.Float):
        return builder.bitcast(word, ir.DoubleType())
    return builder.icmp_unsigned("!=", word, WORD(0)) if isinstance(kind, types.Boolean) else word


def _array(context, builder, words, kind):
    data = builder.inttoptr(next(words), context.get_data_type(kind.dtype).as_pointer())
    shape = [next(words) for _ in range(kind.ndim)]
    return _contiguous(context, builder, kind, data, shape, None)


def _contiguous(context, builder, kind, data, shape, owner):
    """numba's value of an array in the memory of `owner`."""
    size = WORD(context.get_abi_sizeof(context.get_data_type(kind.dtype)))
    strides = [size]
    for length in reversed(shape[1:]):
        strides.insert(0, builder.mul(strides[0], length))
    array = make_array(kind)(context, builder)
    populate_array(
        array, data=data, shape=cgutils.pack_array(builder, shape),
        strides=cgutils.pack_array(builder, strides), itemsize=size, meminfo=owner,
    )  # fmt: skip
    return array._getvalue()


@intrinsic
def _block(typing, flat, first, shape):
    """The view of `linalg.blocks`: numba's own reshape looks at all strides, and took a tenth of a step."""
    kind = types.Array(flat.dtype, len(shape), "C")

    def generate(context, builder, signature, values):
        array = make_array(flat)(context, builder, values[0])
        data, lengths = builder.gep(array.data, [values[1]]), cgutils.unpack_tuple(builder, values[2])
        view = _contiguous(context, builder, kind, data, lengths, array.meminfo)
        return impl_ret_borrowed(context, builder, kind, view)

    return kind(flat, types.int64, types.UniTuple(types.int64, len(shape))), generate


def built_in_type(name):
    """Return numba's type of a function that is not compiled from its text."""
    return cpu_target.typing_context.resolve_value_type({"block": _block}[name])


def _store_result(builder, kind, value, room, k: Any):
    """Store what a kernel returns from word k on; return the word behind it."""
    if kind is types.none:
        return k
    if isinstance(kind, types.BaseTuple):
        for place, part in enumerate(kind):  # type: ignore[arg-type, var-annotated]
            k = _store_result(builder, part, builder.extract_value(value, place), room, k)
        return k
    if isinstance(kind, types.Float):
        value = builder.bitcast(value, WORD)
    elif isinstance(kind, types.Boolean):
        value = builder.zext(value, WORD)
    builder.store(value, builder.gep(room, [WORD(k)]))
    return k + 1
