"""`flexmb check --json` prints one JSON object for a deck of every kind, and text that names what is free."""

import json
import subprocess
import sys
import weakref
from pathlib import Path
from types import SimpleNamespace

import pytest

from flexmb_cli.results.texts import check_text
from flexmb_cli.run.check import check as parts
from flexmb_cli.run.check import check as run_check
from flexmb_cli.run.outcome import Outcome, RunOptions

DECKS = Path(__file__).resolve().parents[2] / "decks"


def check(deck, *options):
    command = [sys.executable, "-m", "flexmb_cli", "check", str(DECKS / deck), *options]
    return subprocess.run(command, capture_output=True, text=True, timeout=300, check=True).stdout


@pytest.mark.parametrize(
    "deck, dof",
    [
        ("young/IN4-BAR.dat", 1),
        ("young/dynamics/IN4-BAR-MASS.dat", 1),
        ("young/dynamics/IN-BRICARD.dat", 1),
        ("dafms/fourbar_rigid.DAT", 1),
        ("vsdf/pendulum.vsdf", 10),
        ("vsdf/freeflying.vsdf", 15),
    ],
)
def test_degrees_of_freedom_of_known_mechanisms(deck, dof):
    """One crank, Bricard's one freedom, a hinge or six freedoms beside nine modes."""
    assert json.loads(check(deck, "--json"))["counts"]["degrees_of_freedom"] == dof


def test_what_is_free_is_named():
    assert "free motions 15, such as those of: body 1 vx; body 1 vy; body 1 vz" in check(
        "vsdf/freeflying.vsdf"
    )


def test_echo_and_jacobian_are_not_dropped():
    """Seven coordinates for each of four bodies; the row of a ground's x has that alone."""
    from click.testing import CliRunner

    from flexmb_cli.cli.check import check as command

    done = CliRunner().invoke(
        command, [str(DECKS / "young/IN4-BAR.dat"), "--json", "--echo", "--jacobian", "0"]
    )
    jacobian = json.loads(done.stdout)["jacobian"]
    assert "counts.NBODY" in done.stderr
    assert (jacobian["time"], len(jacobian["bodies"])) == (0.0, 4)
    assert sorted(jacobian["matrix"][jacobian["rows"].index("ground 1, x")]) == [0.0] * 27 + [1.0]
    assert {len(row) for row in jacobian["matrix"]} == {28}
    plain = CliRunner().invoke(command, [str(DECKS / "young/IN4-BAR.dat"), "--json"])
    assert "jacobian" not in json.loads(plain.stdout) and not plain.stderr


def test_a_jacobian_of_forward_dynamics_is_refused():
    report = run_check.check_deck(
        str(DECKS / "young/dynamics/IN-ANDREWS.dat"), RunOptions(), jacobian="estimate"
    )
    (fault,) = report.outcome.faults
    assert (report.outcome.exit_code, fault.id) == (2, "RUN-001")
    assert "inverse dynamics" in fault.message


def test_what_is_too_large_to_be_assembled_is_counted(monkeypatch):
    monkeypatch.setattr(parts, "MOST_ASSEMBLED", 27)
    report = run_check.check_deck(str(DECKS / "young/IN4-BAR.dat"), RunOptions())
    assert report.outcome.exit_code == 0 and report.as_dict()["assembly"] == []
    assert "  coordinates 28, report times 26\n" in check_text.check_text(report)
    (note,) = report.outcome.faults
    assert note.message == "28 coordinates are more than the 27 that check assembles; run does"


def test_a_last_row_before_the_end_is_told(monkeypatch):
    """0.4 s go six times into the 2.5 s of the deck."""
    monkeypatch.setattr(parts, "MOST_ASSEMBLED", 27)
    report = run_check.check_deck(str(DECKS / "young/IN4-BAR.dat"), RunOptions(changes=("time.step=0.4",)))
    assert "  coordinates 28, report times 7, the last at 2.4 s\n" in check_text.check_text(report)


def test_of_very_many_gaps_the_widest_are_listed(monkeypatch):
    monkeypatch.setattr(check_text, "MOST_GAPS", 2)
    gaps = [("ground 1", 0.5, 0.0, "m"), ("driver 1", 2.0, 0.0, "1"), ("joint 1", 1.0, 0.0, "m")]
    lines = list(check_text.assembly_lines(SimpleNamespace(gaps=gaps, time=0.0)))
    assert [line.split()[0] for line in lines[1:3]] == ["driver", "joint"]
    assert lines[3] == "    and 1 with narrower gaps of the estimates; --json has all"


def test_round_off_is_not_printed_as_a_singular_value():
    """36 equations of Bricard's linkage, rank 35: the next value is round-off, another on every processor."""
    report = run_check.check_deck(str(DECKS / "young/dynamics/IN-BRICARD.dat"), RunOptions())
    assert report.smallest < 1e-12
    assert "  rank 35 of 36, smallest singular value below 1e-12\n" in check_text.check_text(report)


def test_a_deck_is_let_go_before_the_next_is_read(monkeypatch):
    """Two models of 62 MB took 1,094 MB, since the first was kept while the second was read."""
    from click.testing import CliRunner

    from flexmb_cli.cli.check import check as command

    checked, kept = [], []

    def check_deck(path, *given):
        kept.append([found() for found in checked])
        report = run_check.CheckReport(Outcome(path))
        checked.append(weakref.ref(report))
        return report

    monkeypatch.setattr(run_check, "check_deck", check_deck)
    decks = [str(DECKS / "young/IN4-BAR.dat"), str(DECKS / "young/IN-RSSR.dat")]
    assert CliRunner().invoke(command, decks).exit_code == 0
    assert kept == [[], [None]]
