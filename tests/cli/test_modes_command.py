"""`flexmb modes` as scripts use it."""

import json
import math
import subprocess
import sys
from pathlib import Path

import pytest

TOP = Path(__file__).parents[2]


def flexmb(folder, *arguments):
    environment = {"FLEXMB_CACHE_DIR": str(folder), "PATH": "/usr/bin:/bin"}
    command = [sys.executable, "-m", "flexmb_cli", "modes", *arguments]
    return subprocess.run(command, capture_output=True, text=True, cwd=TOP, env=environment, timeout=120)


def test_the_table_of_the_pendulum(tmp_path):
    done = flexmb(tmp_path, "decks/vsdf/pendulum.vsdf")
    assert (done.returncode, done.stderr) == (0, "")
    lines = done.stdout.splitlines()
    assert lines[0] == "decks/vsdf/pendulum.vsdf: VSDF deck, flexible bodies 1"
    assert lines[1] == "  body 1: nodes 54, modes 9, mass 0.26 kg"
    assert lines[3] == "    centre of mass 0.05 0.005 0.0075 m"
    table = [line.split() for line in lines[-10:-1]]
    assert [f"{float(row[2]):.2f}" for row in table] == [
        "5.26", "7.41", "24.93", "34.54", "39.86", "47.64", "60.25", "97.73", "124.32",
    ]  # fmt: skip


def test_json_has_the_frequencies_in_full(tmp_path):
    done = flexmb(tmp_path, "decks/vsdf/pendulum_ccx.vsdf", "--json")
    record = json.loads(done.stdout)
    assert record["exit_code"] == 0
    (body,) = record["bodies"]
    assert body["frequencies"][8] == pytest.approx(124.32, abs=0.005)
    assert body["dropped"]["internal"] == 144


def test_another_frame_is_one_setting_away(tmp_path):
    """The chord frame of nodes 1, 49, 5: 9.70 ... 121.93 Hz."""
    changes = ("--set", "body.1.n2=49", "--set", "body.1.n3=5")
    done = flexmb(tmp_path, "decks/vsdf/pendulum.vsdf", *changes, "--json")
    found = json.loads(done.stdout)["bodies"][0]["frequencies"]
    assert (round(found[0], 2), round(found[-1], 2)) == (9.70, 121.93)


def test_a_fault_of_a_file_is_shown_at_its_card(tmp_path):
    deck = tmp_path / "x.vsdf"
    text = (TOP / "decks/vsdf/pendulum.vsdf").read_text()
    deck.write_text(text.replace("fe/pendulum_nodes", f"{TOP}/decks/vsdf/fe/pendulum_nodes"))
    done = flexmb(tmp_path, str(deck))
    assert done.returncode == 2
    assert done.stdout == ""
    assert done.stderr.splitlines()[:3] == [
        f"{deck}:7:12: error: body 1: pendulum_M.mtx: no such file in {tmp_path / 'fe'}",
        "        1 MM   fe/pendulum_M.mtx",
        "               ^^^^^^^^^^^^^^^^^",
    ]


def test_a_step_too_long_for_the_modes_is_a_warning(tmp_path):
    done = flexmb(tmp_path, "decks/vsdf/pendulum.vsdf", "--set", "time.step=0.001", "-q", "--strict")
    assert done.returncode == 2
    assert (
        "error: body 1: a step of 0.001 s is longer than 1/20 of the period of the highest mode, 0.00804 s; "
        in (done.stderr)
    )


RIGID_PENDULUM = """VSDF A PENDULUM
BODY
    1 RIGD
RIGI
1,2.0,0,0,-0.3
0.05,0.05,0.01
NODE
1,1,0,0,0
1,2,0,1,0
JOIN
1,REVO,0,0,0,1,1,2
GRAV
0,0,-9.81
TIME
1,0.1
END
STAR
STOP
"""


def test_the_mechanism_of_rigid_bodies_is_looked_at_unasked(tmp_path):
    """A physical pendulum: omega^2 = m g l / (J + m l^2), here with l = 0.3 m, J = 0.05 kg m^2."""
    deck = tmp_path / "pendulum.vsdf"
    deck.write_text(RIGID_PENDULUM)
    record = json.loads(flexmb(tmp_path, str(deck), "--json").stdout)
    frequency = math.sqrt(2.0 * 9.81 * 0.3 / (0.05 + 2.0 * 0.3**2)) / math.tau
    assert record["mechanism"]["frequency"] == pytest.approx([frequency], rel=1e-6)
