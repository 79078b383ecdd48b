"""The end of a run whose point leaves an open curve."""

from collections.abc import Iterable, Iterator
from dataclasses import fields, replace
from typing import Any

from ..errors import AnalysisError, Fault
from ..model.joint_elements import Curve, JointElements, first_outside


def on_curves(elements: JointElements, blocks: Iterable[Any]) -> Iterator[Any]:
    """Yield blocks of report rows up to one whose point has left its curve; then raise AnalysisError."""
    for block in blocks:
        row, curve = first_outside(elements.curves, block.curve_position) if elements.curves else (0, None)
        if curve is None:
            yield block
            continue
        if row:
            yield replace(
                block, **{field.name: _first(getattr(block, field.name), row) for field in fields(block)}
            )
        position = block.curve_position[row, elements.curves.index(curve)]
        raise _left(curve, float(block.time[row]), float(position))


def _first(values: Any, rows: int) -> Any:
    return tuple(value[:rows] for value in values) if isinstance(values, tuple) else values[:rows]


def _left(curve: Curve, t: float, position: float) -> AnalysisError:
    end, length = ("beginning", 0.0) if position < 0.0 else ("end", curve.length)
    message = (
        f"by t = {t:.6g} s the point has left the curve at its {end}, an arc length of {length:.6g} m: "
        "lengthen the curve, hold the point by a stop or a contact, or end the run before"
    )
    return AnalysisError(
        Fault("error", message, curve.place, curve.name, id="SOLVE-110"), t, {"gap": position}
    )
