"""Drivers whose rate rises within next to no time, end by end with bodies of very uneven mass."""

from pathlib import Path

import pytest

import flexmb_cli
from flexmb_cli.errors import AnalysisError
from flexmb_cli.run.check.check import check_deck
from flexmb_cli.run.outcome import RunOptions

HERE = Path(__file__).parent
JUMP = "1.500000005"


def last_angle(deck, **options):
    return flexmb_cli.solve(deck, **options)["coordinate.1"][-1]


@pytest.mark.parametrize(
    ("end", "tolerance"), [(JUMP, "1e-9"), (JUMP, "1e-12"), ("1.5000000001", "1e-9"), ("1.5001", "1e-12")]
)
def test_rate_that_jumps_from_1_to_3_in_the_middle_turns_by_6_radians(tmp_path, end, tolerance):
    """Closed form: 1.5 s of 1 rad/s and 1.5 s of 3 rad/s, less the time of the rise."""
    text = (
        (HERE / "jump.dat").read_text().replace(JUMP, end).replace("ANGLE", f"TOLERANCE {tolerance}\nANGLE")
    )
    (tmp_path / "jump.dat").write_text(text)
    assert last_angle(tmp_path / "jump.dat") == pytest.approx(6.0 - (float(end) - 1.5), abs=2e-10)


@pytest.mark.parametrize("method", ["radau", "alpha"])
def test_jump_is_stepped_by_the_implicit_methods_too(method):
    assert last_angle(HERE / "jump.dat", method=method) == pytest.approx(6.0 - 5e-9, abs=1e-8)


def test_jump_that_no_time_resolves_is_refused_with_its_two_times(tmp_path):
    (tmp_path / "jump.dat").write_text((HERE / "jump.dat").read_text().replace(JUMP, "1.500000000001"))
    with pytest.raises(AnalysisError, match=r"changes between 1\.5 and 1\.500000000001 s"):
        flexmb_cli.solve(tmp_path / "jump.dat")


def test_run_that_a_ratio_of_masses_stops_names_the_two_bodies_and_it():
    with pytest.raises(AnalysisError, match=r"body 2 and body 1 are 2 and 1e-11 kg, in a ratio of 2e\+11"):
        flexmb_cli.solve(HERE / "masses.dat")


def test_check_names_the_two_bodies_before_a_run_does():
    report = check_deck(str(HERE / "masses.dat"), RunOptions())
    notes = [fault for fault in report.outcome.faults if "ratio" in fault.message]
    assert [fault.severity for fault in notes] == ["note"]
    assert "masses of body 2 and body 1 are 2 and 1e-11 kg" in notes[0].message
