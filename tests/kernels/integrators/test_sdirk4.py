"""SDIRK4 on a sliding mass with spring and damper, in closed form (Rao, Mechanical Vibrations, 2.6)."""

import math

import numpy as np

from flexmb_cli.model.mechanism import TimeGrid
from flexmb_cli.model.tree import INERTIAL, TRANSLATION, Body, Hinge, Integration, Spring, Tree
from tests.solvers.tree.tree_runs import run

M, K, C, X0, V0 = 2.0, 50.0, 1.5, 0.3, 0.4


def test_a_damped_mass_swings_as_in_textbooks_within_and_at_the_ends_of_steps():
    tree = Tree(
        (Body("body 1", M, np.eye(3)),),
        (Hinge(INERTIAL, translations=(1,)),),
        np.array([X0]),
        np.array([V0]),
        TimeGrid(0.0, 0.4, 0.05),
        gravity=(0.0, 0.0, 0.0),
        springs=(Spring(0, TRANSLATION, 1, K, C),),
        integration=Integration("sdirk4", 1e-6, 1e-6),
    )
    rows = run(tree)
    decay = C / (2.0 * M)
    omega = math.sqrt(K / M - decay**2)
    wave = X0 * np.cos(omega * rows.time) + (V0 + decay * X0) / omega * np.sin(omega * rows.time)
    np.testing.assert_allclose(rows.q[:, 0], np.exp(-decay * rows.time) * wave, rtol=0, atol=2e-5)
