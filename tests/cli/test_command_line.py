"""The command line as scripts and pipelines use it: streams, exit codes, files, signals."""

import json
import os
import shutil
import subprocess
import sys
from pathlib import Path

import h5py
import pytest

pytestmark = pytest.mark.processes

TOP = Path(__file__).resolve().parents[2]
FOUR_BAR = TOP / "decks" / "young" / "IN4-BAR.dat"
HELD = TOP / "decks" / "young" / "IN1-1-1.dat"
# Rod of 5.4 m instead of 6.1 m: the crank cannot turn fully (a linkage of this size locks at t = 0.499 s).
LOCKING = ["--set", "universal.1.P_j.y=5.4"]


def flexmb(*arguments, cwd, stdin=None, **environment):
    """A finished `flexmb` process, outputs as text."""
    return subprocess.run(
        [sys.executable, "-m", "flexmb_cli", *map(str, arguments)],
        cwd=cwd, input=stdin, capture_output=True, text=True, encoding="utf-8", timeout=300,
        env={**os.environ, **environment},
    )  # fmt: skip


def test_run_writes_table_and_result_beside_and_says_so_on_standard_error(tmp_path):
    done = flexmb("run", FOUR_BAR, cwd=tmp_path)
    assert done.returncode == 0
    assert done.stdout == ""
    assert done.stderr.splitlines()[-1].endswith("26 rows → OUT4-BAR.dat, OUT4-BAR.h5")
    assert sorted(path.name for path in tmp_path.iterdir()) == ["OUT4-BAR.dat", "OUT4-BAR.h5"]


def test_a_table_on_standard_output_is_alone_there(tmp_path):
    done = flexmb("run", FOUR_BAR, "--out", "-", "--no-h5", cwd=tmp_path)
    flexmb("run", FOUR_BAR, "-q", cwd=tmp_path)
    assert done.stdout == (tmp_path / "OUT4-BAR.dat").read_text(encoding="utf-8")


def test_standard_input_gives_flexmb_files_and_the_name_of_a_dash(tmp_path):
    done = flexmb("run", "-", cwd=tmp_path, stdin=HELD.read_text())
    assert done.returncode == 0
    with h5py.File(tmp_path / "flexmb.h5") as result:
        assert result.attrs["deck_name"] == "-"
    assert (tmp_path / "flexmb.OUT").exists()


def test_quiet_prints_nothing_when_all_is_well(tmp_path):
    done = flexmb("run", FOUR_BAR, "-q", cwd=tmp_path)
    assert (done.returncode, done.stdout, done.stderr) == (0, "", "")


def test_a_missing_deck_has_no_place_and_exit_2(tmp_path):
    done = flexmb("run", "none.dat", cwd=tmp_path)
    assert (done.returncode, done.stderr) == (2, "none.dat: error: no such file\n")


def test_a_bad_deck_leaves_no_file(tmp_path):
    done = flexmb("run", "-", cwd=tmp_path, stdin=HELD.read_text().replace("1 6 0", "1 7 0"))
    assert done.returncode == 2
    assert list(tmp_path.iterdir()) == []


def test_a_lock_keeps_its_rows_marks_them_and_exits_with_1(tmp_path):
    done = flexmb("run", FOUR_BAR, *LOCKING, cwd=tmp_path)
    assert done.returncode == 1
    assert ": error: at t = 0.5 s the constraints cannot be met" in done.stderr
    assert "5 rows kept, marked as failed" in done.stderr
    table = (tmp_path / "OUT4-BAR.dat").read_text(encoding="utf-8")
    assert table.count("TIME=") == 5
    assert table.endswith("\n-----CONVERGENCE FAILED-----\n")
    with h5py.File(tmp_path / "OUT4-BAR.h5") as result:
        assert result.attrs["status"] == "failed"
        assert result.attrs["message"].startswith("at t = 0.5 s")
        assert result["time"].shape == (5,)


def test_json_tells_of_a_failure_what_a_program_needs(tmp_path):
    done = flexmb("run", FOUR_BAR, *LOCKING, "--json", "-q", cwd=tmp_path)
    record = json.loads(done.stdout)
    assert (record["status"], record["exit_code"], record["time"], record["rows"]) == ("failed", 1, 0.5, 5)
    assert record["faults"][0]["severity"] == "error"
    assert record["faults"][0]["file"] == record["deck"]
    assert record["faults"][0]["object"] in record["faults"][0]["message"]
    assert record["faults"][0]["object"] in record["norms"]["worst"][0]
    assert record["faults"][0]["line"] in (13, 14, 15, 16)  # the gap is shared by the joints in a row
    assert 1e-4 < record["norms"]["gap"] < 1e-2
    assert record["files"] == ["./OUT4-BAR.dat", "./OUT4-BAR.h5"] or record["files"] == [
        "OUT4-BAR.dat",
        "OUT4-BAR.h5",
    ]


def test_a_number_beyond_computing_is_refused_where_it_stands(tmp_path):
    deck = "2 1 0 0 0 0 0 1 0 0 0 1\n0 0 1e308 1 0 0 0\n" + "\n".join(
        (TOP / "decks/young/IN2-5-1.dat").read_text().splitlines()[-6:]
    )
    done = flexmb("run", "-", cwd=tmp_path, stdin=deck)
    assert done.returncode == 2
    assert "1e308; numbers beyond 1e+50 cannot be computed with" in done.stderr


def test_several_decks_are_all_tried_and_the_largest_code_wins(tmp_path):
    done = flexmb("run", "none.dat", FOUR_BAR, HELD, "-q", cwd=tmp_path)
    assert done.returncode == 2
    assert (tmp_path / "OUT4-BAR.dat").exists()
    assert (tmp_path / "OUT1-1-1.dat").exists()


def test_several_jobs_give_the_same_bytes_as_one(tmp_path):
    one, two = tmp_path / "one", tmp_path / "two"
    decks = sorted((TOP / "decks" / "young").glob("*.dat"))
    assert flexmb("run", *decks, "-q", "-o", one, cwd=tmp_path).returncode == 0
    assert flexmb("run", *decks, "-q", "-o", two, "-j", 2, cwd=tmp_path).returncode == 0
    names = sorted(path.name for path in one.iterdir())
    assert len(names) == 2 * len(decks)
    for name in names:
        assert (one / name).read_bytes() == (two / name).read_bytes(), name


def test_two_decks_for_one_file_are_refused_before_anything_is_solved(tmp_path):
    (tmp_path / "a").mkdir()
    shutil.copy(HELD, tmp_path / "a" / HELD.name)
    done = flexmb("run", HELD, tmp_path / "a" / HELD.name, cwd=tmp_path)
    assert done.returncode == 2
    assert not (tmp_path / "OUT1-1-1.dat").exists()


def test_set_changes_a_number_by_its_name(tmp_path):
    flexmb("run", FOUR_BAR, "--set", "time.end=0.3", "-q", cwd=tmp_path)
    assert (tmp_path / "OUT4-BAR.dat").read_text().count("TIME=") == 4


def test_an_unknown_name_is_an_error_with_neighbours(tmp_path):
    done = flexmb("run", FOUR_BAR, "--set", "time.and=0.3", cwd=tmp_path)
    assert done.returncode == 2
    assert "time.end" in done.stderr


def test_strict_turns_a_warning_into_an_error(tmp_path):
    deck = HELD.read_text().replace("0 0 0 1 0 0 0", "0 0 0 1.1 0 0 0")
    assert flexmb("run", "-", "-o", "loose", cwd=tmp_path, stdin=deck).returncode == 0
    done = flexmb("run", "-", "--strict", cwd=tmp_path, stdin=deck)
    assert done.returncode == 2
    assert "warning" not in done.stderr


@pytest.mark.parametrize("option", ["--feps", "--epslu"])
@pytest.mark.parametrize("value", ["nan", "inf", "-1"])
def test_a_solver_setting_that_is_no_number_is_refused(tmp_path, option, value):
    assert flexmb("run", HELD, option, value, cwd=tmp_path).returncode == 2


def test_diff_refuses_a_tolerance_that_lets_everything_pass(tmp_path):
    flexmb("run", HELD, "-q", cwd=tmp_path)
    assert flexmb("diff", "OUT1-1-1.dat", "OUT1-1-1.dat", "--atol", "inf", cwd=tmp_path).returncode == 2


def test_diff_names_the_file_it_cannot_read(tmp_path):
    flexmb("run", HELD, "-q", cwd=tmp_path)
    done = flexmb("diff", "OUT1-1-1.dat", "nope", cwd=tmp_path)
    assert (done.returncode, done.stderr) == (2, "nope: error: no such file\n")


def test_an_option_of_another_dialect_is_said_to_have_no_effect(tmp_path):
    assert "no effect on this YOUNG deck" in flexmb("run", HELD, "--rtol", "1e-4", cwd=tmp_path).stderr
    assert flexmb("run", HELD, "--rtol", "1e-4", "--strict", cwd=tmp_path).returncode == 2


def test_a_fault_of_a_changed_number_tells_of_the_change(tmp_path):
    done = flexmb("run", HELD, "--set", "point.1.body=99", cwd=tmp_path)
    assert "(numbers changed by --set: point.1.body=99)" in done.stderr
