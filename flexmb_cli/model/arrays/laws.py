"""Fields of the force law that every record of an element has, and how they are filled.

The kernels of both formulations hand such records to `kernels.laws`.
"""

from typing import TYPE_CHECKING, Any

import numpy as np

from ..joint_elements import JointMotor
from ..laws import CABLE, MOTOR, SPRING, JointLaw
from ..time_functions import integral_of

if TYPE_CHECKING:
    from .function_table import FunctionTable

NONE = -1
FUNCTIONS = ("function", "curve", "energy", "damper")  # fields that hold numbers of functions

LAW = np.dtype(
    [
        ("shape", np.int64),  # SPRING, CABLE, MOTOR, or the code of a law of `model.laws`
        ("stiffness", np.float64),  # N/m, N m/rad
        ("free_length", np.float64),  # m or rad
        ("damping", np.float64),  # N s/m, N m s/rad; of a cable s/m
        ("preload", np.float64),  # of a spring without stretch; of a motor besides its function; N, N m
        ("c", np.float64, 4),  # parameters of a law of `model.laws`, in their units
        ("function", np.int64),  # MOTOR: function of time, -1: none
        ("curve", np.int64),  # SPRING: function of the stretch, -1: none
        ("energy", np.int64),  # SPRING: function that is its integral, -1: none
        ("damper", np.int64),  # SPRING: function of the rate, -1: none
    ]
)
FRICTION_LAW = np.dtype(
    [
        ("dynamic", np.float64),  # coefficient of sliding, no unit
        ("static", np.float64),  # coefficient at rest, no unit
        ("stribeck", np.float64),  # speed at which the one passes into the other, m/s
        ("creep", np.float64),  # speed below which it grows with the speed, m/s
        ("radius", np.float64),  # of what turns, m
    ]
)
# Fields that elements and records share; `rest` is the record's free length.
_NUMBERS = {"stiffness": "stiffness", "damping": "damping", "preload": "preload", "rest": "free_length"}


def fill_law(record: Any, item: Any, table: "FunctionTable") -> Any:
    """Fill the law of a record by an element; its functions join those of the table."""
    for field in FUNCTIONS:
        record[field] = NONE
    if isinstance(item, JointLaw):
        record["shape"], record["c"][: len(item.values)] = item.law.code, item.values
        return record
    if isinstance(item, JointMotor):
        record["shape"], record["function"] = MOTOR, table.function(item.function)
        return record
    record["shape"] = CABLE if getattr(item, "slack", False) else SPRING
    for name, field in _NUMBERS.items():
        record[field] = getattr(item, name)
    if item.curve is not None:
        energy = integral_of(item.curve)
        assert energy is not None, "a curve is no product"
        record["curve"] = table.function(item.curve, of_time=False)
        record["energy"] = table.function(energy, of_time=False)
    if item.damper is not None:
        record["damper"] = table.function(item.damper, of_time=False)
    return record


def fill_spring(record: Any, stiffness: float, rest: float, damping: float) -> Any:
    """Fill the law of a record by that of a linear spring and damper."""
    record["shape"], record["stiffness"], record["free_length"], record["damping"] = (
        SPRING, stiffness, rest, damping,
    )  # fmt: skip
    for field in FUNCTIONS:
        record[field] = NONE
    return record


def fill_friction(record: Any, item: Any) -> Any:
    """Fill the law of friction, and its preload, by an element."""
    for field in ("dynamic", "static", "stribeck", "creep", "radius", "preload"):
        record[field] = getattr(item, field)
    return record
