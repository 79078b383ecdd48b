"""Report rows of a mechanism of rigid and flexible bodies with elements at its joints."""

from dataclasses import dataclass, fields

from ...kernels.constrained.report import Report
from ...model.arrays.element_table import coordinates_of_joints
from ...model.arrays.system import SystemArrays
from ...model.flexible_mechanism import FlexibleMechanism
from .element_rows import JointAnswers, coupling_efforts, element_answers
from .flexible_rows import FlexibleRows, flexible_rows


@dataclass(frozen=True)
class FlexibleElementRows(JointAnswers, FlexibleRows):
    """Rows with joint coordinates, springs and elements."""


def flexible_element_rows(
    mechanism: FlexibleMechanism, arrays: SystemArrays, report: Report
) -> FlexibleElementRows:
    """The rows of a report in the terms of the model."""
    rows = flexible_rows(mechanism, arrays, report)
    kept = {field.name: getattr(rows, field.name) for field in fields(FlexibleRows)}
    first = len(mechanism.forces) + len(mechanism.torques)
    count = len(coordinates_of_joints(mechanism.joints))
    return FlexibleElementRows(
        **kept,
        **element_answers(report, first, mechanism.elements, count),
        coupling_effort=coupling_efforts(report, arrays, mechanism.elements),
    )
