"""FMBD.OUT, the echo of a DAFMS deck, and the time series of units 2 and 3.

Transcribed from the FORMAT statements of the DAFMS thesis (Zhao, 1992), appendix C: MAIN, QCONTR,
DFIN, TSYSIN, CDGEAR.  The 1992 program read in single precision, so that its last printed digit may
differ.  It knew no extension cards, and echoes none; its ==WKD== debug lines are dropped.
"""

from collections.abc import Sequence
from itertools import groupby
from typing import TYPE_CHECKING, Any

import numpy as np

from ...deck.edit import SAFE, E, Edit, F, I
from ...deck.fortran_format import Layout
from ...deck.record import Deck, Record
from .beam import full_matrix

if TYPE_CHECKING:
    from ...solvers.tree.analysis import TreeAnalysis


# DFIN adds the weight of the nodes to their forces when it reads them; a GRAV card, which it did not know,
# gives another gravity.
_GRAVITY = (0.0, 9.8, 0.0)
_HEAD = "     {:<30}"
SERIES_FIELDS = (F(12, 7), F(12, 7), *5 * (E(15, 6),))  # FORMAT(2F12.7,5E15.6) of CDGEAR

_AXES, _PARAMETERS = "axis 1,axis 2,axis 3", "e1,e2,e3,e4"
_VECTOR, _QUATERNION = (I(5), *3 * (F(10, 5),)), (I(5), *4 * (F(10, 5),))
# Lines of cards with a record for each body: tag, fields, and type and names of the numbers of a body.
BODY_LINES = {
    "mass": ("BM==", (I(5), F(10, 5)), "mass", "mass"),
    "inertia": ("BII=", _VECTOR, "inertia", _AXES),
    "offset": ("XI==", _VECTOR, "length", _AXES),
    "hinge_point": ("PH==", _VECTOR, "length", _AXES),
    "hinge_node": ("NP==", (I(5), I(10)), "count", "node"),
    "attitude": ("EPT=", _QUATERNION, "euler", _PARAMETERS),
    "hinge_attitude": ("EPL=", _QUATERNION, "euler", _PARAMETERS),
    "force": ("HF==", _VECTOR, "force", _AXES),
    "torque": ("HM==", _VECTOR, "torque", _AXES),
    "mass_centre": ("RC==", _VECTOR, "length", _AXES),
    "pulse": ("IDS", (I(5), I(5), *2 * (F(10, 5),)), "torque", "law,F1,TIME"),
}
_LISTS = {"first_coordinate": "     X(L)", "state": "     Y(L)"}


def echo_text(deck: Deck, layout: str = SAFE) -> str:
    """The whole of FMBD.OUT for `deck`, lines ended by LF; `layout` as in `deck.edit`."""
    page = _Page(deck, layout)
    parts = [page.control()]
    bodies = range(1, deck.one("counts")["N"] + 1)
    parts += [page.flexible_body(k) for k in bodies if page.counts[k]["NUMNP"]]
    parts.append(page.system())
    return "".join(parts)


class _Page:
    """One echo in the making: the deck's records by section, and the layout."""

    def __init__(self, deck: Deck, layout: str):
        self.layout = layout
        self.sections: dict[str, list[Record]] = {}
        for record in deck.records:
            self.sections.setdefault(record.section, []).append(record)
        self.records = deck.records
        self.counts = self.sections["counts"]
        self.heading = self.sections["heading"][0].numbers[0].text.ljust(80) + "\n"

    def line(self, *parts: Any, values: Any) -> str:
        return Layout(*parts, "\n", layout=self.layout).lines(values)

    def listed(self, tag: str, edit: Edit, per_line: int, values: Sequence[Any]) -> str:
        """A list under a FORMAT that reverts: its tag begins every line."""
        chunks = [values[i : i + per_line] for i in range(0, len(values), per_line)]
        return "".join(self.line(tag, *len(chunk) * (edit,), values=chunk) for chunk in chunks)

    def control(self) -> str:
        """Return what MAIN and QCONTR write."""
        size, *bodies = self.counts
        time = self.sections["time"][0]
        return "".join(
            (
                self.line("     ==N==NDM==", I(5), I(5), values=_values(size)),
                self.heading,
                self._dofs(bodies, "NT", "NUMBER OF DOF OF TRANSLATION ="),
                self._dofs(bodies, "NR", "NUMBER OF DOF OF ROTATION    ="),
                self._counted("NUMBER OF NODES IN BODY K    =", [body["NUMNP"] for body in bodies]),
                self._counted("NUMBER OF DOF OF NODE IN BK  =", [body["NDF"] for body in bodies]),
                self._counted("AMOUNT OF INTEGRAL STEP      =", [time["IT"]]),
                self.line(_HEAD.format("LENGTH OF TIME OF ONE STEP   ="), F(10, 5), values=[time["H"]]),
                self._counted("DOF OF THE SYSTEM            =", [_coordinates(bodies)]),
            )
        )

    def _dofs(self, bodies: list[Record], name: str, title: str) -> str:
        keys = (name, *(f"{name}{axis}" for axis in (1, 2, 3)))
        rows = [[k, *(body[key] for key in keys)] for k, body in enumerate(bodies, 1)]
        return self.line(_HEAD.format(title), *5 * (I(5),), values=rows)

    def _counted(self, title: str, values: list[int]) -> str:
        return self.listed(_HEAD.format(title), I(5), 10, values)

    def flexible_body(self, k: int) -> str:
        """Return what DFIN writes for one body."""
        positions = self._nodes("node", k)
        forces = self._nodes("nodal_force", k)
        masses = _values(self._array("bmi", k))
        weighted = [
            [*row[:2], *(f + m * g for f, g in zip(row[2:], self._gravity(), strict=True))]
            for row, m in zip(forces, masses, strict=True)
        ]
        vector = (I(5), I(5), *3 * (F(10, 5),))
        return "".join(
            (
                self.line("  COOR", *vector, values=positions),
                self.line("  =PI=", *vector, values=forces),
                self.line("  NEQ=", I(5), values=_values(self._array("equations", k))),
                self.listed("  =ID=", I(5), 10, _values(self._array("id", k))),
                self.listed("  JDIA", I(5), 10, _values(self._array("counts.jdi", k))),
                self.listed("  BKCP", E(12, 4), 6, _values(self._array("bkp", k))),
                self.line("          ====K====", I(5), values=[k]),
                self.listed("  BMI=", F(10, 5), 10, masses),
                self.line("  PIP=", *vector, values=weighted),
                *(self.listed("  =BK=", E(12, 4), 6, row) for row in self._stiffness(k)),
            )
        )

    def _gravity(self) -> tuple[float, float, float]:
        """Gravity in effect, inertial axes; the last GRAV card counts."""
        given = self.sections.get("gravity")
        return tuple(given[-1][key] for key in ("g1", "g2", "g3")) if given else _GRAVITY

    def _array(self, section: str, k: int) -> Record:
        return next(record for record in self.sections[section] if record.number == k)

    def _nodes(self, section: str, k: int) -> list[list[float]]:
        """Rows K, I and three components; a planar deck gives the last two."""
        rows = []
        for record in self.sections[f"{section}.{k}"]:
            given = _values(record)
            rows.append([k, record.number, *(3 - len(given)) * (0.0,), *given])
        return rows

    def _stiffness(self, k: int) -> list[list[float]]:
        """Rows of the full matrix that the skyline stands for."""
        return full_matrix(_values(self._array("counts.jdi", k)), _values(self._array("bkp", k))).tolist()

    def system(self) -> str:
        """Return what TSYSIN writes, card by card as read, unless NOPR has switched the echo off."""
        text, printing = [], True
        for section, group in groupby(self.records, key=_card):
            records = list(group)
            if section == "echo":
                printing = bool(records[-1]["PRT"])
            elif printing:
                text.append(self._card_text(section, records))
        return "".join(text)

    def _card_text(self, section: str, records: list[Record]) -> str:
        if section == "parent":
            parents = [record["L"] for record in records]
            return self.heading + self.listed("     LC==", I(5), 10, parents)
        if section in _LISTS:
            return self.listed(_LISTS[section], F(10, 5), 5, [record.numbers[0].value for record in records])
        if section in BODY_LINES:
            rows = [[record.number, *_values(record)] for record in records]
            tag, edits, *_ = BODY_LINES[section]
            return self.line(f"     {tag}", *edits, values=rows)
        return ""


def _card(record: Record) -> str:
    """Section of the card a record came with: Y(L) gives speeds and coordinates in one list."""
    return "state" if record.section in ("speed", "coordinate") else record.section


def _values(record: Record) -> list[Any]:
    return [number.value for number in record.numbers]


def _coordinates(bodies: list[Record]) -> int:
    """NS (thesis, eq. 2.4)."""
    return sum(body["NT"] + body["NR"] + body["NUMNP"] * body["NDF"] for body in bodies)


class Series:
    """The time series of units 2 and 3 (listing, CDGEAR), FORMAT(2F12.7,5E15.6).

    Unit 2 holds the time, Y(NS), Y(NS+1), Y(NS+2), unit 3 the time, Y(NS+3), Y(NS+5), Y(NS+6), where
    Y lists the NS speeds and then the NS coordinates; entries that a small model lacks are left out.
    """

    def __init__(self, unit2: Any, unit3: Any, coordinates: int, layout: str = SAFE):
        self.layout = layout
        self.units = (
            (unit2, [coordinates - 1, coordinates, coordinates + 1]),
            (unit3, [coordinates + 2, coordinates + 4, coordinates + 5]),
        )

    def rows(self, time: np.ndarray, q: np.ndarray, y: np.ndarray) -> None:
        """Write the rows of a block: `time` (T,), s; coordinates `q` and speeds `y`, both (T, NS)."""
        state = np.hstack([y, q])
        for unit, columns in self.units:
            chosen = [column for column in columns if column < state.shape[1]]
            unit.write(self._layout(len(chosen)).lines(np.column_stack([time, state[:, chosen]])))

    def failed(self, tolerance: float, end: float, step: float, time: float, state: np.ndarray) -> None:
        """Note on unit 3 that the integration stopped at `time` on the way to `end` with Y = `state`."""
        unit = self.units[1][0]
        head = Layout("  TOL,XEND,H,,METH,MITER,INDEX", *4 * (F(10, 5),), "\n", layout=self.layout)
        unit.write(head.lines([tolerance, end, step, time]))
        for first in range(0, len(state), 7):
            chunk = state[first : first + 7]
            unit.write(Layout("  **Y**", *len(chunk) * (F(10, 5),), "\n", layout=self.layout).lines(chunk))

    def stopped(self) -> None:
        """The same note where nothing is known of the step: rows of a resume file, absolute coordinates."""
        self.units[1][0].write("  TOL,XEND,H,,METH,MITER,INDEX\n")

    def _layout(self, values: int) -> Layout:
        return Layout(*SERIES_FIELDS[: values + 1], "\n", layout=self.layout)


class Tables:
    """Echo and time series of a run in `streams`: that of the echo, which may be None, and units 2 and 3.

    `analysis` has the `tree`, and the time at which it stopped (`stopped_at`), None if unknown.
    """

    def __init__(self, streams: tuple[Any, ...], deck: Deck, layout: str, analysis: "TreeAnalysis"):
        self.echo, *units = streams
        self.deck, self.layout, self.analysis = deck, layout, analysis
        self.series = Series(units[0], units[1], len(analysis.tree.coordinates), layout) if units else None

    def begin(self) -> None:
        """Write the echo."""
        if self.echo is not None:
            self.echo.write(echo_text(self.deck, self.layout))

    def rows(self, values: dict[str, np.ndarray]) -> None:
        """Write report rows, given by the paths of their datasets."""
        if self.series:
            self.series.rows(values["time"], values["coordinate/q"], values["coordinate/u"])

    def stopped(self) -> None:
        """Note that the run ended before the last time, and where it stands."""
        if self.series is None:
            return
        stopped_at = getattr(self.analysis, "stopped_at", None)
        self.series.failed(*stopped_at) if stopped_at else self.series.stopped()

    failed = stopped
