"""The files of dynamic decks: what `flexmb run` writes of reactions, efforts and energies."""

import h5py
import numpy as np
import pytest

from flexmb_cli.results.quantities.quantities import open_result, read, resolve
from flexmb_cli.run.outcome import RunOptions
from flexmb_cli.run.solution import run_deck
from tests.solvers.constrained.dynamic_runs import DECKS


@pytest.fixture(scope="module")
def result(tmp_path_factory):
    folder = tmp_path_factory.mktemp("results")
    outcome = run_deck(str(DECKS / "dynamics/IN4-BAR-MASS.dat"), RunOptions(folder=str(folder)))
    assert outcome.exit_code == 0, outcome.faults
    with h5py.File(folder / "OUT4-BAR-MASS.h5") as file:
        yield file


def test_reactions_and_efforts_stand_along_joints_and_drivers(result):
    assert result.attrs["analysis"] == "dynamic"
    assert result["reaction/force"].shape == (26, 4, 3)
    assert result["reaction/torque"].attrs["units"] == "N m"
    assert result["driver/effort"].shape == (26, 1)
    # The crank is turned.
    assert result["driver/effort"].attrs["units"] == "N m"
    assert list(result["driver/unit"].asstr()) == ["N m"]
    assert list(result["held/name"].asstr()) == ["ground 1"]


def test_an_inverse_run_has_no_work_and_no_total(result):
    assert set(result["energy"]) == {"kinetic", "potential", "applied_power"}


def test_the_ground_carries_what_the_weights_and_accelerations_of_the_bodies_ask(result):
    """Vertical force on the ground: -Σ m (g + z'') of the centres, which are the origins but for body 1."""
    force = result["held/force"][:, 0, 2]
    z = result["body/acceleration"][:, :, 2]
    A = result["body/euler_parameters"][:, 0]
    turned = 2.0 * np.arctan2(A[:, 1], A[:, 0])
    # Body 1 turns evenly about x through its origin, its centre 1 m along its z axis.
    crank = -(np.pi**2) * np.cos(turned)
    expected = 20.0 * (9.81 + crank) + 120.0 * (9.81 + z[:, 1]) + 70.0 * (9.81 + z[:, 2])
    assert force == pytest.approx(expected, rel=1e-7)


@pytest.mark.parametrize("cards", ["MASS 1 1 0 0 0 1 1 1\n", "MASS 1 1 0 0 0 1 1 1\nVELOCITY 1 1 2 3\n"])
def test_a_forward_run_keeps_its_energy_in_the_file(tmp_path, cards):
    deck = tmp_path / "thrown.dat"
    deck.write_text(
        "1 0 0 0 0 0 0 0 0 0 0 0\n0 0 0 1 0 0 0\n0 1 0.25\nDYNAMICS forward\nGRAVITY 0 0 -9.81\n" + cards
    )
    assert run_deck(str(deck), RunOptions(folder=str(tmp_path))).exit_code == 0
    with h5py.File(tmp_path / "thrown.h5") as file:
        start = 3.0 if "VELOCITY" in cards else 0.0
        time = file["time"][:]
        assert file["body/position"][:, 0, 2] == pytest.approx(start * time - 0.5 * 9.81 * time**2, abs=1e-9)
        assert np.ptp(file["energy/total"][:]) < 1e-8


def test_every_effort_has_the_unit_of_its_driver(tmp_path):
    """A free body moved along y by 3 m/s² and turned about y by 0.5 rad/s²: m a and I alpha."""
    deck = tmp_path / "moved.dat"
    deck.write_text(
        "1 2 0 0 0 0 0 0 0 4 0 0\n0 0 0 1 0 0 0\n1 2 0 0 3\n1 5 0 0 0.5\n1 1 0\n1 3 0\n1 4 0\n1 6 0\n"
        "0 0.2 0.1\nDYNAMICS inverse\nMASS 1 2 0 0 0 1 4 3\n"
    )
    assert run_deck(str(deck), RunOptions(folder=str(tmp_path))).exit_code == 0
    with open_result(tmp_path / "moved.h5") as file:
        efforts = resolve(file, ["driver.*.effort"])
        assert [quantity.header for quantity in efforts] == ["driver.1.effort [N]", "driver.2.effort [N m]"]
        assert file["driver/effort"].attrs["units"] == "N or N m"
        assert read(file, efforts) == pytest.approx(np.tile([2 * 3.0, 4 * 0.5], (3, 1)), rel=1e-9)
