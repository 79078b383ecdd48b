"""Explicit steps of flexible bodies that stability limits, not the tolerance."""

from dataclasses import replace
from pathlib import Path

import pytest

from flexmb_cli.deck.text import read_text
from flexmb_cli.dialects.vsdf.build import build_vsdf
from flexmb_cli.dialects.vsdf.reader import read_vsdf
from flexmb_cli.fe.build_mechanism import flexible_mechanism
from flexmb_cli.kernels.integrators.dop853 import AT_LIMIT
from flexmb_cli.kernels.integrators.dop853_table import STAGE_WEIGHTS, STAGES
from flexmb_cli.model.integrators import Integrator
from flexmb_cli.model.mechanism import TimeGrid
from flexmb_cli.solvers.constrained.flexible_dynamics import FlexibleDynamics

DECKS = Path(__file__).parents[4] / "decks" / "vsdf"


def growth(z):
    """Growth of x' = z x in a step of length 1."""
    slopes = []
    for stage in range(STAGES + 1):
        slopes.append(z * (1 + sum(a * b for a, b in zip(STAGE_WEIGHTS[stage], slopes, strict=False))))
    return slopes[-1] / z


def test_vibrations_are_damped_at_the_limit_looked_for_and_grow_a_third_above_it():
    """The stability polynomial of DOP853 on the imaginary axis, by its stages alone."""
    assert 0.9 < abs(growth(1j * AT_LIMIT)) < 0.95
    assert abs(growth(6.0j)) > 1.05


@pytest.mark.long_motion
@pytest.mark.parametrize(
    ("method", "tolerance", "warned"), [("RK45", 5.6e-3, True), ("RK45", 1e-9, False), ("RAD5", 1e-3, False)]
)
def test_loose_tolerance_of_a_stiff_rod_is_warned_of(method, tolerance, warned):
    """The rod's 20th mode is 150 times as fast as the fastest that moves noticeably."""
    text = read_text(DECKS / "pendulum.vsdf")
    text = replace(text, text=text.text.replace("    1 FLEX    9", "    1 FLEX   20"))
    given = flexible_mechanism(build_vsdf(read_vsdf(text), DECKS)[0], cached=False)[0]
    run = FlexibleDynamics(
        replace(given, time=TimeGrid(0.0, 0.1, 0.05), integrator=Integrator(method, tolerance=tolerance))
    )
    list(run.rows())
    assert any("GALF or RAD5" in fault.message for fault in run.warnings) == warned
