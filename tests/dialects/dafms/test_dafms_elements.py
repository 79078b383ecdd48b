"""Cards of functions and elements in FMBD.DAT: closed forms, and the same arm in a YOUNG deck."""

from dataclasses import fields, replace
from types import SimpleNamespace

import numpy as np
import pytest

from flexmb_cli.solvers.constrained.tree_element_rows import TreeElementRows
from flexmb_cli.solvers.tree.analysis import TreeAnalysis
from tests.dialects.dafms.dafms_decks import build, reported
from tests.solvers.constrained.element_decks import ARM
from tests.solvers.constrained.element_decks import rows_of as young_rows

# Bodies 1 and 2 turn about axis 3, the second on the end of the first, 1 m away.
TWO_LINKS = """    2    3
DFMB ARM
    1    0    0    0    0
    2    0    0    0    0
    1    1    0    0    1
    2    1    0    0    1
    0    0
    0    0
    5
       0.1
CONN
    0    1
MASS
    1       1.5
    2       0.8
INER
    1       0.1      0.44      0.44
    2      0.05     0.172     0.172
Q(k)
    1       0.0       0.0       0.0
    2       1.0       0.0       0.0
EULT
    1       0.0       0.0       0.0       1.0
    2       0.0       0.0       0.0       1.0
EULL
    1       0.0       0.0       0.0       1.0
    2       0.0       0.0       0.0       1.0
Y(L)
       0.0       0.0       0.0       0.0
RC(K
    1       0.4       0.0       0.0
    2       0.3       0.0       0.0
GRAV
    0       0.0     -9.81       0.0
TOLR
    1.000E-12    1.000E-13
"""
SHORT = TWO_LINKS.replace("       0.1\nCONN", "      0.01\nCONN")
MASSES = "MASS 2 1.5 0.4 0 0 0.1 0.2 0.2\nMASS 3 0.8 0.3 0 0 0.05 0.1 0.1\nGRAVITY 0 -9.81 0\n"


def integers(*values):
    return "".join(f"{value:5d}" for value in values)


def reals(*values):
    return "".join(f"{value:10.4f}" for value in values)


def card(word, *lines):
    return "\n".join([word, integers(1), *lines])


def deck(cards, model=TWO_LINKS):
    return f"{model}{cards}\nEND \nSTAR\nSTOP\n"


def rows_of(cards, method="dop853", model=TWO_LINKS):
    tree = build(deck(cards, model))[0]
    tree = replace(tree, integration=replace(tree.integration, method=method))
    blocks = list(TreeAnalysis(tree).rows())
    names = [field.name for field in fields(TreeElementRows) if field.name != "displacement"]
    return SimpleNamespace(
        **{name: np.concatenate([getattr(block, name) for block in blocks]) for name in names}
    )


def function(number, kind, *values):
    return f"ELEMENTS\n  FUNCTION {number} {kind} {' '.join(map(repr, values))}"


ENDS, HELD = integers(0, 0, 2, 0), reals(1, 2, 0, 0.6, 0, 0)
CASES = {
    "hinge spring": (
        "ELEMENTS\n  SPRING tspring-1 at=1.angle stiffness=20 rest=0.2 damping=0.3 preload=1",
        "ELEMENTS\n  SPRING hspr-1 at=1.r3 stiffness=20 rest=0.2 damping=0.3 preload=1",
    ),
    "stop": (
        "ELEMENTS\n  STOP tstop-1 at=1.angle lower=-0.5 upper=3 stiffness=4000 damping=0.2",
        "ELEMENTS\n  STOP hsto-1 at=1.r3 lower=-0.5 upper=3 stiffness=4000 damping=0.2",
    ),
    "line": (
        "ELEMENTS\n"
        "  SPRING lspring-1 from=0(1,2,0) to=3(0.6,0,0) stiffness=30 rest=1.2 damping=0.5 "
        "preload=2",
        "ELEMENTS\n  SPRING lspr-1 from=0(1,2,0) to=2(0.6,0,0) stiffness=30 rest=1.2 damping=0.5 preload=2",
    ),
    "cable": (
        "ELEMENTS\n  CABLE cable-1 from=0(1,2,0) to=3(0.6,0,0) stiffness=300 rest=1.9 damping=0.1",
        "ELEMENTS\n  CABLE cabl-1 from=0(1,2,0) to=2(0.6,0,0) stiffness=300 rest=1.9 damping=0.1",
    ),
    "bushing": (
        "ELEMENTS\n"
        "  BUSHING bushing-1 from=0(1,2,0) to=3(0.6,0,0) k=(90,160,250) kr=(6,9,16) c=(5,6,7) "
        "cr=(0.2,0.3,0.4)",
        "ELEMENTS\n"
        "  BUSHING bush-1 from=0(1,2,0) to=2(0.6,0,0) k=(90,160,250) kr=(6,9,16) c=(5,6,7) "
        "cr=(0.2,0.3,0.4)",
    ),
    "gears": (
        "ELEMENTS\n  COUPLING coupling-1 1.angle=2 2.angle=3",
        "ELEMENTS\n  COUPLING coup-1 1.r3=2 2.r3=3",
    ),
    "friction": (
        "ELEMENTS\n"
        "  FRICTION friction-1 joint=1 dynamic=0.2 static=0.3 stribeck=0.1 creep=0.01 "
        "radius=0.05 preload=3",
        "ELEMENTS\n"
        "  FRICTION fric-1 joint=1 dynamic=0.2 static=0.3 stribeck=0.1 creep=0.01 radius=0.05 "
        "preload=3",
    ),
    "motor": (
        "ELEMENTS\n  FUNCTION 4 sine 0 3 5\n  MOTOR tmotor-1 at=2.angle effort=4",
        f"{function(4, 'sine', 0, 3, 5)}\nELEMENTS\n  MOTOR motf-1 at=2.r3 effort=4",
    ),
    "driver": (
        "ELEMENTS\n  FUNCTION 4 step 0 0 0.4 1\n  DRIVE angle-1 at=2.angle value=4",
        f"{function(4, 'step', 0, 0, 0.4, 1)}\nELEMENTS\n  DRIVE pref-1 at=2.r3 value=4",
    ),
}


@pytest.mark.long_motion
@pytest.mark.parametrize("name", CASES)
def test_an_arm_moves_as_the_same_arm_in_a_young_deck(name):
    young, dafms = CASES[name]
    # A bushing ends the longer run: its bodies turn by more than a quarter.
    times, model = ("0 0.05 0.01", SHORT) if name == "bushing" else ("0 0.5 0.1", TWO_LINKS)
    one = young_rows(ARM, times, f"{MASSES}{young}\nTOLERANCE 1e-12")
    other = rows_of(dafms, model=model)
    assert other.q == pytest.approx(one.joint_coordinate, abs=1e-8)
    assert other.y == pytest.approx(one.joint_rate, abs=1e-7)
    assert other.element_effort == pytest.approx(one.element_effort, abs=1e-6)
    assert other.element_power == pytest.approx(one.element_power, abs=1e-6)
    assert other.coupling_effort == pytest.approx(one.coupling_effort, abs=1e-6)


@pytest.mark.long_motion
@pytest.mark.parametrize("method", ["dop853", "radau"])
def test_a_stiff_hinge_spring_keeps_its_energy_by_both_integrators(method):
    """Two links from rest: what the springs and the weights lose is kinetic."""
    rows = rows_of("ELEMENTS\n  SPRING hspr-1 at=2.r3 stiffness=400 rest=0.1", method)
    spring = 200 * (rows.q[:, 1] - 0.1) ** 2
    one, both = rows.q[:, 0], rows.q.sum(axis=1)
    height = 1.5 * 0.4 * np.sin(one) + 0.8 * (np.sin(one) + 0.3 * np.sin(both))
    total = rows.kinetic + spring + 9.81 * height
    assert total == pytest.approx(np.full(6, 200 * 0.01), abs=1e-7 if method == "dop853" else 1e-6)


def test_slips_are_told_with_place_object_and_remedy():
    faults = reported(deck("ELEMENTS\n  SPRING hspr-1 at=1.r2 stiffness=20"))
    assert any("hspr-1: rotation 2 of this hinge is not free" in line for line in faults)
    faults = reported(deck("ELEMENTS\n  MOTOR motf-1 at=1.r3 effort=7"))
    assert any("motf-1: there is no function 7; the deck has none" in line for line in faults)
    faults = reported(deck(function(1, "no", 1.0)))
    assert any("FUNCTION name is followed by table, spline, periodic, polynomial" in line for line in faults)


def test_a_coupling_of_one_term_is_refused():
    found = reported(deck("ELEMENTS\n  COUPLING coup-1 1.r3=1"))
    assert any("couples two coordinates or more" in fault for fault in found)
