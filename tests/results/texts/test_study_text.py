"""The table of a study as text: cases as rows, what is not shown is said."""

import csv
import io
import json

import h5py
import pytest
from click.testing import CliRunner

from flexmb_cli.cli.diff import diff
from flexmb_cli.cli.export import export
from flexmb_cli.cli.table import table
from flexmb_cli.results.quantities.quantities import ResultError, open_result
from flexmb_cli.study.table import Column, TableHead, write_table

COLUMNS = (
    Column("parameter/driver.1.B", "rad/s", "speed"),
    Column("result/top", "m", "max of point.1.z"),
    Column("result/path", "m", "series of point.1.z", 3),
)
NAN = float("nan")
ROWS = [
    (1, 0, 3, "", [0.1, 1 / 3, [1.0, 2.0, 3.0]]),
    (2, 1, 0, 'locks, "at once"', [2.5, NAN, [NAN] * 3]),
    (3, 0, 3, "", [1e-7, -4.0, [4.0, 5.0, 6.0]]),
]


@pytest.fixture
def study(tmp_path):
    path = tmp_path / "study.h5"
    write_table(str(path), TableHead("", "", "a.dat", "0" * 64, COLUMNS, len(ROWS)), ROWS)
    return path


def printed(study, *arguments):
    done = CliRunner().invoke(table, [str(study), *arguments])
    assert done.exit_code == 0, done.output
    return done.stdout, done.stderr


def test_cases_are_rows_with_parameters_and_results_and_every_digit(study):
    text, reported = printed(study)
    head, *lines = csv.reader(io.StringIO(text))
    assert head == ["case", "parameter.driver.1.B [rad/s]", "result.top [m]", "exit_code"]
    assert [line[0] for line in lines] == ["1", "2", "3"]
    assert [float(line[1]) for line in lines] == [row[4][0] for row in ROWS]
    assert [lines[0][2], lines[1][2], lines[2][2]] == [repr(1 / 3), "nan", "-4.0"]
    assert [line[3] for line in lines] == ["0", "1", "0"]
    assert "note: name a series to see it: result.path" in reported
    assert "note: 1 of 3 cases failed and have nan for results; the column message says why" in reported


@pytest.mark.parametrize("form", ["csv", "mat"])
def test_an_export_says_how_many_cases_failed(study, form, tmp_path):
    done = CliRunner().invoke(export, [str(study), "--to", form, "-o", str(tmp_path / f"s.{form}")])
    assert "note: 1 of 3 cases failed and have nan for results" in done.stderr


def test_series_and_messages_are_printed_when_named(study):
    text, reported = printed(study, "path", "message")
    head, *lines = csv.reader(io.StringIO(text))
    assert head == ["case", *(f"result.path.{row} [m]" for row in (1, 2, 3)), "message"]
    assert lines[1] == ["2", "nan", "nan", "nan", 'locks, "at once"']
    assert lines[2] == ["3", "4.0", "5.0", "6.0", ""]
    assert reported == ""


@pytest.mark.parametrize("name", ["top", "result.top", "RESULT.TOP", "to?", "result.t*"])
def test_a_column_may_be_called_with_or_without_its_group(study, name):
    assert printed(study, name, "-q")[0].splitlines()[0] == "case,result.top [m]"


def test_json_has_no_nan_and_every_takes_some_cases(study):
    records = [
        json.loads(line) for line in printed(study, "top", "--every", "2", "-f", "jsonl")[0].splitlines()
    ]
    assert records == [{"case": 1, "result.top [m]": 1 / 3}, {"case": 3, "result.top [m]": -4.0}]
    line = printed(study, "top", "-f", "jsonl")[0].splitlines()[1]
    assert json.loads(line) == {"case": 2, "result.top [m]": None}


def test_text_is_aligned_and_the_list_tells_units(study):
    lines = printed(study, "top", "driver*", "-f", "text")[0].splitlines()
    assert len({len(line) for line in lines}) == 1
    assert "result.top            m      max of point.1.z\n" in printed(study, "--list")[0]


@pytest.mark.parametrize(
    "arguments, reported",
    [
        (
            ["tip"],
            "tip: the study has no such parameter or result; near it are result.top; "
            "flexmb table RESULT.h5 --list shows all",
        ),
        (["--from", "1"], "is the table of a study, a row a case: it has no times for --from and --to"),
    ],
)
def test_what_the_study_does_not_have_is_refused(study, arguments, reported):
    done = CliRunner().invoke(table, [str(study), *arguments])
    assert reported in f"{done.exception} {done.output}"


def test_a_column_that_was_cut_is_told(study):
    with h5py.File(study, "a") as file:
        del file["result/top"]
        file["result/top"] = [1.0]
        file["result/top"].attrs["units"] = file["result/top"].attrs["long_name"] = ""
    done = CliRunner().invoke(table, [str(study)])
    assert isinstance(done.exception, ResultError)
    assert "study.h5: a damaged table: /result/top has 1" in str(done.exception)


def test_other_commands_say_what_the_file_is(study):
    with pytest.raises(ResultError, match="this is the table of a study"), open_result(study):
        pass


def test_diff_names_the_case_of_the_worst_place_and_passes_over_the_text_of_the_study(study, tmp_path):
    other = tmp_path / "other.h5"
    rows = [ROWS[0], ROWS[1], (3, 0, 3, "", [1e-7, -4.0, [4.0, 5.5, 6.0]])]
    write_table(str(other), TableHead("# a comment", "", "a.dat", "0" * 64, COLUMNS, len(rows)), rows)
    done = CliRunner().invoke(diff, [str(study), str(other)])
    assert done.exit_code == 1
    assert "/result/path, case 3, row 2: 5.0 against 5.5" in done.output
    assert "0 missing entries" in done.output


def test_a_parquet_table_is_told_from_a_damaged_one(tmp_path):
    (tmp_path / "s.parquet").write_bytes(b"PAR1....PAR1")
    done = CliRunner().invoke(table, [str(tmp_path / "s.parquet"), "top"])
    assert "s.parquet: this is a Parquet table, which pandas and polars read" in str(done.exception)
