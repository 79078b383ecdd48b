"""Compare two OUT tables, or two HDF5 results, number by number."""

import numpy as np

from ..errors import Fault
from .diff_report import Found, Report
from .out_table import LARGEST_INDEX, Listing, Section, TableError, parse_listing, read_bytes
from .tolerances import Tolerances

HDF5_SIGNATURE = b"\x89HDF\r\n\x1a\n"
# The parts of the sections that change sign with the Euler parameters.
SIGNED_KINDS = ("euler", "euler_rate", "euler_acceleration")


def compare(path_a, path_b, tolerances: Tolerances | None = None, same_attitude: bool = False) -> Report:
    """Compare two results of the same format.

    `same_attitude`: Euler parameters p and -p (with their rates) count as equal.  Raises `TableError`
    when a file cannot be read, or when one is an HDF5 result and the other is not.
    """
    tolerances = tolerances or Tolerances()
    kinds = [_is_hdf5(path) for path in (path_a, path_b)]
    if all(kinds):
        from .diff_hdf5 import compare_hdf5

        return compare_hdf5(str(path_a), str(path_b), tolerances, same_attitude)
    if any(kinds):
        other = path_b if kinds[0] else path_a
        message = "this is no HDF5 result, the other file is; compare two tables, or two HDF5 results"
        raise TableError(str(other), [Fault("error", message)])
    listings = [_read_listing(path) for path in (path_a, path_b)]
    return compare_listings(*listings, tolerances, same_attitude)


def compare_listings(a: Listing, b: Listing, tolerances: Tolerances, same_attitude: bool = False) -> Report:
    """Compare two OUT tables that were read."""
    report = Report(a.name, b.name)
    _compare_echo(report, a, b, tolerances)
    rows_a, rows_b = _matching_rows(report, a, b)
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
        report.missing.append(f"only {(a if a.failed else b).name} ends with CONVERGENCE FAILED")
    return report


def _is_hdf5(path):
    if str(path) == "-":
        return False
    try:
        with open(path, "rb") as file:
            return file.read(len(HDF5_SIGNATURE)) == HDF5_SIGNATURE
    except OSError:
        # The reader that opens it again words the fault.
        return False


def _read_listing(path):
    name = str(path)
    listing = parse_listing(name, read_bytes(path))
    if listing is None:
        message = "no OUT table is found in it: there is neither a line TIME= nor an echo of a YOUNG deck"
        raise TableError(name, [Fault("error", message)])
    return listing


def _matching_rows(report, a, b):
    """Row numbers of `a` and `b` that belong together: all in order, or by time when their numbers differ."""
    if len(a.time) == len(b.time):
        rows = np.arange(len(a.time))
        return rows, rows
    rows_a, rows_b = _common(_occurrences(a.time), _occurrences(b.time))
    for listing, other, rows in ((a, b, rows_a), (b, a, rows_b)):
        alone = np.setdiff1d(np.arange(len(listing.time)), rows)
        if alone.size:
            times = _few([f"{listing.time[row]:.10g}" for row in alone])
            report.missing.append(f"{alone.size} rows of {listing.name} are not in {other.name}: t = {times}")
    return rows_a, rows_b


def _occurrences(time):
    """Pairs (time, how often it came before), since three decimals print several rows alike."""
    seen: dict[float, int] = {}
    pairs = []
    for value in time.tolist():
        seen[value] = seen.get(value, -1) + 1
        pairs.append((value, seen[value]))
    return pairs


def _common(keys_a, keys_b):
    """Positions of the keys that both lists have, in the order of the first."""
    place = {key: row for row, key in enumerate(keys_b)}
    rows = [(row, place[key]) for row, key in enumerate(keys_a) if key in place]
    return tuple(
        np.array(column, dtype=np.int64) for column in (zip(*rows, strict=True) if rows else ((), ()))
    )


def _compare_times(report, a, b, rows_a, rows_b, tolerances):
    time_a, time_b = a.time[rows_a], b.time[rows_b]

    def describe(position, distance):
        row = position[0]
        return Found("time", f"row {row + 1}", "", None, float(time_a[row]), float(time_b[row]), distance)

    report.compare("time", time_a, time_b, tolerances.of("time"), describe, max(a.time_unit, b.time_unit))


def _compare_section(report, name, listings, rows, tolerances, flips):
    sections = [listing.sections[name] for listing in listings]
    pick_a, pick_b = _matching_lines(name, listings, rows)
    first, second = sections
    _report_lines(report, name, listings, rows, (pick_a, pick_b))
    shared = [column for column in first.columns if column in second.columns]
    _report_columns(report, name, listings, sections)
    values = [
        section.values[pick][:, [section.columns.index(column) for column in shared]]
        for section, pick in ((first, pick_a), (second, pick_b))
    ]
    kinds = np.array([first.kinds[first.columns.index(column)] for column in shared])
    units = np.maximum(*[section.units[[section.columns.index(c) for c in shared]] for section in sections])
    if flips is not None:
        signs = np.where(np.isin(_keys(first, pick_a), flips), -1.0, 1.0)
        values[1] = np.where(np.isin(kinds, SIGNED_KINDS), values[1] * signs[:, None], values[1])
    for kind in dict.fromkeys(kinds.tolist()):
        columns = np.flatnonzero(kinds == kind)
        describe = _describer(name, listings[0], pick_a, columns, shared, values)
        a, b = (block[:, columns] for block in values)
        report.compare(kind, a, b, tolerances.of(kind), describe, units[columns])


def _describer(name, listing, pick, columns, shared, values):
    section: Section = listing.sections[name]

    def describe(position, distance):
        row, column = position[0], columns[position[1]]
        line = pick[row]
        item = f"{'point' if name == 'point' else 'body'} {section.index[line]}"
        time = float(listing.time[section.step[line]])
        a, b = (float(block[row, column]) for block in values)
        return Found(name, item, shared[column], time, a, b, distance)

    return describe


def _matching_lines(name, listings, rows):
    """Line numbers of the section in both tables that belong to the same row and item."""
    keys = [_ranked(listing, name, chosen) for listing, chosen in zip(listings, rows, strict=True)]
    if (
        all(np.array_equal(left, right) for left, right in zip(*keys, strict=True))
        and (keys[0][0] >= 0).all()
    ):
        everything = np.arange(len(keys[0][0]))
        return everything, everything
    pairs = [list(zip(rank.tolist(), index.tolist(), strict=True)) for rank, index in keys]
    return _common(*[[pair if pair[0] >= 0 else ("alone", *pair, k) for pair in pairs[k]] for k in (0, 1)])


def _ranked(listing, name, chosen):
    """For every line of the section: its row among the rows that both tables have (else -1), and its item."""
    section = listing.sections[name]
    rank = np.full(len(listing.time), -1)
    rank[chosen] = np.arange(len(chosen))
    return rank[section.step], section.index


def _report_lines(report, name, listings, rows, picks):
    """Lines of rows that both tables have, but of a body or point that one of them lacks."""
    for k, (listing, other) in enumerate((listings, listings[::-1])):
        section = listing.sections[name]
        rank, _ = _ranked(listing, name, rows[k])
        alone = np.setdiff1d(np.flatnonzero(rank >= 0), picks[k])
        if alone.size:
            item = "point" if name == "point" else "body"
            places = [f"{item} {section.index[n]} at t = {listing.time[section.step[n]]:.10g}" for n in alone]
            lines = f"{name}: {alone.size} lines of {listing.name} are not in {other.name}"
            report.missing.append(f"{lines}: {_few(places)}")


def _report_columns(report, name, listings, sections):
    for k in (0, 1):
        alone = [column for column in sections[k].columns if column not in sections[1 - k].columns]
        if alone:
            report.missing.append(f"{name}: {listings[1 - k].name} has no column {', '.join(alone)}")


def _flips(listings, rows):
    """The lines of `a` whose Euler parameters point against b's, as keys of row and body."""
    if any("position" not in listing.sections for listing in listings):
        return np.array([], dtype=np.int64)
    pick_a, pick_b = _matching_lines("position", listings, rows)
    section = listings[0].sections["position"]
    p_a, p_b = (
        _attitudes(x.sections["position"])[pick] for x, pick in zip(listings, (pick_a, pick_b), strict=True)
    )
    with np.errstate(invalid="ignore"):
        against = (p_a * p_b).sum(axis=1) < 0
    return _keys(section, pick_a)[against]


def _attitudes(section):
    columns = [k for k, kind in enumerate(section.kinds) if kind == "euler"]
    return section.values[:, columns] if len(columns) == 4 else np.zeros((len(section.values), 4))


def _keys(section, lines):
    return section.step[lines] * (LARGEST_INDEX + 1) + section.index[lines]


def _compare_echo(report, a, b, tolerances):
    tolerance = tolerances.of("echo")
    if tolerance.ignores:
        return
    if [len(line.values) for line in a.echo] != [len(line.values) for line in b.echo]:
        report.missing.append(_echo_sentence(a, b))
        return
    titles = [line.title for line in a.echo for _ in line.values]
    values = [np.array([value for line in x.echo for value in line.values]) for x in (a, b)]
    units = [np.array([unit for line in x.echo for unit in line.units]) for x in (a, b)]

    def describe(position, distance):
        k = position[0]
        return Found("echo", titles[k], "", None, float(values[0][k]), float(values[1][k]), distance)

    if titles:
        report.compare("echo", *values, tolerance, describe, np.maximum(*units))


def _echo_sentence(a, b):
    counts = [sum(len(line.values) for line in x.echo) for x in (a, b)]
    if counts[0] != counts[1]:
        return f"echo of the input: {counts[0]} numbers in {a.name}, {counts[1]} in {b.name}"
    return f"echo of the input: the numbers of {a.name} and {b.name} stand on different lines"


def _few(words, most=3):
    return ", ".join(words[:most]) + (f" and {len(words) - most} more" if len(words) > most else "")
