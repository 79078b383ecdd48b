"""`flexmb check --json` prints one JSON object for a deck of every kind, and text that names what is free."""

import json
import subprocess
import sys
from pathlib import Path

import pytest

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
