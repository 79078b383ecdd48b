"""OUT table of a YOUNG deck: echo of the input, a head, one block for every report time.

Layout of the listings in Appendix B of the YOUNG dissertation (Liang Yong, 1996).  In the safe layout
body numbers that the program printed without a blank between them (screw joints) stay so only while
both have one digit.
"""

from typing import Any

import numpy as np

from ...deck.edit import HISTORIC, SAFE, Edit, fixed, integer
from ...deck.fortran_format import Layout
from ...deck.record import Deck, Record
from ...solvers.as_printed.errors import AS_PRINTED

_BODY_PAIR = "FOR {name} No {{number}}\n ENTER BODY No I & J \n{{pair}}{coordinates}\n"
_DIRECTION = "ENTER 1-6 FOR DIRECTION X,Y,Z,ALPH(axis is X),BETA(axis is Y),DELT(axis is Z)\n{direction:3d}\n"
_COUNTS = (
    "ENTER NUMBER OF\nbody : NBODY\ndriver: NDRIVE\npoints of interest: NPOINT\nspherical joints: NSPHER\n"
    "universal joints: NUNIVE\nrevolute joints: NREVOL\ncylindrical joints: NCYLIN\n"
    "translational joints: NTRANS\nscrew joints: NSCREW\nsimplified constraint: NSIMPL\n"
    "distance constraint: NSIMP2\ngrounded body: NGROUN\n"
)
# The driver's title carries the number of drivers, not its own: a slip of the program, seen in every
# listing with several drivers and kept for its byte layout.
_DRIVER = (
    "FOR DRIVER No {drivers}\n ENTER BODY No \n{body:3d}\n"
    "ENTER DRIVER CONSTRAINT\n NUMBER 1-6 FOR X,Y,Z,ALPHA,BETA,DELTA\n{direction:3d}\n"
    "ENTER INITIAL POSITION, VELOCITY & ACCELERATION\n"
)


def _joint(name: str, coordinates: str) -> tuple[str, int, Edit]:
    title = _BODY_PAIR.format(name=name, coordinates=coordinates)
    return title, 2, fixed(6, 2)


# Questions of the program, in the order of reading: the text with the first answers of a record, and the
# field of those from the given one on.  `pair`: the line of bodies I and J.
_QUESTIONS: dict[str, tuple[str, int, Edit]] = {
    "counts": (_COUNTS, 0, integer(3)),
    "body": ("FOR BODY {number} ENTER INITIAL ESTIMATES OF X,Y,Z & E0 E1,E2,E3\n", 0, fixed(6, 2)),
    "driver": (_DRIVER, 2, fixed(8, 2)),
    "point": (
        "FOR POINT OF INTEREST No {number}\n ENTER BODY No \n{body:3d}\n"
        "ENTER RELATIVE COORDINATES OF THE POINT\n",
        1,
        fixed(6, 2),
    ),
    "spherical": _joint("SPHERICAL JOINT", "ENTER LOCAL COORDINATES OF JOINT POINT"),
    "universal": _joint("UNIVERSAL JOINT", "ENTER LOCAL COORDINATES OF POINTS"),
    "revolute": _joint("REVOLUTE JOINT", "ENTER LOCAL COORDINATES OF POINTS Pij,Qi,Qj"),
    "cylindrical": _joint(
        "CYLINDRICAL JOINT", "ENTER LOCAL COORDINATES OF 4 POINTS: 2 ON AXIS, 2 ON EACH BODY"
    ),
    "translational": _joint(
        "TRANSLATIONAL JOINTS",
        "ENTER LOCAL COORDINATES OF 6 POINTS, 3 ON EACH BODY,\n4 ON AXIS, 2 FOR PERPENDICULAR VECTORS:",
    ),
    "screw": _joint("SCREW JOINT", "ENTER LOCAL COORDINATES OF 6 POINTS,3 ON EACH BODY, 4 ON AXIS"),
    "simplified": (
        "FOR SIMPLIFIED CONSTRAINTS No {number}\n ENTER BODY No: \n{body:3d}\n"
        f"{_DIRECTION}ENTER VALUES OF CONSTRAINT\n",
        2,
        fixed(6, 2),
    ),
    "distance": (
        f"FOR DISTANCE CONSTRAINTS No {{number}}\n ENTER THE TWO BODY No: \n{{pair}}"
        f"{_DIRECTION}ENTER VALUES OF DISTANCE\n",
        3,
        fixed(6, 2),
    ),
}
HEAD = "\n-----------------------------\n-- KINEMATIC ANALYSIS --\n-----------------------------\n"
FAILED = "\n\n-----CONVERGENCE FAILED-----\n"
STOPPED = "\n\n-----RUN STOPPED-----\n"
AS_PRINTED_MARK = "NUMBERS WITH THE KNOWN ERRORS OF THE PROGRAM OF 1996 (flexmb run --as-printed)\n"

POSITION_TITLE = "BODY       X         Y         Z         e0        e1        e2        e3"
VELOCITY_TITLE = "BODY  dX     dY     dZ     de0    de1    de2    de3    w-x    w-y    w-z"
ACCELERATION_TITLE = "BODY  ddX    ddY    ddZ    dde0   dde1   dde2   dde3   dw-x   dw-y   dw-z"
POINT_TITLE = "No   X       Y       Z       dX      dY      dZ      ddX     ddY     ddZ"
# Fields of a line; the listings show two decimals in w-x and w-y only.
POSITION_FIELDS = 7 * (fixed(10, 3),)
VELOCITY_FIELDS = 7 * (fixed(7, 3),) + (fixed(7, 2), fixed(7, 2), fixed(7, 3))
ACCELERATION_FIELDS = 10 * (fixed(7, 3),)
POINT_FIELDS = 9 * (fixed(8, 4),)
# Datasets of the sections of a block.
_SECTIONS = (
    ("body/position", "body/euler_parameters"),
    ("body/velocity", "body/euler_parameter_rates", "body/angular_velocity"),
    ("body/acceleration", "body/euler_parameter_accelerations", "body/angular_acceleration"),
    ("point/position", "point/velocity", "point/acceleration"),
)


class OutTable:
    """Writes a YOUNG deck's OUT table to the first of `streams`; lines end in LF.

    `layout`: "safe" or "historic" (see `deck.edit`).
    """

    def __init__(self, streams: tuple[Any, ...], deck: Deck, layout: str = SAFE, analysis: object = None):
        self._stream = streams[0]
        self._deck = deck
        self._layout = layout
        counts = deck.one("counts")
        self._block = report_block(counts["NBODY"], counts["NPOINT"], layout)

    def begin(self) -> None:
        """Write the echo of the input and the head of the analysis, below a line that marks an emulation."""
        mark = AS_PRINTED_MARK if AS_PRINTED in self._deck.options else ""
        self._stream.write(mark + echo_of_input(self._deck, self._layout) + HEAD)

    def rows(self, values: dict[str, np.ndarray]) -> None:
        """Write the blocks of the given report times; `values` by the paths of their datasets."""
        self._stream.write(self._block.lines(block_values(values)))

    def failed(self) -> None:
        """Write that the iterations did not converge; nothing follows."""
        self._stream.write(FAILED)

    def stopped(self) -> None:
        """Write that the run was ended before the last time; nothing follows."""
        self._stream.write(STOPPED)


def report_block(bodies: int, points: int, layout: str = SAFE) -> Layout:
    """The block of one report time; its fields are the columns of `block_values`."""
    parts = ["\n-----\nTIME= ", fixed(5, 3), "\n-----\n"]
    parts += _section("POSITION", POSITION_TITLE, bodies, POSITION_FIELDS)
    parts += ["\n\n", *_section("VELOCITY", VELOCITY_TITLE, bodies, VELOCITY_FIELDS)]
    parts += ["\n", *_section("ACCELERATION", ACCELERATION_TITLE, bodies, ACCELERATION_FIELDS), "\n"]
    if points:
        parts += ["\n", *_section("POINTS OF INTEREST", POINT_TITLE, points, POINT_FIELDS), "\n"]
    return Layout(*parts, "*****\n", layout=layout)


def block_values(values: dict[str, np.ndarray]) -> np.ndarray:
    """Values of the blocks, shape (times, fields of `report_block`), in the order of the page."""
    times = len(values["time"])
    flat = [
        np.concatenate([values[path] for path in paths], axis=2).reshape(times, -1) for paths in _SECTIONS
    ]
    return np.concatenate([values["time"][:, None], *flat], axis=1)


def echo_of_input(deck: Deck, layout: str = SAFE) -> str:
    """The program's questions, each with the deck's answer, in the order of reading."""
    drivers = len(deck.section("driver"))
    texts = [
        _question(record, question, drivers, layout)
        for section, question in _QUESTIONS.items()
        for record in deck.section(section)
    ]
    texts += [_ground(record, layout) for record in deck.section("ground")]
    return "".join([*texts, _time(deck.one("time"), layout)])


def _section(name: str, title: str, count: int, fields: Any) -> Any:
    parts = [f"{name}\n{title}\n"]
    for number in range(1, count + 1):
        parts += [f"{number:3d}", *fields, "\n"]
    return parts


def _answers(values: list[Any], field: Edit, layout: str) -> str:
    """One line of answers, all with the same field."""
    return Layout(*len(values) * (field,), "\n", layout=layout).lines(values)


def _values(record: Record, start: int) -> list[Any]:
    return [number.value for number in record.numbers[start:]]


def _question(record: Record, question: tuple[str, int, Edit], drivers: int, layout: str) -> str:
    text, start, field = question
    first = {number.key: number.value for number in record.numbers[:start]}
    if "{pair}" in text:
        pair = [first["I"], first["J"]]
        touching = record.section == "screw"
        first["pair"] = _touching(pair, layout) if touching else _answers(pair, integer(3), layout)
    heading = text.format(number=record.number, drivers=drivers, **first)
    return heading + _answers(_values(record, start), field, layout)


def _touching(pair: list[int], layout: str) -> str:
    readable = layout == HISTORIC or max(pair) < 10
    return ("" if readable else " ").join(str(number) for number in pair) + "\n"


def _ground(record: Record, layout: str) -> str:
    body = record["body"]
    group = (integer(2), integer(2), fixed(6, 2))
    answers = [
        item for direction, value in enumerate(_values(record, 1), 1) for item in (body, direction, value)
    ]
    coordinates = Layout(*6 * group, "\n", layout=layout).lines(answers)
    title = f"ENTER BODY No FOR No {record.number} GROUNDED BODY"
    return f"{title}\n{body}\nENTER BODY {body} COORDINATES\n{coordinates}"


def _time(record: Record, layout: str) -> str:
    gap = 5 * " "
    field = fixed(5, 2)
    line = Layout(field, gap, field, gap, field, "\n", layout=layout).lines(_values(record, 0))
    return f"-----*-----*-----\nENTER STARTING TIME: Ti; FINAL TIME: Te; AND dT\n{line}"
