"""Text of what `flexmb check` found of a tree (`run.check.tree.TreeFindings`)."""

from typing import TYPE_CHECKING, Any

from ...errors import visible

if TYPE_CHECKING:
    from collections.abc import Iterator


MOST_COORDINATES = 24


def check_tree_text(report: Any) -> str:
    """Counts, coordinates, inertia, closures and energies at the start, one fact a line."""
    counts, found = report.counts, report.tree
    lines = [
        f"{visible(report.outcome.deck)}: {report.deck.dialect.upper()} deck{_one_way(counts)}",
        f"  bodies {counts['bodies']}, of them flexible {counts['flexible']}; "
        f"closures {counts['closures']}, closed directions {counts['closed_directions']}",
        f"  coordinates {counts['coordinates']}: rotations {counts['rotations']}, "
        f"translations {counts['translations']}, elastic {counts['elastic']}; "
        f"prescribed {counts['prescribed']}",
        f"  {_dof(counts)}report times {counts['report_times']}",
        *_elastic_lines(found.elastic),
        *_coordinate_lines(found.coordinates),
        *_closure_lines(found),
        *_inertia_lines(found),
        *_energy_lines(found.energies),
    ]
    return "".join(f"{line}\n" for line in lines)


def _one_way(counts: dict[str, int]) -> str:
    return ", one-way: elastic motion does not act on rigid motion" if counts["one_way"] else ""


def _dof(counts: dict[str, int]) -> str:
    dof = counts.get("degrees_of_freedom")
    return "" if dof is None else f"degrees of freedom {dof}, "


def _elastic_lines(bodies: list[tuple[str, int, int, float, float]]) -> "Iterator[str]":
    for name, nodes, coordinates, lowest, highest in bodies:
        yield (
            f"  {name}: nodes {nodes}, elastic coordinates {coordinates}, "
            f"{lowest:.4g} to {highest:.4g} Hz with the root held"
        )


def _coordinate_lines(coordinates: list[tuple[str, str, float, float]]) -> "Iterator[str]":
    yield "  at the start: coordinate, its speed"
    width = max(len(name) for name, *_ in coordinates)
    for name, unit, q, u in coordinates[:MOST_COORDINATES]:
        yield f"    {name:<{width}}  {q:14.7g} {unit:<3}  {u:14.7g} {unit}/s"
    if len(coordinates) > MOST_COORDINATES:
        yield f"    and {len(coordinates) - MOST_COORDINATES} more; --json lists all"


def _closure_lines(found: Any) -> "Iterator[str]":
    if not found.gaps:
        return
    yield "  gap of the loops, as given → assembled"
    for name, before, after in found.gaps:
        yield f"    {name}  {before:9.2e} → {after:9.2e} m"
    for name in found.redundant:
        yield f"    closed by others too: {name}"


def _inertia_lines(found: Any) -> "Iterator[str]":
    if found.lightest is not None:
        name, share = found.lightest
        yield (
            f"  mass matrix positive definite; least inertia left: {share:.3g} of its body's own, at '{name}'"
        )


def _energy_lines(energies: dict[str, float]) -> "Iterator[str]":
    if energies:
        yield "  energies at the start: " + ", ".join(
            f"{name} {value:.6g} J" for name, value in energies.items()
        )
