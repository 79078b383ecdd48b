"""Every joint, stop and spring moves alike in other dialects."""

import numpy as np
import pytest

from tests.run.convert.test_convert_decks import CHAIN, COLUMNS, EXACT, assert_alike, convert, motion


@pytest.mark.long_motion
def test_a_chain_of_every_joint_moves_alike_in_all_dialects_and_back(tmp_path):
    """Springs, motors and loads over time among them; two formulations and the numbers of three formats."""
    (tmp_path / "chain.dat").write_text(CHAIN)
    vsdf = convert(tmp_path / "chain.dat", "vsdf", tmp_path)
    back = convert(vsdf, "young", tmp_path, "back")
    assert_alike(tmp_path / "chain.dat", [vsdf, back], EXACT)
    tree = convert(tmp_path / "chain.dat", "dafms", tmp_path)
    assert_alike(tmp_path / "chain.dat", [tree], COLUMNS)
    assert_alike(tree, [convert(tree, "young", tmp_path, "tree")], EXACT)


# Cards of elements; joint 3 is a revolute, 5 a cylindrical, 6 a translational joint.
ELEMENTS = {
    "stops and friction": (
        "ELEMENTS\n"
        "  STOP tstop-1 at=3.angle lower=-0.1 upper=0.15 stiffness=900 damping=0.2\n"
        "  STOP astop-1 at=6.stroke lower=-0.01 upper=0.03 stiffness=4e4\n"
        "ELEMENTS\n"
        "  FRICTION friction-1 joint=3 dynamic=0.1 static=0.2 stribeck=0.3 creep=0.02 "
        "radius=0.1 preload=2\n"
        "  FRICTION friction-2 joint=6 dynamic=0.2 static=0.2 stribeck=1 creep=0.05\n"
    ),
    "springs with functions": (
        "ELEMENTS\n"
        "  FUNCTION 5 polynomial 0 0 0 40\n"
        "  FUNCTION 6 step -3 -0.5 3 0.7\n"
        "  SPRING turned-1 at=3.angle stiffness=8 rest=0.1 damping=0.4 preload=1.6 curve=5 "
        "damper=6\n"
        "ELEMENTS\n"
        "  FUNCTION 7 spline -1 -20 -0.3 -3 0 0 0.4 7 1 40\n"
        "  SPRING own-aspring-1 at=6.stroke stiffness=80 rest=0.01 damping=0.9 preload=1.6 "
        "curve=7\n"
        "  SPRING own-aspring-2 at=5.stroke stiffness=50 rest=0.02 damping=2\n"
    ),
    "springs in line": (
        "SPRING 2 8 0.1 0 0 0 0.2 0 50 0.4 1\n"
        "ELEMENTS\n"
        "  SPRING own-lspring-1 from=0(0.3,0,1) to=5(0.1,0,0.2) stiffness=40 rest=0.5 damping=0.8 "
        "preload=3\n"
        "ELEMENTS\n"
        "  FUNCTION 8 sine 0.1 2 3\n"
        "  SPRING own-lspring-2 from=0(0.3,0,1) to=4(0.1,0,0.2) stiffness=40 rest=0.5 damping=0.8 "
        "preload=3 curve=8\n"
        "ELEMENTS\n  SPRING own-lspring-3 from=2(0.3,0,1) to=5(0,0,0.2) stiffness=0 rest=0.5 preload=3\n"
    ),
    "cable, bushing, coupling": (
        "ELEMENTS\n"
        "  CABLE own-cable-1 from=0(0.3,0,1) to=5(0.1,0,0.2) stiffness=400 rest=0.5 damping=0.3\n"
        "  COUPLING coupling-1 5.angle=2 5.stroke=10\n"
        "ELEMENTS\n"
        "  BUSHING own-bushing-1 from=0(0.1,0,0) to=8(0.1,0.02,0) k=(90,160,250) kr=(0,0,0) "
        "c=(5,6,7) cr=(0,0,0)\n"
    ),
    "motors by functions": (
        "ELEMENTS\n"
        "  FUNCTION 5 sine 0.1 2 3\n"
        "  FUNCTION 7 polynomial 1 2\n"
        "  FUNCTION 8 product 5 7\n"
        "  FUNCTION 9 ramp 0.6 1 0.8 3\n"
        "  FUNCTION 6 sum 5 8 9\n"
        "ELEMENTS\n  MOTOR turning-1 at=3.angle effort=6\n  MOTOR own-amotor-1 at=6.stroke effort=5\n"
    ),
}


@pytest.mark.long_motion
@pytest.mark.parametrize("cards", ELEMENTS.values(), ids=ELEMENTS)
def test_elements_act_alike_in_other_dialects_and_back(cards, tmp_path):
    (tmp_path / "chain.dat").write_text(
        CHAIN.replace(
            "ELEMENTS\n  SPRING tspring-1 at=3.angle", f"{cards}ELEMENTS\n  SPRING tspring-1 at=3.angle"
        )
    )
    (tmp_path / "without.dat").write_text(CHAIN)
    vsdf = convert(tmp_path / "chain.dat", "vsdf", tmp_path)
    tree = convert(vsdf, "dafms", tmp_path)
    assert_alike(tmp_path / "chain.dat", [vsdf, convert(vsdf, "young", tmp_path, "back")], EXACT)
    assert_alike(tmp_path / "chain.dat", [tree], COLUMNS)
    assert_alike(tree, [convert(tree, form, tmp_path, "tree") for form in ("young", "vsdf")], EXACT)
    assert np.abs(motion(vsdf)[0] - motion(tmp_path / "without.dat")[0]).max() > 1e-3


# A free body on a bushing, to which it is turned against nothing at the start.
HUNG = """\
2 0 0 0 0 0 0 0 0 0 0 1
0 0 0 1 0 0 0
0 0 0 1 0 0 0
1 0 0 0 0 0 0
0 0.2 0.05

DYNAMICS forward
MASS 2 1.5 0.3 0.1 0 0.2 0.3 0.5
GRAVITY 1.2 -9.81 0.4
ELEMENTS
  BUSHING bushing-1 from=0(0.1,0,0) to=2(0.1,0.02,0) k=(900,1600,2500) kr=(60,90,160) c=(5,6,7)
      cr=(0.2,0.3,0.4)
VELOCITY 2 0.1 0.2 -0.1 1.5 -1 2
TOLERANCE 1e-12
END
"""


@pytest.mark.long_motion
@pytest.mark.parametrize("form", ["vsdf", "dafms"])
def test_a_bushing_turns_its_body_back_in_other_dialects(form, tmp_path):
    (tmp_path / "hung.dat").write_text(HUNG)
    new = convert(tmp_path / "hung.dat", form, tmp_path)
    assert_alike(tmp_path / "hung.dat", [new], COLUMNS)


# Links, a weld, a pin and a screw, which close loops; the plane of the link is beside the point of its axis.
LOOPS = """\
VSDF LOOPS
BODY
    1,RIGD
    2,RIGD
    3,RIGD
    4,RIGD
RIGI
    1,2.0,0.05,0.01,0.02
    0.3,0.4,0.5,0.02,0.03,-0.04
    2,1.5,0.03,0.0,0.01
    0.2,0.3,0.25,0.01,0.0,0.02
    3,1.2,0.0,0.02,0.0
    0.22,0.27,0.3
    4,1.1,0.02,0.0,0.03
    0.1,0.12,0.15
POSI
    2,0.4,0.1,0.05
    3,0.9,0.3,-0.2
    4,-0.5,0.2,0.1
EULP
    2,0.9,0.1,0.3,0.2
    4,0.8,-0.1,0.1,0.3
VELO
    3,,,,0.3,-0.2,0.5
NODE
    0,1,-0.5,0.2,0.1
    0,2,0.1,0.8,0.1
    0,3,-0.5,1.2,0.6
    0,4,0.9,0.3,0.5
    1,1,0.0,0.0,0.0
    1,2,0.1,0.2,1.0
    1,3,0.3,0.1,0.0
    1,4,0.3,0.1,0.5
    1,5,0.3,0.6,0.1
    2,1,0.05,0.1,0.02
    2,2,0.05,0.1,0.9
    3,1,0.0,0.0,0.0
    3,2,0.1,0.2,0.3
    3,3,-0.1,0.1,0.4
    4,1,0.0,0.0,0.0
    4,2,0.3,0.1,1.0
    4,3,0.6,0.1,0.2
JOIN
    1,REVO,0,,,1,1,2
    2,FIXD,1,3,4,2,3,4,5,5
    3,RSPH,2,1,2,3,2
    4,DIST,0,4,,3,3
    5,SCRW,0,,,4,1,2,,3,0.3
PINN
    3,1,111
MOTN
    1,ANGL,1,3,-0.2,0.4,3.0,0.7
TABL
    1,0.0,0.0
    1,0.1,2.0
    1,0.2,-1.0
FORC
    3,2,1.0,2.0,-1.5,1,1
TORQ
    4,0.3,0.2,2.0,1,0
SPRI
    1,1,4,4,2,50.0,2.0,0.9
JSPR
    5,12.0,0.3,0.1
GRAV
    0.4,-0.2,-9.81
TIME
    0.3,0.1
INTG
    RK45,1E-12
OUTN
    3,2
END
STAR
STOP
"""
# On body 2 where nodes 3, 4 and 5 of body 1 are at the start.
WELD = """\
    2,3,-0.0463157895,0.0157894737,-0.1005263158
    2,4,-0.3094736842,0.1736842105,0.2942105263
    2,5,0.1221052632,0.4947368421,-0.0531578947
"""


@pytest.mark.long_motion
def test_links_a_weld_a_pin_and_a_screw_move_alike_in_young_and_back(tmp_path):
    text = LOOPS.replace("    3,1,0.0,0.0,0.0\n", f"{WELD}    3,1,0.0,0.0,0.0\n")
    (tmp_path / "loops.vsdf").write_text(text)
    young = convert(tmp_path / "loops.vsdf", "young", tmp_path)
    back = convert(young, "vsdf", tmp_path, "back")
    assert_alike(tmp_path / "loops.vsdf", [young, back], EXACT)
