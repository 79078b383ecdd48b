"""Text of what `flexmb check` found of a mechanism of flexible bodies (`run.check.check.CheckReport`)."""

from typing import TYPE_CHECKING, Any

from ...errors import visible
from .check_text import assembly_lines, few, redundant_lines, smallest_value

if TYPE_CHECKING:
    from collections.abc import Iterator


def check_flexible_text(report: Any) -> str:
    """Counts, bodies, assembly and rank of a deck that could be read, one fact a line."""
    counts = report.counts
    joints = ", ".join(f"{number} {kind}" for kind, number in counts["joints"].items()) or "none"
    lines = [
        f"{visible(report.outcome.deck)}: {report.deck.dialect.upper()} deck",
        f"  bodies {counts['bodies']}, of them flexible {counts['flexible']}, joints: {joints}",
        f"  pins {counts['pins']}, motions {counts['motions']}, forces and torques {counts['loads']}, "
        f"springs {counts['springs']}, output nodes {counts['outputs']}",
        *(_body_line(body) for body in report.bodies),
        *(_assembled_lines(report) if "equations" in counts else [_size_line(counts)]),
    ]
    return "".join(f"{line}\n" for line in lines)


def _size_line(counts: "dict[str, Any]") -> str:
    """Return the size of a mechanism that is too large to be assembled."""
    return f"  speeds {counts['coordinates']}, modal {counts['modes']}, report times {counts['report_times']}"


def _assembled_lines(report: Any) -> "Iterator[str]":
    counts = report.counts
    yield (
        f"  equations {counts['equations']}, speeds {counts['coordinates']}, modal {counts['modes']}, "
        f"degrees of freedom without motions {counts['degrees_of_freedom']}, "
        f"report times {counts['report_times']}"
    )
    yield from assembly_lines(report)
    yield (
        f"  rank {report.rank} of {counts['equations']}, smallest singular value "
        f"{smallest_value(report.smallest)}"
    )
    yield from redundant_lines(report)
    yield from _free_line(report.free)


def _free_line(free: list[list[str]]) -> "Iterator[str]":
    """The motions left, each by the first of its coordinates."""
    if free:
        yield f"  free motions {len(free)}, such as those of: " + few([names[0] for names in free])


def _body_line(body: "dict[str, Any]") -> str:
    centre = " ".join(f"{value + 0.0:.6g}" for value in body["centre"])
    line = f"  {body['name']}: {body['kind']}, mass {body['mass']:.6g} kg, centre of mass {centre} m"
    if not body["modes"]:
        return line
    low, high = body["frequencies"][0], body["frequencies"][-1]
    line += f", nodes {body['nodes']}, modes {body['modes']} from {low:.4g} to {high:.4g} Hz"
    line += f", precise to {max(body['frequency_errors']):.0e}"
    return f"{line}; {body['elements']}" if "elements" in body else line
