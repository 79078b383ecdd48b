"""Both formulations of the supplied DAFMS decks agree, and `flexmb verify` says so."""

import json

import h5py
import numpy as np
import pytest
from click.testing import CliRunner

from flexmb_cli.cli import cli
from flexmb_cli.run.outcome import Outcome, RunOptions
from flexmb_cli.run.verify.verify import Difference, Verification, verify_deck
from tests.run.dafms_runs import DECKS, NAMES, loaded, run

pytestmark = pytest.mark.long_motion

COUPLED = [name for name in NAMES if not name.endswith("unco")]
COMPARED = {"rotation speeds", "body position", "point velocity", "body attitude", "total energy"}


def verified(name):
    return verify_deck(str(DECKS / f"{name}.DAT"), RunOptions(), 1e-7)


# The fast pass has a shorter manipulator of the same kind.
LONGEST = pytest.param("two_link_n4", marks=pytest.mark.campaign)


@pytest.mark.parametrize("name", [LONGEST if name == "two_link_n4" else name for name in COUPLED])
def test_kane_and_absolute_coordinates_give_one_motion(name):
    """Over the whole run, to 1e-7 of the largest value of each kind; 6e-9 were measured."""
    found = verified(name)
    assert found.outcome.exit_code == 0, [each for each in found.differences if each.relative > 1e-7]
    # The drivers of arm_elements do work: its energy is not kept, and its parts are compared.
    kept = COMPARED - ({"total energy"} if name == "arm_elements" else set())
    assert {each.name for each in found.differences} >= kept
    # Nothing is compared that stands still.
    assert all(each.scale > 0 for each in found.differences if "speeds" in each.name)


def test_one_way_decks_are_refused():
    found = verified("two_link_n2_unco")
    assert found.outcome.exit_code == 2
    assert "UNCO" in found.outcome.faults[-1].message


def test_a_difference_beyond_the_tolerance_is_an_exit_of_1():
    """Steps of 1e-4 leave differences that 1e-12 does not allow."""
    steps = ["--rtol", "1e-4", "--atol", "1e-4", "--tol", "1e-12"]
    result = CliRunner().invoke(cli, ["verify", str(DECKS / "sliding_mass.DAT"), *steps])
    assert result.exit_code == 1
    assert "beyond 1e-12" in result.stdout


def test_json_holds_every_difference():
    result = CliRunner().invoke(cli, ["verify", "--json", str(DECKS / "sliding_mass.DAT")])
    record = json.loads(result.stdout)
    assert (result.exit_code, record["agree"], record["tolerance"]) == (0, True, 1e-6)
    for row in record["differences"]:
        assert row["relative"] == row["difference"] / (row["scale"] or 1.0)


def test_what_was_compared_is_named():
    result = CliRunner().invoke(cli, ["verify", str(DECKS / "sliding_mass.DAT")])
    assert "Kane's equations and absolute coordinates, " in result.stdout


def test_a_share_of_what_is_always_zero_is_the_difference_itself():
    assert Difference("x", "m", 0.5, 0.0, 0.0).relative == 0.5


def test_what_is_no_number_is_the_largest_difference():
    each = [Difference(name, "m", size, 1.0, 0.0) for name, size in (("a", 1.0), ("b", np.nan), ("c", 2.0))]
    assert Verification(Outcome("x.DAT"), 1e-6, tuple(each)).largest.name == "b"


def test_a_run_in_absolute_coordinates_writes_the_files_of_the_deck(tmp_path):
    """The series differ from Kane's by the tolerance of the steps."""
    outcome = run("fourbar_flex", tmp_path / "absolute", formulation="absolute")
    assert outcome.exit_code == 0
    assert run("fourbar_flex", tmp_path / "kane").exit_code == 0
    one, other = (loaded(tmp_path / kind, "fourbar_flex") for kind in ("kane", "absolute"))
    assert one.keys() == other.keys() | {"hinge/force", "hinge/torque"}
    for path in ("coordinate/q", "point/position", "reaction/force", "energy/total"):
        assert np.max(np.abs(one[path] - other[path])) < 1e-5 * np.max(np.abs(one[path])), path
    with h5py.File(tmp_path / "absolute" / "fourbar_flex.h5") as file:
        assert file.attrs["status"] == "complete"


def test_resume_goes_with_kane():
    arguments = ["run", "--resume", "--formulation", "absolute", str(DECKS / "pendulum.DAT")]
    result = CliRunner().invoke(cli, arguments)
    assert result.exit_code == 2
    assert "--formulation kane" in result.stderr


@pytest.mark.parametrize(("asked", "said"), [((), ""), (("-v",), "verify: compiling kernels\n")])
def test_a_log_names_compiling_with_v_alone(asked, said, monkeypatch):
    def verify_deck(path, choices, tolerance, listener):
        listener.status("compiling kernels")
        return Verification(Outcome(path), tolerance, ())

    monkeypatch.setattr("flexmb_cli.run.verify.verify.verify_deck", verify_deck)
    result = CliRunner().invoke(cli, ["verify", *asked, str(DECKS / "pendulum.DAT")])
    assert (result.exit_code, result.stderr) == (0, said)
