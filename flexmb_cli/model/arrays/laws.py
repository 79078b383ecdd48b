"""What an element does along its coordinate: fields that every record of an element has, and how they are
filled.

The kernels of both formulations hand such records to `kernels.laws`.
"""

from typing import TYPE_CHECKING, Any

import numpy as np

from ..joint_elements import EndStop, JointMotor
from ..laws import MOST_PARAMETERS, JointLaw
from ..time_functions import integral_of

if TYPE_CHECKING:
    from .function_table import FunctionTable

# What a law is.
SPRING, STOP, CABLE, MOTOR = 1, 2, 3, 4
NONE = -1
FUNCTIONS = ("function", "curve", "energy", "damper")  # fields that hold numbers of functions

LAW = np.dtype(
    [
        ("shape", np.int64),  # SPRING, STOP, CABLE, MOTOR
        ("stiffness", np.float64),  # N/m, N m/rad
        ("free_length", np.float64),  # m or rad
        ("damping", np.float64),  # N s/m, N m s/rad; of a stop or cable s/m, s/rad
        ("preload", np.float64),  # of a spring without stretch; of a motor besides its function; N, N m
        ("lower", np.float64),  # STOP: where it begins below, m, rad
        ("upper", np.float64),  # STOP: and above, m, rad
        ("c", np.float64, 4),  # parameters of a law of `model.laws`
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
_SHAPES = {EndStop: STOP, JointMotor: MOTOR}
# Fields that elements and records share; `rest` is the record's free length.
_NUMBERS = {"stiffness": "stiffness", "damping": "damping", "preload": "preload", "rest": "free_length",
            "lower": "lower", "upper": "upper"}  # fmt: skip


def fill_law(record: Any, item: Any, table: "FunctionTable") -> Any:
    """Fill the law of a record by an element; its functions join those of the table."""
    if isinstance(item, JointLaw):
        record["c"] = np.pad(item.values, (0, MOST_PARAMETERS - len(item.values)))
        record["shape"] = item.law.code
    else:
        record["shape"] = CABLE if getattr(item, "slack", False) else _SHAPES.get(type(item), SPRING)
    for name, field in _NUMBERS.items():
        record[field] = getattr(item, name, 0.0)
    for field in FUNCTIONS:
        record[field] = NONE
    if getattr(item, "function", None) is not None:
        record["function"] = table.function(item.function)
    if getattr(item, "curve", None) is not None:
        record["curve"] = table.function(item.curve, of_time=False)
        energy = integral_of(item.curve)
        assert energy is not None, "a curve is no product"
        record["energy"] = table.function(energy, of_time=False)
    if getattr(item, "damper", None) is not None:
        record["damper"] = table.function(item.damper, of_time=False)
    return record


def fill_friction(record: Any, item: Any) -> Any:
    """Fill the law of friction, and its preload, by an element."""
    for field in ("dynamic", "static", "stribeck", "creep", "radius", "preload"):
        record[field] = getattr(item, field)
    return record
