"""Text of what `flexmb check` found (`run.check.check.CheckReport`), one fact a line."""

from collections.abc import Iterator
from typing import Any

from ...errors import visible

COLUMNS = ("x", "y", "z", "e0", "e1", "e2", "e3")
MOST_NAMES_SHOWN = 8
MOST_GAPS = 500
MOST_COORDINATES = 24
ROUND_OFF_VALUE = 1e-12  # of the largest: smaller singular values are round-off, another on other processors


def check_text(report: Any) -> str:
    """Return counts, assembly and rank of a mechanism; of a tree coordinates, inertia, loops and energies."""
    one_way = ", one-way: elastic motion does not act on rigid motion" * bool(report.counts.get("one_way"))
    first = f"{visible(report.outcome.deck)}: {report.deck.dialect.upper()} deck{one_way}"
    lines = _tree_lines(report) if report.analysis == "tree" else _mechanism_lines(report)
    return "".join(f"{line}\n" for line in (first, *lines))


def _mechanism_lines(report: Any) -> Iterator[str]:
    counts, flexible = report.counts, report.analysis == "flexible"
    joints = ", ".join(f"{number} {kind}" for kind, number in counts["joints"].items()) or "none"
    if flexible:
        yield f"  bodies {counts['bodies']}, of them flexible {counts['flexible']}, joints: {joints}"
        yield (
            f"  pins {counts['pins']}, motions {counts['motions']}, forces and torques {counts['loads']}, "
            f"springs {counts['springs']}, output nodes {counts['outputs']}"
        )
        yield from map(_body_line, report.bodies)
    else:
        yield f"  bodies {counts['bodies']}, joints: {joints}"
        yield (
            f"  simplified {counts['simplified']}, distance {counts['distance']}, "
            f"drivers {counts['drivers']}, grounded bodies {counts['grounds']}, "
            f"points of interest {counts['points']}"
        )
    yield _size_line(counts, flexible)
    yield from assembly_lines(report)
    if report.rank is not None:
        full = counts["equations" if flexible else "coordinates"]
        yield f"  rank {report.rank} of {full}, smallest singular value {smallest_value(report.smallest)}"
        yield from ("  redundant, one of: " + few(group) for group in report.redundant)
        if flexible and report.free:
            first = few([names[0] for names in report.free])
            yield f"  free motions {len(report.free)}, such as those of: {first}"
        elif not flexible:
            yield from ("  not determined to first order: " + few(names) for names in report.free)


def _size_line(counts: dict[str, Any], flexible: bool) -> str:
    """Return the size of a mechanism; one that is too large to be assembled has no count of equations."""
    times = f"report times {counts['report_times']}"
    if "last_time" in counts:  # not the end that the deck gives
        times += f", the last at {counts['last_time']:.6g} s"
    size = f"speeds {counts['coordinates']}, modal {counts['modes']}" if flexible else ""
    size = size or f"coordinates {counts['coordinates']}"
    if "equations" not in counts:
        return f"  {size}, {times}"
    held = f"degrees of freedom without {'motions' if flexible else 'drivers'} {counts['degrees_of_freedom']}"
    return f"  equations {counts['equations']}, {size}, {held}, {times}"


def _body_line(body: dict[str, Any]) -> str:
    centre = " ".join(f"{value + 0.0:.6g}" for value in body["centre"])
    line = f"  {body['name']}: {body['kind']}, mass {body['mass']:.6g} kg, centre of mass {centre} m"
    if not body["modes"]:
        return line
    low, high = body["frequencies"][0], body["frequencies"][-1]
    line += f", nodes {body['nodes']}, modes {body['modes']} from {low:.4g} to {high:.4g} Hz"
    line += f", precise to {max(body['frequency_errors']):.0e}"
    return f"{line}; {body['elements']}" if "elements" in body else line


def assembly_lines(report: Any) -> Iterator[str]:
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


def smallest_value(value: float) -> str:
    """Return a singular value of the scaled Jacobian, and no digits of round-off."""
    return f"{value:.1e}" if value >= ROUND_OFF_VALUE else f"below {ROUND_OFF_VALUE:.0e}"


def few(names: list[str]) -> str:
    """The first names of a group, and how many there are besides."""
    more = f" and {len(names) - MOST_NAMES_SHOWN} more" if len(names) > MOST_NAMES_SHOWN else ""
    return "; ".join(names[:MOST_NAMES_SHOWN]) + more


def _tree_lines(report: Any) -> Iterator[str]:
    counts, findings = report.counts, report.tree
    dof = counts.get("degrees_of_freedom")
    yield (
        f"  bodies {counts['bodies']}, of them flexible {counts['flexible']}; "
        f"closures {counts['closures']}, closed directions {counts['closed_directions']}"
    )
    yield (
        f"  coordinates {counts['coordinates']}: rotations {counts['rotations']}, "
        f"translations {counts['translations']}, elastic {counts['elastic']}; "
        f"prescribed {counts['prescribed']}"
    )
    known = "" if dof is None else f"degrees of freedom {dof}, "
    yield f"  {known}report times {counts['report_times']}"
    for name, nodes, coordinates, lowest, highest in findings.elastic:
        yield (
            f"  {name}: nodes {nodes}, elastic coordinates {coordinates}, "
            f"{lowest:.4g} to {highest:.4g} Hz with the root held"
        )
    yield from _coordinate_lines(findings.coordinates)
    if findings.gaps:
        yield "  gap of the loops, as given → assembled"
        yield from (f"    {name}  {before:9.2e} → {after:9.2e} m" for name, before, after in findings.gaps)
        yield from (f"    closed by others too: {name}" for name in findings.redundant)
    if findings.lightest is not None:
        name, share = findings.lightest
        least = f"least inertia left: {share:.3g} of its body's own, at '{name}'"
        yield f"  mass matrix positive definite; {least}"
    if findings.energies:
        energies = ", ".join(f"{name} {value:.6g} J" for name, value in findings.energies.items())
        yield f"  energies at the start: {energies}"


def _coordinate_lines(coordinates: list[tuple[str, str, float, float]]) -> Iterator[str]:
    yield "  at the start: coordinate, its speed"
    width = max(len(name) for name, *_ in coordinates)
    for name, unit, q, u in coordinates[:MOST_COORDINATES]:
        yield f"    {name:<{width}}  {q:14.7g} {unit:<3}  {u:14.7g} {unit}/s"
    if len(coordinates) > MOST_COORDINATES:
        yield f"    and {len(coordinates) - MOST_COORDINATES} more; --json lists all"


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
