"""Tolerances of a comparison of two results, for every type of column and for single quantities."""

import math
import re
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field, replace
from fnmatch import fnmatchcase
from typing import Any

import numpy as np

from ...errors import Fault, FlexmbError
from ..files.file_names import HDF5_SIGNATURE

KINDS = (
    "time", "position", "euler", "velocity", "euler_rate", "omega", "acceleration", "euler_acceleration",
    "alpha", "point_position", "point_velocity", "point_acceleration", "speed", "coordinate", "state",
    "count", "length", "mass", "inertia", "stiffness", "force", "torque", "effort", "energy", "elastic",
    "modal", "echo", "audit", "other",
)  # fmt: skip
DEFAULT_ATOL, DEFAULT_RTOL = 1e-12, 1e-9  # of results that were not printed


class ToleranceError(FlexmbError):
    """A `--tol` that cannot be understood (exit 2)."""

    exit_code = 2
    of_the_call = True


@dataclass(frozen=True)
class Tolerance:
    """Values differ when they exceed `atol`, `rtol` (of the larger) and `last_digit` printed units alike.

    Each is a number, or an array that broadcasts to the values.
    """

    atol: float | np.ndarray = 0.0
    rtol: float | np.ndarray = 0.0
    last_digit: int | np.ndarray = 0

    @property
    def ignores(self) -> bool:
        """Return whether nothing of this type counts, not even that it is missing."""
        return bool(np.isinf(self.atol).all())

    def exceeded(
        self,
        a: np.ndarray,
        b: np.ndarray,
        unit: float | np.ndarray | None = None,
        slack: float | np.ndarray = 0.0,
    ) -> tuple[np.ndarray, np.ndarray]:
        """(differs, distance) for values of equal shape; NaN equals NaN only.

        `unit` is one unit of the last printed digit, broadcast to `a`; None for values that were not
        printed.  `slack` is allowed in any case: half a unit where one was printed with fewer decimals.
        """
        with np.errstate(invalid="ignore", over="ignore"):
            distance = np.abs(a - b)
            size = np.maximum(np.abs(a), np.abs(b))
            allowed = np.maximum(self.atol, self.rtol * size)
        same = (a == b) | (np.isnan(a) & np.isnan(b))
        distance = np.where(same, 0.0, np.where(np.isnan(distance), np.inf, distance))
        if unit is not None:
            with np.errstate(invalid="ignore", over="ignore"):
                allowed = np.maximum(np.maximum(allowed, slack), self.last_digit * unit)
                # 0.003 - 0.002 is a little more than 0.001: round-off of printed numbers is no difference.
                allowed = np.where(allowed > 0, allowed + 4 * np.finfo(float).eps * size, allowed)
        # An infinite value has an infinite relative allowance, but equals only itself.
        finite = np.isfinite(distance) | np.isinf(self.atol)
        return ~same & ~((distance <= allowed) & finite), distance


@dataclass(frozen=True)
class Tolerances:
    """`atol`, `rtol` None: what the format asks for; `kinds` overrules single types of columns.

    `quantities` overrules single quantities, by patterns of their names; the last that fits counts.  The
    patterns that fitted anything are put into `used`.
    """

    atol: float | None = None
    rtol: float | None = None
    last_digit: int = 0
    kinds: dict[str, Tolerance] = field(default_factory=dict)
    quantities: dict[str, Tolerance] = field(default_factory=dict)
    used: set[str] = field(default_factory=set, compare=False)

    def with_defaults(self, atol: float, rtol: float) -> "Tolerances":
        """The same with `atol` and `rtol` where none were given."""
        return replace(
            self, atol=atol if self.atol is None else self.atol, rtol=rtol if self.rtol is None else self.rtol
        )

    def without_digits(self) -> "Tolerances":
        """The same for results that were not printed."""
        return replace(self, last_digit=0)

    def of(self, kind: str) -> Tolerance:
        """Tolerance of one type of column."""
        return self.kinds.get(kind) or Tolerance(self.atol or 0.0, self.rtol or 0.0, self.last_digit)

    def of_places(self, kind: str, shape: tuple[int, ...], overrules: Iterable[Any]) -> Tolerance:
        """Tolerance of a block of `shape`; `overrules` are pairs (index of the block, tolerance there)."""
        general = self.of(kind)
        overrules = list(overrules)
        if not overrules:
            return general
        arrays = [np.full(shape, value) for value in (general.atol, general.rtol, general.last_digit)]
        for index, special in overrules:
            for array, value in zip(arrays, (special.atol, special.rtol, special.last_digit), strict=True):
                array[index] = value
        return Tolerance(*arrays)

    def named(self, name: str) -> Tolerance | None:
        """Tolerance of the quantity `name` of its own, if it has one; capitals and blanks do not matter."""
        fitting = [pattern for pattern in self.quantities if fnmatchcase(_folded(name), _folded(pattern))]
        self.used.update(fitting)
        return self.quantities[fitting[-1]] if fitting else None


def parse_kinds(settings: Sequence[Any]) -> dict[str, Tolerance]:
    """Tolerances of single types from `KIND=ATOL` or `KIND=ATOL,RTOL`; "inf" leaves the type out.

    Raises `ToleranceError` with one fault for every setting that cannot be understood.
    """
    kinds, faults = {}, []
    for setting in settings:
        kind, _, figures = setting.partition("=")
        numbers = [_figure(text) for text in figures.split(",")]
        if kind not in KINDS:
            message = f"{setting}: there is no type {kind!r}; the types are {', '.join(KINDS)}"
            faults.append(Fault("error", message, id="DIFF-011"))
        elif None in numbers or len(numbers) > 2:
            message = f"{setting}: write {kind}=ATOL or {kind}=ATOL,RTOL with numbers not below zero"
            faults.append(Fault("error", message, id="DIFF-036"))
        else:
            kinds[kind] = Tolerance(*numbers)
    if faults:
        raise ToleranceError(faults[0].message, tuple(faults), id=faults[0].id)
    return kinds


def _folded(name: str) -> str:
    return name.lower().replace(" ", "_")


def _figure(text: str) -> Any:
    if not re.fullmatch(r"\s*\+?((\d+\.?\d*|\.\d+)(e[-+]?\d+)?|inf)\s*", text, re.IGNORECASE | re.ASCII):
        return None
    figure = float(text)
    # 1e999 is too large for a number, and no way of writing inf.
    return None if math.isinf(figure) and "inf" not in text.lower() else figure


HDF5, CSV, MATLAB, LISTING = "an HDF5 file", "a CSV table", "a MATLAB file", "a table for print"
UNREADABLE = "a file that cannot be opened"
MATLAB_SIGNATURE = b"MATLAB 5.0 MAT-file"
# The heading of the first column that `flexmb export --to csv` and `flexmb table` write, and what follows.
CSV_HEAD = re.compile(rb"\A(?:\xef\xbb\xbf)?\"?time \[s\]\"?([,\t\r\n]|\Z)")
_SIGNATURE_BYTES = 64


def form_of(path: Any) -> str:
    """Return the form of the file at `path`; what is unknown counts as a table for print."""
    if str(path) == "-":
        return LISTING
    try:
        with open(path, "rb") as file:
            begins = file.read(_SIGNATURE_BYTES)
    except OSError:
        # The reader that opens it again words the fault.
        return UNREADABLE
    if begins.startswith(HDF5_SIGNATURE):
        return HDF5
    if begins.startswith(MATLAB_SIGNATURE):
        return MATLAB
    return CSV if CSV_HEAD.match(begins) else LISTING
