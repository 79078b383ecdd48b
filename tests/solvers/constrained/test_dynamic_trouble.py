# ruff: noqa: E501
"""Trouble with numbers under forces: YOUNG decks with dynamics and VSDF decks.

A parallelogram without gravity turns evenly: from 0.3 rad at 2 rad/s it lies in line at (π - 0.3)/2 = 1.421 s
and (2 π - 0.3)/2 = 2.992 s.
"""

import h5py
import numpy as np
import pytest

from tests.dialects.vsdf.vsdf_decks import RIGID, changed
from tests.solvers.constrained.element_decks import analysis_of, model_of
from tests.solvers.constrained.elements.element_cases import SWIVEL, TWO
from tests.solvers.kinematics.young_linkages import AT_REST, four_bar_bodies, outcome, reported, turned, young

MASS = "MASS 2 1 0.5 0 0 0.01 0.1 0.1\n"
REPEATED = "note: planar mechanism of spatial joints: 3 of "
SPINNING = "VELOCITY 2 0 0 0 0 0 2\n"


def linkage(lengths, angle, cards, time=(0, 4, 0.1), drivers=()):
    """A four-bar of four revolute joints, lines 6 to 9 (one more with a driver), crank, coupler, rocker of 1
    kg.
    """
    ground, crank, coupler, rocker = lengths
    ends = ((1, 2, 0, 0), (2, 3, crank, 0), (3, 4, coupler, 0), (1, 4, ground, -rocker))
    masses = "".join(
        f"MASS {body} 1 {centre} 0 0 0.01 0.1 0.1\n"
        for body, centre in ((2, crank / 2), (3, coupler / 2), (4, -rocker / 2))
    )
    return young(
        four_bar_bodies(*lengths, angle),
        time,
        f"DYNAMICS forward\n{masses if 'MASS' not in cards else ''}{cards.replace('MASSLESS', '')}END\n",
        drivers=drivers,
        revolute=[(i, j, p, 0, 0, q, 0, 0, p, 0, 1, q, 0, 1) for i, j, p, q in ends],
        ground=[AT_REST],
    )


def pendulum(cards, time=(0, 1, 0.1)):
    """A body on a hinge about z: cards from line 8 on."""
    return young(
        (turned(0, 0, 0), turned(0, 0, 0.5)),
        time,
        f"DYNAMICS forward\n{cards}END\n",
        revolute=[(1, 2, 0, 0, 0, 0, 0, 0, 0, 0, 1, 0, 0, 1)],
        ground=[AT_REST],
    )


def test_a_parallelogram_that_passes_its_flat_positions_is_told(tmp_path):
    found = outcome(tmp_path, linkage((4, 1, 4, 1), 0.3, SPINNING))
    assert (found.exit_code, found.rows) == (0, 41)
    joints = ", ".join(f"revolute joint {k} (line {k + 5})" for k in range(1, 5))
    notes = [
        f"IN.dat:6:1: note: near t = {time} s the motion passes a singular position of {joints} (condition above "
        "1e+06), where it could branch; it continues smoothly"
        for time in ("1.421", "2.992")
    ]
    repeated, *others = reported(found)
    assert REPEATED in repeated
    assert others == notes
    with h5py.File(tmp_path / "OUT.h5") as result:
        assert result.attrs["notes"].split("\n")[1:] == [note.partition("note: ")[2] for note in notes]
        assert result["body/angular_velocity"][:, 3, 2] == pytest.approx([2.0] * 41, abs=1e-6)


@pytest.mark.long_motion
@pytest.mark.parametrize("steps", ["", "GALF 0.01 0.9\n"], ids=["explicit", "implicit"])
def test_a_driver_beyond_the_reach_stops_where_the_mechanism_locks(steps, tmp_path):
    """cos φ = (4² + 2² - 3.7²)/16: from 0.3 rad at 1 rad/s at 0.865409 s, the ninth row is the last."""
    deck = linkage((4, 2, 1.5, 2.2), 0.3, steps, drivers=[(2, 6, 0.3, 1, 0)])
    found = outcome(tmp_path, deck)
    assert (found.exit_code, found.rows) == (1, 9)
    assert found.norms["reached"] == pytest.approx(0.865409, abs=1e-6)
    line = reported(found)[-1]
    assert line.startswith("IN.dat:7:1: error: at t = 0.865409 s the step length falls to ")
    assert " s: a singular position of revolute joint 1 (line 7), revolute joint 2 (line 8)" in line
    assert "), a dead centre or a branching, is reached; if the motion locks, free it or end" in line
    assert found.norms["condition"] > 1e4


def around(ground, coupler, rocker, crank=1.0, angle=2.4689, speed=4.1574):
    """A four-bar without loads, its crank given a speed; it lies in line where lengths add up so."""
    return linkage((ground, crank, coupler, rocker), angle, f"VELOCITY 2 0 0 0 0 0 {speed}\n", (0, 2, 0.02))


@pytest.mark.long_motion
@pytest.mark.parametrize("tolerance", [1e-8, 1e-9, 1e-10])
@pytest.mark.parametrize(("coupler", "rocker"), [(2.983532527847233, 2.59568683134426), (4.1, 2.7)])
def test_speeds_do_not_jump_where_the_motion_could_branch(coupler, rocker, tolerance, tmp_path):
    """Ground 1 + coupler - rocker: in line where the crank points along it, at φ = 0.

    Nothing acts: speeds change no faster than in the rows before, whichever way the run ends.
    """
    deck = around(1.0 + coupler - rocker, coupler, rocker)
    found = outcome(tmp_path, deck.replace("VELOCITY", f"TOLERANCE {tolerance}\nVELOCITY"))
    with h5py.File(tmp_path / "OUT.h5") as result:
        speed, rate = (result[f"body/angular_{what}"][:, 1, 2] for what in ("velocity", "acceleration"))
    steps = np.abs(np.diff(speed))
    assert np.all(steps <= 0.02 * 1.5 * np.maximum(np.abs(rate[1:]), np.abs(rate[:-1])) + 0.05)
    if found.exit_code:
        assert "a dead centre or a branching, is reached" in reported(found)[-1]


def test_a_start_in_line_is_no_wrong_driver(tmp_path):
    found = outcome(tmp_path, linkage((4, 1, 4, 1), 0.0, SPINNING))
    assert (found.exit_code, found.rows) == (1, 1)
    line = reported(found)[-1]
    assert "equations that repeated others contradict them: revolute joint " in line
    assert line.endswith(
        "; they did so at the start only, which is a singular position (rods in line); begin elsewhere"
    )


@pytest.mark.long_motion
@pytest.mark.parametrize("length", ["0", "0.01"], ids=["chosen steps", "given steps"])
def test_a_start_in_line_is_no_fault_of_loads(length, tmp_path):
    found = outcome(tmp_path, linkage((4, 1, 4, 1), 0.0, f"{SPINNING}GALF {length} 0.9\n"))
    assert (found.exit_code, found.rows) == (1, 1)
    line = reported(found)[-1]
    assert "equations that repeated others contradict them: revolute joint " in line
    assert line.endswith(
        "; they did so at the start only, which is a singular position (rods in line); begin elsewhere"
    )


def test_equations_that_repeat_others_everywhere_are_not_called_singular(tmp_path):
    spring = "SPRING 1 2 0 2 0 1 0 0 1e20 1 0\n"
    found = outcome(tmp_path, linkage((4, 1, 3.9, 1.2), 0.3, f"{spring}GALF 0 0.9\n"))
    repeated, line = reported(found)
    assert REPEATED in repeated
    assert "so a load, stiffness or speed is too great" in line


@pytest.mark.parametrize(
    ("steps", "others"), [("", "RAD5 or GALF"), ("GALF 0 0.9\n", "RAD5")], ids=["explicit", "implicit"]
)
def test_forces_that_no_step_can_follow_are_told_from_singular_joints(steps, others, tmp_path):
    found = outcome(tmp_path, pendulum(MASS + "SPRING 1 2 0 2 0 1 0 0 1e20 1 0\n" + steps))
    assert found.exit_code == 1
    (line,) = reported(found)
    assert line.startswith("IN.dat: error: at t = 0 s the step length falls to ")
    assert line.endswith(
        "e-23 s: the joints are far from singular (condition 5e+00), so a load, stiffness or speed is too great; "
        f"try {others}, or a smaller one"
    )


@pytest.mark.parametrize(
    "load", ["", "GRAVITY 0 -9.81 0\n", "FORCE 2 1 0 0 0 5 0\n", "TORQUE 2 0 0 3\n"],
    ids=["no load", "gravity", "force", "torque"],
)  # fmt: skip
@pytest.mark.parametrize("steps", ["", "GALF 0.01 0.9\n"], ids=["explicit", "implicit"])
def test_a_motion_without_inertia_is_refused_whatever_the_load(load, steps, tmp_path):
    """A point mass in the hinge's axis: nothing resists the turn."""
    found = outcome(tmp_path, pendulum("MASS 2 1 0 0 0 0 0 0\n" + load + steps))
    assert (found.exit_code, found.rows) == (1, 0)
    assert reported(found) == [
        "IN.dat: error: at t = 0 s body 2 can move without any mass or inertia resisting (smallest inertia 0); "
        "give masses and inertias to what can move"
    ]


@pytest.mark.parametrize("load", ["", "GRAVITY 0 -9.81 0\n"], ids=["no load", "gravity"])
def test_a_linkage_without_mass_is_refused_whatever_the_load(load, tmp_path):
    found = outcome(tmp_path, linkage((4, 1, 3.9, 1.2), 0.3, "MASSLESS" + load))
    assert found.exit_code == 1
    assert reported(found)[-1] == (
        "IN.dat: error: at t = 0 s body 2, body 3, body 4 can move without any mass or inertia resisting "
        "(smallest inertia 0); give masses and inertias to what can move"
    )


@pytest.mark.parametrize(
    ("cards", "message"),
    [
        ("MASS 2 1 .5 0 0 -.01 .1 .1\n", "8:17: error: mass 1: the inertia tensor must have no negative principal moment; they are -0.01, 0.1, 0.1 kg m^2"),
        ("MASS 2 -1 .5 0 0 .01 .1 .1\n", "8:8: error: mass 1: the mass must not be negative; read -1"),
        ("MASS 2 1 .5 0 0 .01 .1 .3\n", "8:17: warning: mass 1: no body has principal moments of inertia 0.01, 0.1, 0.3 kg m^2: the largest exceeds the sum of the others"),
        (MASS + "SPRING 1 2 0 2 0 1 0 0 1e300 1 0\n", "9:24: error: spring 1: stiffness is 1e300; numbers beyond 1e+50 cannot be computed with"),
        (MASS + "GRAVITY 0 1e200 0\n", "9:11: error: gravity 1: g.y is 1e200; numbers beyond 1e+50 cannot be computed with"),
        (MASS + "FORCE 2 1 0 0 1e999 0 0\n", "9:15: error: force 1: F.x must be a number of at most 1.8e308 in size; read '1e999'"),
        (MASS + "TOLERANCE 1e-20\n", "9:11: error: tolerance: must lie between 1e-13 and 0.01; read 1e-20"),
    ],
    ids=["inertia", "mass", "triangle", "stiffness", "gravity", "overflow", "tolerance"],
)  # fmt: skip
def test_numbers_of_no_body_and_beyond_all_bounds_are_told_at_their_place(cards, message, tmp_path):
    found = outcome(tmp_path, pendulum(cards))
    assert reported(found) == ["IN.dat:" + message]
    assert found.exit_code == (0 if "warning" in message else 2)


@pytest.mark.parametrize("value", ["inf", "nan", "-Infinity"])
def test_infinite_loads_are_no_numbers(value, tmp_path):
    found = outcome(tmp_path, pendulum(MASS + f"FORCE 2 1 0 0 {value} 0 0\n"))
    assert found.exit_code == 2
    (message,) = reported(found)
    assert f"force 1: F.x must be a number; read '{value}': a finite number is needed" in message


def test_a_run_of_ages_is_refused(tmp_path):
    assert reported(outcome(tmp_path, pendulum(MASS, (0, 1e12, 1e11)))) == [
        "IN.dat:6:1: error: time: the last time would be 1e+12 s; motions are integrated up to 1e+09 s (30 years)"
    ]


@pytest.mark.parametrize(
    ("change", "message"),
    [
        (("       1.0      0.01\n", "     1E12      1E11\n"), "28:6: error: TIME: the last time would be 1e+12 s; motions are integrated up to 1e+09 s (30 years)"),
        (("    1       2.0       0.5\n", "    1       0.0       0.5\n"), "6:13: error: mass of body 1: the mass must be above zero; read 0.0"),
        (("       0.1       0.2       0.2\n", "       0.1       0.2       0.9\n"), "7:8: error: mass of body 1: no body has the principal moments 0.1, 0.2, 0.9 kg m^2: the largest must not exceed the sum of the others (the moments are about the centre of mass)"),
        (("       0.1       0.2       0.2\n", "      -0.1       0.2       0.2\n"), "7:7: error: mass of body 1: no principal moment of inertia may be negative; the least is -0.1 kg m^2"),
    ],
    ids=["ages", "mass", "triangle", "negative"],
)  # fmt: skip
def test_vsdf_numbers_of_no_body_are_told_at_their_place(change, message, tmp_path):
    found = outcome(tmp_path, changed(change, text=RIGID), "x.vsdf")
    assert found.exit_code == 2
    assert [line for line in reported(found) if "error" in line] == ["IN.dat:" + message]


PIN = "ELEMENTS\n  JOINT revcyl-1 revcyl from=0(1,0,0) to=3(0,0,0) axis_from=({}) axis_to=(1,0,0)\n"
ROD = "ELEMENTS\n  JOINT revsph-1 revsph from=0(1,1,0) to=3(0.6,0,0) axis_from=({}) length=1\n"


@pytest.mark.parametrize(
    ("cards", "told"),
    [
        (
            PIN.format("0 0 1"),
            ("note", "planar mechanism of spatial joints: 2 of 20 equations repeat others, those"),
        ),
        (
            ROD.format("0 0 1"),
            ("note", "planar mechanism of spatial joints: 1 of 19 equations repeats others, those"),
        ),
        (
            PIN.format("0 0 1") + PIN.format("0 0 1").replace("revcyl-1", "again"),
            ("warning", "5 equations repeat others"),
        ),
        (
            "".join(
                f"ELEMENTS\n  JOINT {name} sphsph from=0(1,1,0) to=3(0.6,0,0) length=1\n" for name in "ab"
            ),
            ("warning", "1 equation repeats others"),
        ),
    ],
    ids=["swivel", "rod", "swivel twice", "rod with balls twice"],
)
def test_a_composite_joint_in_a_plane_repeats_what_holds_it_there(cards, told):
    """Out of the plane a swivel holds a displacement and a turn, a rod with a hinge a displacement.

    17 equations are those of two revolute joints and of the ground with its four Euler parameters.
    """
    analysis = analysis_of(model_of(SWIVEL, "0 1 1", f"{TWO}{cards}"))
    analysis.start()
    (fault,) = analysis.warnings
    assert (fault.severity, fault.message[: len(told[1])]) == told
