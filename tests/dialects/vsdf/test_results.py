"""Files and records of `flexmb run` on VSDF decks: listing, HDF5 result, changes, failures."""

import io
import json
from types import SimpleNamespace

import h5py
import numpy as np
import pytest

from flexmb_cli.deck.edit import P
from flexmb_cli.deck.fortran_format import Layout
from flexmb_cli.dialects.vsdf.listing import VsdfTable
from flexmb_cli.run.outcome import RunOptions
from flexmb_cli.run.solution import run_deck
from tests.dialects.vsdf.vsdf_decks import changed

SHORT = changed(("       1.0      0.01\n", "       0.1      0.02\nINTG\n RK45    1.0E-9\n"))
PINNED = changed(
    ("    2 REVO    1    3    4    2    1    2\n", "PINN\n    2    3  001\nMOTN\n1,ANGL,1,1,0.0,0.5\n"),
    text=SHORT,
)


def run(folder, text, **options):
    deck = folder / "deck.vsdf"
    deck.write_text(text)
    return run_deck(str(deck), RunOptions(folder=str(folder), **options))


def test_the_listing_has_the_numbers_of_the_result(tmp_path):
    outcome = run(tmp_path, SHORT)
    assert outcome.exit_code == 0, outcome.faults
    assert (outcome.rows, len(outcome.files)) == (6, 2)
    lines = (tmp_path / "deck.OUT").read_text().splitlines()
    assert lines[1:3] == ["VSDF TWO LINKS", "BODY"]
    first = next(k for k, line in enumerate(lines) if line.startswith(" TIME ="))
    with h5py.File(tmp_path / "deck.h5") as file:
        position, velocity = file["point/position"][:, 0], file["point/velocity"][:, 0]
        energies = [file[f"energy/{name}"][:] for name in ("kinetic", "strain", "potential")]
        times = file["time"][:]
    for k, t in enumerate(times):
        time, node, energy = lines[first + 3 * k : first + 3 * k + 3]
        assert float(time.split("=")[1]) == pytest.approx(t, rel=1e-5)
        numbers = node.split()
        assert numbers[:2] == ["2", "3"]
        np.testing.assert_allclose(
            np.array(numbers[2:], float), [*position[k], *velocity[k]], rtol=6e-6, atol=1e-300
        )
        values = [series[k] for series in energies]
        np.testing.assert_allclose(np.array(energy.split()[1:], float), [*values, sum(values)], rtol=6e-6)


def test_the_result_names_what_the_deck_has_and_nothing_else(tmp_path):
    assert run(tmp_path, PINNED).exit_code == 0
    with h5py.File(tmp_path / "deck.h5") as file:
        assert (file.attrs["dialect"], file.attrs["analysis"]) == ("vsdf", "dynamic")
        assert [name.decode() for name in file["joint/name"][:]] == ["joint 1"]
        assert [name.decode() for name in file["held/name"][:]] == ["pin 1"]
        assert [name.decode() for name in file["driver/name"][:]] == ["motion 1"]
        assert file["reaction/force"].shape == (6, 1, 3)
        assert file["driver/effort"].shape == (6, 1)
        assert file["driver/effort"].attrs["units"] == "N m"
        assert "modal" not in file
        total = file["energy/total"][:]
        np.testing.assert_allclose(total, total[0], atol=1e-9)
        # Prescribed at 0.5 rad/s about z from the x axis.
        angle = 0.5 * file["time"][:]
        p = file["body/euler_parameters"][:, 0]
        np.testing.assert_allclose(p[:, 3], np.sin(angle / 2), atol=1e-9)


def test_the_listing_goes_to_standard_output_and_changes_are_obeyed(tmp_path):
    deck, stream = tmp_path / "deck.vsdf", io.StringIO()
    deck.write_text(SHORT)
    options = RunOptions(folder=str(tmp_path), out="-", no_h5=True, changes=("time.end=0.04",))
    outcome = run_deck(str(deck), options, stdout=stream)
    assert outcome.exit_code == 0, outcome.faults
    assert outcome.rows == 3
    assert stream.getvalue().count(" TIME =") == 3
    assert list(tmp_path.iterdir()) == [deck]


def test_a_failed_assembly_leaves_a_marked_result_and_tells_the_joint(tmp_path):
    far = changed(
        ("    2 REVO    1    3    4    2    1    2\n",
         "    2 REVO    1    3    4    2    1    2\n3,DIST,0,1,,2,3,,,,9.0\n"),
        text=SHORT,
    )  # fmt: skip
    outcome = run(tmp_path, far)
    record = json.loads(json.dumps(outcome.as_dict()))
    assert (record["status"], record["exit_code"], record["rows"]) == ("failed", 1, 0)
    (fault,) = record["faults"]
    assert "joint 3 (distance" in fault["message"]
    assert far.splitlines()[fault["line"] - 1].startswith("3,DIST")
    with h5py.File(tmp_path / "deck.h5") as file:
        assert file.attrs["status"] == "failed"


def test_numbers_of_the_listing_are_those_of_1PE():
    layout = Layout(P(13, 5), P(13, 5), P(13, 5), "\n")
    assert layout.lines([0.1, -12345.678, 0.0]) == "  1.00000E-01 -1.23457E+04  0.00000E+00\n"


@pytest.mark.parametrize(("smallest", "shown"), [(7.359e-2, "7.359E-02"), (3.1e-17, "below 1E-12")])
def test_the_listing_has_no_digits_of_round_off_for_a_singular_value(smallest, shown):
    found = SimpleNamespace(coordinates=12, rank=11, equations=12, smallest=smallest)
    lines = VsdfTable._constraint_lines(SimpleNamespace(analysis=SimpleNamespace(mobility=found)))
    assert list(lines)[-1] == f"  degrees of freedom 1, smallest singular value {shown}"
