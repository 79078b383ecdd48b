"""Dry friction of bodies that hardly weigh anything: the equations of motion are linear in the masses."""

import numpy as np
import pytest

from tests.solvers.constrained.element_decks import ROTOR, rows_of


def swung(mass):
    """A pendulum of 0.4 m on a bearing of 20 mm; its friction is a share of the force in the bearing."""
    inertia = mass * 0.2
    return rows_of(
        ROTOR,
        "0 0.3 0.1",
        f"MASS 2 {mass!r} 0.4 0 0 {inertia!r} {inertia!r} {inertia!r}\nGRAVITY 0 -9.81 0\n"
        "ELEMENTS\n"
        "  FRICTION friction-1 joint=1 dynamic=0.6 static=0.6 stribeck=0.1 creep=1e-3 "
        "radius=0.1\n"
        "  START at=1.angle rate=0.5\n",
    )


def test_a_pendulum_of_a_microgram_swings_as_one_of_a_kilogram():
    """M q'' = Q: a mass of m times 1e-9 kg divides both sides by the same, and leaves the motion as it is.

    Friction is a share of the reaction, which has the factor as well: it, too, is 1e-9 of that of 1 kg.
    """
    heavy, light = swung(1.0), swung(1e-9)
    assert np.abs(heavy.joint_coordinate[-1, 0]) > 0.05
    assert light.joint_coordinate == pytest.approx(heavy.joint_coordinate, abs=3e-10)
    assert light.joint_rate == pytest.approx(heavy.joint_rate, abs=1e-8)
    for found, wanted in (
        (light.element_effort, heavy.element_effort),
        (light.reaction_force, heavy.reaction_force),
    ):
        assert 1e9 * found == pytest.approx(wanted, abs=1e-8 * np.abs(wanted).max())
