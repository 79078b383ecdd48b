"""`flexmb statics` and lines `START equilibrium`: equilibria, stability, reactions and stiffness.

The buckled pendulum: `reference/motion`, problem equilibrium-buckled-pendulum, closed form k a = m g l sin a.
"""

import json
import math
from pathlib import Path

import h5py
import numpy as np
import pytest
from click.testing import CliRunner

from flexmb_cli.cli import cli
from flexmb_cli.interface import solve_to_files
from flexmb_cli.run.outcome import Listener, RunOptions
from flexmb_cli.run.statics import Stepping, statics_of_deck
from tests.dialects.dafms.test_dafms_elements import TWO_LINKS
from tests.solvers.linearisation.test_from_equilibrium import ROTOR_OF_VSDF, buckled

BUCKLED, FREQUENCY = 1.63194426255, 3.63303936095
AT_REST = "  START equilibrium\n"


def pendulum(guess, more=""):
    return buckled(guess, more=more).replace("0.1 0.1 0.1", "0 0 0")


def statics(folder, name, text, stepping=Stepping(), **options):  # noqa: B008
    deck = folder / name
    deck.write_text(text)
    report = statics_of_deck(str(deck), stepping, RunOptions(**options), Listener())
    assert report.outcome.exit_code == 0, [fault.message for fault in report.outcome.faults]
    return report


def quantity(report, path):
    """Values of the last equilibrium by the names of their items."""
    [(names, values)] = [(names, values) for found, names, values in report.named() if found == path]
    return dict(zip(names, values[-1], strict=True))


@pytest.mark.parametrize("guess", [0.3, -0.3])
def test_the_buckled_pendulum_has_the_angle_frequency_and_torque_of_the_closed_form(tmp_path, guess):
    report = statics(tmp_path, "INB", pendulum(guess))
    [found] = report.equilibria
    assert found.stiffness.stability == "stable"
    assert quantity(report, "coordinate/q")["revolute 1 angle"] + guess == pytest.approx(
        math.copysign(BUCKLED, guess), abs=1e-10
    )
    assert quantity(report, "element/effort")["hinge"] == pytest.approx(
        -math.copysign(4.89583278765, guess), abs=1e-9
    )
    # The hinge carries the weight, and the stiffness is k - m g l cos a.
    assert quantity(report, "reaction/force")["revolute 1"] == pytest.approx([0, 0, 9.81], abs=1e-9)
    stiffness = 3 - 9.81 * 0.5 * math.cos(BUCKLED)
    assert found.stiffness.matrix[0, 0] == pytest.approx(stiffness, abs=1e-10)
    assert math.sqrt(found.stiffness.lowest) == pytest.approx(FREQUENCY, abs=1e-10)


def test_upright_it_is_unstable_from_the_share_of_its_weight_that_buckles_it(tmp_path):
    """Eigenvalue (m g l - k)/m l² = 7.62 1/s²; stability is lost at k/(m g l)."""
    report = statics(tmp_path, "INB", pendulum(0.0), Stepping(steps=4))
    lowest = [found.stiffness.lowest for found in report.equilibria]
    expected = [(3 - share * 9.81 * 0.5) / 0.25 for share in (0, 0.25, 0.5, 0.75, 1)]
    assert lowest == pytest.approx(expected, abs=1e-10)
    [warned] = [fault.message for fault in report.outcome.faults if fault.id == "SOLVE-181"]
    assert f"load factor {3 / (9.81 * 0.5):.4g}" in warned


def test_steps_of_a_force_on_a_spring_give_its_characteristic(tmp_path):
    """A slide on a spring of 40 N/m with a cubic one: share times the force = 40 x + 100 x³, by numpy."""
    text = (
        "2 0 0 0 0 0 0 1 0 0 0 1\n0 0 0 1 0 0 0\n0 0 0 1 0 0 0\n1 2 0 0 0 0 0 0 1 0 0 1 0 0 0 1 0 0 0 1\n"
        "1 0 0 0 0 0 0\n0 1 0.5\nDYNAMICS forward\nMASS 2 2 0 0 0 1 1 1\nELEMENTS\n"
        "  FUNCTION cubic polynomial 0 0 0 100\n  FUNCTION push polynomial 12\n"
        "  SPRING hold at=1.stroke stiffness=40 curve=cubic\n"
        "  FORCE load to=2(0,0,0) direction=(1,0,0) effort=push\nEND\n"
    )
    report = statics(tmp_path, "INS", text, Stepping(steps=3))
    strokes = report.values["coordinate/q"][:, 0]
    roots = [np.roots([100, 0, 40, -12 * k / 3]) for k in range(4)]
    expected = [float(root[np.abs(root.imag) < 1e-12].real[0]) for root in roots]
    assert strokes == pytest.approx(expected, abs=1e-9)
    stiffness = [found.stiffness.matrix[0, 0] for found in report.equilibria]
    assert stiffness == pytest.approx([40 + 300 * x * x for x in expected], rel=1e-7)


def test_two_links_of_a_tree_have_the_stiffness_of_their_weight(tmp_path):
    """Hanging pendulums: d²V/dq² of V = -g (m1 c1 + m2 l) cos a - g m2 c2 cos (a + b), by hand."""
    report = statics(tmp_path, "arm.DAT", f"{TWO_LINKS}END \nSTAR\nSTOP\n")
    [found] = report.equilibria
    # Masses 1.5 and 0.8, centres 0.4 m and 0.3 m from their hinges, 1 m apart.
    near, far = 9.81 * (1.5 * 0.4 + 0.8 * 1.0), 9.81 * 0.8 * 0.3
    assert found.stiffness.matrix == pytest.approx(np.array([[near + far, far], [far, far]]), rel=1e-6)
    upper, lower = (quantity(report, "hinge/force")[f"body {k}"] for k in (1, 2))
    assert np.linalg.norm(upper) == pytest.approx(9.81 * 2.3, rel=1e-9)
    assert np.linalg.norm(lower) == pytest.approx(9.81 * 0.8, rel=1e-9)


def test_a_rotor_of_a_vsdf_deck_follows_a_torque_at_the_times_of_its_rows(tmp_path):
    """Torque 0.6 t on torsion springs of 3 N m/rad: the angle is 0.2 t."""
    block = (
        "ELEMENTS\n  FUNCTION grows polynomial 0 0.6\n  SPRING soft at=1.angle stiffness=1\n"
        "  MOTOR load at=1.angle effort=grows\n  SPRING hold at=1.angle stiffness=2\n"
    )
    text = f"{ROTOR_OF_VSDF}{block}\nTIME\n 1,0.25\nEND\nSTAR\nSTOP\n"
    report = statics(tmp_path, "rotor.vsdf", text, Stepping(rows=True))
    assert report.values["time"] == pytest.approx([0, 0.25, 0.5, 0.75, 1])
    assert report.values["coordinate/q"][:, 0] == pytest.approx(0.2 * report.values["time"], abs=1e-9)
    # The inertia of the rotor is 0.02 kg m².
    assert [each.stiffness.lowest for each in report.equilibria] == pytest.approx([150.0] * 5, rel=1e-7)


def test_a_result_holds_the_equilibria_by_the_load_factor(tmp_path):
    place = tmp_path / "statics.h5"
    report = statics(tmp_path, "INB", pendulum(0.3), Stepping(steps=2), h5=str(place))
    with h5py.File(place) as h5:
        assert h5.attrs["analysis"] == "static" and h5.attrs["status"] == "complete"
        assert h5["time"][:] == pytest.approx([0, 0.5, 1])
        assert h5["statics/load_factor"][:] == pytest.approx([0, 0.5, 1])
        lowest = [each.stiffness.lowest for each in report.equilibria]
        assert h5["statics/lowest_eigenvalue"][:] == pytest.approx(lowest)
    table = CliRunner().invoke(cli, ["table", str(place), "statics.lowest_eigenvalue"])
    assert table.exit_code == 0 and len(table.output.splitlines()) == 4


def test_json_has_stiffness_and_reactions_by_name(tmp_path):
    (tmp_path / "INB").write_text(pendulum(0.3))
    printed = CliRunner().invoke(cli, ["statics", str(tmp_path / "INB"), "--json"])
    [found] = json.loads(printed.stdout)["equilibria"]
    assert found["stability"] == "stable" and found["relative_to"] == ["body 1"]
    assert found["reaction/force"]["revolute 1"][2] == pytest.approx(9.81)


def test_a_prescribed_motion_has_no_equilibrium_to_find(tmp_path):
    driven = "  FUNCTION turn polynomial 0 1\n  DRIVE motor at=1.angle value=turn\n"
    (tmp_path / "INB").write_text(buckled(0.3, "inverse", driven))
    report = statics_of_deck(str(tmp_path / "INB"), Stepping(), RunOptions(), Listener())
    assert report.outcome.exit_code == 2 and report.outcome.faults[-1].id == "SOLVE-180"


@pytest.mark.parametrize(
    "options", [("--rows", "--steps", "3"), ("--rows", "--at", "1"), ("--h5", "x.h5", "INB")]
)
def test_calls_that_contradict_themselves_are_refused(tmp_path, monkeypatch, options):
    monkeypatch.chdir(tmp_path)
    Path("INB").write_text(pendulum(0.3))
    assert CliRunner().invoke(cli, ["statics", "INB", *options]).exit_code == 2


# Lines START equilibrium


def run(folder, name, text):
    (folder / name).write_text(text)
    settings = RunOptions(folder=str(folder), no_out=True, h5=str(folder / "x.h5"))
    return solve_to_files(folder / name, settings), folder / "x.h5"


def test_a_line_begins_the_motion_of_a_mechanism_at_rest(tmp_path):
    outcome, result = run(tmp_path, "INB", pendulum(0.3, AT_REST))
    assert outcome.exit_code == 0
    with h5py.File(result) as h5:
        assert h5["coordinate/q"][:, 0] + 0.3 == pytest.approx(np.full(5, BUCKLED), abs=1e-10)
        assert np.abs(h5["body/velocity"][:]).max() < 1e-9


def test_a_line_begins_the_motion_of_a_tree_at_rest(tmp_path):
    outcome, result = run(tmp_path, "arm.DAT", f"{TWO_LINKS}ELEMENTS\n{AT_REST}END \nSTAR\nSTOP\n")
    assert outcome.exit_code == 0
    with h5py.File(result) as h5:
        assert np.sin(h5["coordinate/q"][:, 0]) == pytest.approx(-1, abs=1e-12)


def test_a_line_begins_the_motion_of_a_vsdf_deck_at_rest(tmp_path):
    block = f"ELEMENTS\n  SPRING hold at=1.angle stiffness=3 rest=0.4\n{AT_REST}"
    outcome, result = run(tmp_path, "r.vsdf", f"{ROTOR_OF_VSDF}{block}\nTIME\n 1,0.25\nEND\nSTAR\nSTOP\n")
    assert outcome.exit_code == 0
    with h5py.File(result) as h5:
        assert h5["coordinate/q"][:, 0] == pytest.approx(np.full(5, 0.4), abs=1e-10)


def test_another_start_beside_it_is_refused(tmp_path):
    outcome, _ = run(tmp_path, "INB", pendulum(0.3, AT_REST + "  START at=1.angle rate=2\n"))
    assert outcome.exit_code == 2 and [fault.id for fault in outcome.faults][-1] == "ELEMENTS-200"


def test_modes_are_those_of_the_equilibrium_and_verify_is_refused(tmp_path):
    (tmp_path / "INB").write_text(pendulum(0.3, AT_REST))
    found = CliRunner().invoke(cli, ["modes", str(tmp_path / "INB"), "--json"])
    [frequency] = json.loads(found.stdout)["mechanism"]["frequency"]
    assert frequency * math.tau == pytest.approx(3.63303936095, rel=1e-8)
    for command, fault in ((["verify"], "SOLVE-182"), (["modes", "--at", "0.5"], "SOLVE-183")):
        refused = CliRunner().invoke(cli, [*command, str(tmp_path / "INB"), "--json"])
        assert refused.exit_code == 2
        assert json.loads(refused.stdout)["faults"][-1]["id"] == fault


def test_a_converted_deck_begins_in_the_equilibrium(tmp_path):
    (tmp_path / "INB").write_text(pendulum(0.3, AT_REST))
    place = tmp_path / "c.vsdf"
    converted = CliRunner().invoke(cli, ["convert", str(tmp_path / "INB"), "--to", "vsdf", "-o", str(place)])
    assert converted.exit_code == 0, converted.output
    outcome, result = run(tmp_path, "c.vsdf", place.read_text())
    assert outcome.exit_code == 0
    with h5py.File(result) as h5:
        assert h5["element/effort"][:, 0] == pytest.approx(np.full(5, -4.89583278765), abs=1e-6)
