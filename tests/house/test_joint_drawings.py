"""Drawings of joints: their points make the joint that they show, and the files are those of the script."""

import sys
from pathlib import Path

import pytest

from flexmb_cli import check, read_deck
from flexmb_cli.model.joints import JOINT_TYPES, NODE_JOINT_TYPES

TOP = Path(__file__).resolve().parents[2]
sys.path.insert(0, str(TOP / "docs" / "_ext"))

import joint_drawings  # noqa: E402

COUNTED = [joint.name for joint in JOINT_TYPES]  # in the order of the counts of a YOUNG deck


@pytest.mark.parametrize("name", joint_drawings.NAMES)
def test_a_drawing_is_that_of_the_script(name):
    stored = joint_drawings.FOLDER / f"{name}.svg"
    assert stored.read_text(encoding="utf-8") == joint_drawings.draw(name)


@pytest.mark.parametrize("joint", (*JOINT_TYPES, *NODE_JOINT_TYPES), ids=lambda joint: joint.name)
def test_a_drawing_shows_all_points_of_its_joint(joint):
    """The points that decks give, by the table of joints, under the names that the formats use."""
    drawn = joint_drawings.draw(joint.name)
    assert tuple(sorted(joint_drawings.POINTS[joint.name])) == tuple(sorted(joint.points))
    missing = [
        point for point in joint.points if f'{point[0]}<tspan dy="3" font-size="10">{point[2]}' not in drawn
    ]
    assert missing == []


@pytest.mark.parametrize("name", COUNTED)
def test_the_points_of_a_drawing_meet_the_equations_of_the_joint(name):
    """As a deck of two bodies at rest at the origin, which the kernels of the joint judge."""
    points = joint_drawings.POINTS[name]
    order = [point + side for point in "PQH" for side in ("_i", "_j") if f"{point}_i" in points]
    numbers = " ".join(str(value) for point in order for value in points[point])
    counts = " ".join(str(int(name == each)) for each in COUNTED)
    deck = (
        f"2 0 0 {counts} 0 0 1\n0 0 0 1 0 0 0\n0 0 0 1 0 0 0\n1 2 {numbers}{' 0.1' * (name == 'screw')}\n"
        "1 0 0 0 0 0 0\n0 1 1\nDYNAMICS forward\nMASS 2 1 0 0 0 1 1 1\nEND\n"
    )
    gaps = check(read_deck(deck)).gaps
    assert f"{name} joint 1" in {owner for owner, *_ in gaps}
    assert max(max(gap[1], gap[2]) for gap in gaps) < 1e-12
