"""Wrong commands: exit 2, one form of error on standard error, and with --json one object on the other."""

import json
import os
import subprocess
import sys
from pathlib import Path

import pytest

from flexmb_cli import cli as package
from flexmb_cli.cli import cli, main
from flexmb_cli.cli.options.output_file import Millimetres
from flexmb_cli.study.table import Column, TableHead, write_table

DECKS = Path(__file__).resolve().parents[2] / "decks"
FOUR_BAR = str(DECKS / "young" / "IN4-BAR.dat")
WITH_JSON = [name for name, one in cli.commands.items() if any("--json" in p.opts for p in one.params)]


@pytest.fixture
def flexmb(monkeypatch, capsys, tmp_path):
    """Run the program here: exit code, standard output and standard error."""
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr(package.signal, "signal", lambda number, action: None)
    monkeypatch.setattr(package.os, "environ", dict(os.environ))

    def run(*arguments):
        monkeypatch.setattr(sys, "argv", ["flexmb", *arguments])
        with pytest.raises(SystemExit) as ended:
            main()
        return ended.value.code, *capsys.readouterr()

    return run


def test_the_commands_with_json_are_those_of_the_readme():
    assert set(WITH_JSON) == {
        *("run", "check", "verify", "modes", "statics", "diff", "sweep", "fit", "sensitivity"),
        *("convert", "export", "table", "plot", "report"),
    }


@pytest.mark.parametrize("name", WITH_JSON)
@pytest.mark.parametrize("wrong", [["--nope"], [], ["a", "b", "c", "--jobs", "x", "--tol", "x", "--at", "x"]])
def test_a_wrong_call_is_one_json_object(flexmb, name, wrong):
    code, printed, reported = flexmb(name, "--json", *wrong)
    record = json.loads(printed)
    assert (code, record["status"], record["exit_code"]) == (2, "bad input", 2)
    (fault,) = record["faults"]
    assert (fault["severity"], fault["file"], fault["line"]) == ("error", None, None)
    assert reported.splitlines()[-1] == f"flexmb: error: {fault['message']}"
    assert reported.startswith(f"Usage: flexmb {name} ")


@pytest.mark.parametrize(
    "arguments",
    [
        ["run", "--json", FOUR_BAR, "--nrmax", "abc"],
        ["run", FOUR_BAR, FOUR_BAR, "--json"],
        ["run", FOUR_BAR, "--json", "--out", "-"],
        ["check", FOUR_BAR, "--json", "--jacobian", "now"],
        ["diff", "--json", "a", "b", "--tol", "nothing=1"],
        ["sweep", "study.toml", "--json", "-o", "table.txt"],
        ["sweep", "study.toml", "--json"],
        ["sweep", ".", "--json"],
    ],
)
def test_what_a_command_refuses_is_one_json_object(flexmb, arguments):
    code, printed, reported = flexmb(*arguments)
    record = json.loads(printed)
    assert (code, record["status"], record["exit_code"]) == (2, "bad input", 2)
    assert all(fault["message"] in reported for fault in record["faults"])


def test_a_wrong_tolerance_blames_no_file(flexmb):
    _, printed, _ = flexmb("diff", "--json", FOUR_BAR, FOUR_BAR, "--tol", "nothing=1")
    (fault,) = json.loads(printed)["faults"]
    assert fault["file"] is None


def test_a_name_behind_two_dashes_asks_for_no_json(flexmb):
    code, printed, _ = flexmb("diff", "--", "a", "--json")
    assert (code, printed) == (2, "")


def test_a_command_without_json_prints_none(flexmb):
    assert flexmb("beam", "--json")[:2] == (2, "")


@pytest.mark.parametrize(
    ("arguments", "where"),
    [
        (["run", "none.dat"], "none.dat"),
        (["diff", "none", "none"], "none"),
        (["table", "none.h5", "time"], "none.h5"),
        (["plot", "none.h5"], "none.h5"),
        (["report", "none.h5"], "none.h5"),
        (["export", "none.h5", "--to", "csv"], "none.h5"),
        (["sweep", "none.toml"], "none.toml"),
        (["beam", "--length", "1", "--nodes", "1", "--ei", "1", "--rho", "1", "--into", "none.DAT",
          "--body", "1"], "none.DAT"),
    ],
)  # fmt: skip
def test_a_missing_file_is_named_in_front_by_every_command(flexmb, arguments, where):
    code, _, reported = flexmb(*arguments)
    assert (code, reported) == (2, f"{where}: error: no such file\n")


@pytest.mark.parametrize(
    ("command", "option"),
    [("run", "--out"), ("run", "--h5"), ("run", "-o"), ("sweep", "-o"), ("sweep", "--parts"), ("new", "-o")]
    + [(command, "-o") for command in ("plot", "report", "export")],
)
def test_an_empty_name_of_a_result_is_no_place_to_write_to(flexmb, command, option):
    code, _, reported = flexmb(command, "young" if command == "new" else FOUR_BAR, option, "")
    assert code == 2 and "an empty name; give a path" in reported and f"'{option}'" in reported


def test_a_folder_in_place_of_a_study_is_what_is_complained_of(flexmb):
    assert flexmb("sweep", ".")[2] == ".: error: is a directory, not a study\n"


@pytest.mark.skipif(not Path("/proc/self").exists(), reason="needs a folder that takes no files")
def test_a_folder_that_is_there_but_takes_no_files_is_not_called_missing(flexmb):
    code, _, reported = flexmb("run", FOUR_BAR, "-o", "/proc")
    assert code == 2
    assert "/proc/OUT4-BAR.dat: cannot be written: its folder takes no new files" in reported


def test_quiet_silences_the_statistics_too(flexmb):
    assert flexmb("run", FOUR_BAR, "-q", "-v")[1:] == ("", "")
    assert "Newton iterations" in flexmb("run", FOUR_BAR, "-v")[2]


def test_few_iterations_of_newton_are_followed_by_a_search(flexmb):
    """NRMAX limits Newton's iterations, not the damped search after them."""
    assert flexmb("run", FOUR_BAR, "--nrmax", "1")[0] == 0


@pytest.mark.long_motion
@pytest.mark.parametrize(("given", "unit"), [("universal.1.P_j.y=5.4", "m"), ("universal.1.P_j.y=50", "m")])
def test_the_gap_in_json_is_the_first_of_the_message(flexmb, given, unit):
    """A lock at t = 0.499 s, and a rod that fits nowhere."""
    _, printed, _ = flexmb("run", FOUR_BAR, "--set", given, "--json", "-q")
    record = json.loads(printed)
    norms, message = record["norms"], record["faults"][0]["message"]
    assert norms["unit"] == norms["units"][0] == unit
    assert norms["gap"] == norms["gaps"][0]
    assert len(norms["worst"]) == len(norms["gaps"]) == len(norms["units"]) == 3
    for name, size, of in zip(norms["worst"], norms["gaps"], norms["units"], strict=True):
        joint, part = name.split(", ", 1)
        reported = message.partition(f"{joint} ({part}, line ")[2].partition("): ")[2].partition(";")[0]
        assert reported == f"{size:.1e}" + " m" * (of == "m")


@pytest.mark.processes
@pytest.mark.skipif(not Path("/dev/full").exists(), reason="needs a device that is always full")
def test_a_wrong_call_with_a_full_standard_output_ends_without_traceback(tmp_path):
    command = [sys.executable, "-m", "flexmb_cli", "run", "--json", "--nope"]
    with open("/dev/full", "w") as full:
        done = subprocess.run(command, stdout=full, stderr=subprocess.PIPE, text=True, timeout=60)
    assert done.returncode == 1
    assert "flexmb: error: standard input or output: No space left on device" in done.stderr
    assert "Traceback" not in done.stderr


def test_a_slip_of_the_hand_is_answered_with_what_is_meant(flexmb, tmp_path):
    deck = tmp_path / "IN4-BAR.dat"
    deck.write_text(Path(FOUR_BAR).read_text())
    assert flexmb("run", "IN4-BAR.dat", "-q")[0] == 0
    meant = {
        ("--json", "run", "IN4-BAR.dat"): "--json belongs after the command: flexmb run --json ...",
        ("IN4-BAR.dat",): "IN4-BAR.dat is a file, not a command: flexmb run IN4-BAR.dat",
        ("run", "IN4-BAR"): "IN4-BAR: error: no such file; is IN4-BAR.dat meant?",
        ("run", "IN4-BAR.dta"): "IN4-BAR.dta: error: no such file; is IN4-BAR.dat meant?",
        ("check", "time.step=1"): "no such file; is it a number to change, --set time.step=1?",
        ("run", "OUT4-BAR.h5"): "this is named like a result; give the deck it was computed from",
        ("check", "OUT4-BAR.h5"): "this is not a deck but an HDF5 file, as results are; flexmb table",
        (
            "run",
            "OUT4-BAR.dat",
        ): "this is a table that a YOUNG run printed; give the deck it was computed from",
        ("plot", "IN4-BAR.dat"): "this is a text, not an HDF5 result; is OUT4-BAR.h5 meant?",
        ("table", "OUT4-BAR.dat", "time"): "this is a text, not an HDF5 result; is OUT4-BAR.h5 meant?",
        ("diff", ".", "nowhere"): "nowhere: no such file or folder",
        ("examples", "pendulum"): "is one of these meant: pendulum.DAT, ",
        ("examples", "IN4BAR"): "is one of these meant: IN4-BAR, ",
        ("run", "IN4-BAR.dat", "--set", "driver.1.b=3"): "near it is driver.1.B; ",
    }
    for arguments, answer in meant.items():
        code, _, reported = flexmb(*arguments)
        assert (code, answer in reported) == (2, True), (arguments, reported)


def test_a_file_that_is_refused_is_not_suggested(flexmb, tmp_path):
    """A text named like a result was suggested for itself, and for its deck."""
    for name in ("IN4-BAR.dat", "OUT4-BAR.h5"):
        (tmp_path / name).write_text(Path(FOUR_BAR).read_text())
        code, _, reported = flexmb("table", name, "time")
        assert code == 2
        assert "is a text, not an HDF5 result; flexmb run writes" in reported


def test_the_table_of_a_study_is_no_result_of_an_earlier_run(flexmb, tmp_path):
    """`flexmb sweep f.toml` writes f.h5, which a run of f.dat would write, too."""
    (tmp_path / "f.dat").write_text(Path(FOUR_BAR).read_text().replace("0 2.5 0.1", "0 2.5 x"))
    head = TableHead("a = 1", "deck", "a.dat", "0" * 64, (Column("parameter/a", "m", "a"),), 1)
    write_table(str(tmp_path / "f.h5"), head, [(1, 0, 3, "", [1.0])])
    assert "earlier run" not in flexmb("run", "f.dat")[2]
    (tmp_path / "f.OUT").write_text("")
    assert "this one has none: f.OUT.stale\n" in flexmb("run", "f.dat", "-q")[2]
    assert (tmp_path / "f.h5").exists()


def test_a_run_to_standard_output_says_so(flexmb):
    code, printed, reported = flexmb("run", FOUR_BAR, "--out", "-", "--no-h5")
    assert (code, reported) == (0, f"{FOUR_BAR}: 26 rows → standard output\n")
    assert printed.count("TIME=") == 26


def test_a_study_given_to_run_and_a_deck_given_to_sweep_are_named(flexmb, tmp_path):
    (tmp_path / "study.toml").write_text('# speeds\ndeck = "a.dat"\n[parameters]\n')
    code, _, told = flexmb("run", "study.toml")
    assert code == 2 and "this is a study, not a deck; flexmb sweep computes it" in told
    code, _, told = flexmb("sweep", FOUR_BAR)
    assert code == 2 and "this is a YOUNG deck, not a study; flexmb run computes it" in told


def test_a_decimal_comma_in_an_option_gets_its_remedy(flexmb):
    code, _, told = flexmb("table", "any.h5", "body.1.x", "--from", "1,5")
    assert code == 2 and "1,5 has a decimal comma; write 1.5" in told


@pytest.mark.parametrize(
    ("width", "reported"),
    [
        ("3.5 inch", "3.5 inch is not a width: give millimetres, such as 85, or 8.5cm, 3.5in"),
        ("3,5in", "3,5in is not a width"),
        ("0.5in", "12.7 is not in the range 20<=x<=1000"),  # 0.5 · 25.4 mm
    ],
)
def test_a_width_that_is_none_gets_its_remedy(flexmb, width, reported):
    code, _, told = flexmb("plot", "any.h5", "--width", width)
    assert code == 2 and reported in " ".join(told.split())


@pytest.mark.parametrize(
    ("width", "millimetres"), [("3.5in", 88.9), ("8.5 CM", 85.0), ("85mm", 85.0), ("85", 85)]
)
def test_a_width_may_have_its_unit(width, millimetres):
    assert Millimetres(20, 1000).convert(width, None, None) == pytest.approx(millimetres, rel=1e-15)


def test_a_setting_of_an_unknown_name_is_an_object_of_its_own(flexmb):
    code, out, _ = flexmb("run", FOUR_BAR, "--set", "drivr.1.B=3", "--json")
    assert code == 2 and json.loads(out)["faults"][0]["object"] == "drivr.1.B"


def test_a_second_name_behind_only_is_explained(flexmb):
    """`--only point energy` said no more than `energy: error: no such file`."""
    code, _, reported = flexmb("run", "--only", "point", "energy")
    assert code == 2 and "energy: error: no such file" in reported
    assert "--only takes one quantity: give it once for each" in reported
    assert "--only takes" not in flexmb("run", "--only", "point", FOUR_BAR)[2]
