"""Trees with loops, point springs, couplings and constant loads in MuJoCo: its motion is that of flexmb."""

import numpy as np
import pytest

from flexmb_cli.interface import solve
from flexmb_cli.run.convert import converted
from tests.dialects.dafms.test_dafms_elements import TWO_LINKS, deck
from tests.run.convert.test_convert_decks import DECKS


def motion(text, names, times, step=1e-4):
    """Positions (times, bodies, 3) of the origins of bodies by MuJoCo's RK4."""
    mujoco = pytest.importorskip("mujoco")
    model = mujoco.MjModel.from_xml_string(text)
    model.opt.timestep = step
    data = mujoco.MjData(model)
    mujoco.mj_resetDataKeyframe(model, data, 0)
    rows = []
    for time in times:
        while data.time < time - step / 2:
            mujoco.mj_step(model, data)
        mujoco.mj_forward(model, data)
        rows.append([data.body(name).xpos.copy() for name in names])
    return np.array(rows)


def compared(path, last):
    """Largest difference of positions up to a time, and how far the bodies move."""
    result = solve(path)
    count = int(np.searchsorted(result["time"], last + 1e-9))
    own = result["body/position"][:count]
    names = [f"body {k + 1}" for k in range(own.shape[1])]
    theirs = motion(converted(str(path), "mjcf"), names, result["time"][:count])
    return np.abs(own - theirs).max(), np.ptp(own, axis=0).max()


ELEMENTS = """ELEMENTS
  FUNCTION pull polynomial 1.5
  SPRING stay from=0(0.3,0.6,0.5) to=2(1,0,0) stiffness=40 rest=0.4 damping=0.2
  SPRING elbow at=2.r3 stiffness=3 rest=0.5 damping=0.05 preload=0.7
  MOTOR shoulder at=1.r3 effort=pull
"""


@pytest.mark.processes
def test_springs_between_points_and_constant_motors_convert(tmp_path):
    (tmp_path / "arm.DAT").write_text(f"{TWO_LINKS}{ELEMENTS}END\nSTOP\n")
    apart, moved = compared(tmp_path / "arm.DAT", 0.5)
    assert moved > 0.05 and apart < 1e-6


@pytest.mark.processes
def test_couplings_convert(tmp_path):
    """A gear of 3 to -2 between both hinges, which MuJoCo holds by stiff forces."""
    text = deck("ELEMENTS\n  COUPLING gear 1.r3=2 2.r3=3", TWO_LINKS)
    (tmp_path / "gear.DAT").write_text(text)
    apart, moved = compared(tmp_path / "gear.DAT", 0.5)
    assert moved > 0.5 and apart < 1e-6


@pytest.mark.processes
def test_a_closed_loop_converts(tmp_path):
    """MuJoCo holds loops by stiff forces: the difference falls with its step.

    Its bodies need moments of inertia about all axes; those in the plane do nothing in a plane motion.
    """
    text = (DECKS / "dafms/fourbar_rigid.DAT").read_text()
    for old, new in (
        ("1.005333333       0.0.005333333", "1.005333333      .001.005333333"),
        ("2      .036       0.0      .036", "2      .036      .001      .036"),
        ("3.041666667       0.0.041666667", "3.041666667      .001.041666667"),
    ):
        assert old in text
        text = text.replace(old, new)
    (tmp_path / "loop.DAT").write_text(text)
    apart, moved = compared(tmp_path / "loop.DAT", 0.2)
    assert moved > 0.01 and apart < 1e-7
