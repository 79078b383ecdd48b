"""`--rtol`, `--method` and `--only` of `flexmb run`: the same in every dialect, or an answer that helps."""

from pathlib import Path

import h5py
import numpy as np
import pytest
from click.testing import CliRunner

from flexmb_cli.cli.report import report
from flexmb_cli.cli.run import run
from flexmb_cli.cli.table import table
from flexmb_cli.errors import FlexmbError
from flexmb_cli.run.outcome import RunOptions
from flexmb_cli.run.solution import run_deck
from tests.dialects.vsdf.vsdf_decks import RIGID

DECKS = Path(__file__).resolve().parents[2] / "decks"
# Andrews' squeezer, stopped early.
FORWARD = str(DECKS / "young/dynamics/IN-ANDREWS.dat")
TREE = DECKS / "dafms/pendulum.DAT"
SHORT = ("--set", "time.end=0.002", "--set", "time.step=0.001")


def solved(tmp_path, deck, *options, code=0):
    """The result of a run, and what it printed."""
    path = tmp_path / "r.h5"
    done = CliRunner().invoke(run, [str(deck), "--no-out", "--h5", str(path), *options])
    assert done.exit_code == code, done.stderr
    return path, done.stderr


def position(path):
    with h5py.File(path) as file:
        return file["body/position"][-1]


@pytest.fixture
def vsdf(tmp_path):
    path = tmp_path / "links.vsdf"
    path.write_text(RIGID)
    return path


def steps(text):
    """The count of steps that -v prints."""
    return int(text.partition("steps ")[2].split(",")[0])


def test_rtol_sets_the_steps_of_a_young_deck_and_is_kept_in_the_result(tmp_path):
    coarse, reported = solved(tmp_path, FORWARD, *SHORT, "--rtol", "1e-4", "-v")
    few = steps(reported)
    with h5py.File(coarse) as file:
        assert file.attrs["options"] == "rtol=0.0001"
    near = position(coarse)
    fine, reported = solved(tmp_path, FORWARD, *SHORT, "--rtol", "1e-12", "-v")
    assert steps(reported) > 1.3 * few
    # Two tolerances of one motion: apart by what the coarser one allows, and not the same numbers.
    assert 0 < np.max(np.abs(position(fine) - near)) < 1e-3
    assert "no effect" not in reported


@pytest.mark.long_motion
@pytest.mark.parametrize("method", ["dop853", "radau", "alpha"])
def test_each_method_moves_a_young_deck_alike(tmp_path, method):
    wanted = position(solved(tmp_path, FORWARD, *SHORT, "--rtol", "1e-11")[0])
    rtol = "1e-7" if method == "alpha" else "1e-9"
    found, _ = solved(tmp_path, FORWARD, *SHORT, "--method", method, "--rtol", rtol)
    np.testing.assert_allclose(position(found), wanted, atol=2e-6)
    with h5py.File(found) as file:
        assert f"method={method}" in file.attrs["options"]


@pytest.mark.long_motion
@pytest.mark.parametrize("method", ["dop853", "radau", "alpha"])
def test_each_method_moves_a_vsdf_deck_alike(tmp_path, vsdf, method):
    wanted = position(solved(tmp_path, vsdf, "--method", "dop853", "--rtol", "1e-11")[0])
    found, reported = solved(tmp_path, vsdf, "--method", method)
    assert "no effect" not in reported
    np.testing.assert_allclose(position(found), wanted, atol=1e-3)


@pytest.mark.parametrize(
    ("deck", "method", "known"),
    [
        (FORWARD, "lsoda", "a YOUNG deck is integrated by dop853, radau or alpha"),
        ("vsdf", "sdirk4", "a VSDF deck is integrated by dop853, radau or alpha"),
        (
            DECKS / "dafms/pendulum.DAT",
            "alpha",
            "a DAFMS deck is integrated by dop853, radau, lsoda or sdirk4",
        ),
    ],
)
def test_a_method_that_a_dialect_lacks_is_refused_with_those_that_it_has(tmp_path, vsdf, deck, method, known):
    path, reported = solved(tmp_path, vsdf if deck == "vsdf" else deck, "--method", method, code=2)
    assert f"method {method}: {known}" in reported
    assert not path.exists()


def test_where_nothing_is_integrated_the_warning_names_what_sets_the_accuracy(tmp_path):
    _, reported = solved(tmp_path, DECKS / "young/IN1-1-1.dat", "--rtol", "1e-6", "--resume")
    assert "--rtol has no effect on this YOUNG deck: nothing is integrated" in reported
    assert "--feps sets the residual" in reported
    assert "note: nothing to resume" in reported


def test_json_has_what_is_told_on_the_way(tmp_path):
    """Rule: what standard error says of the run stands with its identifier in `--json`."""
    outcome = run_deck(str(DECKS / "young/IN1-1-1.dat"), RunOptions(folder=str(tmp_path), resume=True))
    found = [fault for fault in outcome.as_dict()["faults"] if fault["id"] == "RUN-064"]
    assert [(fault["severity"], fault["message"]) for fault in found] == [
        ("note", "nothing to resume; the run starts at its beginning")
    ]


@pytest.mark.parametrize("deck", ["IN4-BAR-MASS.dat", "IN-ARM.dat"])
@pytest.mark.parametrize("method", ["lsoda", "radau"])
def test_a_prescribed_motion_does_not_depend_on_the_method(tmp_path, deck, method):
    """`lsoda` ended as a fault of flexmb; `radau` stepped the arm by another method than the warning says."""
    deck = DECKS / "young/dynamics" / deck
    plain = solved(tmp_path, deck)[0].read_bytes()
    path, reported = solved(tmp_path, deck, "--method", method)
    assert "--method has no effect on this YOUNG deck" in reported
    assert path.read_bytes() == plain


def test_steps_of_given_length_have_no_tolerance(tmp_path, vsdf):
    _, reported = solved(tmp_path, vsdf, "--rtol", "1e-6", "--method", "alpha", "--set", "time.step=0.01")
    assert "rtol: the deck gives the length of the steps; set it to 0" in reported


@pytest.mark.parametrize(
    ("deck", "options"),
    [(DECKS / "young/IN4-BAR.dat", ()), (DECKS / "dafms/pendulum.DAT", ("--set", "time.IT=3"))],
)
def test_only_the_quantities_named_are_stored(tmp_path, deck, options):
    path, _ = solved(tmp_path, deck, *options, "--only", "body.1.velocity.x", "--only", "point.1")
    with h5py.File(path) as file:
        assert "body/velocity" in file and "point/position" in file and "time" in file
        assert "body/position" not in file and "body/acceleration" not in file
        assert len(file["body/velocity"]) == len(file["time"])
    shown = CliRunner().invoke(table, [str(path), "body.1.velocity.x"])
    assert shown.exit_code == 0 and len(shown.stdout.splitlines()) > 2


def test_a_name_that_a_result_would_not_have_ends_the_run_before_it_begins(tmp_path):
    path, reported = solved(tmp_path, DECKS / "young/IN4-BAR.dat", "--only", "body.1.velocty", code=2)
    assert "--only body.1.velocty: the result has no such quantity; near it are body.1.velocity" in reported
    assert not path.exists()


def test_a_report_of_a_result_without_positions_is_refused_or_drawn_without_traceback(tmp_path):
    path, _ = solved(tmp_path, DECKS / "young/IN4-BAR.dat", "--only", "point.1.z")
    done = CliRunner().invoke(report, [str(path), "-o", str(tmp_path / "r.html")])
    assert done.exit_code == 0 or isinstance(done.exception, FlexmbError)
