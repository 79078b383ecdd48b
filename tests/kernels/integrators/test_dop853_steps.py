"""DOP853 on one equation that knows the time: y' = -2 t y, y = exp(-t²), and attempts that fail."""

from types import SimpleNamespace

import numpy as np
import pytest

from flexmb_cli.kernels._jit import interpreting
from flexmb_cli.kernels.integrators.clock import READY, ROWS_FULL, new_clock
from flexmb_cli.kernels.integrators.dop853 import Equations, dop853, interpolate, next_factor
from flexmb_cli.kernels.integrators.dop853_table import ALL_STAGES, DENSE_TERMS, STAGES

END = 2.0


def slope(integration, stage, t, longest):
    """Fill a slope, which steps longer than `longest` have none of after their first stages."""
    integration.clock["evaluations"] += 1
    integration.slopes[stage] = -2.0 * t * integration.trial
    return stage < 4 or stage > STAGES or integration.clock["length"][0] <= longest


def finish(integration, h, longest):
    slope(integration, STAGES, integration.clock["t"][0] + h, longest)
    return next_factor(integration.clock["error"][0], integration.clock["rejected"][0])


def close(integration, longest):
    integration.slopes[0] = integration.slopes[STAGES]
    return READY


def fill_row(integration, t, report, longest):
    clock, out = integration.clock[0], integration.z.copy()
    if t < clock["t"]:
        interpolate(integration.old, integration.dense, (t - clock["step_start"]) / clock["step_length"], out)
    report.values[clock["row"]] = out[0]
    clock["row"] += 1
    return READY


def integrated(first, longest, tolerance):
    """Values at even times, and the clock, for the lengths of the first step and of the longest."""
    # The last number of a state is work, which steps are not judged by.
    states = {name: np.ones(2) for name in ("z", "old", "trial", "units")}
    slopes, dense = np.zeros((ALL_STAGES, 2)), np.zeros((DENSE_TERMS, 2))
    integration = SimpleNamespace(clock=new_clock(1), slopes=slopes, dense=dense, **states)
    clock = integration.clock
    clock["stop"], clock["step"], clock["rtol"], clock["atol"] = END, first, tolerance, tolerance
    report = SimpleNamespace(times=np.linspace(0.0, END, 21), values=np.zeros(21))
    advance = dop853(Equations(slope, lambda *_: None, finish, lambda *_: READY, close, fill_row))
    with interpreting():
        assert advance(integration, report, 10**6, longest) == ROWS_FULL
    return report, clock[0]


@pytest.mark.parametrize(
    ("first", "longest", "tolerance"), [(0.01, np.inf, 1e-10), (0.5, 0.05, 1e-10), (1.9, np.inf, 1e-14)]
)
def test_rows_are_those_of_the_solution_whatever_attempts_fail(first, longest, tolerance):
    """Steps that begin well, those whose slopes fail, and one whose error is beyond all bounds."""
    report, clock = integrated(first, longest, tolerance)
    assert clock["rejections"] > 0
    assert clock["t"] == END
    np.testing.assert_allclose(report.values, np.exp(-(report.times**2)), rtol=0, atol=1e-9)
