"""Compare two OUT tables number by number."""

from collections.abc import Callable, Iterator
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from ...deck.listing import LARGEST_INDEX, Listing, Section, TableError, plain_text, read_bytes
from ...deck.table_columns import SECTIONS
from ...dialects.recognise import every_dialect
from ...errors import Fault
from .echo import as_stars, compare_echo
from .report import Found, Report, are, counted
from .tolerances import Tolerances

if TYPE_CHECKING:
    from .emulated import Emulation


def matching_rows(report: Report, a: Listing, b: Listing) -> tuple[np.ndarray, np.ndarray]:
    """Row numbers of `a` and `b` that belong together: all in order, or by time when their numbers differ."""
    if len(a.time) == len(b.time):
        rows = np.arange(len(a.time))
        return rows, rows
    rows_a, rows_b = common_places(_occurrences(a.time), _occurrences(b.time))
    for listing, other, rows in ((a, b, rows_a), (b, a, rows_b)):
        alone = np.setdiff1d(np.arange(len(listing.time)), rows)
        if alone.size:
            times = few([f"{listing.time[row]:.10g}" for row in alone])
            count = counted(alone.size, "row")
            report.missing.append(
                f"{count} of {listing.name} {are(alone.size)} not in {other.name}: t = {times}"
            )
    return rows_a, rows_b


def _occurrences(time: np.ndarray) -> list[tuple[float, int]]:
    """Pairs (time, how often it came before), since three decimals print several rows alike."""
    seen: dict[float, int] = {}
    pairs = []
    for value in time.tolist():
        seen[value] = seen.get(value, -1) + 1
        pairs.append((value, seen[value]))
    return pairs


def common_places(keys_a: list[Any], keys_b: list[Any]) -> tuple[Any, ...]:
    """Positions of the keys that both lists have, in the order of the first."""
    place = {key: row for row, key in enumerate(keys_b)}
    rows = [(row, place[key]) for row, key in enumerate(keys_a) if key in place]
    return tuple(
        np.array(column, dtype=np.int64) for column in (zip(*rows, strict=True) if rows else ((), ()))
    )


def few(words: list[str], most: int = 3) -> str:
    """Return the first words, and how many more there are."""
    return ", ".join(words[:most]) + (f" and {len(words) - most} more" if len(words) > most else "")


# The parts of the sections that change sign with the Euler parameters.
SIGNED_KINDS = ("euler", "euler_rate", "euler_acceleration")


def compare_listings(
    a: Listing,
    b: Listing,
    tolerances: Tolerances,
    same_attitude: bool = False,
    explain: bool = False,
    emulation: "Emulation | None" = None,
    listed: int = 0,
) -> Report:
    """Compare two listings of the same form that were read; see `compare.compare`."""
    report = Report(a.name, b.name, explaining=explain, emulation=emulation, most_listed=listed)
    compare_echo(report, a, b, tolerances)
    rows_a, rows_b = matching_rows(report, a, b)
    _compare_times(report, a, b, rows_a, rows_b, tolerances)
    flips = _flips((a, b), (rows_a, rows_b)) if same_attitude else None
    for name in [*a.sections, *(name for name in b.sections if name not in a.sections)]:
        if name in a.sections and name in b.sections:
            _compare_section(report, name, (a, b), (rows_a, rows_b), tolerances, flips)
        else:
            report.missing.append(
                f"{name}: there is no such section in {(b if name in a.sections else a).name}"
            )
    if a.failed != b.failed:
        report.missing.append(f"only {(a if a.failed else b).name} ends with {a.form.mark_of_failure}")
    return report


def read_listing(path: Path | str) -> Listing:
    """The listing or series at `path`; raises `TableError` when it is none."""
    name = str(path)
    text, dialects = plain_text(read_bytes(path)), list(every_dialect())
    for references in ("listing_readers", "series_readers"):
        for dialect in dialects:
            for listing in dialect.listings(name, text, getattr(dialect, references)):
                return listing
    signs = ", ".join(dialect.listing_signs for dialect in reversed(dialects) if dialect.listing_signs)
    message = f"no OUT table is found in it: there is {signs}"
    raise TableError(name, [Fault("error", message, id="DIFF-010")])


def _compare_times(
    report: Report, a: Listing, b: Listing, rows_a: np.ndarray, rows_b: np.ndarray, tolerances: Tolerances
) -> Any:
    if not len(a.time) and not len(b.time):
        return
    time_a, time_b = a.time[rows_a], b.time[rows_b]

    def describe(position: tuple[int], distance: float) -> Found:
        row = position[0]
        return Found("time", f"row {row + 1}", "", None, float(time_a[row]), float(time_b[row]), distance)

    report.compare("time", time_a, time_b, tolerances.of("time"), describe, max(a.time_unit, b.time_unit))


def _compare_section(
    report: Report,
    name: str,
    listings: tuple[Listing, Listing],
    rows: tuple[np.ndarray, np.ndarray],
    tolerances: Tolerances,
    flips: np.ndarray | None,
) -> None:
    sections = [listing.sections[name] for listing in listings]
    picks = _matching_lines(name, listings, rows)
    first = sections[0]
    _report_lines(report, name, listings, rows, picks)
    shared = [column for column in first.columns if column in sections[1].columns]
    _report_columns(report, name, listings, sections)
    values, units = zip(*map(_shared_block, sections, picks, (shared, shared)), strict=True)
    kinds = np.array([first.kinds[first.columns.index(column)] for column in shared])
    if first.edits:
        edits = [first.edits[first.columns.index(column)] for column in shared]
        values = as_stars(values[0], values[1], lambda position: edits[position[1]])
    if flips is not None:
        signs = np.where(np.isin(_keys(first, picks[0]), flips), -1.0, 1.0)
        values = values[0], np.where(np.isin(kinds, SIGNED_KINDS), values[1] * signs[:, None], values[1])
    unit = np.maximum(*units)
    # Where one file prints fewer decimals, the other can agree no better than to half a unit; numbers with
    # exponents all have the same number of digits.
    slack = np.where((units[0] == units[1]) | (not listings[0].form.fewer_decimals), 0.0, 0.5 * unit)
    known = _emulated_errors(report, name, first, picks[0], shared, values[0], units[0])
    known += _known_errors(report, name, listings[0], picks[0], shared)
    for kind in dict.fromkeys(kinds.tolist()):
        columns = np.flatnonzero(kinds == kind)
        describe = _describer(name, listings[0], picks[0], columns, shared, values)
        a, b, unit_here, slack_here = (block[:, columns] for block in (*values, unit, slack))
        marked = [(cause, mask[:, columns]) for cause, mask in known]
        heads = [shared[column] for column in columns]
        special = _quantity_places(name, first, picks[0], heads, tolerances)
        tolerance = tolerances.of_places(kind, a.shape, special)
        report.compare(kind, a, b, tolerance, describe, unit_here, slack_here, marked)


def _quantity_places(
    name: str, section: Section, pick: np.ndarray, heads: list[str], tolerances: Tolerances
) -> Iterator[Any]:
    """Pairs (index of lines and column, tolerance) of quantities such as `velocity.body 3.dX`."""
    if not tolerances.quantities:
        return
    items = np.array([section.name_of(line) for line in pick], dtype=object)
    for item in dict.fromkeys(items.tolist()):
        for column, head in enumerate(heads):
            special = tolerances.named(".".join(word for word in (name, item, head) if word))
            if special:
                yield (items == item, column), special


def _shared_block(section: Section, pick: np.ndarray, shared: list[str]) -> tuple[np.ndarray, np.ndarray]:
    """Values and units of the last digits, both (lines, columns), of the lines `pick`."""
    columns = [section.columns.index(column) for column in shared]
    units = np.broadcast_to(section.units, section.values.shape)
    return section.values[pick][:, columns], units[pick][:, columns]


def _known_errors(
    report: Report, name: str, listing: Listing, pick: np.ndarray, shared: list[str]
) -> list[Any]:
    """Causes, each with the mask (lines, columns) of the cells that it spoils."""
    if not report.explaining:
        return []
    section = listing.sections[name]
    columns = np.array([section.columns.index(column) + 1 for column in shared])
    index, step = section.index[pick, None], section.step[pick, None]
    errors = [error for error in listing.form.known_errors(report.a, report.b) if error.section == name]
    places = [f"{error.deck}, {name}, {section.item} {error.index}" for error in errors]
    return [
        (f"{place}: {error.cause}", error.holds(index, columns, step))
        for place, error in zip(places, errors, strict=True)
    ]


def _emulated_errors(
    report: Any, name: Any, section: Section, pick: np.ndarray, shared: list[str], printed: Any, unit: Any
) -> list[tuple[str, np.ndarray]]:
    """The same by a run of the deck with the errors of the program, the cells that they give."""
    if report.emulation is None:
        return []
    columns = [SECTIONS[name].names.index(column) for column in shared]
    step, index = section.step[pick], section.index[pick]
    causes = report.emulation.causes(name, step, index, columns, printed, unit)
    return [(f"{name}: {cause}", mask) for cause, mask in causes]


def _describer(
    name: str,
    listing: Listing,
    pick: np.ndarray,
    columns: np.ndarray,
    shared: list[str],
    values: tuple[np.ndarray, np.ndarray],
) -> Callable[..., Any]:
    section: Section = listing.sections[name]

    def describe(position: tuple[int, int], distance: float) -> Found:
        row, column = position[0], columns[position[1]]
        line = pick[row]
        time = float(listing.time[section.step[line]])
        a, b = (float(block[row, column]) for block in values)
        return Found(
            name, section.name_of(line), shared[column], time, a, b, distance, int(section.line[line])
        )

    return describe


def _matching_lines(
    name: str, listings: tuple[Listing, Listing], rows: tuple[np.ndarray, np.ndarray]
) -> tuple[np.ndarray, np.ndarray]:
    """Line numbers of the section in both tables that belong to the same row and item."""
    keys = [_ranked(listing, name, chosen) for listing, chosen in zip(listings, rows, strict=True)]
    if (
        all(np.array_equal(left, right) for left, right in zip(*keys, strict=True))
        and (keys[0][0] >= 0).all()
    ):
        everything = np.arange(len(keys[0][0]))
        return everything, everything
    pairs = [list(zip(rank.tolist(), index.tolist(), strict=True)) for rank, index in keys]
    return common_places(
        *[[pair if pair[0] >= 0 else ("alone", *pair, k) for pair in pairs[k]] for k in (0, 1)]
    )


def _ranked(listing: Listing, name: str, chosen: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """For every line of the section: its row among the rows that both tables have (else -1), and its item."""
    section = listing.sections[name]
    rank = np.full(len(listing.time), -1)
    rank[chosen] = np.arange(len(chosen))
    return rank[section.step], section.index


def _report_lines(
    report: Report,
    name: str,
    listings: tuple[Listing, Listing],
    rows: tuple[np.ndarray, np.ndarray],
    picks: tuple[np.ndarray, np.ndarray],
) -> None:
    """Lines of rows that both tables have, but of a body or point that one of them lacks."""
    for k, (listing, other) in enumerate((listings, listings[::-1])):
        section = listing.sections[name]
        rank, _ = _ranked(listing, name, rows[k])
        alone = np.setdiff1d(np.flatnonzero(rank >= 0), picks[k])
        if alone.size:
            times = [f"t = {listing.time[section.step[n]]:.10g}" for n in alone]
            names = [section.name_of(n) for n in alone]
            places = [f"{name} at {t}" if name else t for name, t in zip(names, times, strict=True)]
            lines = f"{counted(alone.size, 'line')} of {listing.name} {are(alone.size)} not in {other.name}"
            report.missing.append(f"{name}: {lines}: {few(places)}")


def _report_columns(
    report: Report, name: str, listings: tuple[Listing, Listing], sections: list[Section]
) -> None:
    for k in (0, 1):
        alone = [column for column in sections[k].columns if column not in sections[1 - k].columns]
        if alone:
            report.missing.append(f"{name}: {listings[1 - k].name} has no column {', '.join(alone)}")


def _flips(listings: tuple[Listing, Listing], rows: tuple[np.ndarray, np.ndarray]) -> np.ndarray:
    """The lines of `a` whose Euler parameters point against b's, as keys of row and body."""
    if any("position" not in listing.sections for listing in listings):
        return np.array([], dtype=np.int64)
    pick_a, pick_b = _matching_lines("position", listings, rows)
    section = listings[0].sections["position"]
    p_a, p_b = (
        _attitudes(x.sections["position"])[pick] for x, pick in zip(listings, (pick_a, pick_b), strict=True)
    )
    with np.errstate(invalid="ignore"):
        # Without the components that are unreadable: p and -p agree or differ in all.
        against = np.nansum(p_a * p_b, axis=1) < 0
    return _keys(section, pick_a)[against]


def _attitudes(section: Section) -> np.ndarray:
    columns = [k for k, kind in enumerate(section.kinds) if kind == "euler"]
    return section.values[:, columns] if len(columns) == 4 else np.zeros((len(section.values), 4))


def _keys(section: Section, lines: np.ndarray) -> np.ndarray:
    return section.step[lines] * (LARGEST_INDEX + 1) + section.index[lines]
