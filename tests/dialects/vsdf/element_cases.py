"""A small mechanism for every card of functions and elements of VSDF decks, which acts on a driven motion."""

import re
from dataclasses import dataclass

from tests.dialects.vsdf.test_elements import SLIDING, TWO_LINKS

POWERS = (1.2, 0.9, -0.7)  # the motion is 1.2 t + 0.9 t² - 0.7 t³, rad or m
REVERSING = (1.2, -5.0, -4.0)  # comes to rest after 0.1 s, and goes back
SLOPES = "FUNC\n 5,POLY,0,0,0,40\n 6,POLY,0,0.3,0.1\n"
VARIED = "FUNC\n 5,SPLI,0,0.3,0.1,1.1,0.2,0.8,0.3,0.4\n 6,SINE,0,2,9\n 7,SUM,5,6\n"
WEIGHT = "GRAV\n 1.2,-9.81,0.4\n"
SINE = "FUNC\n 5,SINE,0.1,0.8,9,0.4\n"
# Body 2, pinned beside the slider, is moved by SUPP.
HELD = SLIDING.replace(" 1,RIGD\n", " 1,RIGD\n 2,RIGD\n").replace("RIGI\n", "RIGI\n 2,1\n 1,1,1\n").replace(
    "JOIN\n", " 2,1,0,0,0\nPOSI\n 2,1,0.4\nPINN\n 2,1,111,1,0.4,0\nJOIN\n"
)  # fmt: skip


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
        function = f"FUNC\n 90,POLY,0,{','.join(map(str, self.powers))}\n"
        return f"{function}MOTN\n 1,{('ANGL', 'STRK')[self.coordinate - 1]},1,5,90\n"

    @property
    def motor(self) -> str:
        """Cards that take the place of the motion: function 99 as effort, and the rate at the start."""
        word = ("TMOT", "AMOT")[self.coordinate - 1]
        return f"{word}\n 1,99\nRATE\n 1,{self.coordinate},{self.powers[0]}\n"


def turned(cards: str) -> Case:
    """An arm whose second link swings freely on the first, which is driven."""
    return Case(TWO_LINKS, cards)


def slid(cards: str) -> Case:
    """A slider with weight."""
    return Case(SLIDING, f"{WEIGHT}{cards}", 2)


CASES = {
    "FUNC": turned(f"{VARIED}TORQ\n 1,0,0,3,0,7\n"),
    "SUPP": Case(HELD, f"{WEIGHT}FUNC\n 5,SINE,0,0.3,6\nSUPP\n 1,5,5,0\nLSPR\n 1,1,2,1,50,0.3\n", 2),
    "TMOT": turned(f"{SINE}TMOT\n 2,5\n"),
    "AMOT": slid(f"{SINE}AMOT\n 1,5\n"),
    "TSPR": turned(f"{SLOPES}TSPR\n 1,8,0.1,0.4,1.6,5,6\n 2,6,0.2,0.3\n"),
    "ASPR": slid(f"{SLOPES}ASPR\n 1,80,0.1,0.9,1.6,5,6\n"),
    "TSTO": turned("TSTO\n 1,-1,-0.2,60,0.3\n"),
    "ASTO": slid("ASTO\n 1,-1,-0.2,300,0.3\n"),
    "LSPR": turned(f"{SLOPES}LSPR\n 0,3,2,3,30,1.2,0.5,4,5,6\n"),
    "CABL": turned("CABL\n 0,3,2,3,80,1.2,0.2\n"),
    "BUSH": turned("BUSH\n 0,3,2,3,9,16,25,0.6,0.9,1.6,0.5,0.6,0.7,0.2,0.3,0.4\n"),
    "COUP": turned("COUP\n 1,1,1,2\n 1,2,1,3\n"),
    "FRIC": turned("FRIC\n 1,0.2,0.25,0.5,1e-3,0.04,3\n 2,0.1,0.1,1,0.01,0.05\n"),
    "RATE": turned("RATE\n 2,1,0.6\n"),
    "OUTJ": turned("OUTJ\n 1\n"),
    "FORC": turned("FORC\n 2,3,0.7,-1.1,0,1\n"),
    "TORQ": turned("TORQ\n 1,0,0,-1.4\n"),
    "SPRI": turned("SPRI\n 1,0,3,2,3,30,0.5,1.2\n"),
    "JSPR": turned("JSPR\n 1,8,0.1,0.4\n 2,6,0.2,0.3\n"),
}  # fmt: skip

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
    "rack and pinion": Case(AXLES, f"{WEIGHT}COUP\n 1,1,1,-0.2\n 1,4,2,1\n"),
    "belt": Case(AXLES, f"{WEIGHT}COUP\n 1,1,1,0.3\n 1,2,1,-0.1\n"),
    "differential": Case(AXLES, f"{WEIGHT}COUP\n 1,1,1,-2\n 1,2,1,1\n 1,3,1,1\n"),
}
# Friction of every joint that has it, which stops, turns round and slides back.
ALONG_Z = "0,3,1,0,0\n 1,1,0,0,0\n 1,2,0,0,1\n 1,3,1,0,0\nJOIN\n 1,{},0,1,2,1,1,2"
BEARING = "FRIC\n 1,0.2,0.25,0.5,0.1,0.04,3\n"


def sleeve(joint: str) -> str:
    """The slider's body on another joint about and along z."""
    return SLIDING.split("NODE")[0] + f"NODE\n 0,1,0,0,0\n 0,2,0,0,1\n {ALONG_Z.format(joint)}"


CASES_OF_FRICTION = {
    "revolute": Case(f"{sleeve('REVO')}\n", f"{WEIGHT}{BEARING}", powers=REVERSING),
    "translational": Case(SLIDING, f"{WEIGHT}FRIC\n 1,0.2,0.25,5,0.5,0,3\n", 2, REVERSING),
    "cylindrical": Case(
        f"{sleeve('CYLI')}\n", f"{WEIGHT}{BEARING}COUP\n 1,1,1,0.05\n 1,1,2,-1\n", powers=REVERSING
    ),
    "screw": Case(f"{sleeve('SCRW')},3,3,0.03\n", f"{WEIGHT}{BEARING}", powers=REVERSING),
}  # fmt: skip


def without(word: str, case: Case) -> str:
    """The cards of a case without the block of a word."""
    return re.sub(rf"^{word}\n( .*\n)*", "", case.cards, flags=re.MULTILINE)
