"""What numba's code calls for memory, in LLVM's language: arrays that a kernel makes live on C's heap.

The names and the layout of a block are numba's (numba/core/runtime/nrt.cpp).
"""

from collections.abc import Iterator
from contextlib import contextmanager

from llvmlite import ir

_WORD, _BYTE, _INT = ir.IntType(64), ir.IntType(8), ir.IntType(32)
_ADDRESS = _BYTE.as_pointer()
# Count of references, destructor and its argument, data, size, allocator: six words, data aligned behind.
_HEAD, _DATA, _SIZE = 6 * 8, 3, 4
_ALLOCATING = {
    "NRT_MemInfo_alloc_aligned": True,
    "NRT_MemInfo_alloc_safe_aligned": True,
    "NRT_MemInfo_alloc": False,
}


def add_allocator(module: ir.Module) -> None:
    """Define what makes a block, what frees it, and the reshape that copies nothing."""
    malloc = ir.Function(module, ir.FunctionType(_ADDRESS, [_WORD]), "malloc")
    free = ir.Function(module, ir.FunctionType(ir.VoidType(), [_ADDRESS]), "free")
    for name, aligned in _ALLOCATING.items():
        _add_alloc(module, malloc, name, aligned)
    destructor = ir.Function(module, ir.FunctionType(ir.VoidType(), [_ADDRESS]), "NRT_MemInfo_call_dtor")
    builder = ir.IRBuilder(destructor.append_basic_block())
    builder.call(free, [destructor.args[0]])
    builder.ret_void()
    _add_reshape(module)


def _add_alloc(module, malloc, name: str, aligned) -> None:
    """void *name(size, alignment): a block with one reference, null where there is no memory."""
    parameters = [_WORD, _INT] if aligned else [_WORD]
    function = ir.Function(module, ir.FunctionType(_ADDRESS, parameters), name)
    builder = ir.IRBuilder(function.append_basic_block())
    size = function.args[0]
    align = builder.zext(function.args[1], _WORD) if aligned else _WORD(16)
    block = builder.call(malloc, [builder.add(builder.add(size, align), _WORD(_HEAD))])
    with builder.if_then(builder.icmp_unsigned("==", block, _ADDRESS(None)), likely=False):
        builder.ret(block)
    data = builder.ptrtoint(builder.gep(block, [_WORD(_HEAD)]), _WORD)
    data = builder.sub(builder.add(data, align), _WORD(1))
    words = builder.bitcast(block, _WORD.as_pointer())
    filled = {0: _WORD(1), _DATA: builder.sub(data, builder.urem(data, align)), _SIZE: size}
    for k in range(_HEAD // 8):
        builder.store(filled.get(k, _WORD(0)), builder.gep(words, [_WORD(k)]))
    builder.ret(block)


def _add_reshape(module) -> None:
    """int reshape(n, lengths, strides, new n, new lengths, new strides, size of an item, Fortran's order).

    It fills the new strides of a contiguous array; 0 where there are none.
    """
    integers = _WORD.as_pointer()
    kind = ir.FunctionType(_INT, [_WORD, integers, integers, _WORD, integers, integers, _WORD, _INT])
    function = ir.Function(module, kind, "numba_attempt_nocopy_reshape")
    n, lengths, strides, new_n, new_lengths, new_strides, item, fortran = function.args
    builder = ir.IRBuilder(function.append_basic_block())
    size, new_size = (_variable(builder, item) for _ in range(2))
    with _places_from_last(builder, n) as k:
        length = builder.load(builder.gep(lengths, [k]))
        other = builder.icmp_signed("!=", builder.load(builder.gep(strides, [k])), builder.load(size))
        with builder.if_then(builder.and_(other, builder.icmp_signed("!=", length, _WORD(1)))):
            builder.ret(_INT(0))
        builder.store(builder.mul(builder.load(size), length), size)
    with _places_from_last(builder, new_n) as k:
        builder.store(builder.load(new_size), builder.gep(new_strides, [k]))
        length = builder.load(builder.gep(new_lengths, [k]))
        builder.store(builder.mul(builder.load(new_size), length), new_size)
    same = builder.icmp_signed("==", builder.load(size), builder.load(new_size))
    in_order = builder.icmp_signed("==", fortran, _INT(0))
    builder.ret(builder.zext(builder.and_(same, in_order), _INT))


def _variable(builder, value):
    """A place for a number; LLVM keeps those of the first block in registers."""
    with builder.goto_entry_block():
        place = builder.alloca(value.type)
    builder.store(value, place)
    return place


@contextmanager
def _places_from_last(builder: ir.IRBuilder, n: ir.Value) -> Iterator[ir.Value]:
    """The code in this block is done for n - 1, n - 2 … 0."""
    left = _variable(builder, n)
    head, body, end = (builder.append_basic_block() for _ in range(3))
    builder.branch(head)
    builder.position_at_end(head)
    k = builder.sub(builder.load(left), _WORD(1))
    builder.cbranch(builder.icmp_signed(">=", k, _WORD(0)), body, end)
    builder.position_at_end(body)
    builder.store(k, left)
    yield k
    builder.branch(head)
    builder.position_at_end(end)
