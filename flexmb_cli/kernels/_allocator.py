"""Memory functions that numba's code calls, in LLVM's language: arrays of a kernel live on C's heap.

The names and the layout of a block are numba's (numba/core/runtime/nrt.cpp).
"""

from typing import Any

from llvmlite import ir

WORD, _BYTE, _INT = ir.IntType(64), ir.IntType(8), ir.IntType(32)
_ADDRESS = _BYTE.as_pointer()
# Count of references, destructor and its argument, data, size, allocator: six words, data aligned behind.
_HEAD, _DATA, _SIZE = 6 * 8, 3, 4
_ALLOCATING = {
    "NRT_MemInfo_alloc_aligned": True,
    "NRT_MemInfo_alloc_safe_aligned": True,
    "NRT_MemInfo_alloc": False,
}


def add_allocator(module: ir.Module) -> None:
    """Define what makes a block, and what frees it."""
    malloc = ir.Function(module, ir.FunctionType(_ADDRESS, [WORD]), "malloc")
    free = ir.Function(module, ir.FunctionType(ir.VoidType(), [_ADDRESS]), "free")
    for name, aligned in _ALLOCATING.items():
        _add_alloc(module, malloc, name, aligned)
    destructor = ir.Function(module, ir.FunctionType(ir.VoidType(), [_ADDRESS]), "NRT_MemInfo_call_dtor")
    builder = ir.IRBuilder(destructor.append_basic_block())
    builder.call(free, [destructor.args[0]])
    builder.ret_void()


def _add_alloc(module: Any, malloc: Any, name: str, aligned: Any) -> None:
    """void *name(size, alignment): a block with one reference, null where there is no memory."""
    parameters = [WORD, _INT] if aligned else [WORD]
    function = ir.Function(module, ir.FunctionType(_ADDRESS, parameters), name)
    builder = ir.IRBuilder(function.append_basic_block())
    size = function.args[0]
    align = builder.zext(function.args[1], WORD) if aligned else WORD(16)
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
