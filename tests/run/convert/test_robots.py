"""Models of URDF and MJCF files as decks: MuJoCo, which reads both formats, computes the same motions."""

from xml.etree import ElementTree

import h5py
import numpy as np
import pytest
from click.testing import CliRunner

from flexmb_cli.cli import cli
from flexmb_cli.results.models.mjcf_file import mjcf_model, solid

URDF = """<?xml version="1.0"?>
<robot name="crane">
  <link name="base"/>
  <link name="tower">
    <inertial><origin xyz="0 0.1 0.4" rpy="0.2 -0.1 0.3"/><mass value="5"/>
      <inertia ixx="0.3" ixy="0.01" ixz="-0.02" iyy="0.4" iyz="0.03" izz="0.2"/></inertial>
    <visual><origin xyz="0 0 0.4"/><geometry><box size="0.1 0.2 0.8"/></geometry></visual>
  </link>
  <joint name="turn" type="continuous"><parent link="base"/><child link="tower"/>
    <origin xyz="0.2 0 0.1" rpy="0.5 0.3 0"/><axis xyz="0 0 1"/><dynamics damping="0.3"/></joint>
  <link name="plate">
    <inertial><origin xyz="0.1 0 0"/><mass value="1.5"/>
      <inertia ixx="0.02" ixy="0" ixz="0" iyy="0.03" iyz="0" izz="0.04"/></inertial>
  </link>
  <joint name="weld" type="fixed"><parent link="tower"/><child link="plate"/>
    <origin xyz="0 0 0.8" rpy="0 0 1"/></joint>
  <link name="jib">
    <inertial><origin xyz="0.5 0 0.05"/><mass value="2"/>
      <inertia ixx="0.02" ixy="0.001" ixz="0" iyy="0.2" iyz="0" izz="0.19"/></inertial>
    <visual><origin xyz="0.5 0 0" rpy="0 1.5707963267948966 0"/>
      <geometry><cylinder radius="0.04" length="1"/></geometry></visual>
  </link>
  <joint name="luff" type="revolute"><parent link="plate"/><child link="jib"/>
    <origin xyz="0.1 0.05 0.1" rpy="0.1 0.4 -0.2"/><axis xyz="0.1 1 0.2"/>
    <limit lower="-3" upper="3" effort="1" velocity="1"/></joint>
  <link name="trolley">
    <inertial><mass value="0.7"/>
      <inertia ixx="0.01" ixy="0" ixz="0" iyy="0.01" iyz="0" izz="0.01"/></inertial>
  </link>
  <joint name="run" type="prismatic"><parent link="jib"/><child link="trolley"/>
    <origin xyz="0.6 0 0" rpy="0 0 0.3"/><axis xyz="1 0.2 0"/><dynamics damping="2"/>
    <limit lower="-9" upper="9" effort="1" velocity="1"/></joint>
</robot>
"""
MJCF = """<mujoco model="toy">
  <compiler angle="degree" eulerseq="zyx"/>
  <option gravity="0.5 0 -9.81"/>
  <default><geom density="2700" contype="0" conaffinity="0"/>
    <default class="stiff"><joint stiffness="3" damping="0.1" springref="20"/></default></default>
  <worldbody>
    <body name="arm" pos="0 0 1" euler="30 20 -10">
      <joint name="shoulder" axis="0 1 0.3" pos="0.02 0 0.01" class="stiff"/>
      <geom type="capsule" fromto="0 0 0 0.4 0 0.1" size="0.03"/>
      <geom type="box" size="0.03 0.05 0.02" pos="0.2 0.05 0" quat="0.9 0.1 0.2 0.3" mass="0.4"/>
      <body name="slider" pos="0.4 0 0.1" axisangle="1 1 0 40">
        <joint name="reach" type="slide" axis="1 0 1" stiffness="40" springref="0.05"/>
        <inertial pos="0.01 0.02 0" mass="0.5" fullinertia="0.003 0.004 0.005 0.0002 -0.0001 0.0003"/>
        <body name="cross" pos="0 0 -0.1" zaxis="0.2 0.1 1">
          <joint name="yaw" axis="1 0 0"/><joint name="pitch" axis="0 1 0"/>
          <geom type="ellipsoid" size="0.05 0.06 0.08" pos="0 0 -0.2"/>
          <body name="bob" pos="0 0 -0.3" xyaxes="0 1 0 -1 0.2 0">
            <joint name="hook" type="ball" pos="0 0 0.02"/>
            <geom type="cylinder" size="0.05 0.1" pos="0.02 0 -0.15"/>
          </body>
        </body>
      </body>
    </body>
    <body name="flyer" pos="2 0 1" euler="10 0 50"><freejoint/>
      <geom type="box" size="0.1 0.2 0.3" pos="0.1 0 0"/>
      <body name="flap" pos="0.1 0.2 0"><joint name="hinge" axis="1 0 0"/>
        <geom size="0.08" pos="0 0.3 0"/></body>
    </body>
  </worldbody>
  <keyframe><key qpos="0.3 0.02 -0.2 0.1 0.9 0.1 -0.3 0.2 2 0 1 0.8 0.5 -0.1 0.2 0.4"
    qvel="1 -0.2 0.5 2 0.3 -1 4 0.5 1 2 3 -1 2 0.7"/></keyframe>
</mujoco>
"""
LOOP = """<mujoco model="four bar"><compiler angle="radian"/>
  <default><geom type="capsule" size="0.02" contype="0" conaffinity="0"/></default>
  <worldbody>
    <body name="crank"><joint name="a" axis="0 1 0"/><geom fromto="0 0 0 0 0 0.2"/>
      <body name="rod" pos="0 0 0.2"><joint name="b" axis="0 1 0"/>
        <geom fromto="0 0 0 0.5 0 0.2"/></body></body>
    <body name="rocker" pos="0.5 0 0"><joint name="c" axis="0 1 0"/><geom fromto="0 0 0 0 0 0.4"/></body>
    <body name="gear" pos="-0.5 0 0"><joint name="d" axis="0 1 0"/><geom fromto="0 0 0 0 0 0.1"/></body>
  </worldbody>
  <equality>
    <connect name="pin" body1="rod" body2="rocker" anchor="0.5 0 0.2"
      solref="0.0005 1" solimp="0.9999 0.99999 1e-6"/>
    <joint name="mesh" joint1="d" joint2="a" polycoef="0 -2 0 0 0"
      solref="0.0005 1" solimp="0.9999 0.99999 1e-6"/>
  </equality>
  <keyframe><key qpos="0 0 0 0" qvel="2 -2 1 -4"/></keyframe></mujoco>
"""
ROWS = 101


def mujoco_motion(text, names, step):
    """Positions (rows, bodies, 3) of the origins of bodies of a file, by MuJoCo's RK4."""
    mujoco = pytest.importorskip("mujoco")
    model = mujoco.MjModel.from_xml_string(text)
    model.opt.timestep, model.opt.integrator = step, mujoco.mjtIntegrator.mjINT_RK4
    model.opt.disableflags |= mujoco.mjtDisableBit.mjDSBL_LIMIT
    data = mujoco.MjData(model)
    if model.nkey:
        mujoco.mj_resetDataKeyframe(model, data, 0)
    rows = []
    for row in range(ROWS):
        while data.time < 0.01 * row - step / 2:
            mujoco.mj_step(model, data)
        mujoco.mj_forward(model, data)
        rows.append([data.body(name).xpos.copy() for name in names])
    return np.array(rows)


def flexmb_motion(text, name, form, count, folder, monkeypatch):
    """The same of the first bodies by flexmb, in their order."""
    monkeypatch.chdir(folder)
    (folder / name).write_text(text)
    deck = "INROBOT.dat" if form == "young" else "robot.vsdf"
    for arguments in (("convert", name, "--to", form, "-o", deck), ("run", deck)):
        done = CliRunner().invoke(cli, arguments)
        assert done.exit_code == 0, (done.output, done.exception)
    with h5py.File("OUTROBOT.h5" if form == "young" else "robot.h5") as result:
        # The last body of a YOUNG deck is the ground.
        return result["body/position"][:, :count]


@pytest.mark.parametrize("form", ["young", "vsdf"])
def test_a_robot_of_urdf_moves_as_in_mujoco(form, tmp_path, monkeypatch):
    """MuJoCo joins welded links as well: the plate has no body in either."""
    names = ["tower", "jib", "trolley"]
    theirs = mujoco_motion(URDF, names, 1e-4)
    own = flexmb_motion(URDF, "crane.urdf", form, 3, tmp_path, monkeypatch)
    assert np.ptp(theirs[:, 2], axis=0).max() > 0.5
    assert np.abs(own - theirs).max() < 1e-7  # m; RK4 of MuJoCo at 1e-4 s


def test_a_model_of_mjcf_moves_as_in_mujoco(tmp_path, monkeypatch):
    """Balls, crosses and free bodies with springs, from a key with positions and speeds."""
    names = ["arm", "slider", "cross", "bob", "flyer", "flap"]
    theirs = mujoco_motion(MJCF, names, 1e-4)
    own = flexmb_motion(MJCF, "toy.xml", "young", 6, tmp_path, monkeypatch)
    assert np.abs(own[0] - theirs[0]).max() < 1e-9
    assert np.abs(own - theirs).max() < 1e-6


def test_a_loop_of_sites_is_that_of_its_anchor():
    """At the reference both are the same point: (0.5, 0, 0.2) of the rod, (0, 0, 0.4) of the rocker."""
    text = LOOP.replace('body1="rod" body2="rocker" anchor="0.5 0 0.2"', 'site1="a" site2="b"')
    text = text.replace('<joint name="b"', '<site name="a" pos="0.5 0 0.2"/><joint name="b"')
    text = text.replace('<joint name="c"', '<site name="b" pos="0 0 0.4"/><joint name="c"')
    for one in (text, LOOP):
        joint = mjcf_model(ElementTree.fromstring(one), []).joints[-1]
        assert (joint.i, joint.j, joint.P_i) == (1, 2, (0.5, 0.0, 0.2))
        assert joint.P_j == pytest.approx((0.0, 0.0, 0.4), abs=1e-15)


def test_loops_and_gears_of_mjcf_close(tmp_path, monkeypatch):
    """MuJoCo closes loops by stiff forces: with smaller steps its motion comes nearer to the exact one."""
    names = ["crank", "rod", "rocker", "gear"]
    own = flexmb_motion(LOOP, "loop.xml", "young", 4, tmp_path, monkeypatch)
    theirs = mujoco_motion(LOOP, names, 2e-5)
    assert np.ptp(theirs[:, 1], axis=0).max() > 0.1
    assert np.abs(own - theirs).max() < 2e-4


@pytest.mark.parametrize("kind", ["sphere", "box", "ellipsoid", "cylinder", "capsule"])
def test_solids_have_the_inertia_that_mujoco_gives_them(kind):
    mujoco = pytest.importorskip("mujoco")
    text = f'<mujoco><worldbody><body><geom type="{kind}" size="0.1 0.2 0.3"/></body></worldbody></mujoco>'
    model = mujoco.MjModel.from_xml_string(text)
    volume, moments = solid(kind, np.array([0.1, 0.2, 0.3]))
    assert volume * 1000 == pytest.approx(model.body_mass[1], rel=1e-12)
    theirs = sorted(model.body_inertia[1])
    assert sorted(1000 * volume * moments) == pytest.approx(theirs, rel=1e-12)


@pytest.mark.parametrize(
    ("old", "new", "words"),
    [
        ('<dynamics damping="0.3"/>', '<dynamics friction="0.3"/>', "turn: constant friction"),
        ('type="prismatic"', 'type="planar"', "run: a joint planar is not a joint of flexmb"),
        ('<parent link="base"/>', '<parent link="none"/>', "turn: its parent is not a link: none"),
        ('xyz="0.2 0 0.1"', 'xyz="0.2 0"', "expected 3 numbers; read '0.2 0'"),
        ("</robot>", "", "this is not XML"),
        ("<robot", "<roboter", "expected <robot> or <mujoco>"),
        ('<parent link="base"/>', '<parent link="trolley"/>', "its joints lead to no root"),
        ('value="0.7"', 'value="x"', "an attribute is not a number"),
    ],
)
def test_what_does_not_convert_is_refused(old, new, words, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    text = URDF.replace(old, new).replace("</roboter", "</robot") if "roboter" not in new else (
        URDF.replace("<robot", "<roboter").replace("</robot", "</roboter"))  # fmt: skip
    (tmp_path / "bad.urdf").write_text(text)
    done = CliRunner().invoke(cli, ["convert", "bad.urdf", "--to", "young"])
    assert done.exit_code and words in str(done.exception)
    assert not (tmp_path / "INbad.dat").exists()
