"""Overconstrained loops whose axes are off, or rounded to print: refused with what is left, or moved with it.

Expected: a four-bar in the plane, whose loop closes by the law of cosines, and the constancy of its energy; a
bar's end that stays off the plane by what the deck types.
"""

import math
from pathlib import Path

import numpy as np
import pytest

from flexmb_cli import interface
from flexmb_cli.deck.text import decode
from flexmb_cli.dialects.recognise import read_deck
from flexmb_cli.errors import AnalysisError
from flexmb_cli.run.loop_tolerance import typed_precision

DECKS = Path(__file__).parents[3] / "decks"
CRANK, COUPLER, ROCKER, GROUND, ANGLE = 0.4, 0.9, 0.7, 1.0, 1.0


def four_bar(tilt, digits=17, method=""):
    """A four-bar of revolutes about z; the last axis is tilted on the ground."""
    B = CRANK * np.array([math.cos(ANGLE), math.sin(ANGLE)])
    way = np.array([GROUND, 0.0]) - B
    L = float(np.hypot(*way))
    angle = math.atan2(way[1], way[0]) + math.acos((COUPLER**2 + L**2 - ROCKER**2) / (2 * COUPLER * L))
    C = B + COUPLER * np.array([math.cos(angle), math.sin(angle)])
    poses = [(0, 0, ANGLE), (*B, angle), (GROUND, 0, math.atan2(C[1], C[0] - GROUND))]
    bodies = [[x, y, 0, math.cos(0.5 * a), 0, 0, math.sin(0.5 * a)] for x, y, a in poses]
    lines = [" ".join(repr(round(float(x), digits)) for x in body) for body in bodies]
    masses = "".join(f"MASS {k} 1 0.2 0 0 .01 .02 .02\n" for k in (2, 3, 4))
    return "\n".join(
        [
            "4 0 0 0 0 4 0 0 0 0 0 1",
            "0 0 0 1 0 0 0",
            *lines,
            "1 2 0 0 0 0 0 0 0 0 1 0 0 1",
            f"2 3 {CRANK} 0 0 0 0 0 {CRANK} 0 1 0 0 1",
            f"3 4 {COUPLER} 0 0 {ROCKER} 0 0 {COUPLER} 0 1 {ROCKER} 0 1",
            f"1 4 {GROUND} 0 0 0 0 0 {GROUND} {tilt} 1 0 0 1",
            "1 0 0 0 0 0 0",
            "0 1 0.05",
            "DYNAMICS forward",
            f"{masses}GRAVITY 0 -9.81 0",
            f"{method}\nEND\n",
        ]
    )


@pytest.fixture
def solve(tmp_path):
    def solved(text, name="x.dat", **options):
        path = tmp_path / name
        path.write_text(text)
        return interface.solve(path, **options)

    return solved


def loop_gap(position):
    """How far coupler's and rocker's lengths are off between their pins, from the origins of the bodies."""
    B, D = position[:, 2, :2], position[:, 3, :2]
    crank = np.hypot(*B.T) - CRANK
    return max(np.max(np.abs(crank)), np.max(np.abs(D - [GROUND, 0.0])))


@pytest.mark.parametrize(
    ("tilt", "digits", "options"),
    [
        ("1e-8", 17, {"loop_tolerance": 1e-7}),
        ("1e-6", 7, {}),
        ("1e-6", 17, {"loop_tolerance": 1e-5}),
        ("1e-4", 17, {"loop_tolerance": 1e-3}),
        ("1e-2", 17, {"loop_tolerance": 0.02}),
    ],
)
def test_a_loop_within_the_tolerance_moves_and_keeps_its_gap(solve, tilt, digits, options):
    found = solve(four_bar(tilt, digits), **options)
    residual, total = (np.array(found[name]) for name in ("audit/constraint_residual", "energy/total"))
    assert 0.1 * float(tilt) < residual.max() < 10.0 * float(tilt)
    assert np.ptp(total) < 1e-6 + 0.5 * float(tilt)
    assert loop_gap(np.array(found["body/position"])) < 5.0 * float(tilt)
    notes = [fault.message for fault in found.warnings if fault.id == "SOLVE-080"]
    assert len(notes) == 1
    assert "overconstrained and closes only to" in notes[0]
    assert np.ptp(np.array(found["body/position"])[:, 2, 0]) > 0.1, "it moves"


@pytest.mark.parametrize("tilt", ["1e-8", "1e-6", "1e-4", "1e-3", "1e-2"])
def test_a_loop_beyond_the_tolerance_is_refused_with_what_is_left(solve, tilt):
    with pytest.raises(AnalysisError, match=r"overconstrained and closes only to .* rad") as failure:
        solve(four_bar(tilt))
    assert 0.05 * float(tilt) < failure.value.norms["gap"] < float(tilt)
    assert "--loop-tolerance" in str(failure.value)


def test_the_digits_typed_are_those_of_the_coarsest_number_that_looks_rounded():
    """Half a unit of the sixth digit is 5e-7; the roundings of a loop add up to ten times as much."""
    for typed, precision in (
        ("0.707107", 5e-6),
        ("-.70710678", 5e-8),
        ("1.50000000000", 5e-12),
        ("0.5", 5e-8),
    ):
        text = f"{{ {typed} 0.25 1.5 }}\n{four_bar(0, 1)}".replace("0.01", "1")
        assert typed_precision(read_deck(decode("x.dat", text.encode()))) == pytest.approx(precision)


@pytest.mark.parametrize("formulation", ["kane"])
def test_a_loop_of_a_tree_keeps_the_gap_across_its_plane(solve, formulation):
    """The cut joint is closed across the plane of the four-bar, too, a millimetre beside it."""
    text = (DECKS / "dafms/fourbar_rigid.DAT").read_text()
    plane = "    3    0    0    0    0    1    1\n       0.0        .5       0.0       0.0"
    assert plane in text
    beside = text.replace(
        plane, "    3    0    0    0    1    1    1\n       0.0        .5       0.0      .001"
    )
    with pytest.raises(AnalysisError, match=r"overconstrained and closes only to 1\.0e-03 m"):
        solve(beside, "x.DAT")
    found = solve(beside, "x.DAT", loop_tolerance=0.01)
    assert np.array(found["audit/constraint_residual"]) == pytest.approx(np.full(201, 1e-3), rel=1e-6)
