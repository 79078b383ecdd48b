"""Objects of machine code that need no numba any more: the entries of a unit, each behind a wrapper.

A wrapper takes the numbers, addresses and lengths of the arguments as 64-bit words.
"""

from typing import Any, NamedTuple

import llvmlite.binding as llvm

from ..collector import without_collector
from ._allocator import add_allocator
from ._front_end import quick
from ._linking import ENVIRONMENT, refuse_missing, with_parts_of_parts
from ._numba import cpu_target, create_nrt_module, global_compiler_lock
from ._values import add_wrapper, numba_type
from .signatures import PROCESSORS

# What objects may call; LLVM replaces some of it, as sin and cos together by sincos.
OF_C = frozenset(
    ("malloc", "free", "memset", "memcpy", "memmove", "sin", "cos", "tan", "asin", "acos", "atan", "atan2")
    + ("sinh", "cosh", "tanh", "exp", "log", "log10", "pow", "sqrt", "fmod", "floor", "ceil", "rint")
    + ("hypot",)
)


class Entry(NamedTuple):
    """A kernel that Python calls."""

    symbol: str  # its name in the library
    kernel: Any  # an Entry of `_entry`
    parameters: list  # as `_arguments` describes them


def emit_objects(unit: str, entries: list[Entry], targets: list[str]) -> dict[str, bytes]:
    """Return the object of the entries for each target.

    The parts of all entries are linked once, and only the entries can be seen from outside.
    """
    # numba makes cycles by the million, and a tenth of the time went into them.
    with global_compiler_lock, quick(), without_collector():
        bitcode = _linked(unit, entries)
        return {target: _machine_code(bitcode, *_machine(target)) for target in targets}


def _machine(target: str) -> tuple[str, str]:
    """Return LLVM's name of a system, and that of the oldest processor of its type."""
    return PROCESSORS.get(target) or (llvm.get_process_triple(), "generic")


def _linked(unit: str, entries: list[Entry]) -> bytes:
    """Return LLVM's code of all entries with their parts."""
    context = cpu_target.target_context
    library = context.codegen().create_library(unit)
    wrappers, called = library.create_ir_module(unit), []
    for entry in entries:
        types_ = tuple(map(numba_type, entry.parameters))
        entry.kernel.part.compile(types_)
        compiled = entry.kernel.part.overloads[types_]
        add_wrapper(context, wrappers, entry.symbol, compiled)
        called.append(compiled.library)
    add_allocator(wrappers)
    module = llvm.parse_assembly(str(wrappers))
    for part in with_parts_of_parts(called):
        module.link_in(part._get_module_for_linking(), preserve=True)
    module.link_in(llvm.parse_assembly(str(create_nrt_module(context)[0])))
    _hide_all_but(module, {entry.symbol for entry in entries})
    refuse_missing(module)
    return module.as_bitcode()


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
    _refuse_foreign(module)
    return machine.emit_object(module)


def _refuse_foreign(module: Any) -> None:
    """Return what neither the object nor the C library has would be called at address 0."""
    called = {function.name for function in module.functions if function.is_declaration}
    foreign = {name for name in called if not name.startswith("llvm.")} - OF_C
    if foreign:
        raise AssertionError(f"compiled kernels call {sorted(foreign)}")
