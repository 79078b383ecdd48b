"""A small slice of scripts/inject_faults: every kind that costs little, a few times."""

import json
import subprocess
import sys
from pathlib import Path

import pytest

from flexmb_cli.kernels import _jit

sys.path.insert(0, str(Path(__file__).parents[2] / "scripts"))
from faults.traced import is_here as strace_is_here

SCRIPT = Path(__file__).parents[2] / "scripts" / "faults" / "inject.py"

pytestmark = [
    pytest.mark.skipif(sys.platform != "linux", reason="forks, limits and /proc"),
    pytest.mark.skipif(_jit.interpreted(), reason="the runs would take minutes"),
]


def test_no_rule_is_broken_by_kills_stops_and_full_disks(tmp_path):
    kinds = ("kill_at_deeds", "torn_writes", "signals_at_deeds", "full_from_a_deed_on", "limited_size")
    kinds += ("output_is_a_folder", "broken_draft", "changed_study")
    wanted = [word for kind in kinds for word in ("--only", kind)]
    command = [sys.executable, SCRIPT, *wanted, "--count", "10", "--seed", "3", "--json", tmp_path / "counts"]
    commands = ("run young", "sweep", "diff --update", "new")
    done = subprocess.run([*command, "--commands", *commands], capture_output=True, text=True, timeout=300)
    assert done.returncode == 0, done.stdout + done.stderr
    counts = json.loads((tmp_path / "counts").read_text())
    assert sum(counts["faults"].values()) >= 75
    assert counts["kills resumed"] >= 5


def test_a_broken_rule_is_told_with_its_folder(tmp_path):
    """An old output that is lost: the judge sees it, and the script ends with 1."""
    code = (
        "import sys; sys.argv[1:] = ['--only', 'failing_run_keeps_the_old', '--count', '1', "
        "'--commands', 'run young']\n"
        "from faults import inject, places\n"
        "def spoiled(stage, chance, number, folder):\n"
        "    command = stage.writers[0]\n"
        "    before = command.prepare(folder, with_old=True)\n"
        "    (folder / command.outputs[0]).write_text('spoiled')\n"
        "    ended = command.run_other(('check', 'none'), folder)\n"
        "    return places.Verdict('spoiled', places.faults_of_files(command, folder, before, ended))\n"
        "inject.NAMED['failing_run_keeps_the_old'] = spoiled\n"
        "sys.exit(inject.main())"
    )
    done = subprocess.run(
        [sys.executable, "-c", code], cwd=SCRIPT.parents[1], capture_output=True, text=True, timeout=300
    )
    assert done.returncode == 1
    assert "is neither the old one, nor the new one, nor marked partial" in done.stderr
    assert "failing_run_keeps_the_old 0" in done.stderr


def test_a_stop_at_any_instruction_leaves_a_record_and_whole_files():
    """Some of them: the script goes on as long as it is told."""
    deck = SCRIPT.parents[2] / "decks" / "young" / "IN1-1-1.dat"
    command = [sys.executable, SCRIPT.parent / "instructions.py", deck, "--seconds", "3", "--seed", "5"]
    done = subprocess.run(command, capture_output=True, text=True, timeout=300)
    assert done.returncode == 0, done.stdout + done.stderr
    assert "'interrupted'" in done.stdout and "'complete'" in done.stdout


@pytest.fixture(scope="module")
def traceable():
    if not strace_is_here():
        pytest.skip("strace (Debian package strace) is not installed, or may not trace here")


@pytest.mark.parametrize("command", [pytest.param("run dafms", marks=pytest.mark.campaign), "sweep"])
@pytest.mark.usefixtures("traceable")
def test_a_loss_of_power_leaves_whole_files_and_what_can_be_gone_on_with(command):
    """Without the syncs of files empty results are found in their places."""
    reported = campaign("power", "--commands", command, "--most", "6", "--seed", "4")
    counts = [list(map(int, line.rsplit("  ", 1)[0].split()[-6:])) for line in reported.splitlines()[1:]]
    assert len(counts) == 3, reported  # without old outputs, with them, gone on with
    assert all(tried == same and wrong == 0 for _, _, tried, same, _, wrong in counts), reported


@pytest.mark.usefixtures("traceable")
def test_any_system_call_may_fail():
    reported = campaign("calls", "--commands", "run young", "--most", "12", "--seed", "4")
    _, failures, *exits, wrong = map(int, reported.splitlines()[1].rsplit("  ", 1)[0].split()[-6:])
    assert (failures, wrong) == (12, 0), reported
    assert sum(exits) == 12 and exits[1] > 0, reported


def campaign(*words):
    done = subprocess.run([sys.executable, SCRIPT, *words], capture_output=True, text=True, timeout=600)
    assert done.returncode == 0, done.stdout + done.stderr
    return done.stdout
