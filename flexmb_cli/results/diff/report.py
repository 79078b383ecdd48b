"""Result of a comparison: counts for every type of column, the worst place, missing entries, and words."""

import math
from collections import Counter
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from ...deck.listing import Listing
from ...errors import visible
from .tolerances import KINDS, Tolerance


def counted(number: int, stem: str, one: str = "", many: str = "s") -> str:
    """Return a number and what is counted: 1 file, 2 files."""
    return f"{number} {stem}{one if number == 1 else many}"


def are(number: int) -> str:
    """Return the verb for a number of things."""
    return "is" if number == 1 else "are"


def agreeing(number: int, verb: str) -> str:
    """Return the verb of a number of things: 1 differs, 2 differ."""
    return f"{verb}s" if number == 1 else verb


SHOWN_MISSING = 20
SHOWN_WORDS = 5


@dataclass(frozen=True)
class Found:
    """One place at which two results are compared; `time`, and `line` of a table A, are None without one."""

    section: str
    item: str
    column: str
    time: float | None
    a: float
    b: float
    distance: float
    line: int | None = None

    @property
    def sentence(self) -> str:
        """The place and both values in one line."""
        words = [word for word in (self.section, self.item, self.column) if word]
        where = ", ".join(words) + ("" if self.time is None else f" at t = {self.time:.10g}")
        return f"{where}: {self.a!r} against {self.b!r}"

    def as_dict(self) -> dict[str, Any]:
        """Plain record for `--json`; numbers that JSON does not know are given as text."""
        return {key: _json_number(value) for key, value in vars(self).items() if key != "line"}


@dataclass
class Tally:
    """Numbers of one type: how many were compared and differ, and the largest distances.

    `explained` of the differing ones are known errors; `worst` is the worst of the others.  `unreadable`
    are not compared, since one of the tables has a question mark in their place.
    """

    compared: int = 0
    unreadable: int = 0
    differing: int = 0
    explained: int = 0
    largest: float = 0.0
    worst: Found | None = None

    def as_dict(self) -> dict[str, Any]:
        """Plain record for `--json`."""
        numbers = {"largest": _json_number(self.largest), "worst": self.worst and self.worst.as_dict()}
        return vars(self) | numbers

    def add(
        self,
        differs: np.ndarray,
        distance: np.ndarray,
        known: np.ndarray,
        unreadable: int,
        describe: Callable[..., Any],
    ) -> None:
        """Count a block; `describe(position)` gives the `Found` at an index of the block."""
        self.compared += distance.size - unreadable
        self.unreadable += unreadable
        if not distance.size:
            return
        self.largest = max(self.largest, float(distance.max()))
        count = int(np.count_nonzero(differs))
        if not count:
            return
        self.differing += count
        self.explained += int(np.count_nonzero(differs & known))
        unknown = differs & ~known
        if not unknown.any():
            return
        position = np.unravel_index(int(np.argmax(np.where(unknown, distance, -1.0))), distance.shape)
        if self.worst is None or float(distance[position]) > self.worst.distance:
            self.worst = describe(position)


@dataclass
class Report:
    """Result of `compare`: `a` and `b` are the names of the files.

    `words` counts lines of text that differ; they are a difference only with `words_count`.
    `causes` counts the differences by known errors, `cells` names them, `emulation` describes them.
    `listed` are the first `most_listed` of the others.
    """

    a: str
    b: str
    missing: list[str] = field(default_factory=list)
    tallies: dict[str, Tally] = field(default_factory=dict)
    words: list[str] = field(default_factory=list)
    words_count: bool = False
    explaining: bool = False
    causes: dict[str, int] = field(default_factory=dict)
    cells: list[tuple[str, Found]] = field(default_factory=list)
    emulation: object = None
    most_listed: int = 0
    listed: list[Found] = field(default_factory=list)

    @property
    def equal(self) -> bool:
        """Return whether nothing differs beyond tolerance, nothing is missing, and no words that count
        differ.
        """
        return not self.missing and not self.differing and not (self.words_count and self.words)

    @property
    def compared(self) -> int:
        """Return how many numbers were compared."""
        return sum(tally.compared for tally in self.tallies.values())

    @property
    def unreadable(self) -> int:
        """Return how many numbers were not compared, since `?` stands in their place."""
        return sum(tally.unreadable for tally in self.tallies.values())

    @property
    def differing(self) -> int:
        """Return how many numbers differ beyond tolerance."""
        return sum(tally.differing for tally in self.tallies.values())

    @property
    def explained(self) -> int:
        """Return how many of these are known errors of the historic programs."""
        return sum(tally.explained for tally in self.tallies.values())

    @property
    def exit_code(self) -> int:
        """0: no difference; 1: they differ."""
        return 0 if self.equal else 1

    @property
    def worst(self) -> Found | None:
        """The place of the largest distance among the numbers that differ and are not explained."""
        places = [tally.worst for tally in self.tallies.values() if tally.worst is not None]
        return max(places, key=lambda place: place.distance, default=None)

    def compare(
        self,
        kind: str,
        a: Any,
        b: np.ndarray,
        tolerance: Tolerance,
        describe: Callable[..., Any],
        unit: float | np.ndarray | None = None,
        slack: float | np.ndarray = 0.0,
        known: Sequence[Any] = (),
    ) -> None:
        """Compare two blocks of one type; `describe(position, distance)` gives the `Found` there.

        `unit` and `slack` as in `Tolerance.exceeded`; `known` are pairs (cause, mask of the block).
        """
        if tolerance.ignores:
            return
        differs, distance = tolerance.exceeded(a, b, unit, slack)
        unreadable = np.broadcast_to(False if unit is None else np.isnan(unit), distance.shape)
        differs, distance = differs & ~unreadable, np.where(unreadable, 0.0, distance)
        marked = np.zeros(distance.shape, dtype=bool)
        for cause, mask in known:
            # The first cause that is named for a number counts.
            here = differs & mask & ~marked
            self._explain(cause, here, lambda place: describe(place, float(distance[place])))
            marked |= mask
        self._list(differs & ~marked, lambda place: describe(place, float(distance[place])))
        tally = self.tallies.setdefault(kind, Tally())
        count = int(np.count_nonzero(unreadable))
        tally.add(
            differs, distance, marked, count, lambda position: describe(position, float(distance[position]))
        )

    def _list(self, here: np.ndarray, describe: Callable[..., Any]) -> None:
        room = self.most_listed - len(self.listed)
        if room > 0:
            places = np.argwhere(here)[:room]
            self.listed += [describe(tuple(place)) for place in places.tolist()]

    def _explain(self, cause: str, here: np.ndarray, describe: Callable[..., Any]) -> None:
        places = list(zip(*np.nonzero(here), strict=True))
        if places:
            self.causes[cause] = self.causes.get(cause, 0) + len(places)
            self.cells += [(cause, describe(place)) for place in places]

    def text(self) -> str:
        """Summary for a reader: what is missing, a table of types, the worst place."""
        lines = list(self.missing[:SHOWN_MISSING])
        if len(self.missing) > SHOWN_MISSING:
            lines.append(f"… and {len(self.missing) - SHOWN_MISSING} more of this sort")
        lines += [f"words: {sentence}" for sentence in self.words[:SHOWN_WORDS]]
        if len(self.words) > SHOWN_WORDS:
            lines.append(f"words: … and {len(self.words) - SHOWN_WORDS} more")
        if self.differing:
            lines += self._table()
            lines += [f"known: {cause}: {count} numbers" for cause, count in self.causes.items()]
            lines += self._list_lines()
            if self.worst:
                lines.append(f"worst: {self.worst.sentence}")
        lines.append(self._verdict())
        return "\n".join(lines) + "\n"

    def as_dict(self) -> dict[str, Any]:
        """Plain record for `--json`."""
        return {
            "a": self.a,
            "b": self.b,
            "equal": self.equal,
            "compared": self.compared,
            "unreadable": self.unreadable,
            "differing": self.differing,
            "explained": self.explained,
            "known_errors": [{"cause": cause, "count": count} for cause, count in self.causes.items()],
            "explained_cells": [{"cause": cause} | cell.as_dict() for cause, cell in self.cells],
            "missing": self.missing,
            "words": self.words,
            "listed": [cell.as_dict() | {"line": cell.line} for cell in self.listed],
            "worst": self.worst and self.worst.as_dict(),
            "kinds": {kind: self.tallies[kind].as_dict() for kind in self._kinds()},
        }

    @property
    def unread(self) -> str:
        """Return how many numbers were not compared, to be added to a sentence; empty where all were."""
        return f"; not compared: {self.unreadable} marked ?" if self.unreadable else ""

    def _kinds(self) -> list[str]:
        return [kind for kind in KINDS if kind in self.tallies]

    def _table(self) -> list[str]:
        known = self.explaining
        rows = [("type", "compared", "differ", *known * ("known",), "largest", "worst place")]
        for kind in self._kinds():
            tally = self.tallies[kind]
            counts = (tally.compared, tally.differing, *known * (tally.explained,))
            place = tally.worst.sentence if tally.worst else ""
            rows.append((kind, *map(str, counts), f"{tally.largest:.3g}", place))
        widths = [max(map(len, column)) for column in zip(*rows, strict=True)]
        return [_aligned(row, widths) for row in rows]

    def _list_lines(self) -> list[str]:
        """Return the numbers listed, in the order of A's lines, as `FILE:LINE: place`."""
        lines = []
        for difference in sorted(self.listed, key=lambda one: one.line or 0):
            place = f"{visible(self.a)}:{difference.line}" if difference.line else "differs"
            lines.append(
                f"{place}: {difference.sentence}{' (only the sign)' if difference.a == -difference.b else ''}"
            )
        left = self.differing - self.explained - len(self.listed)
        return [*lines, f"… and {left} more"] if lines and left else lines

    def _verdict(self) -> str:
        lines = len(self.words)
        words = f"; {counted(lines, 'line')} of words {agreeing(lines, 'differ')}" if lines else ""
        words = f"{self.unread}{words}"
        files = f"{visible(self.a)}, {visible(self.b)}"
        if not self.missing and not self.differing:
            return f"{files}: no difference in {self.compared} numbers{words}"
        known = f", {self.explained} of them by known errors" if self.explaining else ""
        counts = f"{self.differing} of {self.compared} numbers differ{known}"
        missing = counted(len(self.missing), "missing entr", "y", "ies")
        return f"{files}: {counts}, {missing}{words}"


def _aligned(row: tuple[str, ...], widths: list[int]) -> str:
    """The type to the left, figures to the right, the place as it is."""
    figures = [cell.rjust(width) for cell, width in zip(row[1:-1], widths[1:-1], strict=True)]
    return "  ".join([row[0].ljust(widths[0]), *figures, row[-1]]).rstrip()


def _json_number(value: Any) -> Any:
    return str(value) if isinstance(value, float) and not math.isfinite(value) else value


# Attributes of HDF5 results that hold words; `status` and `analysis` count without `--words`.
WORDS_OF_RESULTS = ("notes", "settings", "options", "message")


def compare_words(a: Listing, b: Listing) -> list[str]:
    """Return a sentence for every line of words that only one of the listings has in its place."""
    if len(a.words) == len(b.words):
        pairs = zip(a.words, b.words, strict=True)
        return [f"line {line}: {one!r} against {two!r}" for (line, one), (_, two) in pairs if one != two]
    return [*_only_in(a, b), *_only_in(b, a)]


def _only_in(a: Listing, b: Listing) -> Iterator[str]:
    """Yield the lines that `a` has more often than `b`: where lines are missing, places do not match."""
    left = Counter(text for _, text in b.words)
    for line, text in a.words:
        if left[text]:
            left[text] -= 1
        else:
            yield f"line {line}: {text!r} is only in {a.name}"


def compare_names(name: str, first: np.ndarray, second: np.ndarray) -> list[str]:
    """Return a sentence for every text that differs in two datasets `name` of equal shape."""
    pairs = enumerate(zip(first.ravel().tolist(), second.ravel().tolist(), strict=True), 1)
    return [f"/{name}, row {row}: {_plain(a)!r} against {_plain(b)!r}" for row, (a, b) in pairs if a != b]


def _plain(text: bytes) -> str:
    return text.decode("utf-8", errors="replace") if isinstance(text, bytes) else str(text)
