"""Fields of the force law that every record of an element has, and how they are filled.

The kernels of both formulations hand such records to `kernels.laws`.
"""

from typing import TYPE_CHECKING, Any

import numpy as np

from ..laws import NUMBER, OF_COORDINATE, OF_TIME, SPRING, Element, Law
from ..time_functions import integral_of

if TYPE_CHECKING:
    from .function_table import FunctionTable

NONE = -1

LAW = np.dtype(
    [
        ("shape", np.int64),  # code of a law of `model.laws`
        ("c", np.float64, 10),  # its numbers in their order, SI units; of a motor a constant effort
        # Its functions in their order, -1: none; behind one of the coordinate its integral.
        ("f", np.int64, 3),
    ]
)


def fill_law(record: Any, law: Law, values: tuple[Any, ...], table: "FunctionTable | None" = None) -> Any:
    """Fill the law of a record by values of its parameters; functions join those of the table."""
    record["shape"], record["f"] = law.code, NONE
    numbers = functions = 0
    for p, value in zip(law.parameters, values, strict=True):
        if p.kind == NUMBER:
            record["c"][..., numbers] = value
            numbers += 1
            continue
        if value is not None and table is not None:
            record["f"][..., functions] = table.function(value, of_time=p.kind == OF_TIME)
        functions += 1
        if p.kind == OF_COORDINATE:
            if value is not None and table is not None:
                energy = integral_of(value)
                assert energy is not None, "a curve is no product"
                record["f"][..., functions] = table.function(energy, of_time=False)
            functions += 1
    return record


def fill_bushing(records: Any, item: Element) -> Any:
    """Fill the laws of six records, which are those of springs."""
    (k, kr, c, cr) = item.values
    records["shape"], records["f"] = SPRING.code, NONE
    records["c"][:, 0], records["c"][:, 2] = (*k, *kr), (*c, *cr)
    return records
