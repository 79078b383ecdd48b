"""Motors, springs, dampers and cables of a serial arm, the same model in MuJoCo (minimal coordinates)."""

import mujoco
import numpy as np
import pytest

from tests.solvers.constrained.element_decks import rows_of

pytestmark = pytest.mark.long_motion

# Body 2 turns about z of the ground, body 3 on its end, body 4 slides along body 3.
ARM_WITH_SLIDE = (
    "4 0 0 0 0 2 0 1 0 0 0 1\n0 0 0 1 0 0 0\n0 0 0 1 0 0 0\n1 0 0 1 0 0 0\n1.5 0 0 1 0 0 0\n"
    "1 2 0 0 0 0 0 0 0 0 1 0 0 1\n2 3 1 0 0 0 0 0 1 0 1 0 0 1\n"
    "3 4 0.5 0 0 0 0 0 1.5 0 0 1 0 0 0.5 1 0 0 0 1\n1 0 0 0 0 0 0\n"
)
CARDS = (
    "MASS 2 1.5 0.4 0.02 0 0.1 0.2 0.2\nMASS 3 0.8 0.3 -0.01 0.05 0.05 0.1 0.1\n"
    "MASS 4 0.6 0.1 0.03 0 0.02 0.03 0.04\nGRAVITY 0.5 -9.81 0.3\n"
    "ELEMENTS\n"
    "  SPRING tspring-1 at=1.angle stiffness=20 rest=0.2 damping=0.3\n"
    "  SPRING tspring-2 at=2.angle stiffness=5 damping=0.1\n"
    "  SPRING aspring-1 at=3.stroke stiffness=90 rest=0.05 damping=0.7\n"
    "ELEMENTS\n"
    "  SPRING lspring-1 from=0(1,2,0) to=3(0.6,0,0) stiffness=30 rest=1.2 damping=0.5\n"
    "SPRING 0 4 1 -2 0 0.1 0.2 0.1 12 0.9 0.2\n"
    "DAMPER 0 2 0.3 1 0.2 0.5 0.1 0 0.4\n"
    "ELEMENTS\n"
    "  CABLE cable-1 from=0(3,1,0) to=4(0.2,0,0) stiffness=40 rest=1.7\n"
)
MODEL = """<mujoco><option gravity="0.5 -9.81 0.3" integrator="RK4" timestep="2e-4"/>
<compiler angle="radian" inertiafromgeom="false"/>
<worldbody>
 <site name="g3" pos="1 2 0"/><site name="g4" pos="1 -2 0"/><site name="g2" pos="0.3 1 0.2"/>
 <site name="gc" pos="3 1 0"/>
 <body><inertial mass="1.5" pos="0.4 0.02 0" diaginertia="0.1 0.2 0.2"/>
  <joint type="hinge" axis="0 0 1" stiffness="20" springref="0.2" damping="0.3"/>
  <site name="s2" pos="0.5 0.1 0"/>
  <body pos="1 0 0"><inertial mass="0.8" pos="0.3 -0.01 0.05" diaginertia="0.05 0.1 0.1"/>
   <joint type="hinge" axis="0 0 1" stiffness="5" damping="0.1"/>
   <site name="s3" pos="0.6 0 0"/>
   <body pos="0.5 0 0"><inertial mass="0.6" pos="0.1 0.03 0" diaginertia="0.02 0.03 0.04"/>
    <joint type="slide" axis="1 0 0" stiffness="90" springref="0.05" damping="0.7"/>
    <site name="s4" pos="0.1 0.2 0.1"/><site name="sc" pos="0.2 0 0"/>
 </body></body></body>
</worldbody>
<tendon>
 <spatial stiffness="30" springlength="1.2" damping="0.5"><site site="g3"/><site site="s3"/></spatial>
 <spatial stiffness="12" springlength="0.9" damping="0.2"><site site="g4"/><site site="s4"/></spatial>
 <spatial damping="0.4"><site site="g2"/><site site="s2"/></spatial>
 <spatial stiffness="40" springlength="0 1.7"><site site="gc"/><site site="sc"/></spatial>
</tendon></mujoco>"""


def arm():
    model = mujoco.MjModel.from_xml_string(MODEL)
    return model, mujoco.MjData(model)


def test_motors_of_an_arm_with_springs_and_a_cable_need_the_efforts_of_mujoco():
    """Inverse dynamics, no integration: drivers of two angles and a stroke, two turns of the second."""
    functions = (
        "ELEMENTS\n"
        "  FUNCTION 1 sine 0 0.7 2.0\n"
        "  FUNCTION 2 polynomial 0 8.0 -0.4 0.3\n"
        "  FUNCTION 3 sine 0.1 0.1 5 -1.5707963267948966\n"
    )
    drivers = (
        "ELEMENTS\n"
        "  DRIVE angle-1 at=1.angle value=1\n"
        "  DRIVE angle-2 at=2.angle value=2\n"
        "  DRIVE stroke-1 at=3.stroke value=3\n"
    )
    rows = rows_of(ARM_WITH_SLIDE, "0 1.6 0.1", CARDS + functions + drivers, "inverse")
    t = rows.time
    q = np.column_stack([0.7 * np.sin(2 * t), t * (8 - 0.4 * t + 0.3 * t**2), 0.1 - 0.1 * np.cos(5 * t)])
    v = np.column_stack([1.4 * np.cos(2 * t), 8 - 0.8 * t + 0.9 * t**2, 0.5 * np.sin(5 * t)])
    a = np.column_stack([-2.8 * np.sin(2 * t), -0.8 + 1.8 * t, 2.5 * np.cos(5 * t)])
    model, data = arm()
    wanted, taut = [], []
    for data.qpos[:], data.qvel[:], data.qacc[:] in zip(q, v, a, strict=True):
        mujoco.mj_inverse(model, data)
        wanted.append(data.qfrc_inverse.copy())
        taut.append(data.ten_length[3] > 1.7)
    assert rows.driver_effort == pytest.approx(np.array(wanted), abs=1e-11)
    assert any(taut) and not all(taut)


SHAKEN = """<mujoco><option gravity="0.5 -9.81 0.3"/><compiler angle="radian" inertiafromgeom="false"/>
<worldbody>
 <body><inertial mass="1.5" pos="0.4 0 0" diaginertia="0.1 0.2 0.2"/><joint type="slide" axis="1 0 0"/>
  <body><inertial mass="0.8" pos="0.3 0.1 0" diaginertia="0.05 0.1 0.1"/>
   <joint type="hinge" axis="0 0 1"/>
 </body></body></worldbody></mujoco>"""


def test_a_support_and_a_driver_of_the_deck_need_the_efforts_of_mujoco():
    """Body 2 is shaken along x by a support, body 3 turned on it by a driver of its attitude."""
    deck = "3 1 0 0 0 1 0 0 0 6 0 1\n" + "0 0 0 1 0 0 0\n" * 3 + "3 6 0 0 0\n2 3 0 0 0 0 0 0 0 0 1 0 0 1\n"
    deck += "".join(f"2 {k} 0\n" for k in range(1, 7)) + "1 0 0 0 0 0 0\n"
    cards = "MASS 2 1.5 0.4 0 0 0.1 0.2 0.2\nMASS 3 0.8 0.3 0.1 0 0.05 0.1 0.1\nGRAVITY 0.5 -9.81 0.3\n"
    rows = rows_of(
        deck,
        "0 1 0.1",
        f"{cards}ELEMENTS\n"
        "  FUNCTION 1 sine 0 0.3 6\n"
        "  FUNCTION 2 sine 0 2 3\n"
        "  SUPPORT support-1 simplified=1 value=1\n"
        "  DRIVE drive-1 driver=1 value=2\n",
        "inverse",
    )
    t = rows.time
    q = np.column_stack([0.3 * np.sin(6 * t), 2 * np.sin(3 * t)])
    v = np.column_stack([1.8 * np.cos(6 * t), 6 * np.cos(3 * t)])
    model = mujoco.MjModel.from_xml_string(SHAKEN)
    data, wanted = mujoco.MjData(model), []
    for data.qpos[:], data.qvel[:], data.qacc[:] in zip(q, v, q * (-36.0, -9.0), strict=True):
        mujoco.mj_inverse(model, data)
        wanted.append(data.qfrc_inverse.copy())
    found = np.column_stack([rows.holding_force[:, 0, 0], rows.driver_effort[:, 0]])
    assert found == pytest.approx(np.array(wanted), abs=1e-11)


@pytest.mark.long_motion
def test_an_arm_with_springs_dampers_and_a_cable_moves_as_in_mujoco():
    """MuJoCo by RK4 with 0.2 ms; the cable becomes taut and slack, where RK4 loses its order."""
    rates = (
        "ELEMENTS\n"
        "  START at=1.angle rate=0.5\n"
        "  START at=2.angle rate=-1\n"
        "  START at=3.stroke rate=0.3\n"
        "TOLERANCE 1e-12\n"
    )
    rows = rows_of(ARM_WITH_SLIDE, "0 1 0.1", CARDS + rates)
    model, data = arm()
    data.qvel[:] = 0.5, -1.0, 0.3
    wanted, speeds = [data.qpos.copy()], [data.qvel.copy()]
    for step in range(1, 5001):
        mujoco.mj_step(model, data)
        if step % 500 == 0:
            wanted.append(data.qpos.copy())
            speeds.append(data.qvel.copy())
    pull = rows.element_effort[:, -1]
    assert pull[0] == 0.0 and pull[5] < -5.0 and pull[-1] == 0.0
    assert rows.joint_coordinate == pytest.approx(np.array(wanted), abs=1e-8)
    assert rows.joint_rate == pytest.approx(np.array(speeds), abs=1e-7)
