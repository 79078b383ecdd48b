"""Compare the echoes of the input in two listings."""

from collections.abc import Callable, Sequence
from itertools import groupby
from typing import Any

import numpy as np

from ...deck.fortran_words import overflows
from ...deck.listing import EchoLine, Listing, ListingForm
from .report import Found, Report, compare_words
from .tolerances import Tolerance, Tolerances


def compare_echo(report: Report, a: Listing, b: Listing, tolerances: Tolerances) -> None:
    """Compare what two listings of the same form print of their decks, by titles or by types of lines.

    What has a title may be spread over its lines in another way.
    """
    if not tolerances.of("echo").ignores:
        report.words += compare_words(a, b)
    by_titles = a.form.by_titles
    parts: dict[str, tuple[list[EchoLine], list[EchoLine]]] = {}
    for side, listing in enumerate((a, b)):
        for line in listing.echo:
            parts.setdefault(line.title if by_titles else line.kind, ([], []))[side].append(line)
    for key, lines in parts.items():
        if tolerances.of((lines[0] or lines[1])[0].kind).ignores:
            continue
        counts = [[len(line.values) for line in part] for part in lines]
        sums = [sum(part) for part in counts]
        title = "echo of the input" if key == "echo" else key
        if counts[0] == counts[1] or (by_titles and sums[0] == sums[1]):
            _compare_lines(report, *lines, tolerances, a.form)
        elif sums[0] != sums[1]:
            report.missing.append(f"{title}: {sums[0]} numbers in {a.name}, {sums[1]} in {b.name}")
        else:
            report.missing.append(f"{title}: the numbers of {a.name} and {b.name} stand on different lines")


def as_stars(a: np.ndarray, b: np.ndarray, edit_of: Callable[..., Any]) -> tuple[np.ndarray, np.ndarray]:
    """Both with inf wherever one is stars (inf) and the other would be stars too; `edit_of(position)`."""
    a, b = a.copy(), b.copy()
    for one, other in ((a, b), (b, a)):
        for place in map(tuple, np.argwhere(np.isinf(one) & np.isfinite(other))):
            if overflows(float(other[place]), edit_of(place)):
                other[place] = one[place]
    return a, b


def _compare_lines(
    report: Report,
    lines_a: list[EchoLine],
    lines_b: list[EchoLine],
    tolerances: Tolerances,
    form: ListingForm,
) -> Any:
    """Lines with as many numbers, type by type."""
    flat = _flattened(lines_a), _flattened(lines_b)
    order = sorted(range(len(flat[0])), key=lambda k: flat[0][k][0].kind)
    for kind, group in groupby(order, key=lambda k: flat[0][k][0].kind):
        _compare_kind(report, kind, list(group), flat, tolerances.of(kind), form)


def _flattened(lines: list[EchoLine]) -> list[tuple[EchoLine, int]]:
    """(line, place in the line) of every number."""
    return [(line, place) for line in lines for place in range(len(line.values))]


def _compare_kind(
    report: Report, kind: str, chosen: Sequence[int], flat: Any, tolerance: Tolerance, form: ListingForm
) -> Any:
    places, others = ([part[k] for k in chosen] for part in flat)
    a, b = (np.array([line.values[n] for line, n in part]) for part in (places, others))
    units = [np.array([line.units[n] for line, n in part]) for part in (places, others)]
    unit = np.maximum(*units)
    slack = np.where((units[0] != units[1]) & form.fewer_decimals, 0.5 * unit, 0.0)
    known: tuple[Any, ...] = ()
    if any(line.edits for line, _ in (*places, *others)):

        def edit_of(position: tuple[int, ...]) -> Any:
            (line, number), (other, _) = places[position[0]], others[position[0]]
            return (line.edits or other.edits)[number]

        a, b = as_stars(a, b, edit_of)
        if report.explaining and form.echo_error:
            cause, explains = form.echo_error
            known = ((cause, explains(a, b, unit)),)

    def describe(position: tuple[int, ...], distance: float) -> Found:
        line, number = places[position[0]]
        section, item, column = line.where(number)
        return Found(section, item, column, None, float(a[position]), float(b[position]), distance, line.line)

    report.compare(kind, a, b, tolerance, describe, unit, slack, known)
