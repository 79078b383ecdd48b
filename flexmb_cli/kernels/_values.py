"""Parameters as types of numba's, and words of `_arguments` as their values in LLVM's language.

Named tuples that Python hands to kernels are a type of their own, the address of their words.  numba's own
type is handed on value by value: a mechanism and its work are 300 of them, at every call of a kernel, and two
thirds of what numba wrote for LLVM were such lists.  Tuples that kernels make themselves stay what they are.
"""

import hashlib
from collections.abc import Iterator
from typing import Any

from llvmlite import ir

from ._arguments import Array, Fields, key_of, size_of
from ._numba import (
    AttributeTemplate,
    cgutils,
    cpu_target,
    from_dtype,
    impl_ret_borrowed,
    infer_getattr,
    intrinsic,
    lower_getattr_generic,
    make_array,
    models,
    populate_array,
    register_model,
    types,
)

WORD = ir.IntType(64)


class TupleReference(types.Type):
    """The address of the words of a named tuple, which nothing changes while kernels run."""

    def __init__(self, parameter: Fields):
        self.fields = {}  # place of the first word and numba's type of each
        first = 0
        for name, part in zip(parameter.kind._fields, parameter.parts, strict=True):  # type: ignore[attr-defined]
            self.fields[name] = first, numba_type(part)
            first += size_of(part)
        # Fields of other types are another type, and other functions for LLVM.
        key = hashlib.sha256(key_of(parameter).encode()).hexdigest()[:8]
        super().__init__(f"{parameter.kind.__name__}_{key}")


@register_model(TupleReference)
class _Address(models.PrimitiveModel):
    def __init__(self, manager: Any, kind: TupleReference):
        super().__init__(manager, kind, ir.IntType(64).as_pointer())


@infer_getattr
class _FieldTypes(AttributeTemplate):
    key = TupleReference

    def generic_resolve(self, reference: Any, name: str):  # type: ignore[override]
        """Return the type of a field, None where there is no such field."""
        return reference.fields[name][1] if name in reference.fields else None


def numba_type(parameter: Any):
    """numba's type of a parameter."""
    if isinstance(parameter, Array):
        return types.Array(from_dtype(parameter.dtype), parameter.dimensions, "C")
    if isinstance(parameter, Fields):
        if parameter.kind is not tuple:
            return TupleReference(parameter)
        return types.BaseTuple.from_types(list(map(numba_type, parameter.parts)), tuple)
    return {"i": types.int64, "f": types.float64, "b": types.boolean}[parameter]


def result_of(kind: types.Type) -> str:
    """Return how `Results` describes what a kernel returns; raises TypeError for arrays."""
    if isinstance(kind, types.BaseTuple):
        return "(" + "".join(result_of(part).removeprefix("(") for part in kind)  # type: ignore[attr-defined]
    for number, letter in ((types.Boolean, "b"), (types.Integer, "i"), (types.Float, "f")):
        if isinstance(kind, number):
            return letter
    if kind is types.none:
        return ""
    raise TypeError(f"a kernel returns {kind} to Python: mark it as `plain`")


def add_wrapper(context: Any, module: ir.Module, symbol: str, compiled: Any) -> None:
    """Define int symbol(int64 *words, int64 *results), which calls a part; not 0 where that failed."""
    cgutils.global_constant(
        module,
        f"{symbol}_result",
        cgutils.make_bytearray(result_of(compiled.signature.return_type).encode() + b"\0"),
    ).linkage = ""
    code = ir.IntType(32)
    function = ir.Function(module, ir.FunctionType(code, [WORD.as_pointer()] * 2), symbol)
    builder = ir.IRBuilder(function.append_basic_block())
    signature = compiled.signature
    values = list(_values(context, builder, function.args[0], signature.args))
    part = context.declare_function(module, compiled.fndesc)
    call = context.call_conv.call_function
    status, result = call(builder, part, signature.return_type, signature.args, values)
    with builder.if_then(builder.not_(status.is_ok), likely=False):
        builder.ret(code(1))
    _store_result(builder, signature.return_type, result, function.args[1], 0)
    builder.ret(code(0))


def _values(context: Any, builder: Any, words: Any, kinds: Any, first: int = 0) -> Iterator[Any]:
    """Yield the values of types that follow one another from word `first` on."""
    for kind in kinds:
        yield _value(context, builder, words, first, kind)
        first += _size(kind)


def _size(kind: Any) -> int:
    """Return how many words a value of a type takes."""
    if isinstance(kind, TupleReference):
        return sum(_size(field) for _, field in kind.fields.values())
    if isinstance(kind, types.BaseTuple):
        return sum(map(_size, kind))  # type: ignore[call-overload]
    return 1 + kind.ndim if isinstance(kind, types.Array) else 1


def _value(context: Any, builder: Any, words: Any, first: int, kind: Any):
    """numba's value of the type `kind` from word `first` on."""
    if isinstance(kind, TupleReference):
        return builder.gep(words, [WORD(first)])
    if isinstance(kind, types.BaseTuple):
        return context.make_tuple(builder, kind, list(_values(context, builder, words, kind, first)))
    if isinstance(kind, types.Array):
        data = _read(builder, words, first, context.get_data_type(kind.dtype).as_pointer())
        shape = [_read(builder, words, first + 1 + axis, WORD) for axis in range(kind.ndim)]
        return _contiguous(context, builder, kind, data, shape, None)
    if isinstance(kind, types.Float):
        return _read(builder, words, first, ir.DoubleType())
    word = _read(builder, words, first, WORD)
    return builder.icmp_unsigned("!=", word, WORD(0)) if isinstance(kind, types.Boolean) else word


def _read(builder: Any, words: Any, place: int, kind: Any):
    """The word at a place as a value of LLVM's type `kind`; no store of a kernel changes it."""
    at = builder.bitcast(builder.gep(words, [WORD(place)]), kind.as_pointer())
    word = builder.load(at)
    word.set_metadata("invariant.load", builder.module.add_metadata([]))
    return word


@lower_getattr_generic(TupleReference)
def _field_value(context: Any, builder: Any, reference: Any, words: Any, name: str):
    """The value of a field of a tuple."""
    return _value(context, builder, words, *reference.fields[name])


def _contiguous(context: Any, builder: Any, kind: Any, data: Any, shape: Any, owner: Any):
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
def _block(typing: Any, flat: Any, first: Any, shape: Any):
    """The view of `linalg.blocks`: numba's own reshape looks at all strides, and took a tenth of a step."""
    kind = types.Array(flat.dtype, len(shape), "C")

    def generate(context: Any, builder: Any, signature: Any, values: Any):
        array = make_array(flat)(context, builder, values[0])
        data, lengths = builder.gep(array.data, [values[1]]), cgutils.unpack_tuple(builder, values[2])
        view = _contiguous(context, builder, kind, data, lengths, array.meminfo)
        return impl_ret_borrowed(context, builder, kind, view)

    return kind(flat, types.int64, types.UniTuple(types.int64, len(shape))), generate


def built_in_type(name: str) -> types.Type:
    """Return numba's type of a function that is not compiled from its text."""
    return cpu_target.typing_context.resolve_value_type({"block": _block}[name])


def _store_result(builder: Any, kind: Any, value: Any, room: Any, k: Any):
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
