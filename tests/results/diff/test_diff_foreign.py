"""What `flexmb diff` and `--update` refuse: files of others, and runs that show nothing."""

import json

import h5py
import pytest
from click.testing import CliRunner

from flexmb_cli.cli.diff import diff
from flexmb_cli.dialects.young.listing import OutTable
from flexmb_cli.results.hdf5.kinematic import kinematic_values
from flexmb_cli.study.table import Column, TableHead, write_table
from tests.results.results import write_result


@pytest.fixture
def good(tmp_path):
    return write_result(tmp_path / "good.h5", 3)


def compared(*arguments):
    return CliRunner().invoke(diff, [*map(str, arguments)])


@pytest.mark.parametrize("attributes", [{}, {"Conventions": "CF-1.8"}, {"Conventions": "flexmb-1"}])
@pytest.mark.parametrize("update", [[], ["--update"]])
def test_an_hdf5_file_that_is_no_result_is_refused(attributes, update, good, tmp_path):
    other = tmp_path / "other.h5"
    with h5py.File(other, "w") as file:
        file["numbers"] = [1.0, 2.0]
        file.attrs.update(attributes)
    before = good.read_bytes()
    for reference, result in ((good, other), (other, good), (other, other)):
        done = compared(reference, result, *update)
        assert (done.exit_code, done.stdout) == (2, "")
        assert f"{other}: error: this HDF5 file is not a result of flexmb" in done.stderr
    assert compared(tmp_path / "new", other, "--update").exit_code == 2
    assert good.read_bytes() == before
    assert not (tmp_path / "new").exists()


def test_a_result_and_the_table_of_a_study_are_no_pair(good, tmp_path):
    study = tmp_path / "study.h5"
    head = TableHead("", "", "a.dat", "0" * 64, (Column("result/top", "m", "max of point.1.z"),), 1)
    write_table(str(study), head, [(1, 0, 3, "", [0.1])])
    done = compared(good, study)
    assert done.exit_code == 2
    assert (
        f"{study}: error: it is the table of a study, {good} is a result; compare two of the same type"
        in done.stderr
    )
    assert compared(study, study).exit_code == 0


@pytest.fixture(params=["OUT", "h5"])
def nothing(request, tmp_path, deck):
    """The result of a run that failed before its first row."""
    path = tmp_path / f"nothing.{request.param}"
    if request.param == "h5":
        return write_result(path, 0, "failed", "at t = 0 s the mechanism cannot be assembled")
    with path.open("w") as stream:
        table = OutTable((stream,), deck, "safe")
        table.begin()
        table.failed()
    return path


def test_a_run_that_shows_nothing_is_no_reference(nothing, tmp_path):
    done = compared(tmp_path / "new", nothing, "--update")
    assert (done.exit_code, done.stdout) == (2, "")
    assert f"{nothing}: error: its run failed before the first row" in done.stderr
    assert not (tmp_path / "new").exists()


def test_a_failed_run_takes_the_place_of_a_failed_one_only(good, tmp_path):
    failed = write_result(tmp_path / "failed.h5", 2, "failed", "locks")
    before = good.read_bytes()
    for reference in (good, tmp_path / "new.h5"):
        done = compared(reference, failed, "--update")
        assert (done.exit_code, done.stdout) == (2, "")
        assert f"{failed}: error: its run did not complete" in done.stderr
    assert good.read_bytes() == before and not (tmp_path / "new.h5").exists()
    other = write_result(tmp_path / "other.h5", 1, "failed", "locks")
    assert compared(other, failed, "--update").exit_code == 0
    assert other.read_bytes() == failed.read_bytes()


def test_a_table_that_ends_in_the_mark_of_failure_is_no_reference(tmp_path, deck, rows):
    paths = tmp_path / "good.OUT", tmp_path / "failed.OUT"
    for path in paths:
        with path.open("w") as stream:
            table = OutTable((stream,), deck, "safe")
            table.begin()
            table.rows(kinematic_values(rows([0.0, 0.1])))
            if path == paths[1]:
                table.failed()
    before = paths[0].read_text()
    done = compared(*paths, "--update")
    assert done.exit_code == 2 and "its run did not complete" in done.stderr
    assert paths[0].read_text() == before


def test_units_of_the_last_digit_are_refused_where_no_digit_is_printed(good):
    done = compared(good, good, "--last-digit", "1")
    assert done.exception.exit_code == 2
    assert "--last-digit: HDF5 results have no printed digits" in str(done.exception)


def test_a_fault_is_told_in_json(good, tmp_path):
    done = compared(good, tmp_path / "none", "--json")
    reported = json.loads(done.stdout)
    assert (done.exit_code, reported["exit_code"], reported["status"]) == (2, 2, "bad input")
    assert reported["faults"][0]["file"] == str(tmp_path / "none")
    assert reported["faults"][0]["message"] == "no such file"
    # A fault that is no file's.
    done = compared(good, good, "--last-digit", "1", "--json")
    assert "printed digits" in json.loads(done.stdout)["faults"][0]["message"]


def test_a_new_reference_is_named_in_json(good, tmp_path):
    new = str(tmp_path / "new.h5")
    reported = json.loads(compared(new, good, "--update", "--json").stdout)
    assert (reported["a"], reported["b"], reported["updated"]) == (new, str(good), True)
