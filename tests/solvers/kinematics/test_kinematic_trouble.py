# ruff: noqa: E501
"""Dead centres, locks, branchings and narrow places of kinematic decks, told in the deck's words.

Times and gaps are closed forms: a crank from 0.3 rad at 1 rad/s lies in line at π - 0.3 = 2.84159 s; it locks
where cos φ = (4² + 2² - 3.7²)/16, at 0.865409 s; the slider reaches crank + rod where 1.6 t - 0.8 t² = 0.58.
Every deck runs with the factors of small and with those of large mechanisms.
"""

import math
import re

import h5py
import numpy as np
import pytest

from flexmb_cli.deck.text import read_text
from flexmb_cli.dialects.young.build import build_young
from flexmb_cli.dialects.young.reader import read_young
from flexmb_cli.errors import AnalysisError
from flexmb_cli.solvers.kinematics import position, state
from flexmb_cli.solvers.kinematics.analysis import KinematicAnalysis
from flexmb_cli.solvers.kinematics.position import KinematicSettings
from tests.solvers.kinematics.young_linkages import four_bar, gear, outcome, reported, slider_crank

ONE_RADIAN = math.cos(1.0) + math.sqrt(9.0 - math.sin(1.0) ** 2)
BETWEEN = "spherical joint 1 (line 7), universal joint 1 (line 8)"
TURNING = "body 4 turning about (0, 0, 1), body 3 turning about (0, 0, 1) is least determined"
CROSS = "two motions cross there, and the smooth one is followed"
SMALL_AND_LARGE = pytest.mark.parametrize("dense", [True, False], ids=["dense", "sparse"])


def without_figures(line):
    """A note with # in place of its time and condition, and the two."""
    figures = re.search(r"t = (\S+) s .*condition (\S+);", line)
    text = line.replace(f"t = {figures[1]} s", "t = # s").replace(f"condition {figures[2]};", "condition #;")
    return text, float(figures[1]), float(figures[2])


@pytest.fixture(autouse=True)
def factors(request, monkeypatch):
    """The linear algebra of large mechanisms also for small ones, where the test asks for it."""
    if not getattr(request.node, "callspec", None) or request.node.callspec.params.get("dense", True):
        return
    monkeypatch.setattr(position, "DENSE_LIMIT", 0)
    monkeypatch.setattr(state, "DENSE_ELIMINATION", 1)


@SMALL_AND_LARGE
def test_a_parallelogram_that_passes_its_flat_positions_goes_on_and_tells(dense, tmp_path):
    found = outcome(tmp_path, four_bar(4, 1, 4, 1, (0.3, 1, 0), (0, 6, 0.5)))
    assert found.exit_code == 0
    for line, turn in zip(reported(found), (math.pi, 2.0 * math.pi), strict=True):
        text, time, condition = without_figures(line)
        assert text == (
            f"IN.dat:7:1: note: at t = # s the motion passes a singular position of {BETWEEN}, revolute joint 1 "
            f"(line 9) (condition #; {TURNING}); {CROSS}"
        )
        # A crossing is stepped over within 1e-4 of the way.
        assert time == pytest.approx(turn - 0.3, abs=1e-4)
        assert condition > 1e4
    with h5py.File(tmp_path / "IN.h5" if (tmp_path / "IN.h5").exists() else tmp_path / "OUT.h5") as result:
        assert result.attrs["notes"] == "\n".join(line.partition(" note: ")[2] for line in reported(found))
        turn = 2.0 * np.arctan2(
            result["body/euler_parameters"][:, 3, 3], result["body/euler_parameters"][:, 3, 0]
        )
    # A parallelogram's rocker turns with its crank; an antiparallelogram's would turn back.
    assert np.cos(turn - 0.3 - np.arange(13) / 2) == pytest.approx(np.ones(13), abs=1e-12)


@SMALL_AND_LARGE
def test_a_report_row_in_line_is_the_limit_from_both_sides(dense, tmp_path):
    """Rows at 0, π/4, ... of a crank from π/2: the third one is at π, where Φ_q is singular."""
    found = outcome(tmp_path, four_bar(4, 1, 4, 1, (math.pi / 2, 1, 0), (0, 4, math.pi / 4)))
    assert found.exit_code == 0
    assert reported(found) == [
        f"IN.dat:7:1: note: at t = 1.5708 s the motion passes a singular position of {BETWEEN}, revolute "
        f"joint 1 (line 9) (condition above 1e+12; {TURNING}); {CROSS}"
    ]
    with h5py.File(tmp_path / "OUT.h5") as result:
        angle = math.pi / 2 + result["time"][:]
        assert len(angle) == 6
        circle = np.stack([np.cos(angle), np.sin(angle)], axis=1)
        assert result["body/position"][:, 3, :2] == pytest.approx(circle + [4.0, 0.0], abs=1e-12)
        assert result["body/velocity"][:, 3, 0] == pytest.approx(-np.sin(angle), abs=1e-9)
        assert result["body/angular_acceleration"][:, 3, 2] == pytest.approx(np.zeros(6), abs=1e-6)
        assert result["audit/constraint_residual"][:].max() < 1e-12
        assert result["audit/velocity_residual"][:].max() < 1e-12


@SMALL_AND_LARGE
def test_a_gear_at_half_a_turn_has_its_row(dense, tmp_path):
    found = outcome(tmp_path, gear((0, 2 * math.pi, math.pi / 2)))
    assert reported(found) == [
        "IN.dat:8:1: note: at t = 3.14159 s the motion passes a singular position of distance constraint 1 "
        "(line 8) (condition above 1e+12; body 3 turning about (0, 0, 1) is least determined); " + CROSS
    ]
    with h5py.File(tmp_path / "OUT.h5") as result:
        assert result["body/angular_velocity"][:, 2, 2] == pytest.approx(np.ones(5), abs=1e-9)
        assert result["body/euler_parameters"][2, 2] == pytest.approx([0.0, 0.0, 0.0, 1.0], abs=1e-12)


@SMALL_AND_LARGE
def test_a_narrow_place_is_told_with_its_condition(dense, tmp_path):
    """1e-6 m short of a parallelogram: no crossing, the rocker turns back."""
    found = outcome(tmp_path, four_bar(4, 1, 4.0000005, 1.000001, (0.3, 1, 0), (0, 6, 0.5)))
    assert found.exit_code == 0
    for line, turn in zip(reported(found), (math.pi, 2.0 * math.pi), strict=True):
        text, time, condition = without_figures(line)
        assert text == (
            f"IN.dat:7:1: note: at t = # s the motion passes close to a singular position of {BETWEEN}, revolute "
            f"joint 1 (line 9) (condition #; {TURNING})"
        )
        assert time == pytest.approx(turn - 0.3, abs=2e-3)
        assert condition > 3e3


@pytest.mark.long_motion
@SMALL_AND_LARGE
def test_a_lock_is_told_with_the_gap_that_remains(dense, tmp_path):
    """The crank's end is 3.777 m from the rocker's pivot at 1 s, 0.077 m beyond coupler and rocker."""
    found = outcome(tmp_path, four_bar(4, 2, 1.5, 2.2, (0.3, 1, 0), (0, 2, 0.5)))
    assert (found.exit_code, found.rows, found.failed_at) == (1, 2, 1.0)
    (line,) = reported(found)
    head, _, rest = line.partition("the worst ones: ")
    assert head.partition(" ")[2] == (
        "error: at t = 1 s the constraints cannot be met (motion reached t = 0.865409 s); what is left of "
    )
    parts = rest.partition(" m; the mechanism locks, or a driver asks for more than it can do")
    assert parts[1]
    gaps = dict(part.split(": ") for part in f"{parts[0]} m".split("; "))
    assert sorted(gaps) == [
        "revolute joint 1 (x, line 9)", "spherical joint 1 (x, line 7)", "universal joint 1 (x, line 8)",
    ]  # fmt: skip
    assert [float(gap.removesuffix(" m")) for gap in gaps.values()] == pytest.approx([0.077] * 3, rel=0.02)


@pytest.mark.long_motion
@SMALL_AND_LARGE
def test_a_dead_centre_on_the_way_is_a_lock(dense, tmp_path):
    """At 0.5 s the slider is asked for 3.42 + 0.8 - 0.2 = 4.02 m, 0.02 m beyond, half in each joint."""
    found = outcome(tmp_path, slider_crank(1, 3, (3.42, 1.6, -1.6), (0, 2, 0.25), 1.0))
    assert (found.exit_code, found.rows) == (1, 2)
    (line,) = reported(found)
    assert line.partition(" ")[2].startswith(
        "error: at t = 0.5 s the constraints cannot be met (motion reached t = 0.475596 s); what is left of "
    )
    assert "spherical joint 1 (x, line 7): 1.0e-02 m" in line
    assert "universal joint 1 (x, line 8): 1.0e-02 m" in line


@SMALL_AND_LARGE
@pytest.mark.parametrize(
    ("deck", "joints", "motion"),
    [
        (
            slider_crank(1, 1, (math.pi / 2, 1, 0), (0, 3, 0.5)),
            BETWEEN,
            "body 4 moving along (1, 0, 0), body 3",
        ),
        (
            slider_crank(1, 3, (4, -0.1, 0), (0, 2, 0.5), 0.0),
            BETWEEN,
            "body 2 turning about (0, 0, 1), body 3",
        ),
        (gear((0, 1, 0.1), math.pi), "distance constraint 1 (line 8)", "body 3"),
    ],
    ids=["branching", "dead centre", "half a turn"],
)
def test_a_start_at_a_singular_position_is_refused(dense, deck, joints, motion, tmp_path):
    found = outcome(tmp_path, deck)
    assert (found.exit_code, found.rows) == (1, 0)
    line = 8 if "distance" in joints else 7
    assert reported(found) == [
        f"IN.dat:{line}:1: error: at t = 0 s the mechanism starts at a singular position of {joints} "
        f"(condition above 1e+12; {motion} turning about (0, 0, 1) is least determined): a dead centre, or a "
        "place where motions branch; begin a little earlier or later"
    ]


@SMALL_AND_LARGE
def test_a_singular_position_at_rest_is_no_failure(dense, tmp_path):
    """The same gear, not driven on: one equation repeats others for good, and nothing moves."""
    found = outcome(tmp_path, gear((0, 1, 0.5), math.pi, 0.0))
    assert (found.exit_code, found.rows) == (0, 3)
    (line,) = reported(found)
    assert "warning: redundant equations, consistent with the others: one of" in line


@SMALL_AND_LARGE
def test_the_assembly_of_a_mechanism_too_large_for_two_attempts_at_once_ends(dense, tmp_path, monkeypatch):
    """One attempt a call, as of a thousand bodies: a refused one was tried again without end."""
    monkeypatch.setattr(state, "KINEMATIC_CALL_WORK", 0)
    found = outcome(tmp_path, gear((0, 1, 0.5), math.pi, 0.0))
    assert (found.exit_code, found.rows) == (0, 3)


def test_equations_too_many_for_singular_values_are_said_to_be(tmp_path):
    deck = tmp_path / "IN.dat"
    deck.write_text(gear((0, 1, 0.5), math.pi, 0.0))
    mechanism, _ = build_young(read_young(read_text(str(deck))))
    few = KinematicAnalysis(mechanism, KinematicSettings(most_ranked=13))
    with pytest.raises(AnalysisError, match="of 21 equations flexmb does not look for which"):
        next(few.rows())


@pytest.mark.long_motion
def test_a_slider_driven_to_its_dead_centre_and_no_further_stops_there(tmp_path):
    found = outcome(tmp_path, slider_crank(1, 3, (ONE_RADIAN, 4 - ONE_RADIAN, 0), (0, 2, 0.5), 1.0))
    assert found.exit_code == 1
    assert "singular position of " + BETWEEN in reported(found)[0]
    assert found.failed_at in (1.0, 1.5)
