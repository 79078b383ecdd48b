"""A small mechanism for every card of functions and elements of VSDF decks, which acts on a driven motion."""

import re
from dataclasses import dataclass

from tests.dialects.vsdf.test_elements import SLIDING, TWO_LINKS

POWERS = (1.2, 0.9, -0.7)  # the motion is 1.2 t + 0.9 t² - 0.7 t³, rad or m
REVERSING = (1.2, -5.0, -4.0)  # comes to rest after 0.1 s, and goes back
SLOPES = "ELEMENTS\n  FUNCTION 5 polynomial 0 0 0 40\n  FUNCTION 6 polynomial 0 0.3 0.1\n"
VARIED = (
    "ELEMENTS\n"
    "  FUNCTION 5 spline 0 0.3 0.1 1.1 0.2 0.8 0.3 0.4\n"
    "  FUNCTION 6 sine 0 2 9\n"
    "  FUNCTION 7 sum 5 6\n"
)
WEIGHT = "GRAV\n 1.2,-9.81,0.4\n"
SINE = "ELEMENTS\n  FUNCTION 5 sine 0.1 0.8 9 0.4\n"
# Body 2, pinned beside the slider, is moved by SUPP.
HELD = (
    SLIDING.replace(" 1,RIGD\n", " 1,RIGD\n 2,RIGD\n")
    .replace("RIGI\n", "RIGI\n 2,1\n 1,1,1\n")
    .replace("JOIN\n", " 2,1,0,0,0\nPOSI\n 2,1,0.4\nPINN\n 2,1,111,1,0.4,0\nJOIN\n")
)


@dataclass(frozen=True)
class Case:
    """A mechanism, its cards, and whether joint 1 is driven in its angle or its stroke."""

    mechanism: str
    cards: str
    coordinate: int = 1
    powers: tuple[float, float, float] = POWERS  # of the motion

    @property
    def driver(self) -> str:
        """Cards of the motion."""
        function = f"ELEMENTS\n  FUNCTION 90 polynomial 0 {' '.join(map(str, self.powers))}\n"
        return f"{function}MOTN\n 1,{('ANGL', 'STRK')[self.coordinate - 1]},1,5,90\n"

    @property
    def motor(self) -> str:
        """Cards that take the place of the motion: function 99 as effort, and the rate at the start."""
        at = ("1.angle", "1.stroke")[self.coordinate - 1]
        return f"ELEMENTS\n  MOTOR motor at={at} effort=99\n  START at={at} rate={self.powers[0]}\n"


def turned(cards: str) -> Case:
    """An arm whose second link swings freely on the first, which is driven."""
    return Case(TWO_LINKS, cards)


def slid(cards: str) -> Case:
    """A slider with weight."""
    return Case(SLIDING, f"{WEIGHT}{cards}", 2)


CASES = {
    "FUNC": turned(f"{VARIED}TORQ\n 1,0,0,3,0,7\n"),
    "SUPP": Case(
        HELD,
        f"{WEIGHT}ELEMENTS\n"
        "  FUNCTION 5 sine 0 0.3 6\n"
        "  SUPPORT supp-1 pin=1 x=5 y=5\n"
        "  SPRING lspr-1 from=1:1 to=2:1 stiffness=50 rest=0.3\n",
        2,
    ),
    "TMOT": turned(f"{SINE}ELEMENTS\n  MOTOR tmot-1 at=2.angle effort=5\n"),
    "AMOT": slid(f"{SINE}ELEMENTS\n  MOTOR amot-1 at=1.stroke effort=5\n"),
    "TSPR": turned(
        f"{SLOPES}ELEMENTS\n"
        "  SPRING tspr-1 at=1.angle stiffness=8 rest=0.1 damping=0.4 preload=1.6 curve=5 "
        "damper=6\n"
        "  SPRING tspr-2 at=2.angle stiffness=6 rest=0.2 damping=0.3\n"
    ),
    "ASPR": slid(
        f"{SLOPES}ELEMENTS\n"
        "  SPRING aspr-1 at=1.stroke stiffness=80 rest=0.1 damping=0.9 preload=1.6 curve=5 "
        "damper=6\n"
    ),
    "TSTO": turned("ELEMENTS\n  STOP tsto-1 at=1.angle lower=-1 upper=-0.2 stiffness=60 damping=0.3\n"),
    "ASTO": slid("ELEMENTS\n  STOP asto-1 at=1.stroke lower=-1 upper=-0.2 stiffness=300 damping=0.3\n"),
    "LSPR": turned(
        f"{SLOPES}ELEMENTS\n"
        "  SPRING lspr-1 from=0:3 to=2:3 stiffness=30 rest=1.2 damping=0.5 preload=4 curve=5 "
        "damper=6\n"
    ),
    "CABL": turned("ELEMENTS\n  CABLE cabl-1 from=0:3 to=2:3 stiffness=80 rest=1.2 damping=0.2\n"),
    "BUSH": turned(
        "ELEMENTS\n"
        "  BUSHING bush-1 from=0:3 to=2:3 k=(9,16,25) kr=(0.6,0.9,1.6) c=(0.5,0.6,0.7) "
        "cr=(0.2,0.3,0.4)\n"
    ),
    "COUP": turned("ELEMENTS\n  COUPLING coup-1 1.angle=2 2.angle=3\n"),
    "FRIC": turned(
        "ELEMENTS\n"
        "  FRICTION fric-1 joint=1 dynamic=0.2 static=0.25 stribeck=0.5 creep=1e-3 "
        "radius=0.04 preload=3\n"
        "  FRICTION fric-2 joint=2 dynamic=0.1 static=0.1 stribeck=1 creep=0.01 radius=0.05\n"
    ),
    "RATE": turned("ELEMENTS\n  START at=2.angle rate=0.6\n"),
    "OUTJ": turned(""),
    "FORC": turned("FORC\n 2,3,0.7,-1.1,0,1\n"),
    "TORQ": turned("TORQ\n 1,0,0,-1.4\n"),
    "SPRI": turned("SPRI\n 1,0,3,2,3,30,0.5,1.2\n"),
    "JSPR": turned("JSPR\n 1,8,0.1,0.4\n 2,6,0.2,0.3\n"),
}

# Joints 1, 2 and 3 turn about z of the ground, joint 4 slides along x.
AXLES = """VSDF AXLES
BODY
 1,RIGD
 2,RIGD
 3,RIGD
 4,RIGD
RIGI
 1,1.5,0.3,0.1
 0.2,0.3,0.5
 2,0.8,0.2
 0.1,0.2,0.2
 3,0.5,0.1,0.2
 0.1,0.1,0.2
 4,2
 1,1,1
POSI
 2,1
 3,2
NODE
 0,1,0,0,0
 0,2,0,0,1
 0,3,1,0,0
 0,4,1,0,1
 0,5,2,0,0
 0,6,2,0,1
 0,7,0,1,0
 1,1,0,0,0
 1,2,0,0,1
 2,1,0,0,0
 2,2,0,0,1
 3,1,0,0,0
 3,2,0,0,1
 4,1,0,0,0
 4,2,1,0,0
 4,3,0,1,0
JOIN
 1,REVO,0,1,2,1,1,2
 2,REVO,0,3,4,2,1,2
 3,REVO,0,5,6,3,1,2
 4,TRAN,0,1,3,4,1,2,7,3
"""
CASES_OF_COUPLINGS = {
    "rack and pinion": Case(AXLES, f"{WEIGHT}ELEMENTS\n  COUPLING coup-1 1.angle=-0.2 4.stroke=1\n"),
    "belt": Case(AXLES, f"{WEIGHT}ELEMENTS\n  COUPLING coup-1 1.angle=0.3 2.angle=-0.1\n"),
    "differential": Case(AXLES, f"{WEIGHT}ELEMENTS\n  COUPLING coup-1 1.angle=-2 2.angle=1 3.angle=1\n"),
}
# Friction of every joint that has it, which stops, turns round and slides back.
ALONG_Z = "0,3,1,0,0\n 1,1,0,0,0\n 1,2,0,0,1\n 1,3,1,0,0\nJOIN\n 1,{},0,1,2,1,1,2"
BEARING = (
    "ELEMENTS\n"
    "  FRICTION fric-1 joint=1 dynamic=0.2 static=0.25 stribeck=0.5 creep=0.1 radius=0.04 "
    "preload=3\n"
)


def sleeve(joint: str) -> str:
    """The slider's body on another joint about and along z."""
    return SLIDING.split("NODE")[0] + f"NODE\n 0,1,0,0,0\n 0,2,0,0,1\n {ALONG_Z.format(joint)}"


CASES_OF_FRICTION = {
    "revolute": Case(f"{sleeve('REVO')}\n", f"{WEIGHT}{BEARING}", powers=REVERSING),
    "translational": Case(
        SLIDING,
        f"{WEIGHT}ELEMENTS\n"
        "  FRICTION fric-1 joint=1 dynamic=0.2 static=0.25 stribeck=5 creep=0.5 preload=3\n",
        2,
        REVERSING,
    ),
    "cylindrical": Case(
        f"{sleeve('CYLI')}\n",
        f"{WEIGHT}{BEARING}ELEMENTS\n  COUPLING coup-1 1.angle=0.05 1.stroke=-1\n",
        powers=REVERSING,
    ),
    "screw": Case(f"{sleeve('SCRW')},3,3,0.03\n", f"{WEIGHT}{BEARING}", powers=REVERSING),
}


def without(word: str, case: Case) -> str:
    """The cards of a case without those of a word, or without the lines that took the place of these."""
    own = rf"{word}\n(?: .*\n)*|  \w+ {word.lower()}-.*\n"
    return re.sub(rf"^(?:{own})", "", case.cards, flags=re.MULTILINE)
