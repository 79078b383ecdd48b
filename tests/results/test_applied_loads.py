"""Series of applied forces: vectors against scipy's rotations of directions, work by Simpson's rule."""

import numpy as np
import pytest
from scipy.integrate import simpson
from scipy.spatial.transform import Rotation

from flexmb_cli import interface
from tests.dialects.dafms.test_dafms_elements import TWO_LINKS
from tests.solvers.constrained.elements.test_forces_over_time import FREE, HINGED, ROTOR, solved

GROWS = "FUNCTION rise polynomial 3 12"


def applied(result):
    """Force, torque and power of the only load."""
    return [result[f"load/{name}"][:, 0] for name in ("force", "torque", "power")]


@pytest.mark.parametrize(
    ("name", "deck", "place", "options"),
    [
        ("x.DAT", FREE, "1(0.5,0,0)", {"formulation": "kane"}),
        ("x.DAT", FREE, "1(0.5,0,0)", {"formulation": "absolute"}),
        ("INX", ROTOR, "2(0.5,0,0)", {}),
        ("x.vsdf", HINGED, "1:2", {}),
    ],
)
def test_a_force_that_turns_with_its_body_has_the_vector_and_power_of_its_line(
    tmp_path, name, deck, place, options
):
    body = int(place[0])
    line = f"FORCE push to={place} direction=(3,4,0) axes={body} effort=rise"
    found = solved(tmp_path, deck, [GROWS, line], name, **options)
    force, torque, power = applied(found)
    e = found["body/euler_parameters"][:, body - 1]
    axes = Rotation.from_quat(e[:, [1, 2, 3, 0]])
    expected = (3 + 12 * found.time)[:, None] * axes.apply([0.6, 0.8, 0])
    np.testing.assert_allclose(force, expected, atol=1e-12)
    assert not torque.any()
    omega, arm = found["body/angular_velocity"][:, body - 1], axes.apply([0.5, 0, 0])
    speed = found["body/velocity"][:, body - 1] + np.cross(omega, arm)
    np.testing.assert_allclose(power, np.sum(expected * speed, axis=1), atol=1e-9)


def test_a_torque_in_axes_of_the_ground_has_no_force(tmp_path):
    line = "TORQUE turn to=2(0,0,0) direction=(0,0,-2) effort=rise"
    found = solved(tmp_path, ROTOR, [GROWS, line], "INX")
    force, torque, power = applied(found)
    assert not force.any()
    expected = -(3 + 12 * found.time)
    np.testing.assert_allclose(torque, expected[:, None] * [0, 0, 1], atol=1e-12)
    np.testing.assert_allclose(power, expected * found["body/angular_velocity"][:, 1, 2], atol=1e-12)


@pytest.mark.parametrize("formulation", ["kane", "absolute"])
def test_cards_of_a_tree_do_the_work_that_the_run_integrates(tmp_path, formulation):
    none = "    1       0.0       0.0       0.0\n"
    cards = (
        f"FORC\n{none}    2       3.0       5.0       0.0\nTOQU\n{none}    2       0.0       0.0      -0.7\n"
    )
    deck = tmp_path / "arm.DAT"
    model = TWO_LINKS.replace("    5\n       0.1\nCONN", "   50\n      0.01\nCONN")
    deck.write_text(f"{model}{cards}END \nSTAR\nSTOP\n")
    found = interface.solve(str(deck), formulation=formulation)
    force, torque, power = applied(found)
    assert (force == [3, 5, 0]).all() and (torque == [0, 0, -0.7]).all()
    assert simpson(power, x=found.time) == pytest.approx(found["energy/applied_work"][-1], rel=1e-7)


def test_results_without_such_loads_have_none(tmp_path):
    found = solved(tmp_path, ROTOR, ["SPRING hold at=1.angle stiffness=3"], "INX")
    assert "load/force" not in found
