"""Trouble with numbers in DAFMS decks: steps, tolerances, times, inertias, loops that lie in line."""

# Messages stand here as they are read.
# ruff: noqa: E501
import math
import re

import pytest

from tests.dialects.dafms.dafms_decks import deck_text
from tests.solvers.kinematics.young_linkages import outcome

SHORT = (" 6000\n", " 0100\n")
SPRING = "SPRI\n    1\n    1    1     1.E30\n"
# Crank 0.2 m, coupler 0.6 m, rocker 0.5 m; pivots 0.9 m apart: in line where the crank points away.
IN_LINE = (
    "       0.0        .5       0.0       0.0       0.0        .6",
    "       0.0        .5       0.0       0.0       0.0        .9",
)
DRIVEN = ("END \n", "PRES\n    1\n    1    1       1.5      10.0       0.0\nEND \n")
VANISHED = "'body 1 rotation 1'; the motion or a load grows without bound there, or the tolerance is finer than round-off"


def reported(folder, name, *changes, **options):
    """Errors and warnings of a run, and its exit code."""
    found = outcome(folder, deck_text(name, *changes), "x.DAT", **options)
    return found.exit_code, [f"{fault.severity}: {fault.sentence}" for fault in found.faults]


def cards(text):
    return "END \n", text + "END \n"


@pytest.mark.parametrize("method", [1, 2, 3, 4])
def test_a_tolerance_below_round_off_is_refused(method, tmp_path):
    added = f"TOLR\n    1.0E-20      1.0E-20\nMETH\n    {method}\n"
    assert reported(tmp_path, "pendulum", cards(added)) == (
        2,
        [
            "error: TOLR: RTOL: a relative tolerance of 1e-20 is finer than round-off allows; 1e-14 is the finest"
        ],
    )


def test_the_finest_tolerance_runs(tmp_path):
    added = "TOLR\n    1.0E-14      1.0E-14\n"
    assert reported(tmp_path, "pendulum", SHORT, cards(added)) == (0, [])


def test_a_run_of_ages_is_refused(tmp_path):
    assert reported(tmp_path, "pendulum", ("       .01\n", "     1.E30\n")) == (
        2,
        [
            "error: time: H = 1e+30 s, IT = 6000: the last time would be 6e+33 s; motions are integrated up to "
            "1e+09 s (30 years)"
        ],
    )


def test_a_step_below_round_off_is_refused(tmp_path):
    assert reported(tmp_path, "pendulum", ("       .01\n", "    1.E-30\n")) == (
        2,
        [
            "error: time: H = 1e-30 s, IT = 6000: the time between rows is 1e-30 s; below 1e-12 s there is only "
            "round-off"
        ],
    )


@pytest.mark.parametrize("method", [1, 4])
def test_a_spring_too_stiff_for_any_step_stops_the_compiled_methods(method, tmp_path):
    """The step is a part of the period 2π √(0.018/1e30) = 8e-16 s of the hinge, below the clock's digits."""
    code, (fault,) = reported(tmp_path, "pendulum", SHORT, cards(SPRING + f"METH\n    {method}\n"))
    assert code == 1
    stopped = re.fullmatch(r"error: body 1: at t = 0 s the step length fell to (\S+) s; (.*)", fault)
    assert 0.0 < float(stopped[1]) < 2.0 * math.pi * math.sqrt(0.018 / 1e30)
    assert stopped[2] == "the speed with the largest error is " + VANISHED


@pytest.mark.long_motion
@pytest.mark.parametrize(("method", "name"), [(2, "radau"), (3, "lsoda")])
def test_a_spring_too_stiff_for_any_step_stops_the_library_methods(method, name, tmp_path):
    code, (fault,) = reported(tmp_path, "pendulum", SHORT, cards(SPRING + f"METH\n    {method}\n"))
    assert code == 1
    assert (
        f" s {name} finds no step that meets the tolerance; the motion or a load grows without bound" in fault
    )
    assert float(fault.partition("t = ")[2].partition(" ")[0]) < 1e-12


@pytest.mark.parametrize("gravity", ["9.8", "0.0"])
def test_a_hinge_without_inertia_is_refused_whether_or_not_something_pulls(gravity, tmp_path):
    changes = (
        ("    1      .018      .018", "    1       0.0       0.0"),
        ("       0.0       9.8", f"       0.0       {gravity}"),
    )
    assert reported(tmp_path, "pendulum", *changes) == (
        2,
        [
            "error: body 1: INER about axis 1 is 0 kg m^2, of which its nodes take sum m x^2 = 0: the mass matrix is "
            "not positive definite; add the inertia of the root's half element (rho h^3/24) and of any hub, or "
            "uncouple with card UNCO"
        ],
    )


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        (
            "    2      .036       0.0      .036", "    2       0.0       0.0       0.0",
            "body 2: INER about axis 1 is 0 kg m^2, less than m rc^2 = 0.027 of its mass centre: INER is about O_k, "
            "not about the mass centre",
        ),
        (
            "    2      .036       0.0      .036", "    2     -.036       0.0      .036",
            "body 2: BII1 = -0.036: a moment of inertia is not negative",
        ),
        ("    3        .5\n", "    3       -.5\n", "body 3: BM = -0.5: a mass is not negative"),
    ],
    ids=["zero", "negative", "negative mass"],
)  # fmt: skip
def test_inertias_of_no_body_are_refused(old, new, message, tmp_path):
    assert reported(tmp_path, "fourbar_rigid", (old, new)) == (2, ["error: " + message])


@pytest.mark.long_motion
@pytest.mark.parametrize("method", [1, 4])
def test_a_loop_driven_into_its_position_in_line_stops_there(method, tmp_path):
    """With 0.6 - 0.2 = 0.9 - 0.5 the bars lie in line once a turn; the crank at 1.5 + 10 t then stands at 3
    pi/2.

    Two motions cross there.  Steps over it closed the loop onto the other one, with an energy off by 0.5 J.
    """
    code, (fault,) = reported(tmp_path, "fourbar_rigid", IN_LINE, cards(f"METH\n    {method}\n"), DRIVEN)
    assert code == 1
    assert fault.startswith(
        "error: closure 1: at t = 0.321239 s the loop comes to a singular position (condition "
    )
    assert "'body 3 rotation 1' moves most" in fault
    time = float(fault.partition("t = ")[2].partition(" ")[0])
    assert time == pytest.approx((1.5 * math.pi - 1.5) / 10.0, abs=1e-6)


@pytest.mark.long_motion
def test_a_loop_that_a_library_carries_over_its_position_in_line_is_told_by_its_energy(tmp_path):
    """LSODA closes loops at the rows only.  The crank's turn is given, so that energy and work must
    balance.
    """
    code, (fault,) = reported(tmp_path, "fourbar_rigid", IN_LINE, cards("METH\n    3\n"), DRIVEN)
    assert code == 0
    assert fault.startswith("warning: total energy drifts by ")
    assert fault.endswith(
        " J, which the equations keep constant: the motion is wrong from the row at which it drifts (energy/total); "
        "a loop that passes a singular position, or too coarse a tolerance; compare with a finer TOLR and with "
        "--formulation absolute"
    )


@pytest.mark.long_motion
@pytest.mark.parametrize("tolerance", [1e-10, 1e-11, 1e-12])
def test_the_other_formulation_stops_where_the_loop_lies_in_line(tolerance, tmp_path):
    """The crank points away at 3π/2 rad: from 1.5 rad at 10 rad/s at t = 0.321239 s, printed to six digits.

    Round-off of speeds grows with the inverse square of the way to it; steps that were refused for that
    stopped by up to 2e-4 s too early.
    """
    steps = {"rtol": tolerance, "atol": tolerance}
    code, (fault,) = reported(
        tmp_path, "fourbar_rigid", IN_LINE, DRIVEN, formulation="absolute", integration=steps
    )
    assert code == 1
    stopped = re.match(r"error: at t = (\S+) s the step length falls to ", fault)
    assert float(stopped[1]) == pytest.approx((1.5 * math.pi - 1.5) / 10.0, abs=2e-6)


@pytest.mark.long_motion
def test_a_node_of_a_rigid_parent_is_not_used_and_told(tmp_path):
    """The 1992 listing does not look at NP there either."""
    code, faults = reported(
        tmp_path, "fourbar_rigid", ("NOFP\n    1    0\n    2    0\n", "NOFP\n    1    0\n    2    3\n")
    )
    assert (code, faults) == (
        0, ["note: hinge of body 2: NP = 3 is not used: body 1 is rigid, and Q(k) says where P_k is"],
    )  # fmt: skip
