"""Objects of machine code that need no numba any more: the entries of a unit, each behind a wrapper.

A wrapper takes the numbers, addresses and lengths of the arguments as 64-bit words.
"""

from typing import Any

import llvmlite.binding as llvm
from llvmlite import ir

from ..memory import without_collector
from ._linking import ENVIRONMENT, quick, refuse_missing, with_parts_of_parts
from ._numba import cpu_target, create_nrt_module, global_compiler_lock
from ._values import WORD, add_wrapper, numba_type
from .signatures import PROCESSORS

_ADDRESS = ir.IntType(8).as_pointer()
# Count of references, destructor and its argument, data, size, allocator: six words, data aligned behind.
_HEAD, _DATA, _SIZE = 6 * 8, 3, 4
_ALLOCATING = ("NRT_MemInfo_alloc_aligned", "NRT_MemInfo_alloc_safe_aligned")


def emit_objects(unit: str, entries: dict[str, tuple[Any, list]], targets: list[str]) -> dict[str, bytes]:
    """Return the object of the entries for each target: part and parameters by the name in the library.

    The parts of all entries are linked once, and only the entries can be seen from outside.
    """
    # numba makes cycles by the million, and a tenth of the time went into them.
    with global_compiler_lock, quick(), without_collector():
        bitcode = _linked(unit, entries)
        # Elsewhere it is this process's system.
        here = llvm.get_process_triple(), "generic"
        return {target: _machine_code(bitcode, *PROCESSORS.get(target, here)) for target in targets}


def _linked(unit: str, entries: dict[str, tuple[Any, list]]) -> bytes:
    """Return LLVM's code of all entries with their parts."""
    context = cpu_target.target_context
    library = context.codegen().create_library(unit)
    wrappers, called = library.create_ir_module(unit), []
    for symbol, (part, parameters) in entries.items():
        kinds = tuple(map(numba_type, parameters))
        part.compile(kinds)
        add_wrapper(context, wrappers, symbol, part.overloads[kinds])
        called.append(part.overloads[kinds].library)
    _add_allocator(wrappers)
    module = llvm.parse_assembly(str(wrappers))
    for part in with_parts_of_parts(called):
        module.link_in(part._get_module_for_linking(), preserve=True)
    module.link_in(llvm.parse_assembly(str(create_nrt_module(context)[0])))
    _hide_all_but(module, entries)
    refuse_missing(module)
    return module.as_bitcode()


def _add_allocator(module: ir.Module) -> None:
    """Define memory functions that numba's code calls: arrays of a kernel live on C's heap.

    The names and the layout of a block are numba's (numba/core/runtime/nrt.cpp).
    """
    malloc = ir.Function(module, ir.FunctionType(_ADDRESS, [WORD]), "malloc")
    free = ir.Function(module, ir.FunctionType(ir.VoidType(), [_ADDRESS]), "free")
    for name in _ALLOCATING:
        _add_alloc(module, malloc, name)
    destructor = ir.Function(module, ir.FunctionType(ir.VoidType(), [_ADDRESS]), "NRT_MemInfo_call_dtor")
    builder = ir.IRBuilder(destructor.append_basic_block())
    builder.call(free, [destructor.args[0]])
    builder.ret_void()


def _add_alloc(module: Any, malloc: Any, name: str) -> None:
    """void *name(size, alignment): a block with one reference, null where there is no memory."""
    function = ir.Function(module, ir.FunctionType(_ADDRESS, [WORD, ir.IntType(32)]), name)
    builder = ir.IRBuilder(function.append_basic_block())
    size, align = function.args[0], builder.zext(function.args[1], WORD)
    block = builder.call(malloc, [builder.add(builder.add(size, align), WORD(_HEAD))])
    with builder.if_then(builder.icmp_unsigned("==", block, _ADDRESS(None)), likely=False):
        builder.ret(block)
    data = builder.ptrtoint(builder.gep(block, [WORD(_HEAD)]), WORD)
    data = builder.sub(builder.add(data, align), WORD(1))
    words = builder.bitcast(block, WORD.as_pointer())
    filled = {0: WORD(1), _DATA: builder.sub(data, builder.urem(data, align)), _SIZE: size}
    for k in range(_HEAD // 8):
        builder.store(filled.get(k, WORD(0)), builder.gep(words, [WORD(k)]))
    builder.ret(block)


def _hide_all_but(module: Any, symbols: Any) -> None:
    """Leave nothing else to be seen: LLVM may then change how functions are called, or drop them."""
    for function in module.functions:
        if not function.is_declaration and function.name not in symbols:
            function.linkage = "internal"
    for variable in module.global_variables:
        # Constants that a traceback in Python would ask for.
        if variable.name.startswith(ENVIRONMENT):
            variable.linkage = "internal"


def _machine_code(bitcode: bytes, triple: str, processor: str):
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
    return machine.emit_object(module)
