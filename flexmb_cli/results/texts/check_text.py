"""Text of what `flexmb check` found (`run.check.check.CheckReport`)."""

from typing import TYPE_CHECKING, Any

from ...errors import visible

if TYPE_CHECKING:
    from collections.abc import Iterator


COLUMNS = ("x", "y", "z", "e0", "e1", "e2", "e3")
MOST_NAMES_SHOWN = 8
MOST_GAPS = 500
ROUND_OFF_VALUE = 1e-12  # of the largest: smaller singular values are round-off, another on other processors


def check_text(report: Any) -> str:
    """Counts, assembly and rank of a deck that could be read, one fact a line."""
    counts = report.counts
    joints = ", ".join(f"{number} {kind}" for kind, number in counts["joints"].items()) or "none"
    lines = [
        f"{visible(report.outcome.deck)}: {report.deck.dialect.upper()} deck",
        f"  bodies {counts['bodies']}, joints: {joints}",
        f"  simplified {counts['simplified']}, distance {counts['distance']}, drivers {counts['drivers']}, "
        f"grounded bodies {counts['grounds']}, points of interest {counts['points']}",
        _size_line(counts),
        *assembly_lines(report),
        *_rank_lines(report),
    ]
    return "".join(f"{line}\n" for line in lines)


def _size_line(counts: dict[str, dict[str, int] | int]) -> str:
    times = f"report times {counts['report_times']}"
    if "last_time" in counts:  # not the end that the deck gives
        times += f", the last at {counts['last_time']:.6g} s"
    if "equations" not in counts:  # too large to be assembled
        return f"  coordinates {counts['coordinates']}, {times}"
    return (
        f"  equations {counts['equations']}, coordinates {counts['coordinates']}, "
        f"degrees of freedom without drivers {counts['degrees_of_freedom']}, {times}"
    )


def assembly_lines(report: Any) -> "Iterator[str]":
    """Gaps of the estimates and of the assembled position, owner by owner; of very many the widest."""
    if not report.gaps:
        return
    yield f"  assembly at t = {report.time:.6g} s: largest residual per constraint, estimates → assembled"
    shown = report.gaps
    if len(shown) > MOST_GAPS:
        shown = sorted(shown, key=lambda gap: -gap[1])[:MOST_GAPS]
    width = max(len(owner) for owner, *_ in shown)
    for owner, before, after, unit in shown:
        yield f"    {owner:<{width}}  {before:9.2e} → {after:9.2e} {'m' if unit == 'm' else ''}".rstrip()
    if len(shown) < len(report.gaps):
        yield f"    and {len(report.gaps) - len(shown)} with narrower gaps of the estimates; --json has all"


def _rank_lines(report: Any) -> "Iterator[Any]":
    if report.rank is None:
        return
    coordinates = report.counts["coordinates"]
    yield f"  rank {report.rank} of {coordinates}, smallest singular value {smallest_value(report.smallest)}"
    yield from redundant_lines(report)
    for names in report.free:
        yield "  not determined to first order: " + few(names)


def smallest_value(value: float) -> str:
    """Return a singular value of the scaled Jacobian, and no digits of round-off."""
    return f"{value:.1e}" if value >= ROUND_OFF_VALUE else f"below {ROUND_OFF_VALUE:.0e}"


def redundant_lines(report: Any) -> "Iterator[Any]":
    """Groups of equations one of which repeats the others."""
    for group in report.redundant:
        yield "  redundant, one of: " + few(group)


def few(names: list[str]) -> str:
    """The first names of a group, and how many there are besides."""
    more = f" and {len(names) - MOST_NAMES_SHOWN} more" if len(names) > MOST_NAMES_SHOWN else ""
    return "; ".join(names[:MOST_NAMES_SHOWN]) + more


def jacobian_text(jacobian: Any) -> str:
    """Φ_q as in Young's tables 6.1 and 6.2: a row an equation, seven columns a body."""
    when = "at the estimates" if jacobian.time is None else f"at t = {jacobian.time:.6g} s"
    width = max(len(name) for name in jacobian.rows)
    number = len(str(len(jacobian.rows)))
    lines = [f"Jacobian {when}; rows: equations, columns: {' '.join(COLUMNS)} of each body"]
    lead = " " * (number + 2 + width)
    lines.append(lead + "".join(f"  {name:<{7 * 9 - 1}}" for name in jacobian.bodies).rstrip())
    lines.append(lead + "".join(" " + "".join(f"{c:>9}" for c in COLUMNS) for _ in jacobian.bodies))
    for k, (name, row) in enumerate(zip(jacobian.rows, jacobian.matrix, strict=True), start=1):
        cells = "".join(
            " " + "".join(_cell(value) for value in row[7 * body : 7 * body + 7])
            for body in range(len(jacobian.bodies))
        )
        lines.append(f"{k:>{number}}  {name:<{width}}{cells}".rstrip())
    return "".join(f"{line}\n" for line in lines)


def _cell(value: Any) -> str:
    if abs(value) < 5e-16:
        return f"{'.':>9}"
    return f"{value:>9.4f}" if abs(value) < 1000 else f"{value:>9.2e}"
