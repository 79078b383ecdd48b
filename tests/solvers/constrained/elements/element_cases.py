"""A small mechanism for every card of loads, functions and elements that a YOUNG deck can have.

In each the card acts, one more coordinate follows `MOTION`, and nothing else is free: an inverse run finds
the effort that the coordinate needs, a forward run with this effort must give the motion back.
"""

import re
from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from flexmb_cli.dialects.elements_block.old_cards import LINES
from flexmb_cli.dialects.young.cards import CARDS
from tests.solvers.constrained.element_decks import ARM, ROTOR, SLIDER, TWO_ROTORS, rows_of

# What acts on the motion; the others give masses, gravity, the start, integrators and pictures.
OTHERS = {"MASS", "GRAVITY", "VELOCITY", "TOLERANCE", "GALF", "RAD5", "GEOM", "STL"}
# Cases are named by the cards of earlier versions: a line `SPRING at=2.angle` is a case of TSPRING.
KEYWORDS = (*(card.keyword for card in CARDS if card.keyword not in OTHERS), *LINES["young"])
COORDINATES = ("angle", "stroke")
END, STEP = 0.2, 0.002  # s
POWERS = (1.2, 0.9, -0.7)  # the motion is 1.2 t + 0.9 t² - 0.7 t³, rad or m
REVERSING = (1.2, -5.0, -4.0)  # comes to rest after 0.1 s, and goes back
HALFWAY = 0.1  # s, where tables bend and stops are met
CUT = 1e-6  # s, in which one spline follows another
AT_HALFWAY = sum(c * HALFWAY**k for k, c in enumerate(POWERS, 1))


def motion(t, powers=POWERS):
    """The coordinate that is driven, and its rate."""
    a, b, c = powers
    return t * (a + t * (b + t * c)), a + t * (2 * b + t * 3 * c)


_FRAMES = "0 0 0 1 0 0 0\n"
# Body 2 slides along x, body 3 turns on it about z.
CART = (
    f"3 0 0 0 0 1 0 1 0 0 0 1\n{_FRAMES * 3}2 3 0 0 0 0 0 0 0 0 1 0 0 1\n"
    "1 2 0 0 0 0 0 0 1 0 0 1 0 0 0 1 0 0 0 1\n1 0 0 0 0 0 0\n"
)
# The same with the slide along x as a simplified constraint of body 2, which holds the others too.
HELD = (
    f"3 0 0 0 0 1 0 0 0 6 0 1\n{_FRAMES * 3}2 3 0 0 0 0 0 0 0 0 1 0 0 1\n"
    + "".join(f"2 {k} 0\n" for k in range(1, 7))
    + "1 0 0 0 0 0 0\n"
)
# The arm, whose first body has a driver about z.
DRIVEN_ARM = ARM.replace("3 0 0", "3 1 0", 1).replace("1 0 0 1 0 0 0\n", "1 0 0 1 0 0 0\n2 6 0 0 0\n", 1)
# Body 2 turns about z, body 3 slides along x, 1.2 m from the axis.
CRANK = (
    f"3 0 0 0 0 1 0 1 0 0 0 1\n{_FRAMES * 2}1.2 0 0 1 0 0 0\n1 2 0 0 0 0 0 0 0 0 1 0 0 1\n"
    "1 3 1.2 0 0 0 0 0 2.2 0 0 1 0 0 1.2 1 0 0 0 1\n1 0 0 0 0 0 0\n"
)
# Body 2 turns about z; body 3 turns and slides along z, 1 m beside it.
CRANK_AND_SLEEVE = (
    f"3 0 0 0 0 1 1 0 0 0 0 1\n{_FRAMES * 2}1 0 0 1 0 0 0\n1 2 0 0 0 0 0 0 0 0 1 0 0 1\n"
    "1 3 1 0 0 0 0 0 1 0 1 0 0 1\n1 0 0 0 0 0 0\n"
)
# Body 2 turns about z; body 3 turns on its end, at (0.4, 0, 0), and points through (1, 0, 0).
SWIVEL = (
    f"3 0 0 0 0 2 0 0 0 0 0 1\n{_FRAMES * 2}0.4 0 0 1 0 0 0\n1 2 0 0 0 0 0 0 0 0 1 0 0 1\n"
    "2 3 0.4 0 0 0 0 0 0.4 0 1 0 0 1\n1 0 0 0 0 0 0\n"
)
TURNED = "MASS 2 1.5 0.3 0.1 0 0.2 0.3 0.5\nGRAVITY 1.2 -9.81 0.4\n"
SLID = "MASS 2 2 0.1 0.2 0 1 1 1\nGRAVITY 1.2 -9.81 0.4\n"
TWO = "MASS 2 1.5 0.4 0 0 0.1 0.2 0.2\nMASS 3 0.8 0.3 0.1 0 0.05 0.1 0.1\nGRAVITY 1.2 -9.81 0.4\n"


@dataclass(frozen=True)
class Case:
    """A mechanism, its cards and the joint coordinate (from 1; 1: angle, 2: stroke) that follows `MOTION`."""

    mechanism: str
    cards: str
    joint: int = 1
    coordinate: int = 1
    breaks: tuple[float, ...] = ()  # s, where the effort bends
    powers: tuple[float, float, float] = POWERS  # of the motion

    @property
    def at(self) -> str:
        """The coordinate that follows `MOTION`."""
        return f"{self.joint}.{COORDINATES[self.coordinate - 1]}"

    @property
    def driver(self) -> str:
        """The card that lets the coordinate follow `MOTION`."""
        powers = " ".join(map(str, self.powers))
        return f"ELEMENTS\n  FUNCTION 90 polynomial 0 {powers}\n  DRIVE driven at={self.at} value=90\n"

    def motor(self, times, efforts) -> str:
        """Cards of an effort given at `times`, cubic between the breaks, and of the rate at the start."""
        pieces = [0.0, *self.breaks, END]
        text, parts = "", []
        for k, (first, last) in enumerate(pairwise(pieces)):
            rows = (times > first - 1e-9) & (times < last + 1e-9)
            pairs = zip(times[rows].tolist(), efforts[rows].tolist(), strict=True)
            text += (
                f"ELEMENTS\n  FUNCTION {100 + k} spline " + " ".join(f"{t!r} {v!r}" for t, v in pairs) + "\n"
            )
            # The end pieces of a spline go on: a window cuts them off, where its neighbour has all but the
            # same value.
            rise, fall = first - 1.0 * (k == 0), last + 1.0 * (last == END)
            text += (
                "ELEMENTS\n"
                f"  FUNCTION {200 + k} table {rise!r} 0 {rise + CUT!r} 1 {fall!r} 1 {fall + CUT!r} 0\n"
            )
            text += f"ELEMENTS\n  FUNCTION {300 + k} product {100 + k} {200 + k}\n"
            parts.append(str(300 + k))
        text += f"ELEMENTS\n  FUNCTION 99 sum {' '.join(parts)}\n  MOTOR motor at={self.at} effort=99\n"
        return f"{text}  START at={self.at} rate={self.powers[0]}\n"


def _varied(function: str, *breaks: float) -> Case:
    """A torque that function 5 multiplies."""
    return Case(ROTOR, f"{TURNED}{function}\nTORQUE 2 0 0 2 0 5\n", breaks=breaks)


_SLOPES = "ELEMENTS\n  FUNCTION 5 polynomial 0 0 0 40\n  FUNCTION 6 polynomial 0 0.3 0.1\n"
CASES = {
    "FORCE": Case(ROTOR, f"{TURNED}FORCE 2 0.5 0.1 0 3 -2 1\n"),
    "TORQUE": Case(ROTOR, f"{TURNED}TORQUE 2 0.1 0.2 -1.4\n"),
    "SPRING": Case(ROTOR, f"{TURNED}SPRING 0 2 2 0.3 0 1 0 0 30 0.5 0.7\n"),
    "DAMPER": Case(ROTOR, f"{TURNED}DAMPER 0 2 2 0.3 0 1 0 0 1.7\n"),
    "TABLE": _varied(f"ELEMENTS\n  FUNCTION 5 table 0 0.3 {HALFWAY} 1.8 0.3 -0.4", HALFWAY),
    "SPLINE": _varied(
        "ELEMENTS\n  FUNCTION 5 spline 0 0.3 0.05 1.1 0.1 0.8 0.15 0.4 0.3 0.9", 0.05, HALFWAY, 0.15
    ),
    "POLYNOMIAL": _varied("ELEMENTS\n  FUNCTION 5 polynomial 0.2 4 -30 50"),
    "SINE": _varied("ELEMENTS\n  FUNCTION 5 sine 0.1 0.8 9 0.4"),
    "RAMP": _varied("ELEMENTS\n  FUNCTION 5 ramp 0.05 0.2 0.15 1.9", 0.05, 0.15),
    "STEP": _varied("ELEMENTS\n  FUNCTION 5 step 0.05 0.2 0.15 1.9", 0.05, 0.15),
    "SUM": _varied(
        "ELEMENTS\n  FUNCTION 3 sine 0.1 0.8 9\n  FUNCTION 4 polynomial 0.2 1 -3\n  FUNCTION 5 sum 3 4 3"
    ),
    "PRODUCT": _varied(
        "ELEMENTS\n  FUNCTION 3 sine 0.1 0.8 9\n  FUNCTION 4 polynomial 0.2 1 -3\n  FUNCTION 5 product 3 4 3"
    ),
    "DRIVE": Case(
        DRIVEN_ARM, f"{TWO}ELEMENTS\n  FUNCTION 5 sine 0 0.7 3\n  DRIVE drive-1 driver=1 value=5\n", joint=2
    ),
    "SUPPORT": Case(
        HELD, f"{TWO}ELEMENTS\n  FUNCTION 5 sine 0 0.3 6\n  SUPPORT support-1 simplified=1 value=5\n"
    ),
    "ANGLE": Case(
        ARM, f"{TWO}ELEMENTS\n  FUNCTION 5 sine 0 0.7 3\n  DRIVE angle-1 at=1.angle value=5\n", joint=2
    ),
    "STROKE": Case(
        CART, f"{TWO}ELEMENTS\n  FUNCTION 5 sine 0.2 0.7 3\n  DRIVE stroke-1 at=2.stroke rate=5\n"
    ),
    "TMOTOR": Case(
        ROTOR, f"{TURNED}ELEMENTS\n  FUNCTION 5 sine 0.1 0.8 9 0.4\n  MOTOR tmotor-1 at=1.angle effort=5\n"
    ),
    "AMOTOR": Case(
        SLIDER,
        f"{SLID}ELEMENTS\n  FUNCTION 5 sine 0.1 0.8 9 0.4\n  MOTOR amotor-1 at=1.stroke effort=5\n",
        coordinate=2,
    ),
    "TSPRING": Case(
        ROTOR,
        f"{TURNED}{_SLOPES}ELEMENTS\n"
        "  SPRING tspring-1 at=1.angle stiffness=8 rest=0.1 damping=0.4 preload=1.6 curve=5 "
        "damper=6\n",
    ),
    "ASPRING": Case(
        SLIDER,
        f"{SLID}{_SLOPES}ELEMENTS\n"
        "  SPRING aspring-1 at=1.stroke stiffness=80 rest=0.1 damping=0.9 preload=1.6 curve=5 "
        "damper=6\n",
        coordinate=2,
    ),
    "TSTOP": Case(
        ROTOR,
        f"{TURNED}ELEMENTS\n  STOP tstop-1 at=1.angle lower=-1 upper={AT_HALFWAY} stiffness=60 damping=0.3\n",
        breaks=(HALFWAY,),
    ),
    "ASTOP": Case(
        SLIDER,
        f"{SLID}ELEMENTS\n  STOP astop-1 at=1.stroke lower=-1 upper={AT_HALFWAY} stiffness=300 damping=0.3\n",
        coordinate=2,
        breaks=(HALFWAY,),
    ),
    "LSPRING": Case(
        ROTOR,
        f"{TURNED}{_SLOPES}ELEMENTS\n"
        "  SPRING lspring-1 from=0(2,0.3,0) to=2(1,0,0) stiffness=30 rest=0.5 damping=0.7 "
        "preload=4 curve=5\n"
        "      damper=6\n",
    ),
    "CABLE": Case(
        ROTOR,
        f"{TURNED}ELEMENTS\n  CABLE cable-1 from=0(2,0.3,0) to=2(1,0,0) stiffness=80 rest=0.6 damping=0.2\n",
    ),
    "BUSHING": Case(
        ROTOR,
        f"{TURNED}ELEMENTS\n"
        "  BUSHING bushing-1 from=0(0.1,0,0) to=2(0.1,0.02,0) k=(90,160,250) kr=(6,9,16) "
        "c=(5,6,7)\n"
        "      cr=(0.2,0.3,0.4)\n",
    ),
    "COUPLING": Case(TWO_ROTORS, f"{TWO}ELEMENTS\n  COUPLING coupling-1 1.angle=2 2.angle=-1\n"),
    "FRICTION": Case(
        ROTOR,
        f"{TURNED}ELEMENTS\n"
        "  FRICTION friction-1 joint=1 dynamic=0.2 static=0.25 stribeck=0.5 creep=1e-3 "
        "radius=0.04 preload=3\n",
    ),
    "REVCYL": Case(
        SWIVEL,
        f"{TWO}ELEMENTS\n"
        "  JOINT revcyl-1 revcyl from=0(1,0,0) to=3(0,0,0) axis_from=(0,0,1) axis_to=(1,0,0)\n",
    ),
    "REVSPH": Case(
        CRANK_AND_SLEEVE,
        f"{TWO}ELEMENTS\n"
        "  JOINT revsph-1 revsph from=2(0.1,0.3,0) to=3(-0.2,0.8,0) "
        "axis_from=(-0.05,0.07,0.3)\n"
        f"      length={0.74**0.5!r}\n",
    ),
    "SPHSPH": Case(
        CRANK,
        f"{TWO}ELEMENTS\n  JOINT sphsph-1 sphsph from=2(0.2,0.1,0) to=3(0,0.3,0) length={1.04**0.5!r}\n",
    ),
    "RATE": Case(ROTOR, TURNED),
    "JOINTS": Case(ROTOR, TURNED),
}


# Rack and pinion, belt and differential are couplings too; body 2 of the differential carries 3 and 4.
THREE_ROTORS = (
    f"4 0 0 0 0 3 0 0 0 0 0 1\n{_FRAMES * 2}1 0 0 1 0 0 0\n2 0 0 1 0 0 0\n1 2 0 0 0 0 0 0 0 0 1 0 0 1\n"
    "1 3 1 0 0 0 0 0 1 0 1 0 0 1\n1 4 2 0 0 0 0 0 2 0 1 0 0 1\n1 0 0 0 0 0 0\n"
)
CASES_OF_COUPLINGS = {
    "rack and pinion": Case(CRANK, f"{TWO}ELEMENTS\n  COUPLING coupling-1 1.angle=-0.2 2.stroke=1\n"),
    "belt": Case(TWO_ROTORS, f"{TWO}ELEMENTS\n  COUPLING coupling-1 1.angle=0.3 2.angle=-0.1\n"),
    "differential": Case(
        THREE_ROTORS,
        f"{TWO}MASS 4 0.5 0.1 0.2 0 0.1 0.1 0.2\n"
        "ELEMENTS\n"
        "  FUNCTION 5 sine 0 0.7 3\n"
        "  DRIVE angle-1 at=2.angle value=5\n"
        "  COUPLING coupling-1 1.angle=-2 2.angle=1 3.angle=1\n",
    ),
}
# Friction of other joints, which stops, turns round and slides back; slow enough for splines to follow.
SLEEVE = "2 0 0 0 0 0 {} 0 {} 0 0 1\n" + _FRAMES * 2 + "1 2 0 0 0 0 0 0 0 0 1 0 0 1{}\n1 0 0 0 0 0 0\n"
BEARING = (
    "ELEMENTS\n"
    "  FRICTION friction-1 joint=1 dynamic=0.2 static=0.25 stribeck=0.5 creep=0.1 "
    "radius=0.04 preload=3\n"
)
CASES_OF_FRICTION = {
    "revolute": Case(ROTOR, f"{TURNED}{BEARING}", powers=REVERSING),
    "translational": Case(
        SLIDER,
        f"{SLID}ELEMENTS\n"
        "  FRICTION friction-1 joint=1 dynamic=0.2 static=0.25 stribeck=5 creep=0.5 "
        "preload=3\n",
        coordinate=2,
        powers=REVERSING,
    ),
    "cylindrical": Case(
        SLEEVE.format(1, 0, ""),
        f"{TURNED}ELEMENTS\n  FUNCTION 5 sine 0 0.02 9\n  DRIVE stroke-1 at=1.stroke value=5\n{BEARING}",
        powers=REVERSING,
    ),
    "screw": Case(SLEEVE.format(0, 1, " 1 0 0 1 0 0 0.03"), f"{TURNED}{BEARING}", powers=REVERSING),
}


def without(keyword: str, case: Case) -> str:
    """The cards of a case without those of its keyword."""
    own = rf"{keyword} |  \w+ {keyword.lower()}-"
    return re.sub(rf"^(?:{own}).*\n(?:      .*\n)*", "", case.cards, flags=re.MULTILINE)


def inverse(case: Case):
    """Rows of the run in which the coordinate is driven; its driver stands last."""
    return rows_of(case.mechanism, f"0 {END} {STEP}", case.cards + case.driver, "inverse")


def forward(case: Case, driven, method: str):
    """Rows of the run that the effort of the rows `driven` moves, and which of these have the same times."""
    cards = case.cards + case.motor(driven.time, driven.driver_effort[:, -1]) + method
    found = rows_of(case.mechanism, f"0 {END} {END / 10}", cards)
    return found, np.searchsorted(driven.time, found.time - 1e-9)


def free(case: Case, method: str):
    """Rows of the run in which the coordinate moves freely, from a rate at which it meets the stops."""
    cards = f"{case.cards}ELEMENTS\n  START at={case.at} rate={2 * POWERS[0]}\n{method}"
    return rows_of(case.mechanism, "0 0.5 0.1", cards)
