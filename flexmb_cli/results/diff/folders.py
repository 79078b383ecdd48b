"""Compare the results of two folders, or of two patterns of names: files of one name belong together."""

import os
import re
from collections.abc import Callable, Sequence
from fnmatch import fnmatch
from pathlib import PurePath
from typing import Any

from ...errors import BAD_INPUT, FlexmbError, compiler_style, visible
from ...quick_dataclass import dataclass, field
from ..files.file_names import STALE
from .counts import agreeing, counted
from .forms import CSV, HDF5, LISTING, MATLAB, form_of
from .report import Report

WILD = re.compile(r"[*?[]")
# A table for print is known by its name or by its content; these are the names that runs give.
RESULT_NAME = re.compile(r"OUT.*|.*\.(OUT|T2|T3|h5|csv|tsv|mat)")
EXPORTS = (".csv", ".tsv", ".mat")


@dataclass(frozen=True)
class Pair:
    """Files of one name; `a` or `b` is None where there is none."""

    name: str
    a: str | None
    b: str | None


@dataclass
class Compared:
    """Result of one pair: its report, the file that is missing, or why it cannot be read."""

    pair: Pair
    report: Report | None = None
    missing: str = ""
    failure: FlexmbError | None = None
    updated: bool = False
    new: bool = False  # there was no reference

    @property
    def equal(self) -> bool:
        """Return whether the results are there and do not differ."""
        return self.report is not None and self.report.equal

    @property
    def exit_code(self) -> int:
        """0: no difference; 1: they differ, or one is missing; 2: one cannot be read."""
        if self.failure is not None:
            return self.failure.exit_code
        return 0 if self.equal or self.updated else 1

    @property
    def sentence(self) -> str:
        """Return how it ended, in one or several lines."""
        if self.failure is not None:
            lines = getattr(self.failure, "lines", ())
            return compiler_style(self.failure.file or self.pair.name, self.failure.faults, lines) + "\n"
        if not self.report:
            return f"{visible(self.missing)}\n"
        # What differs is read with the name of its file in mind.
        return f"{visible(self.pair.name)}\n{self.report.text()}"

    def as_dict(self) -> dict[str, Any]:
        """Plain record for `--json`."""
        record: dict[str, Any] = {
            "name": self.pair.name,
            "a": self.pair.a,
            "b": self.pair.b,
            "equal": self.equal,
        }
        if self.failure is not None:
            record["faults"] = [fault.as_dict() for fault in self.failure.faults]
        if self.missing:
            record["missing"] = [self.missing]
        return (self.report.as_dict() if self.report else {}) | record | {"updated": self.updated}


@dataclass
class Summary:
    """All pairs of two folders, in the order of their names; `passed_over`: names of other files.

    `special`: names of links to folders, pipes, devices and sockets, which are neither followed nor opened.
    """

    a: str
    b: str
    compared: list[Compared] = field(default_factory=list)
    passed_over: list[str] = field(default_factory=list)
    special: list[str] = field(default_factory=list)

    @property
    def exit_code(self) -> int:
        """The largest of the pairs; 2 where there is nothing to compare."""
        return max((pair.exit_code for pair in self.compared), default=BAD_INPUT)

    @property
    def verdict(self) -> str:
        """One line: how many files were compared, differ, are missing or cannot be read."""
        special = [f"{counted(len(self.special), 'special file')} passed over"] * bool(self.special)
        if not self.compared:
            reported = ", ".join(["error: no results to compare", *special])
            return f"{visible(self.a)}, {visible(self.b)}: {reported}\n"
        missing = sum(bool(pair.missing) for pair in self.compared)
        failed = sum(pair.failure is not None for pair in self.compared)
        differ = sum(pair.report is not None and not pair.equal for pair in self.compared)
        updated = sum(pair.updated for pair in self.compared)
        read = len(self.compared) - missing - failed
        counts = [f"{counted(read, 'file')} compared", f"{differ} {agreeing(differ, 'differ')}"]
        counts += [f"{missing} missing"]
        counts += [f"{failed} cannot be read"] * bool(failed)
        unreadable = sum(pair.report.unreadable for pair in self.compared if pair.report is not None)
        counts += [f"{counted(unreadable, 'number')} marked ? not compared"] * bool(unreadable)
        counts += [f"{counted(updated, 'reference')} updated"] * bool(updated)
        counts += [f"{counted(len(self.passed_over), 'other file')} passed over"] * bool(self.passed_over)
        counts += special
        return f"{visible(self.a)}, {visible(self.b)}: {', '.join(counts)}\n"

    def as_dict(self) -> dict[str, Any]:
        """Plain record for `--json`."""
        return {
            "a": self.a,
            "b": self.b,
            "equal": all(pair.equal for pair in self.compared) and bool(self.compared),
            "exit_code": self.exit_code,
            "files": [pair.as_dict() for pair in self.compared],
            "passed_over": self.passed_over,
            "special": self.special,
        }


def is_many(path: str) -> bool:
    """Return whether `path` is a folder, or a pattern that is no name of a file."""
    return os.path.isdir(path) or (bool(WILD.search(path)) and not os.path.lexists(path))


def matched(a: str, b: str) -> tuple[list[Pair], list[str]]:
    """Return the files of `a` and `b` by name, in order, and the names of what is no regular file.

    The name of a file is its path behind the folder, or behind the last folder without a wildcard.  An export
    belongs to the HDF5 result of its stem.
    """
    (files_a, special_a), (files_b, special_b) = _files(a), _files(b)
    partners = {name: _result_of(name) for name in files_a if _result_of(name) in files_b}
    found = []
    for name in sorted(files_a.keys() | files_b.keys()):
        partner = name if name in files_b else partners.get(name, name)
        if name in files_a or name not in partners.values():
            found.append(Pair(name, files_a.get(name), files_b.get(partner) if partner is not None else None))
    return found, sorted(special_a | special_b)


def are_same(pairs: Sequence[Pair]) -> bool:
    """Return whether all pairs are of one file each: such a comparison proves nothing."""
    return bool(pairs) and all(
        one and other and os.path.exists(one) and os.path.exists(other) and os.path.samefile(one, other)
        for one, other in ((pair.a, pair.b) for pair in pairs)
    )


def _result_of(name: str) -> str | None:
    """Name of the HDF5 result from which an export comes; None for other files."""
    path = PurePath(name)
    return path.with_suffix(".h5").as_posix() if path.suffix in EXPORTS else None


def _files(path: str) -> tuple[dict[str, str], set[str]]:
    """Return the regular files of a folder or of a pattern by name, and the names of what else matches.

    Hidden files are left out.  Each folder is read once, and a link to a folder is not followed: it may lead
    back here, or anywhere.
    """
    folder, parts = (path, ("**",)) if os.path.isdir(path) else _split(path)
    files: dict[str, str] = {}
    special: set[str] = set()
    waiting, seen = [("", parts)], set()
    while waiting:
        place = waiting.pop()
        if place in seen:
            continue
        seen.add(place)
        inner, (head, *rest) = place
        waiting += [(inner, tuple(rest))] if head == "**" and rest else []
        for name in _names(folder, inner, head, special):
            whole = os.path.join(folder, name)
            deeper = place[1] if head == "**" else tuple(rest)
            is_folder, last = os.path.isdir(whole), not rest
            if is_folder and not os.path.islink(whole):
                waiting += [(name, deeper)] if deeper else []
            elif last and os.path.isfile(whole):
                files[PurePath(name).as_posix()] = whole
            elif last or is_folder:
                special.add(PurePath(name).as_posix())
    return files, special


def _names(folder: str, inner: str, pattern: str, special: set[str]) -> list[str]:
    """Return what fits the pattern in a folder; one that cannot be read is added to `special`."""
    try:
        names = os.listdir(os.path.join(folder, inner) or ".")
    except OSError:
        special.add(PurePath(inner).as_posix())
        return []
    shown = [name for name in names if not name.startswith(".") or pattern.startswith(".")]
    return [os.path.join(inner, name) for name in shown if fnmatch(name, pattern)]


def _split(pattern: str) -> tuple[str, tuple[str, ...]]:
    """The folder before the first wildcard, and the parts behind it."""
    parts = PurePath(pattern).parts
    first = next(k for k, part in enumerate(parts) if WILD.search(part))
    return os.path.join("", *parts[:first]), parts[first:]


def compare_many(summary: Summary, pairs: Sequence[Pair], compare_pair: Callable[[Pair], Report]) -> None:
    """Compare all results among `pairs`; a file that cannot be read stops no other."""
    for pair in pairs:
        if _is_result(pair):
            summary.compared.append(_compared(pair, compare_pair, summary))
        else:
            summary.passed_over.append(pair.name)


def _compared(pair: Pair, compare_pair: "Callable[..., Any]", summary: Summary) -> Compared:
    if pair.a is None or pair.b is None:
        lacking = summary.a if pair.a is None else summary.b
        stale = f"{pair.name}{STALE}"
        of_earlier = f" ({stale} is of an earlier run)" * os.path.isfile(os.path.join(lacking, stale))
        return Compared(pair, missing=f"{pair.name}: not in {lacking}{of_earlier}")
    try:
        return Compared(pair, compare_pair(pair))
    except FlexmbError as failure:
        if failure.of_the_call:
            raise
        return Compared(pair, failure=failure)


def _is_result(pair: Pair) -> bool:
    """Return whether a pair is to be compared: by its name, or by the content of one of its files."""
    if pair.name.endswith(STALE):
        return False
    if RESULT_NAME.fullmatch(PurePath(pair.name).name):
        return True
    return any(path is not None and _reads_as_result(path) for path in (pair.a, pair.b))


def _reads_as_result(path: str) -> bool:
    from .listings import read_listing

    form = form_of(path)
    if form in (CSV, MATLAB):
        return True
    if form == HDF5:
        return False  # files of ParaView and of other programs; results of runs have names of their own
    try:
        return form == LISTING and read_listing(path) is not None
    except FlexmbError:
        return False
