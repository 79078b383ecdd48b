"""Joint coordinates of lines START: closed forms, the same arm in three dialects, loops that refuse."""

import math
from pathlib import Path

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from scipy.optimize import fsolve

from flexmb_cli import solve
from flexmb_cli.dialects.vsdf.build import build_vsdf
from flexmb_cli.errors import AnalysisError
from flexmb_cli.fe.build_mechanism import flexible_mechanism
from flexmb_cli.run.convert import converted
from flexmb_cli.solvers.constrained.flexible_dynamics import FlexibleDynamics
from flexmb_cli.solvers.tree.analysis import TreeAnalysis
from tests.dialects.dafms.dafms_decks import build, deck_text, faults
from tests.dialects.dafms.test_dafms_elements import TWO_LINKS as OF_DAFMS
from tests.dialects.dafms.test_dafms_elements import deck
from tests.dialects.vsdf.test_elements import TWO_LINKS as OF_VSDF
from tests.dialects.vsdf.vsdf_decks import read
from tests.solvers.constrained.element_decks import ARM, ROTOR, SLIDER, TWO_ROTORS, rows_of

MASSES = (
    "MASS 2 1.5 0.4 0 0 0.1 0.2 0.2\nMASS 3 0.8 0.3 0 0 0.05 0.1 0.1\nGRAVITY 0 -9.81 0\nTOLERANCE 1e-12\n"
)
BEGINS = "ELEMENTS\n  START at=1.{0} value=0.7 rate=1.1\n  START at=2.{0} value=-1.3 rate=-0.4\n"


def vsdf_rows(mechanism, cards):
    text = f"{mechanism}{cards}INTG\n RK45,1e-12\nTIME\n 0.5,0.1\nEND\nSTAR\nSTOP\n"
    return list(FlexibleDynamics(flexible_mechanism(build_vsdf(read(text), Path())[0])[0]).rows())


def test_a_pendulum_begins_beyond_half_a_turn():
    """θ'' = -(m g c / I) sin θ from θ = 4 rad, solved by scipy; a spring sees it, too."""
    cards = (
        "MASS 2 2 0.5 0 0 1 1 0.7\nGRAVITY 9.81 0 0\nTOLERANCE 1e-12\nELEMENTS\n"
        " START at=1.angle value=4 rate=-2\n SPRING s at=1.angle stiffness=0\n"
    )
    rows, k = rows_of(ROTOR, "0 1 0.25", cards), 2 * 9.81 * 0.5 / (0.7 + 2 * 0.25)
    motion = solve_ivp(
        lambda _, y: (y[1], -k * math.sin(y[0])),
        (0, 1),
        (4.0, -2.0),
        "DOP853",
        rows.time,
        rtol=1e-12,
        atol=1e-12,
    )
    assert rows.joint_coordinate[0, 0] == pytest.approx(4, abs=1e-14)
    assert rows.joint_coordinate[:, 0] == pytest.approx(motion.y[0], abs=1e-9)
    assert rows.element_coordinate[:, 0] == pytest.approx(motion.y[0], abs=1e-9)


def test_an_arm_begins_and_moves_alike_in_all_dialects():
    one = rows_of(ARM, "0 0.5 0.1", f"{MASSES}{BEGINS.format('angle')}")
    assert one.joint_coordinate[0] == pytest.approx((0.7, -1.3), abs=1e-14)
    assert one.joint_rate[0] == pytest.approx((1.1, -0.4), abs=1e-13)
    blocks = vsdf_rows(OF_VSDF, BEGINS.format("angle"))
    other = np.concatenate([block.joint_coordinate for block in blocks])
    assert other == pytest.approx(one.joint_coordinate, abs=1e-9)
    tree = build(deck(BEGINS.format("r3"), OF_DAFMS))[0]
    third = np.concatenate([block.q for block in TreeAnalysis(tree).rows()])
    assert third == pytest.approx(one.joint_coordinate, abs=1e-9)


def test_a_coupling_keeps_the_sum_that_it_begins_with():
    """2 x + 3 y stays 2 · 0.5; the second rotor stays where it is."""
    cards = (
        "MASS 2 1 0 0 0 1 1 1\nMASS 3 1 0 0 0 1 1 1\nELEMENTS\n COUPLING gears 1.angle=2 2.angle=3\n"
        " START at=1.angle value=0.5 rate=3\n"
    )
    rows = rows_of(TWO_ROTORS, "0 1 0.25", cards)
    assert rows.joint_coordinate[0] == pytest.approx((0.5, 0), abs=1e-14)
    assert rows.joint_coordinate @ (2, 3) == pytest.approx(np.ones(5), abs=1e-12)


# The four-bar of decks/dafms/fourbar_rigid.DAT: lengths of its bars and of its base, angles of its deck.
BARS, BASE = (0.2, 0.6, 0.5), 0.6
FIRST = (1.5, 1.5 - 0.86704643, 1.5 - 0.86704643 + 2.41734481)


def closed(given, number):
    """Angles of all bars where that of bar `number` is given, near those of the deck."""

    def gap(unknown):
        a = np.insert(unknown, number, given)
        return BARS @ np.column_stack([np.cos(a), np.sin(a)]) - (0.0, BASE)

    return np.insert(fsolve(gap, np.delete(FIRST, number), xtol=1e-14), number, given)


@pytest.mark.parametrize(("value", "bar"), [(2.3, 0), (0.4, 0)])
def test_a_tree_with_a_loop_keeps_what_is_given(value, bar):
    """The crank is where START puts it; coupler and rocker close the loop."""
    text = deck_text("fourbar_rigid", ("\nEND", f"\nELEMENTS\n  START at=1.r1 value={value}\nEND"))
    row = next(iter(TreeAnalysis(build(text)[0]).rows()))
    assert np.cumsum(row.q[0]) == pytest.approx(closed(value, bar), abs=1e-9)


def test_a_tree_whose_rocker_cannot_get_there_is_refused():
    text = deck_text("fourbar_rigid", ("\nEND", "\nELEMENTS\n  START at=3.r1 value=0.1\nEND"))
    with pytest.raises(AnalysisError, match="loop cannot be closed"):
        next(iter(TreeAnalysis(build(text)[0]).rows()))


def four_bar(value, number):
    """The same four-bar as a YOUNG deck in the plane x, y, with START of the joint of a number."""
    places = np.zeros(2)
    lines = ["4 0 0 0 0 4 0 0 0 0 0 1", "0 0 0 1 0 0 0"]
    for length, angle in zip(BARS, FIRST, strict=True):
        half = angle / 2
        x, y = places.tolist()
        lines.append(f"{x!r} {y!r} 0 {math.cos(half)!r} 0 0 {math.sin(half)!r}")
        places = places + length * np.array([math.cos(angle), math.sin(angle)])
    ends = [(1, 2, 0, 0, 0, 0), (2, 3, 0.2, 0, 0, 0), (3, 4, 0.6, 0, 0, 0), (1, 4, *places.tolist(), 0.5, 0)]
    lines += [f"{i} {j} {x!r} {y!r} 0 {u!r} {v!r} 0 {x!r} {y!r} 1 {u!r} {v!r} 1" for i, j, x, y, u, v in ends]
    lines.append("1 0 0 0 0 0 0")
    masses = "".join(f"MASS {k} 0.4 0.1 0 0 0.01 0.01 0.01\n" for k in (2, 3, 4))
    cards = f"{masses}ELEMENTS\n  START at={number}.angle value={value!r}\n"
    return rows_of("\n".join(lines) + "\n", "0 0.01 0.01", cards)


@pytest.mark.parametrize(("turn", "number"), [(0.8, 1), (-1.1, 1), (5.5, 1), (-0.3, 4)])
def test_a_loop_is_led_to_the_angle_of_any_of_its_joints(turn, number):
    """Angles count from those of the deck; the crank may go round."""
    angles = np.cumsum(four_bar(turn, number).joint_coordinate[0, :3]) + FIRST
    wanted = closed(FIRST[0] + turn if number == 1 else FIRST[2] + turn, 0 if number == 1 else 2)
    assert BARS @ np.column_stack([np.cos(angles), np.sin(angles)]) == pytest.approx((0, BASE), abs=1e-8)
    if abs(turn) < 2:
        assert angles == pytest.approx(wanted, abs=1e-8)
    assert angles[0 if number == 1 else 2] == pytest.approx(FIRST[0 if number == 1 else 2] + turn, abs=1e-12)


def test_a_loop_that_cannot_get_there_is_refused_with_where_it_stops():
    """The rocker of this crank-rocker swings by less than half a turn."""
    with pytest.raises(AnalysisError, match=r"cannot be brought to angle 2 .*do not let it pass") as refused:
        four_bar(2.0, 4)
    assert refused.value.faults[0].id == "SOLVE-130"


def test_what_says_the_same_twice_or_nothing_is_refused():
    begins = "ELEMENTS\n  START at=1.r3 value=1\n"
    found = {
        fault.id for fault in faults(deck(f"{begins}  START at=1.r3 rate=2\n  START at=2.r3\n", OF_DAFMS))
    }
    assert found == {"ELEMENTS-001", "ELEMENTS-160"}
    driven = f"{begins}  FUNCTION f sine 0 1 2\n  DRIVE d at=1.r3 value=f\n"
    assert "ELEMENTS-161" in {fault.id for fault in faults(deck(driven, OF_DAFMS))}
    cam = "ELEMENTS\n  FUNCTION f polynomial 0 2\n  COUPLING c from=1.r3 to=2.r3 function=f\n"
    cam += "  START at=2.r3 value=1\n"
    assert "DAFMS-210" in {fault.id for fault in faults(deck(cam, OF_DAFMS))}


def test_a_converted_deck_begins_there_with_springs_that_know_it(tmp_path):
    """In mm, the stroke counts from the start: the spring at rest at 100 mm is so at 100 - 300."""
    cards = "ELEMENTS\n START at=1.stroke value=0.3 rate=2\n SPRING s at=1.stroke stiffness=40 rest=0.1\n"
    deck = tmp_path / "IN.dat"
    deck.write_text(f"{SLIDER}0 1 0.25\nDYNAMICS forward\nMASS 2 1 0 0 0 1 1 1\n{cards}END\n")
    text = converted(str(deck), "young", to_unit="mm")
    (tmp_path / "INMM.dat").write_text(text)
    one, other = solve(deck), solve(tmp_path / "INMM.dat")
    assert one["coordinate.1"][0] == pytest.approx(0.3, abs=1e-14)
    assert other["coordinate.1"] == pytest.approx(1e3 * one["coordinate.1"] - 300, abs=1e-4)
    assert other["element.s.effort"] == pytest.approx(one["element.s.effort"], abs=1e-6)
