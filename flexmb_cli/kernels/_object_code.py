"""Objects of machine code that a process loads without numba: the entries of a unit, each behind a wrapper.

A wrapper takes the numbers, addresses and lengths of the arguments as 64-bit words.
"""

import importlib
import itertools
from typing import TYPE_CHECKING, Any, NamedTuple

import llvmlite.binding as llvm
from llvmlite import ir
from numba import from_dtype
from numba.core import types
from numba.core.compiler_lock import global_compiler_lock
from numba.core.registry import cpu_target
from numba.core.runtime.nrtdynmod import create_nrt_module

from ._allocator import WORD, add_allocator
from ._arguments import NotDescribedError, described_dtype
from ._linking import ENVIRONMENT, Kernel, contiguous, refuse_missing, with_parts_of_parts
from ._objects import OF_C

if TYPE_CHECKING:
    from collections.abc import Iterator


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
    for part in with_parts_of_parts(called):
        module.link_in(part._get_module_for_linking(), preserve=True)
    module.link_in(llvm.parse_assembly(str(create_nrt_module(context)[0])))
    _hide_all_but(module, {one["symbol"] for one in reported})
    refuse_missing(module)
    return module.as_bitcode(), reported


def _hide_all_but(module, symbols) -> None:
    """Leave nothing else to be seen: LLVM may then change how functions are called, or drop them."""
    for function in module.functions:
        if not function.is_declaration and function.name not in symbols:
            function.linkage = "internal"
    for variable in module.global_variables:
        # Constants that a traceback in Python would ask for.
        if variable.name.startswith(ENVIRONMENT):
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
    return contiguous(context, builder, kind, data, shape, None)


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
