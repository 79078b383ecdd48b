"""Every supplied DAFMS deck from its text to its files, and what the files hold."""

from pathlib import Path

import h5py
import numpy as np
import pytest

from flexmb_cli.deck.text import read_text
from flexmb_cli.dialects.dafms.beam import Beam
from flexmb_cli.dialects.dafms.build import build_dafms
from flexmb_cli.dialects.dafms.reader import read_dafms
from flexmb_cli.errors import ANALYSIS_FAILED
from tests.model.test_beam import rotation_card
from tests.run.dafms_runs import DECKS, ENDINGS, NAMES, altered, loaded, run

pytestmark = pytest.mark.long_motion

PUBLISHED = Path(__file__).parents[1] / "published" / "dafms"


@pytest.fixture(scope="module")
def outcomes(tmp_path_factory):
    """Outcome of every deck by its name, and the folder of the results."""
    folder = tmp_path_factory.mktemp("dafms")
    return {name: run(name, folder) for name in NAMES}, folder


def test_twenty_decks_are_supplied():
    assert len(NAMES) == 20


@pytest.mark.parametrize("name", NAMES)
def test_a_deck_gives_its_four_files_and_a_row_at_each_multiple_of_its_step(outcomes, name):
    outcome, folder = outcomes[0][name], outcomes[1]
    time = read_dafms(read_text(DECKS / f"{name}.DAT")).one("time")
    assert (outcome.exit_code, outcome.status) == (0, "complete")
    assert outcome.files == tuple(str(folder / f"{name}.{ending}") for ending in ENDINGS)
    assert sorted(path.name for path in folder.glob(f"{name}.*")) == sorted(
        f"{name}.{ending}" for ending in ENDINGS
    )
    assert np.array_equal(loaded(folder, name)["time"], np.arange(time["IT"] + 1) * time["H"])
    assert outcome.rows == time["IT"] + 1


@pytest.mark.parametrize("name", [name for name in NAMES if not name.endswith("unco")])
def test_energy_is_kept_but_for_the_tolerance_of_the_steps(outcomes, name):
    """Steps keep to 1e-9; a hundredfold is left for what adds up.  One-way models keep no energy."""
    values = loaded(outcomes[1], name)
    parts = [values[f"energy/{part}"] for part in ("kinetic", "potential", "strain")]
    total = values["energy/total"]
    assert np.max(np.abs(sum(parts) - values["energy/applied_work"] - total)) < 1e-12 * np.max(np.abs(parts))
    assert np.max(np.abs(total - total[0])) < 1e-7 * np.max(parts[0] + parts[2])


@pytest.mark.parametrize("sample", sorted(PUBLISHED.glob("*.OUT")), ids=lambda path: path.stem)
def test_the_out_file_is_the_echo_of_the_listing(outcomes, sample):
    assert (outcomes[1] / sample.name).read_bytes() == sample.read_bytes()


def test_units_2_and_3_have_the_columns_of_the_listing(outcomes):
    """FORMAT(2F12.7,5E15.6): T, Y(6), Y(7), Y(8) and T, Y(9), Y(11), Y(12); Y: 6 speeds, 6 coordinates."""
    values = loaded(outcomes[1], "two_link_n2")
    state = np.hstack([values["coordinate/u"], values["coordinate/q"]])
    for unit, places in (("T2", (6, 7, 8)), ("T3", (9, 11, 12))):
        lines = (outcomes[1] / f"two_link_n2.{unit}").read_text().splitlines()
        assert {len(line) for line in lines} == {12 + 12 + 15 + 15}
        fields = [[float(line[a:b]) for a, b in ((0, 12), (12, 24), (24, 39), (39, 54))] for line in lines]
        expected = np.column_stack([values["time"], *(state[:, place - 1] for place in places)])
        assert np.allclose(fields, expected, rtol=5.1e-7, atol=5.1e-8)


def test_a_result_says_what_it_is_and_names_what_it_holds(outcomes):
    with h5py.File(outcomes[1] / "fourbar_flex.h5") as file:
        assert (file.attrs["dialect"], file.attrs["analysis"]) == ("dafms", "dynamic")
        assert (file.attrs["status"], file.attrs["message"]) == ("complete", "")
        assert list(file["body/name"].asstr()) == ["body 1", "body 2", "body 3"]
        assert list(file["coordinate/name"].asstr())[:4] == [
            *(f"body {k} rotation 1" for k in (1, 2, 3)),
            "body 2 node 1 axis 3",
        ]
        assert list(file["coordinate/unit"].asstr()) == ["rad"] * 3 + ["m"] * 4
        assert list(file["point/name"].asstr())[2:4] == ["hinge 3", "body 2 node 1"]
        assert list(file["joint/name"].asstr()) == ["closure 1"]
        assert file["elastic/body 2/displacement"].shape == (201, 4, 3)
        assert file["reaction/force"].shape == (201, 1, 3)


def test_what_a_tree_does_not_have_is_absent(outcomes):
    with h5py.File(outcomes[1] / "spatial_rigid.h5") as file:
        assert not {"elastic", "reaction", "joint", "audit"} & set(file)


def derivative(values, step):
    """Five-point difference at the inner rows; its error is of the fourth order."""
    return (values[:-4] - 8 * values[1:-3] + 8 * values[3:-1] - values[4:]) / (12 * step)


MOTIONS = [
    ("body/position", "body/velocity", "body/acceleration"),
    ("body/euler_parameters", "body/euler_parameter_rates", "body/euler_parameter_accelerations"),
    ("point/position", "point/velocity", "point/acceleration"),
]


@pytest.mark.parametrize("name", ["spatial_flex", "spatial_rigid", "sliding_mass"])
def test_velocities_and_accelerations_are_derivatives(tmp_path, name):
    """Differences over 0.2 ms: the fastest elastic mode turns 0.05 rad meanwhile."""
    step = 2e-4
    exact = {"rtol": 1e-13, "atol": 1e-13}
    run(name, tmp_path, changes=("time.IT=60", f"time.H={step}"), integration=exact)
    values = loaded(tmp_path, name)
    for motion in MOTIONS:
        for path, rate in (motion[:2], motion[1:]):
            found = values[rate][2:-2]
            error = np.abs(derivative(values[path], step) - found)
            assert np.max(error) < 1e-6 * max(1.0, np.max(np.abs(found))), rate


def test_the_closure_force_is_that_on_the_second_body(outcomes):
    """Moments of the whole four-bar about its fixed hinge: weights, and the closure's pull on body 3.

    Nothing else has a moment there; sum of m r x a + I alpha about axis 1, planar.
    """
    values = loaded(outcomes[1], "fourbar_rigid")
    tree, _ = build_dafms(read_dafms(read_text(DECKS / "fourbar_rigid.DAT")))
    rate = weights = 0.0
    for k, body in enumerate(tree.bodies):
        place, push = (values[f"body/{name}"][:, k] for name in ("position", "acceleration"))
        omega, alpha = (values[f"body/angular_{name}"][:, k, 0] for name in ("velocity", "acceleration"))
        e0, e1 = values["body/euler_parameters"][:, k, :2].T
        angle = 2 * np.arctan2(e1, e0)
        out = body.centre[1] * np.column_stack([0 * angle, np.cos(angle), np.sin(angle)])
        across = np.column_stack([0 * angle, -out[:, 2], out[:, 1]])
        centre = place + out
        push = push + alpha[:, None] * across - omega[:, None] ** 2 * out
        central = body.inertia[0, 0] - body.mass * body.centre[1] ** 2
        rate = rate + np.cross(centre, body.mass * push)[:, 0] + central * alpha
        weights = weights + np.cross(centre, body.mass * np.array(tree.gravity))[:, 0]
    # The loop ends at the inertial point (0, 0, 0.6); body 3 feels the opposite of what the ground feels.
    pull = np.cross([0.0, 0.0, 0.6], -values["reaction/force"][:, 0])[:, 0]
    assert np.max(np.abs(pull)) > 1.0
    assert np.max(np.abs(rate - weights - pull)) < 1e-8 * np.max(np.abs(rate))


def test_a_run_that_fails_keeps_its_rows_marks_them_and_notes_it_on_unit_3(tmp_path):
    """A hinge spring of -1e6 N/m on a slide of 0.5 kg pushes: growth as exp(1414 t)."""
    deck = altered(tmp_path, "sliding_mass", ("END ", "SPRI\n    1\n    2    5 -1000000.       0.0\nEND "))
    outcome = run(deck, tmp_path)
    assert (outcome.exit_code, outcome.status) == (ANALYSIS_FAILED, "failed")
    assert "translation 2" in outcome.faults[-1].message
    assert outcome.failed_at > outcome.rows * 0.01 - 0.011
    with h5py.File(tmp_path / "sliding_mass.h5") as file:
        assert file.attrs["status"] == "failed"
        assert file.attrs["message"].startswith("body 2: at t = ")
        assert file["time"].shape == (outcome.rows,)
    lines = (tmp_path / "sliding_mass.T3").read_text().splitlines()
    assert lines[outcome.rows].startswith("  TOL,XEND,H,,METH,MITER,INDEX")
    assert lines[outcome.rows + 1].startswith("  **Y**")
    assert not (tmp_path / "sliding_mass.resume").exists()


def test_no_files_are_written_when_none_are_wanted(tmp_path):
    outcome = run("spatial_rigid", tmp_path, no_out=True, no_h5=True)
    assert (outcome.exit_code, outcome.files, outcome.rows) == (0, (), 201)
    assert list(tmp_path.iterdir()) == []


def test_a_closed_loop_without_coupling_is_refused_at_its_card_and_leaves_no_file(tmp_path):
    deck = altered(tmp_path, "fourbar_flex", ("END ", "UNCO\nEND "))
    outcome = run(deck, tmp_path / "results")
    assert outcome.exit_code == 2
    (fault,) = (fault for fault in outcome.faults if fault.severity == "error")
    assert fault.sentence.startswith("closure 1: closed loops need the coupled equations")
    assert fault.place is not None
    assert list(tmp_path.glob("results/*")) == []


def test_a_hinge_that_turns_with_its_node_keeps_the_energy(outcomes, tmp_path):
    """Link 2 turned with the slope of link 1's tip: another motion, whose energy is kept as well."""
    card = rotation_card(Beam(1.0, 2, 1000.0, 5.0), 1, 2)
    assert run(altered(tmp_path, "two_link_n2", ("END ", f"{card}END ")), tmp_path).exit_code == 0
    turned, straight = (loaded(folder, "two_link_n2") for folder in (tmp_path, outcomes[1]))
    assert np.max(np.abs(turned["coordinate/q"] - straight["coordinate/q"])) > 1e-5
    total = turned["energy/total"]
    assert np.max(np.abs(total - total[0])) < 1e-7 * np.max(turned["energy/kinetic"])


@pytest.mark.parametrize("method", ["radau", "lsoda"])
def test_other_integrators_give_the_same_motion(outcomes, tmp_path, method):
    """Tolerances of 1e-9 a step; what adds up over 0.5 s stays below 1e-6 rad and m."""
    assert run("shaft_beam_n2", tmp_path, integration={"method": method}).exit_code == 0
    found, expected = (loaded(folder, "shaft_beam_n2") for folder in (tmp_path, outcomes[1]))
    assert np.max(np.abs(found["coordinate/q"] - expected["coordinate/q"])) < 1e-6


def test_an_option_replaces_integrator_and_tolerances_of_the_deck(tmp_path):
    deck = altered(tmp_path, "spatial_rigid", ("END ", "METH\n    3\nEND "))
    loose = run(deck, tmp_path, integration={"method": "dop853", "rtol": 1e-4, "atol": 1e-4})
    tight = run(deck, tmp_path, integration={"method": "dop853", "rtol": 1e-12, "atol": 1e-12})
    assert loose.exit_code == tight.exit_code == 0
    counts = [int(outcome.statistics.split()[0]) for outcome in (loose, tight)]
    assert counts[1] > 2 * counts[0]
