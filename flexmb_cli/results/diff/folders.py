"""Compare the results of two folders, or of two patterns of names: files of one name belong together."""

import os
import re
from collections.abc import Sequence
from dataclasses import dataclass, field
from fnmatch import fnmatch
from pathlib import PurePath
from typing import Any

from ...errors import BAD_INPUT, FlexmbError, compiler_style, visible
from .report import Report, agreeing, counted

WILD = re.compile(r"[*?[]")
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
    """All `pairs` of two folders, in the order of their names; `passed_over`: names of other files.

    `special`: names of links to folders, pipes, devices and sockets, which are neither followed nor opened.
    """

    a: str
    b: str
    pairs: list[Pair] = field(default_factory=list)
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
            counts = ["error: no results to compare", *special]
            return f"{visible(self.a)}, {visible(self.b)}: {', '.join(counts)}\n"
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


def matched(a: str, b: str) -> Summary:
    """Pair the files of `a` and `b` by name, in order; an export belongs to the HDF5 result of its stem.

    The name of a file is its path after the folder, or after the last folder without a wildcard.
    """
    (files_a, special_a), (files_b, special_b) = _files(a), _files(b)
    summary = Summary(a, b, special=sorted(special_a | special_b))
    partners = {name: _result_of(name) for name in files_a if _result_of(name) in files_b}
    for name in sorted(files_a.keys() | files_b.keys()):
        partner = name if name in files_b else partners.get(name, name) or name
        if name in files_a or name not in partners.values():
            summary.pairs.append(Pair(name, files_a.get(name), files_b.get(partner)))
    return summary


def are_same(pairs: Sequence[Pair]) -> bool:
    """Return whether all pairs are of one file each: such a comparison proves nothing."""
    paths = [(pair.a or "", pair.b or "") for pair in pairs]
    return bool(paths) and all(all(map(os.path.exists, two)) and os.path.samefile(*two) for two in paths)


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
        place = inner, (head, *rest) = waiting.pop()
        if place in seen:
            continue
        seen.add(place)
        waiting += [(inner, tuple(rest))] if head == "**" and rest else []
        try:
            names = [name for name in os.listdir(os.path.join(folder, inner) or ".") if _fits(name, head)]
        except OSError:  # a folder that cannot be read
            names, special = [], special | {inner or path}
        for name in (os.path.join(inner, name) for name in names):
            whole = os.path.join(folder, name)
            if os.path.isdir(whole) and not os.path.islink(whole):
                waiting += [(name, parts) for parts in [place[1] if head == "**" else tuple(rest)] if parts]
            elif not rest and os.path.isfile(whole):
                files[PurePath(name).as_posix()] = whole
            elif not rest or os.path.isdir(whole):
                special.add(PurePath(name).as_posix())
    return files, special


def _fits(name: str, pattern: str) -> bool:
    return (pattern.startswith(".") or not name.startswith(".")) and fnmatch(name, pattern)


def _split(pattern: str) -> tuple[str, tuple[str, ...]]:
    """The folder before the first wildcard, and the parts after it."""
    parts = PurePath(pattern).parts
    first = next(k for k, part in enumerate(parts) if WILD.search(part))
    return os.path.join("", *parts[:first]), parts[first:]
