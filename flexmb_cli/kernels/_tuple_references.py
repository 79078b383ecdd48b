"""Named tuples that Python hands to kernels, as a type of numba's: the address of the words of `_arguments`.

numba's own type of a named tuple is handed on value by value: a mechanism and its work are 300 of them, at
every call of a kernel, and two thirds of what numba wrote for LLVM were such lists.  A kernel that gets an
address reads the arrays that it uses.  Tuples that kernels make themselves stay what they are to numba.
"""

import hashlib
from typing import Any, NamedTuple

from llvmlite import ir

from ._arguments import key_of
from ._numba import AttributeTemplate, infer_getattr, models, register_model, types


class Field(NamedTuple):
    """A field of a tuple."""

    first: int  # place of its first word
    kind: types.Type  # numba's type of it


class TupleReference(types.Type):
    """The address of the words of a named tuple, which nothing changes while kernels run."""

    def __init__(self, parameter: list, fields: dict[str, Field]):
        self.fields = fields
        name = parameter[1].rpartition(":")[2]
        # Fields of other types are another type, and other functions for LLVM.
        super().__init__(f"{name}_{hashlib.sha256(key_of(parameter).encode()).hexdigest()[:8]}")


@register_model(TupleReference)
class _Address(models.PrimitiveModel):
    def __init__(self, manager: Any, kind: TupleReference):
        super().__init__(manager, kind, ir.IntType(64).as_pointer())


@infer_getattr
class _FieldTypes(AttributeTemplate):
    key = TupleReference

    def generic_resolve(self, reference: Any, name: str):  # type: ignore[override]
        """Return the type of a field, None where there is no such field."""
        field = reference.fields.get(name)
        return field and field.kind
