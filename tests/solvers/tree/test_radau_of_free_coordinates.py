"""Radau's method where a coordinate acts on nothing: a cart's place, a free body."""

from pathlib import Path

import numpy as np
import pytest

import flexmb_cli
from flexmb_cli.run.outcome import RunOptions
from flexmb_cli.run.verify.verify import verify_deck
from flexmb_cli.solvers.tree.scipy_integrators import jacobian_of

CART = Path(__file__).parent / "radau.DAT"


def test_jacobian_stays_that_of_the_equations_however_often_it_is_asked_for():
    """x' = M x with columns of zeros: the differences are M, at 0 and far away, call after call."""
    matrix = np.array([[0.0, 0.0, 2.0], [0.0, 0.0, -3e6], [0.0, 0.0, 0.5]])
    jacobian = jacobian_of(lambda t, z: matrix @ z)
    for z in (np.zeros(3), np.array([1e9, -4.0, 1e-9])):
        for _ in range(400):
            assert jacobian(0.0, z) == pytest.approx(matrix, rel=1e-6)


def test_forces_of_a_cart_with_a_pendulum_keep_its_centre_of_mass(tmp_path):
    """No force acts along the rails: 3 kg x + 0.5 kg 1 m cos θ is constant."""
    text = CART.read_text().replace("METH\n", "TOLR\n    1.000E-06    1.000E-06\nMETH\n")
    for name, method in (("radau.DAT", "    2\n"), ("lsoda.DAT", "    3\n")):
        deck = text.replace("METH\n    2\n", f"METH\n{method}").replace(
            "   80\n      20.0", "    6\n       2.0"
        )
        (tmp_path / name).write_text(deck)
        angle, place = flexmb_cli.solve(tmp_path / name)["coordinate/q"].T
        assert 3.0 * place + 0.5 * np.cos(angle) == pytest.approx(np.full(7, 0.5), abs=1e-3)


def test_verify_of_a_cart_ends_by_the_steps_of_both_formulations(tmp_path):
    """A spring in the hinge makes `verify` take Radau's method; the cart's place acts on nothing."""
    spring = "ELEMENTS\n  SPRING hspr-1 at=2.r3 stiffness=2.0 damping=0.1\nMETH\n"
    text = CART.read_text().replace("   80\n      20.0", "    3\n       1.0").replace("METH\n", spring)
    (tmp_path / "radau.DAT").write_text(text)
    found = verify_deck(str(tmp_path / "radau.DAT"), RunOptions(), 1e-9)
    assert found.outcome.exit_code == 0, found.largest
    assert {row.name for row in found.differences} >= {"translation coordinates", "element effort"}


@pytest.mark.campaign
def test_pendulum_on_a_cart_swings_for_more_than_a_thousand_periods(tmp_path):
    """SciPy's own differences overflowed after some hundred of them."""
    text = CART.read_text().replace("METH\n", "TOLR\n    1.000E-03    1.000E-03\nMETH\n")
    (tmp_path / "radau.DAT").write_text(text)
    rows = flexmb_cli.solve(tmp_path / "radau.DAT")["coordinate/q"]
    assert len(rows) == 81
    assert np.isfinite(rows).all()
