"""The block ELEMENTS: each slip is reported with its place, its object and a remedy, in every dialect.

Expected places are those of the typed words, counted by hand.
"""

from pathlib import Path

import pytest

from flexmb_cli.deck.text import decode
from flexmb_cli.dialects.elements_block.words import WORDS
from flexmb_cli.dialects.recognise import dialect_named, read_deck
from flexmb_cli.dialects.settings import apply_settings
from flexmb_cli.errors import DeckError, ModelError
from flexmb_cli.results.texts.echo import echo
from tests.dialects.dafms.test_dafms_elements import TWO_LINKS, deck
from tests.dialects.vsdf.test_elements import TWO_LINKS as ARM

# Line 6 is the first one of the block: joint 1 is spherical, joint 2 revolute.
BODIES = """3 0 0 1 0 1 0 0 0 1 0 1
0 0 0 1 0 0 0  0 0 0 1 0 0 0  1 0 0 1 0 0 0
2 3 1 0 0 0 0 0  1 2 0 0 0 0 0 0 0 0 1 0 0 1
3 4 0  1 0 0 0 0 0 0  0 1 0.1
"""
MASSES = "MASS 2 1 0 0 0 1 1 1\nMASS 3 1 0 0 0 1 1 1\n"


def young(lines):
    return f"{BODIES}DYNAMICS forward\nELEMENTS\n{lines}\nEND\n"


def vsdf(cards):
    return f"{ARM.rstrip()}\n{cards}\nTIME\n 1,0.1\nEND\nSTAR\nSTOP\n"


def read(text):
    return read_deck(decode("test", text.encode()))


def build(text, folder=Path()):
    found = read(text)
    return dialect_named(found.dialect).build(found, folder)


def errors(text):
    with pytest.raises((DeckError, ModelError)) as caught:
        build(text)
    return [
        f"{f.place.line}:{f.place.column}: {f.sentence}" for f in caught.value.faults if f.severity == "error"
    ]


def notes(text):
    found = read(text)
    model, faults = dialect_named(found.dialect).build(found, Path())
    assert model.elements.forces, "a note drops no element"
    return [f"{f.place.line}:{f.place.column}: {f.severity}: {f.sentence}" for f in faults if f.place]


PLANE = "from=0(0,0,0) to=2(0,0,0) normal=(0,0,1) stiffness=1"
USAGE = (
    "SPRING name (at=2.angle | from=1(x,y,z) to=1(x,y,z)) [stiffness=…] [rest=…] [damping=…] [preload=…] "
    "[curve=function] [damper=function]"
)


@pytest.mark.parametrize(
    ("line", "wanted"),
    [
        ("  SPRNG a at=2.angle", "7:3: there is no 'SPRNG' in ELEMENTS; is SPRING meant?"),
        ("  SPRING at=2.angle", f"7:3: SPRING wants a name: {USAGE}"),
        ("  SPRING a", f"7:3: a: either at= or from= and to= must be given: {USAGE}"),
        ("  SPRING a at=2.angle to=2(0,0,0)", f"7:3: a: either at= or from= and to= must be given: {USAGE}"),
        ("  SPRING a at=2.angle stifness=4", "7:23: a: SPRING has no key 'stifness'; is stiffness meant?"),
        ("  SPRING a at=2.angle stiffness=4x", "7:33: a: stiffness must be a number; read '4x'"),
        ("  SPRING a at=2.angle stiffness=",
         f"7:23: a: no blank may stand beside '=', and a value follows it: {USAGE}"),
        ("  SPRING a at=2.angle rest=1 rest=2", "7:30: a: rest is given twice; remove one"),
        ("  SPRING a at=2.angle 5", f"7:23: a: '5' belongs to no key: {USAGE}"),
        ("  SPRING a from=0(1,2) to=2(0,0,0)", "7:19: a: from takes three numbers (x,y,z); read '1,2'"),
        ("  SPRING a from=0(1,2,3 to=2(0,0,0)",
         "7:18: each parenthesis is closed on the line where it opens"),
        ("  SPRING a from=0 to=2(0,0,0)", "7:17: a: from must be body(x,y,z) or body:node; read '0'"),
        ("  SPRING a from=0(1,2,3) to=2:4",
         "7:31: a: bodies have no nodes here; give the point in body axes, body(x,y,z)"),
        ("  SPRING a from=0(1,2,3) to=7(0,0,0)", "7:29: a: body number 7 is outside 0..3"),
        ("  SPRING a from=2(1,2,3) to=2(0,0,0)", "7:29: a: both ends are on body 2; two bodies are needed"),
        ("  SPRING 3 at=2.angle",
         "7:10: SPRING: 3 is a number, which names functions only; begin the name with a letter"),
        ("  SPRING a,b at=2.angle", "7:10: SPRING: a name is of letters, digits, _ and -; read 'a,b'"),
        ("  SPRING body at=2.angle", "7:10: SPRING: body names numbers of the deck; take another name"),
        ("  SPRING a at=2.angle\n  SPRING A at=2.angle",
         "8:10: SPRING: a on line 7 has this name; take another"),
        ("  SPRING a at=2.strok",
         "7:15: a: at must be a coordinate, such as 2.angle, 2.stroke, 3.r1 or 3.t2; read '2.strok'"),
        ("  SPRING a at=2.stroke",
         "7:15: a: joint 2 (revolute joint 1) has an angle, not a stroke; take 2.angle"),
        ("  SPRING a at=9.angle", "7:15: a: joint number 9 is outside 1..2"),
        ("  SPRING a at=2.r1",
         "7:15: a: a joint has the coordinates angle and stroke, a universal joint "
         "angle1 and angle2, such as 2.angle; read 2.r1"),
        ("  STOP a at=2.angle lower=1 upper=-1 stiffness=3",
         "7:35: a: upper must be larger than lower, 1; read -1"),
        ("  STOP a at=2.angle lower=-1 upper=1 stiffness=-3",
         "7:48: a: stiffness must not be negative; read -3"),
        ("  FUNCTION f tabel 1 2 3 4",
         "7:14: f: FUNCTION name is followed by table, spline, periodic, polynomial, sine, ramp, step, sum "
         "or product; read 'tabel'"),
        ("  FUNCTION f table 0 1 0 2",
         "7:24: f: times must rise; 0 follows 0 (for a jump take two times a little apart)"),
        ("  FUNCTION f table 0 1 x 2", "7:24: f: t2 must be a number; read 'x'"),
        ("  FUNCTION f sine mean=1",
         "7:3: f: sine takes mean amplitude omega phase; amplitude and omega must be given"),
        ("  FUNCTION f sum g", "7:18: f: function g must be given on a line above"),
        ("  FUNCTION f table file=none.txt", "7:25: f: no such file"),
        ("  FUNCTION f table points=3", "7:27: f: there is no table 3; only VSDF decks have such tables"),
        ("  MOTOR m at=2.angle effort=g",
         "7:29: m: there is no function g; the deck has none; define it, or name another"),
        ("  MOTOR m at=2.angle", "7:3: m: effort must be given: MOTOR name at=2.angle effort=function"),
        ("  COUPLING c 2.angle=1", "7:3: c: couples two coordinates or more, 2.angle=1 3.angle=-2; read 1"),
        ("  COUPLING c 2.angle=0 2.angle=3", "7:24: c: 2.angle is given twice; remove one"),
        ("  FRICTION f joint=2 dynamic=0.1 static=0.1 stribeck=1 creep=1e-4",
         "7:3: f: a joint that turns needs the radius of its bearing"),
        (f"  CONTACT c plane-sphere {PLANE} restitution=0.5",
         "7:3: c: plane-sphere needs radius_to=; its shapes have normal and radius_to"),
        (f"  CONTACT c plane-sphere {PLANE} radius_to=1 size_to=(1,1,1)",
         "7:3: c: plane-sphere has no size_to; its shapes have normal and radius_to"),
        (f"  CONTACT c plane-sphere {PLANE} radius_to=1 restitution=0.5",
         "7:103: c: restitution needs the speed of approach at which it holds: speed="),
        (f"  CONTACT c plane-sphere {PLANE} radius_to=0", "7:89: c: radius_to must be larger than 0; read 0"),
        ("  START at=2.angle rate=x", "7:25: start-1: rate must be a number; read 'x'"),
        ("  JOINT l revsph from=0(1,0,0) to=2(0,0,0) length=1",
         "7:3: l: revsph takes axis_from= and length=, and no other of axis_from, axis_to, length"),
        ("  SUPPORT s pin=1",
         "7:17: s: YOUNG decks have no pins; name a simplified constraint by simplified="),
        ("  SPRING a {", "7:12: a comment is opened here and never closed with }"),
        ("  DYNAMICS forward",
         "7:3: there is no 'DYNAMICS' in ELEMENTS; a line begins with "
         f"{', '.join(word.word for word in WORDS[:-1])} or {WORDS[-1].word}"),
        ("SPRING a at=2.angle",
         "7:1: SPRING stands outside a block; a line ELEMENTS before it, in column 1, opens one"),
        ("END\nELEMENTS\n  SPRING a at=2.angle",
         "8:1: ELEMENTS stands after END, where nothing is read; put the block before END"),
    ],
)  # fmt: skip
def test_a_slip_is_reported_with_place_object_and_remedy(line, wanted):
    assert wanted in errors(young(line))


@pytest.mark.parametrize(
    ("numbers", "wanted"),
    [
        ("friction=0.3 static=0.1", "7:111: warning: c: static 0.1 is less than friction 0.3, which then"),
        ("speed=2", "7:97: note: c: speed has no effect if restitution is 1"),
    ],
)  # fmt: skip
def test_numbers_of_contacts_without_effect_are_named(numbers, wanted):
    assert any(
        one.startswith(wanted)
        for one in notes(young(f"  CONTACT c plane-sphere {PLANE} radius_to=1 {numbers}"))
    )


OUTSIDE = "stands outside a block; a line ELEMENTS before it, in column 1, opens one"


@pytest.mark.parametrize(
    ("text", "wanted"),
    [
        (f"{BODIES}ELEMENT\n  SPRING a at=2.angle\n", f"6:3: SPRING {OUTSIDE}"),
        (deck("ELEMNTS\n  SPRING a at=1.r3"), "37:1: there is no card 'ELEMNTS'; is ELEMENTS meant?"),
        (deck("  SPRING a at=1.r3"), f"37:3: SPRING {OUTSIDE}"),
        (deck("  FUNCTION a sine 0 1 2"), f"37:3: FUNCTION {OUTSIDE}"),
        (TWO_LINKS.replace("DFMB", "ELEMENTS\n  SPRING a at=1.r3\nDFMB"),
         "2:1: ELEMENTS stands before DFMB; a block stands among the cards between DFMB and END"),
        (f"{deck('')}ELEMENTS\n  SPRING a at=1.r3\n",
         "41:1: ELEMENTS stands after STOP, where nothing is read; put the block before STOP"),
        (deck("ELEMENTS\n  SPRING a at=1.angle"),
         "38:15: a: hinges have the coordinates r1 to r3 and t1 to t3; free there: 1.r3"),
        (deck("ELEMENTS\n  SPRING a at=2.r1"),
         "38:15: a: rotation 1 of this hinge is not free; free there: 2.r3"),
        (deck("ELEMENTS\n  SPRING a from=0(0,0,0) to=1:4"),
         "38:31: a: body 1 has no nodes; read 4; give the point, body(x,y,z)"),
        (deck("ELEMENTS\n  JOINT j sphsph from=0(0,0,0) to=1(0,0,0) length=1"),
         "38:3: j: decks of this dialect have no JOINT; remove the line"),
        (vsdf("ELEMNTS\n  SPRING a at=1.angle"), "28:1: there is no card 'ELEM'; is ELEMENTS meant?"),
        (vsdf("  SPRING a at=1.angle"), f"28:3: SPRING {OUTSIDE}"),
        (vsdf("ELEMENTS\n  SPRING a from=1(1,2,3) to=0:1"),
         "29:17: a: points of bodies are their nodes; write 1:node, cards NODE give some"),
        (vsdf("TORQ\n 1,0,0,1,0,g"),
         "29:12: torque 1: there is no function g; the deck has none; define it, or name another"),
        (vsdf("TIME\n 1,0.1\nEND\nELEMENTS\n  SPRING a at=1.angle"),
         "31:1: ELEMENTS stands after END, where nothing is read; put the block before END"),
    ],
)  # fmt: skip
def test_nothing_of_a_block_is_lost_silently_in_any_dialect(text, wanted):
    assert wanted in errors(text)


def test_lines_go_on_on_lines_that_are_indented_further():
    lines = (
        "  SPRING a\n    at=2.angle\n      stiffness=3\n {c}   rest=4 { a\n comment }\n"
        "  STOP b at=2.angle lower=0 upper=1\n   stiffness=5"
    )
    model = build(young(lines))[0]
    found = {item.name: (item["stiffness"], item.law.word) for item in model.elements.forces}
    assert found == {"a": (3.0, "SPRING"), "b": (5.0, "STOP")}
    assert model.elements.forces[0]["rest"] == 4.0


def test_a_block_ends_before_the_first_line_in_column_1_and_there_may_be_several():
    model = build(
        young(f"\n  SPRING a at=2.angle\n\n  SPRING b at=2.angle\n{MASSES}ELEMENTS\n  SPRING c at=2.angle")
    )[0]
    assert [item.name for item in model.elements.forces] == ["a", "b", "c"]
    assert len(model.masses) == 2


def test_numbers_are_set_and_echoed_by_the_names_of_elements():
    found = read(young("  SPRING elbow from=0(1,2,3) to=2(4,5,6) stiffness=3"))
    changed = apply_settings(found, ["elbow.stiffness=7", "elbow.to.y=8", "elbow.rest=0.5"])
    (spring,) = dialect_named("young").build(changed, Path())[0].elements.forces
    assert (spring["stiffness"], spring["rest"], spring.measure.P_j) == (7.0, 0.5, (4.0, 8.0, 6.0))
    lines = [line.split()[1:4] for line in echo(found).splitlines() if "elbow." in line]
    assert ["elbow.stiffness", "3", "N/m"] in lines
    assert ["elbow.from.x", "1", "m"] in lines


def test_units_are_those_of_the_coordinate():
    text = echo(
        read(young("  SPRING a at=2.angle stiffness=3\n  SPRING b from=0(1,2,3) to=2(4,5,6) stiffness=3"))
    )
    units = {line.split()[1]: line for line in text.splitlines()[2:]}
    assert " N m/rad " in units["a.stiffness"]
    assert " N/m " in units["b.stiffness"]


def test_functions_have_names_or_numbers_in_cards_too():
    lines = f"  FUNCTION 3 polynomial 2\n  FUNCTION f polynomial 5 number=4\n{MASSES}"
    loads = "FORCE 2 0 0 0 1 0 0 0 f\nFORCE 2 0 0 0 1 0 0 0 3\nTORQUE 2 0 0 1 0 4"
    model = build(young(lines + loads))[0]
    assert [load.factor.at(0.0)[0] for load in (*model.forces, *model.torques)] == [5.0, 2.0, 5.0]


def test_a_table_comes_from_a_file_beside_the_deck(tmp_path):
    (tmp_path / "swing.txt").write_text("# t value\n0, 1\n2 5\n")
    lines = f"  FUNCTION f table file=swing.txt\n  MOTOR m at=2.angle effort=f\n{MASSES}"
    (motor,) = build(young(lines), tmp_path)[0].elements.forces
    assert motor["function"].at(1.0)[0] == 3.0


def test_a_kinematic_deck_has_its_block_right_behind_the_last_number():
    """The coordinate follows 0.3 + 2 t: its function is given."""
    text = (
        BODIES.replace("3 0 0 1", "3 0 0 1", 1)
        + "ELEMENTS\n  FUNCTION f polynomial 0.3 2\n  DRIVE d at=2.angle value=f\nprose\n"
    )
    model = build(text)[0]
    assert model.elements.drivers[0].function.at(0.5)[0] == pytest.approx(1.3)


def test_prose_with_the_word_alone_opens_no_block():
    """The program of 1996 read nothing after dT."""
    found = read(f"{BODIES}of the mechanism\nELEMENTS\nare listed in k=3\n")
    assert not found.section("elements")


@pytest.mark.parametrize("word", [word.word for word in WORDS])
def test_each_word_stands_on_the_reference_page(word):
    page = (Path(__file__).parents[3] / "docs/reference/elements.md").read_text()
    assert f"`{word}" in page
