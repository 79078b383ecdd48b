"""Cards of elements of earlier versions: each is an error that prints the line of the block in its place.

Expected lines are typed by hand from the fields of the cards, which the headings of these tables name.
"""

import importlib.machinery
import importlib.util
from pathlib import Path

import pytest

from flexmb_cli.deck.text import decode
from flexmb_cli.dialects.elements_block.old_cards import LINES
from flexmb_cli.dialects.recognise import read_deck
from flexmb_cli.errors import DeckError
from tests.dialects.dafms.test_dafms_elements import deck as dafms_deck
from tests.dialects.vsdf.test_elements import TWO_LINKS as ARM

KINEMATIC = """2 0 0 0 0 1 0 0 0 0 0 1
0 0 0 1 0 0 0  0 0 0 1 0 0 0
1 2 0 0 0 0 0 0 0 0 1 0 0 1
1 0 0 0 0 0 0
0 1 0.1
"""
ENDS, SHOWN_ENDS = "0 3 1 2 0 0.6 0 0", "from=0(1,2,0) to=3(0.6,0,0)"
YOUNG = {
    "TABLE 1 0 0 1 2": "FUNCTION 1 table 0 0 1 2",
    "SPLINE 2 0 0 1 2 3 1": "FUNCTION 2 spline 0 0 1 2 3 1",
    "POLYNOMIAL 3 1 2": "FUNCTION 3 polynomial 1 2",
    "SINE 4 0.5 2 3 -0.1": "FUNCTION 4 sine 0.5 2 3 -0.1",
    "RAMP 5 0 1 2 3": "FUNCTION 5 ramp 0 1 2 3",
    "STEP 6 0 1 2 3": "FUNCTION 6 step 0 1 2 3",
    "SUM 7 1 2": "FUNCTION 7 sum 1 2",
    "PRODUCT 8 1 2": "FUNCTION 8 product 1 2",
    "DRIVE 1 3 1": "DRIVE drive-1 driver=1 rate=3",
    "SUPPORT 2 3": "SUPPORT support-1 simplified=2 value=3",
    "ANGLE 1 3": "DRIVE angle-1 at=1.angle value=3",
    "STROKE 2 3 1": "DRIVE stroke-1 at=2.stroke rate=3",
    "TMOTOR 1 3": "MOTOR tmotor-1 at=1.angle effort=3",
    "AMOTOR 2 3": "MOTOR amotor-1 at=2.stroke effort=3",
    "TSPRING 2 40 0.3": "SPRING tspring-1 at=2.angle stiffness=40 rest=0.3",
    "ASPRING 2 0 0.1 0 5 1 2": "SPRING aspring-1 at=2.stroke stiffness=0 rest=0.1 preload=5 curve=1 damper=2",
    f"LSPRING {ENDS} 30 1.2": f"SPRING lspring-1 {SHOWN_ENDS} stiffness=30 rest=1.2",
    "TSTOP 1 -1 1 2e3 0.1": "STOP tstop-1 at=1.angle lower=-1 upper=1 stiffness=2e3 damping=0.1",
    "ASTOP 2 0 0.2 1e5": "STOP astop-1 at=2.stroke lower=0 upper=0.2 stiffness=1e5",
    f"CABLE {ENDS} 800 1.5": f"CABLE cable-1 {SHOWN_ENDS} stiffness=800 rest=1.5",
    f"BUSHING {ENDS} 9 8 7 6 5 4": f"BUSHING bushing-1 {SHOWN_ENDS} k=(9,8,7) kr=(6,5,4)",
    "FRICTION 2 0.1 0.12 0.01 1e-4 0.02": "FRICTION friction-1 joint=2 dynamic=0.1 static=0.12 stribeck=0.01 "
    "creep=1e-4 radius=0.02",
    "COUPLING 1 1 -0.2 2 2 1": "COUPLING coupling-1 1.angle=-0.2 2.stroke=1",
    f"REVCYL {ENDS} 0 0 1 1 0 0": f"JOINT revcyl-1 revcyl {SHOWN_ENDS} axis_from=(0,0,1) axis_to=(1,0,0)",
    f"REVSPH {ENDS} 0 0 1 0.8": f"JOINT revsph-1 revsph {SHOWN_ENDS} axis_from=(0,0,1) length=0.8",
    f"SPHSPH {ENDS} 0.8": f"JOINT sphsph-1 sphsph {SHOWN_ENDS} length=0.8",
    "RATE 2 2 0.5": "START at=2.stroke rate=0.5",
    "JOINTS": "",
}
VSDF = {
    "FUNC\n 5,SINE,0,1,7": "FUNCTION 5 sine 0 1 7",
    "SUPP\n 1,5,0,6": "SUPPORT supp-1 pin=1 x=5 z=6",
    "TMOT\n    1    5": "MOTOR tmot-1 at=1.angle effort=5",
    "AMOT\n 1,5": "MOTOR amot-1 at=1.stroke effort=5",
    "TSPR\n    1      10.0       0.5": "SPRING tspr-1 at=1.angle stiffness=10.0 rest=0.5",
    "ASPR\n 1,10,,2": "SPRING aspr-1 at=1.stroke stiffness=10 damping=2",
    "TSTO\n 1,-1,1,60": "STOP tsto-1 at=1.angle lower=-1 upper=1 stiffness=60",
    "ASTO\n 1,-1,1,60,0.3": "STOP asto-1 at=1.stroke lower=-1 upper=1 stiffness=60 damping=0.3",
    "LSPR\n 0,3,2,4,30,1.2": "SPRING lspr-1 from=0:3 to=2:4 stiffness=30 rest=1.2",
    "CABL\n 0,3,2,4,30,1.2": "CABLE cabl-1 from=0:3 to=2:4 stiffness=30 rest=1.2",
    "BUSH\n ,3,2,4,9,8,7": "BUSHING bush-1 from=0:3 to=2:4 k=(9,8,7) kr=(0,0,0) c=(0,0,0) cr=(0,0,0)",
    "COUP\n 1,1,1,2\n 1,2,1,3": "COUPLING coup-1 1.angle=2 2.angle=3",
    "FRIC\n 1,0.2,0.25,0.5,1e-3,0.04": "FRICTION fric-1 joint=1 dynamic=0.2 static=0.25 stribeck=0.5 "
    "creep=1e-3 radius=0.04",
    "RATE\n 1,1,0.6": "START at=1.angle rate=0.6",
    "OUTJ\n 1": "",
}
_POINTS = "       1.0       2.0       0.0       0.6       0.0       0.0\n"
DAFMS = {
    "FUNC\n    1\n    5    6    4\n                  0.                  1.                  2."
    "                  3.": "FUNCTION 5 step 0. 1. 2. 3.",
    "FUNC\n    1\n    7    7    2\n                  1.                  2.": "FUNCTION 7 sum 1 2",
    "MOTF\n    1\n    2    3    5": "MOTOR motf-1 at=2.r3 effort=5",
    "PREF\n    1\n    1    4    5    1": "DRIVE pref-1 at=1.t1 rate=5",
    "HSPR\n    1\n    1    3      20.0       0.2       0.3       1.0": "SPRING hspr-1 at=1.r3 stiffness=20.0 "
    "rest=0.2 damping=0.3 preload=1.0",
    "HSTO\n    1\n    1    3      -0.5       3.0    4000.0": "STOP hsto-1 at=1.r3 lower=-0.5 upper=3.0 "
    "stiffness=4000.0",
    f"LSPR\n    1\n    0    0    2    1    0    0\n{_POINTS}      30.0       1.2": "SPRING lspr-1 "
    "from=0(1.0,2.0,0.0) to=2:1 stiffness=30.0 rest=1.2",
    f"CABL\n    1\n    0    0    2    0\n{_POINTS}      80.0       1.2": "CABLE cabl-1 from=0(1.0,2.0,0.0) "
    "to=2(0.6,0.0,0.0) stiffness=80.0 rest=1.2",
    f"BUSH\n    1\n    0    0    2    0\n{_POINTS}       9.0       8.0       7.0\n\n": "BUSHING bush-1 "
    "from=0(1.0,2.0,0.0) to=2(0.6,0.0,0.0) k=(9.0,8.0,7.0)",
    "COUP\n    2\n    1    1    3       2.0\n    1    2    3       3.0": "COUPLING coup-1 1.r3=2.0 2.r3=3.0",
    "FRIC\n    1\n    1       0.2       0.3       0.1      0.01      0.05": "FRICTION fric-1 joint=1 "
    "dynamic=0.2 static=0.3 stribeck=0.1 creep=0.01 radius=0.05",
}
TEXTS = {
    "young": lambda card: f"{KINEMATIC}DYNAMICS forward\nMASS 2 1 0 0 0 1 1 1\n{card}\nEND\n",
    "vsdf": lambda card: f"{ARM.rstrip()}\n{card}\nTIME\n 1,0.1\nEND\nSTAR\nSTOP\n",
    "dafms": dafms_deck,
}
CASES = [(name, *pair) for name, cards in (("young", YOUNG), ("vsdf", VSDF), ("dafms", DAFMS))
         for pair in cards.items()]  # fmt: skip


def errors(text):
    with pytest.raises(DeckError) as caught:
        read_deck(decode("test.dat", text.encode()))
    return [fault for fault in caught.value.faults if fault.severity == "error"]


def test_every_word_that_the_block_replaces_has_a_case():
    for name, cards in (("young", YOUNG), ("vsdf", VSDF), ("dafms", DAFMS)):
        assert {card.split()[0] for card in cards} == set(LINES[name])


@pytest.mark.parametrize(("dialect", "card", "line"), CASES)
def test_an_old_card_is_an_error_that_prints_the_line_of_the_block(dialect, card, line):
    text = TEXTS[dialect](card)
    (fault,) = errors(text)
    word = card.split()[0]
    assert fault.message.startswith(f"{word} is no longer a card")
    assert line in fault.message and (f"ELEMENTS: {line}" in fault.message) == bool(line)
    first = text[: text.index(card)].count("\n") + 1
    assert first <= fault.place.line <= first + card.count("\n")


@pytest.mark.parametrize(("dialect", "card", "line"), [case for case in CASES if case[2]])
def test_the_printed_line_is_one_of_the_block(dialect, card, line):
    """Reading it gives no error of form; what it names may be missing in the deck."""
    deck = read_deck(decode("test.dat", TEXTS[dialect](f"ELEMENTS\n  {line}").encode()))
    (record,) = deck.section("elements")
    assert record.word == line.split()[0]


@pytest.mark.parametrize(
    ("dialect", "card", "wanted"),
    [
        ("young", "CABLE 3", "write in a block ELEMENTS: CABLE name from=1(x,y,z) to=1(x,y,z)"),
        ("young", "SINE", "write in a block ELEMENTS: FUNCTION name table|spline"),
        ("vsdf", "COUP\n 1,1", "write in a block ELEMENTS: COUPLING name 2.angle=factor"),
        ("vsdf", "TSPR", "write in a block ELEMENTS: SPRING name (at=2.angle | from="),
    ],
)
def test_a_card_that_lacks_fields_is_answered_by_how_such_lines_are_written(dialect, card, wanted):
    (fault,) = errors(TEXTS[dialect](card))
    assert wanted in fault.message


def test_several_cards_are_named_in_turn():
    faults = errors(TEXTS["young"]("TSPRING 1 5\nTSPRING 1 6"))
    assert [fault.message.split(": ")[1].split()[1] for fault in faults] == ["tspring-1", "tspring-2"]
    faults = errors(TEXTS["dafms"]("HSPR\n    2\n    1    3       5.0\n    2    3       6.0"))
    assert [fault.message.split(": ")[1].split()[1] for fault in faults] == ["hspr-1", "hspr-2"]


@pytest.mark.parametrize("behind", ["", "DYNAMICS forward\nEND\n"])
def test_an_old_card_in_prose_is_a_warning_with_its_line(behind):
    """Nothing is read there: a table's number in prose must not stop a deck of 1996."""
    deck = read_deck(decode("test.dat", f"{KINEMATIC}{behind}\nANGLE 1 3\n".encode()))
    (fault,) = [fault for fault in deck.warnings if "ANGLE" in fault.message]
    assert fault.severity == "warning" and "DRIVE angle-1 at=1.angle value=3" in fault.message


_PATH = str(Path(__file__).parents[3] / "scripts" / "elements_block")
_SPEC = importlib.util.spec_from_loader(
    "script_elements_block", importlib.machinery.SourceFileLoader("script_elements_block", _PATH)
)
SCRIPT = importlib.util.module_from_spec(_SPEC)
_SPEC.loader.exec_module(SCRIPT)


@pytest.mark.parametrize(("dialect", "card", "line"), CASES)
def test_the_script_for_decks_writes_the_line(dialect, card, line):
    text = TEXTS[dialect](card)
    new = SCRIPT.rewritten_deck(text)
    assert card not in new
    found = [found.strip() for found in new.splitlines()]
    after = found[found.index("ELEMENTS") + 1 :] if line else []
    assert " ".join(after[: 1 + line.count("\n")]).startswith(line[:90])
