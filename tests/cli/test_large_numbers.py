"""Numbers on the command line that fit no machine integer, or no span of time."""

from pathlib import Path

import pytest
from click.testing import CliRunner

from flexmb_cli.cli import cli
from flexmb_cli.study.table import Column, TableHead, write_table

DECKS = Path(__file__).resolve().parents[2] / "decks"
HUGE = "9" * 23
BEAM = ["beam", "--rho", "1"]


def done(*arguments):
    return CliRunner().invoke(cli, [str(argument) for argument in arguments])


@pytest.fixture
def study(tmp_path):
    head = TableHead("", "", "a.dat", "0" * 64, (Column("result/top", "m", "max of point.1.z"),), 2)
    write_table(str(tmp_path / "study.h5"), head, [(1, 0, 3, "", [0.5]), (2, 0, 3, "", [0.25])])
    return tmp_path / "study.h5"


@pytest.fixture
def result(tmp_path):
    assert (
        done("run", DECKS / "young/IN1-1-1.dat", "-q", "--no-out", "--h5", tmp_path / "r.h5").exit_code == 0
    )
    return tmp_path / "r.h5"


def test_more_rows_than_there_are_leave_the_first(result, study):
    assert len(done("table", result, "time", "--every", HUGE).stdout.splitlines()) == 2
    assert done("table", study, "top", "--every", HUGE).stdout.splitlines()[1:] == ["1,0.5"]
    picture = result.with_suffix(".png")
    assert done("plot", result, "body.1.x", "--every", HUGE, "-o", picture, "-q").exit_code == 0


@pytest.mark.parametrize(
    ("arguments", "reported"),
    [
        ((*BEAM, "--length", 1, "--ei", 1, "--nodes", HUGE), "is not in the range 1<=x<=1000"),
        ((*BEAM, "--length", "1e300", "--ei", 1, "--nodes", 3), "is not in the range"),
        ((*BEAM, "--length", "1e-320", "--ei", 1, "--nodes", 3), "is not in the range"),
        ((*BEAM, "--length", 1, "--ei", "inf", "--nodes", 3), "is not in the range"),
        ((*BEAM, "--length", 1, "--ei", 1, "--nodes", 3, "--offset", "nan"), "is not a finite number"),
        (
            ("modes", DECKS / "dafms/pendulum.DAT", "--at", "1e300"),
            "--at 1e+300: later than 100000 of the deck's steps; ask for an earlier time",
        ),
    ],
)
def test_numbers_beyond_all_sense_are_refused(arguments, reported):
    refused = done(*arguments)
    assert refused.exit_code == 2
    assert reported in refused.stderr
