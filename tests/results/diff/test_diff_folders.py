"""`flexmb diff` of folders, patterns, exports and files of tolerances."""

import json
import os
import shutil
import tracemalloc
from xml.etree import ElementTree

import h5py
import pytest
from click.testing import CliRunner

from flexmb_cli.cli.diff import diff
from flexmb_cli.cli.export import export
from flexmb_cli.results.diff.csv_columns import kind_of_name
from flexmb_cli.results.diff.hdf5 import kind_of
from flexmb_cli.results.quantities.quantities import names, open_result
from tests.results.results import write_result


def compared(*arguments):
    return CliRunner().invoke(diff, [*map(str, arguments)])


def exported(result, form):
    output = result.with_suffix(f".{form}")
    assert CliRunner().invoke(export, [str(result), "--to", form, "-o", str(output), "-q"]).exit_code == 0
    return output


def changed(path, dataset="body/position", place=(1, 2, 0), by=1e-3):
    """Add to one number of a result."""
    with h5py.File(path, "r+") as file:
        file[dataset][place] += by
    return path


def test_equal_folders_have_no_difference(folders):
    done = compared(*folders)
    old, new = folders
    assert done.stdout == (f"{old}, {new}: 2 files compared, 0 differ, 0 missing, 1 other file passed over\n")
    assert done.exit_code == 0


def test_the_name_of_a_file_stands_before_its_differences(folders):
    changed(folders[1] / "inner" / "two.h5")
    lines = compared(*folders).stdout.splitlines()
    assert lines[0] == "inner/two.h5" and lines[1].startswith("type ")


@pytest.mark.parametrize(("wild", "code"), [("", 2), ("/*.h5", 2), ("/one.h5", 0)])
def test_what_is_compared_with_itself_is_named(folders, wild, code):
    """One wrong variable of a pipeline would make a comparison of folders that never fails."""
    done = compared(f"{folders[0]}{wild}", f"{folders[0]}/../old{wild}")
    assert done.exit_code == code
    assert "are the same, so that nothing can differ" in done.stderr


def test_json_has_the_note_on_what_is_compared_with_itself(folders):
    """Rule: what standard error says stands with its identifier in `--json`."""
    done = compared(f"{folders[0]}/one.h5", f"{folders[0]}/one.h5", "--json")
    (note,) = json.loads(done.stdout)["faults"]
    assert (note["id"], note["severity"]) == ("DIFF-033", "note")


def test_one_difference_in_one_file_is_told_with_its_place_and_ends_with_1(folders):
    changed(folders[1] / "inner" / "two.h5")
    done = compared(*folders)
    assert done.exit_code == 1
    assert "/body/position, body 3, x at t" in done.stdout
    assert done.stdout.splitlines()[-1].endswith(
        "2 files compared, 1 differs, 0 missing, 1 other file passed over"
    )


@pytest.mark.parametrize("lacking", [0, 1])
def test_a_file_that_only_one_folder_has_is_a_difference(folders, lacking):
    (folders[lacking] / "one.h5").unlink()
    done = compared(*folders)
    assert done.exit_code == 1
    assert f"one.h5: not in {folders[lacking]}\n" in done.stdout
    assert "1 file compared, 0 differ, 1 missing" in done.stdout


def test_a_file_that_cannot_be_read_stops_no_other_and_ends_with_2(folders):
    (folders[1] / "inner" / "two.h5").write_bytes(b"\x89HDF\r\n\x1a\nnothing")
    changed(folders[1] / "one.h5")
    done = compared(*folders)
    assert done.exit_code == 2
    assert "two.h5: error: damaged HDF5 file" in done.stderr
    assert "1 file compared, 1 differs, 0 missing, 1 cannot be read" in done.stdout


def test_folders_without_results_are_no_success(tmp_path):
    (tmp_path / "old").mkdir()
    (tmp_path / "new").mkdir()
    done = compared(tmp_path / "old", tmp_path / "new")
    assert (done.exit_code, done.stdout) == (2, "")
    assert "no results to compare" in done.stderr


def test_patterns_pair_the_files_behind_their_folders(folders):
    old, new = folders
    done = compared(old / "**/*.h5", new / "**/*.h5")
    assert (done.exit_code, done.stdout) == (
        0, f"{old}/**/*.h5, {new}/**/*.h5: 2 files compared, 0 differ, 0 missing\n",
    )  # fmt: skip
    assert compared(old / "o*.h5", new / "*.h5").exit_code == 0
    assert compared(old / "*.h5", new / "inner/*.h5").exit_code == 1


def test_a_folder_and_a_file_are_no_pair(folders):
    done = compared(folders[0], folders[1] / "one.h5")
    assert done.exit_code == 2
    assert "is a folder or a pattern" in done.stderr


def test_json_of_folders_has_a_record_for_every_file(folders):
    changed(folders[1] / "one.h5")
    record = json.loads(compared(*folders, "--json").stdout)
    assert [(file["name"], file["equal"]) for file in record["files"]] == [
        ("inner/two.h5", True), ("one.h5", False),
    ]  # fmt: skip
    assert record["files"][1]["kinds"]["position"]["differing"] == 1
    assert (record["equal"], record["exit_code"], record["passed_over"]) == (False, 1, ["README.md"])


def test_junit_has_a_test_for_every_file(folders, tmp_path):
    changed(folders[1] / "one.h5")
    (folders[1] / "inner" / "two.h5").unlink()
    page = tmp_path / "diff.xml"
    assert compared(*folders, "--junit", page, "-q").exit_code == 1
    suite = ElementTree.parse(page).getroot().find("testsuite")
    assert suite.attrib | {"name": ""} == {
        "name": "", "tests": "2", "failures": "2", "errors": "0", "skipped": "0",
    }  # fmt: skip
    reported = {case.get("name"): case.find("failure").get("message") for case in suite}
    assert reported["inner/two.h5"] == f"inner/two.h5: not in {folders[1]}"
    assert "1 of " in reported["one.h5"] and "numbers differ" in reported["one.h5"]


def test_junit_of_two_files_that_agree_has_one_test_that_passed(folders, tmp_path):
    page = tmp_path / "diff.xml"
    assert compared(folders[0] / "one.h5", folders[1] / "one.h5", "--junit", page).exit_code == 0
    cases = ElementTree.parse(page).getroot().findall("testsuite/testcase")
    assert [(case.get("name"), len(case)) for case in cases] == [(str(folders[0] / "one.h5"), 0)]


def test_update_of_folders_takes_what_differs_and_what_is_new(folders):
    old, new = folders
    changed(new / "one.h5")
    shutil.copy(new / "one.h5", new / "inner" / "three.h5")
    before = (old / "inner" / "two.h5").stat().st_ino
    done = compared(*folders, "--update")
    assert done.exit_code == 0
    assert "2 references updated" in done.stdout
    assert (old / "inner" / "three.h5").read_bytes() == (old / "one.h5").read_bytes()
    assert (old / "inner" / "two.h5").stat().st_ino == before
    assert compared(*folders).exit_code == 0


@pytest.mark.parametrize("form", ["csv", "mat"])
def test_an_export_agrees_with_the_result_it_comes_from_and_with_no_other(form, tmp_path):
    result = write_result(tmp_path / "a.h5", 3)
    export_of_it = exported(result, form)
    other = changed(shutil.copy(result, tmp_path / "b.h5"), "body/velocity", (2, 0, 1), 1e-3)
    for a, b, code in (
        (export_of_it, result, 0), (result, export_of_it, 0), (export_of_it, export_of_it, 0),
        (export_of_it, other, 1), (other, export_of_it, 1),
    ):  # fmt: skip
        done = compared(a, b, "--json")
        record = json.loads(done.stdout)
        assert (done.exit_code, record["differing"]) == (code, code)
        assert record["compared"] > 100
    assert record["kinds"]["velocity"]["differing"] == 1
    assert compared(export_of_it, other, "--tol", "velocity=2e-3").exit_code == 0


def test_an_export_in_the_old_folder_is_compared_with_the_result_in_the_new_one(folders):
    old, new = folders
    exported(old / "one.h5", "csv")
    (old / "one.h5").unlink()
    assert compared(old, new).exit_code == 0
    changed(new / "one.h5")
    assert compared(old, new).exit_code == 1


def test_a_csv_table_with_a_selection_is_compared_in_its_own_columns(tmp_path):
    result = write_result(tmp_path / "a.h5", 3)
    lines = exported(result, "csv").read_text().splitlines()
    chosen = tmp_path / "chosen.csv"
    chosen.write_text("".join(",".join(line.split(",")[:4]) + "\n" for line in lines))
    done = compared(chosen, result)
    assert done.exit_code == 0
    (absent,) = (line for line in done.stdout.splitlines() if "not among the columns of" in line)
    columns = len(lines[0].split(","))
    assert absent.endswith(f" and {columns - 4 - 5} more") and "1 line of words" in done.stdout
    assert compared(chosen, result, "--words").exit_code == 1
    assert compared(chosen, tmp_path / "a.csv").exit_code == 1  # two tables must have the same columns
    chosen.write_text("\n".join(lines[:-1]))
    shorter = compared(chosen, result)
    assert shorter.exit_code == 1
    assert "1 row of" in shorter.stdout


@pytest.mark.parametrize(
    ("text", "reported"),
    [
        ("time [s],body.1.x [m]\n0,1\n0.1\n", "line 3 has 1 columns, the heading 2"),
        ("time [s],body.1.x [m]\n0,one\n", "line 2: could not convert string to float: 'one'"),
        ("time [s],body.1.x [m],body.1.x [m]\n0,1,1\n", "two columns have the same heading"),
        (
            f"time [s],body.1.x [m]\n0,{200_000 * '1'}\n",
            "line 2 is not a row of a CSV: field larger than field limit (131072)",
        ),
    ],
)
def test_a_csv_table_that_cannot_be_read_is_refused_with_its_line(text, reported, tmp_path):
    (tmp_path / "a.csv").write_text(text)
    done = compared(write_result(tmp_path / "a.h5", 3), tmp_path / "a.csv")
    assert (done.exit_code, done.stdout) == (2, "")
    assert reported in done.stderr


def test_tables_of_many_rows_are_compared_without_a_table_of_all_pairs(tmp_path):
    """A table of 20,000 times 19,999 rows took 400 MB; two files of 5 MB took 90 GB."""
    rows = [f"{k / 1000},{k % 7}" for k in range(20_000)]
    for name, chosen in (("a.csv", rows), ("b.csv", rows[:100] + rows[101:])):
        (tmp_path / name).write_text("\n".join(["time [s],body.1.x [m]", *chosen]))
    tracemalloc.start()
    done = compared(tmp_path / "a.csv", tmp_path / "b.csv")
    peak = tracemalloc.get_traced_memory()[1]
    tracemalloc.stop()
    assert done.exit_code == 1
    assert "1 row of" in done.stdout and "the first at t = 0.1" in done.stdout
    assert peak < 100e6
    (tmp_path / "b.csv").write_text("\n".join(["time [s],body.1.x [m]", *19_500 * ["0,1"]]))
    (tmp_path / "a.csv").write_text("\n".join(["time [s],body.1.x [m]", *20_000 * ["0,1"]]))
    done = compared(tmp_path / "a.csv", tmp_path / "b.csv")
    assert done.exit_code == 2
    assert "one time stands in many of them" in done.stderr


def test_names_in_headings_have_the_kinds_of_their_datasets(tmp_path):
    with open_result(write_result(tmp_path / "a.h5", 3)) as file:
        for quantity in names(file):
            assert kind_of_name(quantity.name) == kind_of(quantity.dataset), quantity.name


def test_junit_shows_what_controls_a_terminal_or_turns_the_direction_of_writing(folders, tmp_path):
    """Rule: both are replaced wherever names are shown, and XML 1.0 has no control characters."""
    page = tmp_path / "found.xml"
    names = [folder / "a\u202eb\u2066\x1b[31m.h5" for folder in folders]
    for folder, name in zip(folders, names, strict=True):
        (folder / "one.h5").rename(name)
    assert compared(*names, "--junit", page).exit_code == 0
    (case,) = ElementTree.parse(page).iter("testcase")
    assert case.get("name").endswith("a\ufffdb\ufffd\ufffd[31m.h5")


@pytest.mark.parametrize("wild", ["", "/**", "/**/*.h5"])
def test_links_to_folders_are_not_followed(folders, wild):
    """Two links to `.` made 2^40 names of each file (Linux follows 40 links), one doubled the counts."""
    for name in ("again", "more"):
        (folders[1] / name).symlink_to(".", target_is_directory=True)
    (folders[1] / "all").symlink_to("/", target_is_directory=True)
    done = compared(*(f"{folder}{wild}" for folder in folders))
    counts = "2 files compared, 0 differ, 0 missing"
    others = "" if "h5" in wild else ", 1 other file passed over"
    assert done.stdout.endswith(f": {counts}{others}, 3 special files passed over\n")
    assert done.exit_code == 0


def test_what_is_no_regular_file_is_passed_over_and_named(folders):
    """Opening a pipe that nobody writes to waits for ever (POSIX, open)."""
    for folder in folders:
        os.mkfifo(folder / "OUT-pipe.dat")
    (folders[0] / "zero.h5").symlink_to("/dev/zero")
    (folders[0] / "nothing.h5").symlink_to("not-there")
    (folders[1] / "one.h5").unlink()
    os.mkfifo(folders[1] / "one.h5")
    done = compared(*folders, "--json")
    record = json.loads(done.stdout)
    assert record["special"] == ["OUT-pipe.dat", "nothing.h5", "one.h5", "zero.h5"]
    missing = [name for one in record["files"] for name in one["missing"]]
    assert missing == [f"one.h5: not in {folders[1]}"] and done.exit_code == 1


def test_links_stay_as_they_are_where_references_are_made(folders, tmp_path):
    """A new reference is no way out of the folder of references, nor into a pipe."""
    shutil.rmtree(folders[0] / "inner")
    (tmp_path / "elsewhere").mkdir()
    (folders[0] / "inner").symlink_to(tmp_path / "elsewhere", target_is_directory=True)
    (folders[0] / "one.h5").unlink()
    os.mkfifo(folders[0] / "one.h5")
    done = compared(*folders, "--update")
    assert done.exit_code == 2 and done.stderr.count("stands in its place") == 2
    assert list((tmp_path / "elsewhere").iterdir()) == []


def test_results_of_a_deck_with_stale_in_its_name_are_compared(folders):
    """IN4.stale.dat gives OUT4.stale.dat and OUT4.stale.h5, which no rename makes."""
    for folder in folders:
        (folder / "one.h5").rename(folder / "one.stale.h5")
    assert "2 files compared" in compared(*folders).stdout


def test_a_stale_result_is_no_new_one(folders):
    """What an earlier run left under the name of its stale result counts as missing, in JUnit files, too."""
    (folders[1] / "one.h5").rename(folders[1] / "one.h5.stale")
    done = compared(*folders, "--junit", folders[0] / "diff.xml")
    assert done.exit_code == 1
    assert f"one.h5: not in {folders[1]} (one.h5.stale is of an earlier run)\n" in done.stdout
    assert "1 file compared, 0 differ, 1 missing, 2 other files passed over" in done.stdout
    top = ElementTree.parse(folders[0] / "diff.xml").getroot()
    assert (top.get("tests"), top.get("failures"), top.get("errors")) == ("2", "1", "0")


def test_processes_report_what_one_process_reports(folders):
    """Also differences, a missing file, a file that cannot be read, and names of tolerances without use."""
    old, new = folders
    changed(new / "inner" / "two.h5")
    (old / "OUT-A.dat").write_text("nothing")
    shutil.copy(new / "one.h5", new / "three.h5")
    tolerances = old.parent / "t.toml"
    tolerances.write_text('[files."one*"]\natol = 1e-9\n')
    choices = (*folders, "--tolerances", tolerances, "--json")
    alone, together = compared(*choices), compared(*choices, "-j", "3")
    assert (together.exit_code, together.stdout, together.stderr) == (
        alone.exit_code, alone.stdout, alone.stderr,
    )  # fmt: skip
    assert alone.exit_code == 1 and json.loads(alone.stdout)["files"]
    tolerances.write_text('[files."no*"]\natol = 1e-9\n')
    assert compared(*choices, "-j", "3").exception.faults == compared(*choices).exception.faults
