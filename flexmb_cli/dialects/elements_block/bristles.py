"""Numbers of bristles in lines FRICTION and CONTACT."""

from ...model.laws import Touch
from .line import ElementLine
from .measures import Measures


def check_bristles(line: ElementLine, measures: Measures, measure: object) -> None:
    """Refuse bristles without damping or friction, and those of pairs that a search finds."""
    stiffness, damping, static = line["bristle"], line["bristle_damping"], line["static"]
    key = "bristle" if stiffness else "bristle_damping"
    contact = isinstance(measure, Touch)
    sliding = line["friction" if contact else "dynamic"]
    if stiffness == damping == 0.0:
        return
    if not (stiffness > 0.0 and damping > 0.0):
        message = (
            f"bristles have a stiffness and a damping; read bristle={stiffness:g} bristle_damping={damping:g}"
        )
        fault = "ELEMENTS-270"
    elif not (sliding > 0.0 and (contact or static > 0.0)):
        message = "bristles bend by friction; its coefficients must be larger than 0"
        fault = "ELEMENTS-271"
    elif isinstance(measure, Touch) and measure.searched:
        message = (
            "pairs of many shapes with many come and go, and have no bristles; give pairs that stick lines "
            "of their own, or leave out bristle="
        )
        fault = "ELEMENTS-272"
    else:
        return
    measures.findings.error(line.subject, message, line.place_of(key), id=fault)
