"""Rotations and angular velocities of output nodes in results.

Expected: arms on the same node, whose ends other equations place: p_arm - p = A exp(θ) a, and its velocity
ω x (p_arm - p).
"""

import csv

import numpy as np
import pytest
from click.testing import CliRunner
from scipy.spatial.transform import Rotation

from flexmb_cli.cli.plot import plot
from flexmb_cli.cli.table import table
from flexmb_cli.interface import solve
from tests.fe.row_bodies.row_decks import DECKS

pytestmark = pytest.mark.long_motion


@pytest.fixture(scope="module")
def result(tmp_path_factory):
    """Motion of beam_elements.vsdf for 0.2 s: node 103 and arms of 1 m on it along x, y and z."""
    text = (DECKS / "beam_elements.vsdf").read_text().replace("1.5,0.02,", "0.2,0.02,")
    path = tmp_path_factory.mktemp("turns") / "x.vsdf"
    path.write_text(text.replace("fe/", f"{DECKS}/fe/"))
    return solve(path)


def column(result, name, k):
    return np.column_stack(
        [result[f"{name.partition('/')[0]}.{k}.{name.partition('/')[2]}.{x}"] for x in "xyz"]
    )


def test_the_rotation_is_that_of_arms_on_the_node(result):
    arms = np.stack(
        [column(result, "point/position", k) - column(result, "point/position", 1) for k in (2, 3, 4)]
    )
    e = np.column_stack([result[f"body.2.euler_parameters.e{k}"] for k in range(4)])
    body = Rotation.from_quat(e[:, [1, 2, 3, 0]])
    turned = body * Rotation.from_rotvec(column(result, "turning/rotation", 1))
    assert np.abs(column(result, "turning/rotation", 1)).max() > 1e-4
    assert np.abs(turned.as_matrix() - arms.transpose(1, 2, 0)).max() < 1e-12


def test_table_and_plot_show_the_rotations(tmp_path, result):
    path = tmp_path / "x.h5"
    result.save(path)
    shown = CliRunner().invoke(table, [str(path), "turning.1.rotation", "--units", "deg"])
    heading, *rows = csv.reader(shown.stdout.splitlines())
    assert heading == ["time [s]", *(f"turning.1.rotation.{x} [deg]" for x in "xyz")]
    degrees = np.degrees(column(result, "turning/rotation", 1))
    assert np.array(rows, float)[:, 1:] == pytest.approx(degrees, rel=1e-12)
    drawn = CliRunner().invoke(plot, [str(path), "turning.1.rotation", "-q", "-o", str(tmp_path / "x.svg")])
    assert drawn.exit_code == 0, drawn.output
    labels = [f"rotation {x} of body 2 node 103" for x in "xyz"]
    text = (tmp_path / "x.svg").read_text()
    for label in ("rotation of body 2 node 103 [rad]", *labels):
        assert f"<!-- {label} -->" in text, label


def test_the_angular_velocity_moves_arms_of_the_node(result):
    spin = column(result, "turning/angular_velocity", 1)
    for k in (2, 3, 4):
        arm, speed = (
            column(result, f"point/{q}", k) - column(result, f"point/{q}", 1)
            for q in ("position", "velocity")
        )
        assert np.abs(np.cross(spin, arm) - speed).max() < 1e-11 * np.abs(speed).max()


def test_nodes_without_rotations_have_none():
    """Solid elements have no rotations: the dataset is absent."""
    text = (DECKS / "freeflying.vsdf").read_text()
    assert "OUTN" in text
    assert not any(name.startswith("turning") for name in solve(DECKS / "freeflying.vsdf"))
