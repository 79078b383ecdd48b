"""Points on curves, and rolling → equations of constrained mechanisms.

Of points on curves: gaps along the normals, and the parameter.
"""

from typing import TYPE_CHECKING, Any

import numpy as np

from ..joint_elements import Curve, Roll

if TYPE_CHECKING:
    from .constraint_table import PrimitiveTable

NORMALS = "1st normal", "2nd normal"
ROLLING = "normal", "1st direction across", "2nd direction across"


def add_curve(
    table: "PrimitiveTable", curve: Curve, point: int, origin: int, bodies: tuple[int, int]
) -> None:
    """Add the equations of a point of the second of `bodies` on a curve of the first; body vectors of both.

    The primitives of its parameter are kept in `tracks` of the table.
    """
    i = bodies[0]
    assert curve.across is not None, "the curve has been looked at"
    across, first = table.body_vector(i, curve.across), table.in_a_row(curve.functions)
    start = table.place_of(point) - table.place_of(origin)
    turn = len(table.angles)
    table.angles.append(curve.nearest(table.A(i).T @ start))

    def track(number: int) -> Any:
        records = [table.product((point, origin), table.body_vector(i, axis)) for axis in np.eye(3)]
        for field, value in (("track", number), ("turn", turn), ("f", across), ("curve", first)):
            records[0][field] = value
        return records

    parts = [(name, True, table.chained(track(k))) for k, name in enumerate(NORMALS)]
    table.equations(curve.name, curve.place, *bodies, parts)
    table.tracks.append(track(len(NORMALS)))


def add_roll(table: "PrimitiveTable", roll: Roll, centre: int, point: int, bodies: tuple[int, int]) -> None:
    """Add the equations of a disc of the second of `bodies` that rolls on the first; body vectors of both."""
    i, j = bodies
    record = table.product((centre, point), table.body_vector(i, roll.axis_i))
    record["roll"], record["radius"] = roll.code, (roll.radius_j, roll.radius_i)
    record["f"] = table.body_vector(i, roll.across)
    if any(roll.axis_j):
        record["h"] = table.body_vector(j, roll.axis_j)
    parts = []
    for number in roll.directions:
        own = record.copy()
        own["direction"] = number - 1
        parts.append((ROLLING[number - 1], True, own))
    table.equations(roll.name, roll.place, i, j, parts)
