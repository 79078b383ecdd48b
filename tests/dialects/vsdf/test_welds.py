"""Fixed joints and prescribed rotations: attitudes that must agree, from any start, not after a half turn.

Expected attitudes are those of the geometry: with the same three nodes on both bodies their axes agree.
"""

import math
from pathlib import Path

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from flexmb_cli.dialects.vsdf.build import build_vsdf
from flexmb_cli.errors import AnalysisError, ModelError
from flexmb_cli.fe.build_mechanism import flexible_mechanism
from flexmb_cli.solvers.constrained.flexible_dynamics import FlexibleDynamics
from tests.dialects.vsdf.vsdf_decks import read

WELD = """\
VSDF A WELD
BODY
    1 RIGD
    2 RIGD
RIGI
 1,1,0,0,0
 0.1,0.1,0.1
 2,2,0,0,0
 0.2,0.2,0.2
NODE
 1,1,0.1,0,0
 1,2,0.6,0,0
 1,3,0.1,0.5,0
 2,1,0.1,0,0
 2,2,0.6,0,0
 2,3,0.1,0.5,0
 0,1,0,0,0
 0,2,0,0,1
 2,4,0,0,0
 2,5,0,0,1
EULP
 2,{p}
JOIN
 1,FIXD,1,1,2,2,1,2,3,3
{hinge}TIME
 0.1,0.1
INTG
 RK45
END
STAR
STOP
"""
HINGE = " 2,REVO,0,1,2,2,4,5\n"


def spelled(p):
    return ",".join(f"{value:.17g}" for value in p)


def attitudes(text):
    """Rotations of the bodies as assembled, and what was warned of."""
    mechanism = flexible_mechanism(build_vsdf(read(text), Path())[0])[0]
    analysis = FlexibleDynamics(mechanism)
    q = analysis.assembled(0.0)[: 7 * len(mechanism.bodies)].reshape(-1, 7)
    return Rotation.from_quat(q[:, [4, 5, 6, 3]]), " ".join(fault.message for fault in analysis.warnings)


def apart(rotations):
    return (rotations[0].inv() * rotations[1]).magnitude()


def about(axis, degrees):
    half = math.radians(degrees) / 2
    return math.cos(half), *(math.sin(half) * np.array(axis) / np.linalg.norm(axis))


@pytest.mark.parametrize("hinge", ["", HINGE])
@pytest.mark.parametrize("axis", [(1, 0, 0), (0, 1, 0), (0, 0, 1), (1, 1, 1), (2, -1, 0.5)])
@pytest.mark.parametrize("degrees", [1, 30, 89, 91, 120, 150, 179, 180, -100])
def test_bodies_are_welded_with_their_nodes_together(degrees, axis, hinge):
    """A twist about a1-a2 was kept, and starts of 90 degrees and more ended at 180."""
    rotations, said = attitudes(WELD.format(p=spelled(about(axis, degrees)), hinge=hinge))
    assert apart(rotations) < 1e-9
    assert ("it is off by" in said) == (abs(degrees) > 90)


def test_a_chain_of_welds_is_turned_as_one():
    """Three bodies that start at random attitudes; twenty of them."""
    chance = Rotation.random(40, random_state=3).as_quat()[:, [3, 0, 1, 2]]
    text = WELD.format(p="{}", hinge=" 2,FIXD,2,1,2,3,1,2,3,3\n").replace(
        "    2 RIGD\n", "    2 RIGD\n    3 RIGD\n"
    )
    text = text.replace(
        "NODE\n", " 3,1,0,0,0\n 0.1,0.1,0.1\nNODE\n 3,1,0.1,0,0\n 3,2,0.6,0,0\n 3,3,0.1,0.5,0\n"
    )
    for second, third in zip(chance[:20], chance[20:], strict=True):
        rotations, _ = attitudes(text.format(f"{spelled(second)}\n 3,{spelled(third)}"))
        assert apart(rotations[:2]) < 1e-9
        assert apart(rotations[1:]) < 1e-9


def test_bodies_that_others_hold_the_wrong_way_round_are_not_welded():
    """Body 1 is held at 0, body 2 at 180 degrees about z: the half turn met all equations of the weld."""
    held = "MOTN\n" + "".join(
        f"{6 * body + k},{word},{body + 1},1,{math.pi if (body, word) == (1, 'ROTZ') else 0}\n"
        for body in (0, 1)
        for k, word in enumerate(("TRAX", "TRAY", "TRAZ", "ROTX", "ROTY", "ROTZ"), start=1)
    )
    text = WELD.format(p="0,0,0,1", hinge="").replace(",0.1,0,0\n", ",0,0,0\n").replace("TIME", f"{held}TIME")
    with pytest.raises(AnalysisError, match="joint 1"):
        attitudes(text.replace("0.1,0.5,0", "0,0.5,0"))


@pytest.mark.parametrize("node, moved, wanted", [
    (" 2,2,0.6,0,0\n", " 2,2,0.8,0,0\n", "nodes a1 and a2 are 0.5 m apart, b1 and b2 0.7 m"),
    (" 2,3,0.1,0.5,0\n", " 2,3,0.1,0.3,0.3\n", "nodes a1 and a3 are 0.5 m apart, b1 and b3 0.424264 m"),
    (" 2,3,0.1,0.5,0\n", " 2,3,0.4,0.4,0\n", "nodes a2 and a3 are 0.707107 m apart, b2 and b3 0.447214 m"),
])  # fmt: skip
def test_nodes_that_cannot_meet_are_refused_with_their_distance(node, moved, wanted):
    with pytest.raises(ModelError) as stopped:
        attitudes(WELD.format(p="1,0,0,0", hinge="").replace(node, moved))
    (fault,) = stopped.value.faults
    assert wanted in fault.message
    assert fault.place.line == 24


def test_nodes_that_miss_by_less_than_a_hundredth_are_welded():
    rotations, _ = attitudes(
        WELD.format(p=spelled(about((1, 0, 0), 1)), hinge="").replace(" 2,2,0.6", " 2,2,0.604")
    )
    assert apart(rotations) < 1e-9


TURNED = """\
VSDF A BODY TURNED BY MOTIONS
BODY
    1 RIGD
RIGI
 1,1,0,0,0
 0.1,0.1,0.1
EULP
 1,{p}
MOTN
1,TRAX,1,1
2,TRAY,1,1
3,TRAZ,1,1
4,{held}
5,{other}
6,{spun},{angle}
TIME
 0.1,0.1
END
STAR
STOP
"""
WORDS = ("ROTX,1,1", "ROTY,1,1", "ROTZ,1,1")


@pytest.mark.parametrize("spin", [0, 1, 2])
@pytest.mark.parametrize("axis, degrees", [
    ((1, 0, 0), 180), ((0, 1, 0), 180), ((0, 0, 1), 180), ((1, 1, -1), 120), ((9, 1, 1), 155), ((1, 2, 3), 9),
])  # fmt: skip
def test_three_prescribed_rotations_give_one_attitude(axis, degrees, spin):
    """A half turn about a held axis was kept without a word; 120 degrees about a diagonal never ended."""
    held, other = (WORDS[axis] for axis in range(3) if axis != spin)
    text = TURNED.format(p=spelled(about(axis, degrees)), held=held, other=other, spun=WORDS[spin], angle=0.4)
    rotations, said = attitudes(text)
    assert rotations[0].as_rotvec() == pytest.approx(0.4 * np.eye(3)[spin], abs=1e-9)
    assert ("it is off by" in said) == (degrees > 90)


@pytest.mark.parametrize("kind", ["REVO,0,1,2,1,1,2", "CYLI,0,1,2,1,1,2", "TRAN,0,1,2,1,1,2,3,3"])
@pytest.mark.parametrize("degrees, wanted", [(80, 0), (100, 180)])
def test_axes_are_lines_and_take_the_nearer_sense(kind, degrees, wanted):
    """The axis of a hinge has no sense: it is assembled by the shorter turn, of which a warning tells."""
    text = WELD.replace("    2 RIGD\n", "").replace(" 2,2,0,0,0\n 0.2,0.2,0.2\n", "").partition("NODE\n")[0]
    text += "NODE\n" + "".join(f" {b},1,0,0,0\n {b},2,0.5,0,0\n {b},3,0,0.5,0\n" for b in (0, 1))
    text += (
        f"EULP\n 1,{spelled(about((0, 0, 1), degrees))}\nJOIN\n 1,{kind}\nTIME\n 0.1,0.1\nEND\nSTAR\nSTOP\n"
    )
    rotations, said = attitudes(text)
    assert np.degrees(rotations[0].magnitude()) == pytest.approx(wanted, abs=1e-6)
    assert "turned by 1.4 rad" in said
