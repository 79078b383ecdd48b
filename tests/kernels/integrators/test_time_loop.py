"""The loop through time: rows, stops, pauses and retries, by a method whose every step is known: ẏ = 2."""

from collections import namedtuple

import numpy as np
import pytest

from flexmb_cli.kernels._jit import interpreting, kernel
from flexmb_cli.kernels.integrators import constrained_dop853, generalised_alpha, radau5, sdirk4, tree_dop853
from flexmb_cli.kernels.integrators.clock import (
    AT_STOP,
    CLOCK,
    PAUSED,
    READY,
    ROWS_FULL,
    STEP_SHORT,
    STEP_VANISHED,
    new_clock,
)
from flexmb_cli.kernels.integrators.time_loop import Method, time_loop

RATE, LONGEST = 2.0, 0.5  # steps longer than that fail
Integration = namedtuple("Integration", "clock z")
Report = namedtuple("Report", "times states")


@kernel
def length(integration, rate):
    clock = integration.clock[0]
    return min(clock["step"], clock["stop"] - clock["t"])


@kernel
def attempt(integration, h, rate):
    integration.clock[0]["evaluations"] += 1
    return 2.0 if h <= LONGEST else -0.5


@kernel
def accept(integration, factor, rate):
    clock = integration.clock[0]
    integration.z[0] += rate[0] * clock["length"]
    clock["t"] += clock["length"]
    clock["step"] = factor * clock["length"]
    clock["rejected"] = 0
    clock["steps"] += 1
    return READY


@kernel
def reject(integration, h, factor, rate):
    integration.clock[0]["step"] = factor * h
    integration.clock[0]["rejections"] += 1
    integration.clock[0]["rejected"] = 1


@kernel
def fill_row(integration, t, report, rate):
    clock = integration.clock[0]
    report.states[clock["row"]] = integration.z[0] - rate[0] * (clock["t"] - t)
    clock["row"] += 1
    return READY


_advance = time_loop(Method(length, attempt, accept, reject, fill_row))


@kernel
def advance(integration, report, budget, rate):
    return _advance(integration, report, budget, rate)


def march_at(step, **values):
    clock = new_clock()
    clock["step"] = step
    for name, value in values.items():
        clock[name] = value
    return Integration(clock, np.zeros(1))


def integrate(integration, times, budget=1000):
    report = Report(np.array(times), np.full(len(times), np.nan))
    return advance(integration, report, budget, np.array([RATE])), report.states


def test_rows_between_and_at_the_ends_of_steps_lie_on_the_solution():
    integration, times = march_at(0.125), [0.0, 0.1, 0.125, 0.2, 1.0]
    code, states = integrate(integration, times)
    assert code == ROWS_FULL
    np.testing.assert_allclose(states, RATE * np.array(times), rtol=1e-15)
    assert integration.clock["next"][0] == times[-1]


def test_a_failed_attempt_is_made_again_shorter():
    """A step of 1.5 s fails, so do 0.75 s; 0.375 s goes well, and twice as much fails again."""
    integration = march_at(1.5)
    integrate(integration, [0.6])
    clock = integration.clock[0]
    assert (clock["steps"], clock["rejections"], clock["t"]) == (2, 3, 0.75)


def test_no_step_goes_over_the_stop_and_rows_behind_it_wait():
    integration = march_at(0.25, stop=0.4)
    code, states = integrate(integration, [0.3, 0.5])
    assert code == AT_STOP
    assert integration.clock["t"][0] == 0.4
    assert np.isnan(states[1])


def test_a_call_pauses_when_its_evaluations_are_used_up_and_the_next_goes_on():
    integration = march_at(0.125)
    assert integrate(integration, [1.0], budget=2)[0] == PAUSED
    assert integration.clock["evaluations"][0] == 2
    code, states = integrate(integration, [1.0])
    assert (code, states[0]) == (ROWS_FULL, 2.0)


@pytest.mark.parametrize(
    ("factor", "code", "rejections"),
    [(-1.0, STEP_VANISHED, 1), (-2.0, STEP_VANISHED, 1), (-0.5, PAUSED, 10), (-0.99, PAUSED, 10)],
)
def test_a_step_that_no_try_finds_ends_or_pauses_the_call(factor, code, rejections):
    """A try that is not shorter would fail for ever; shorter ones use up the evaluations of the call."""

    @kernel
    def fail(integration, h, rate):
        integration.clock[0]["evaluations"] += 1
        return factor

    loop = time_loop(Method(length, fail, accept, reject, fill_row))
    integration = march_at(0.125)
    report = Report(np.array([1.0]), np.zeros(1))
    with interpreting():
        assert loop(integration, report, 10, np.array([RATE])) == code
    assert integration.clock["rejections"][0] == rejections


def test_pauses_between_tries_change_nothing():
    paused, whole = march_at(1.5), march_at(1.5)
    codes = [integrate(paused, [0.6], budget=1)[0] for _ in range(4)]
    assert codes == [PAUSED, PAUSED, PAUSED, PAUSED]
    assert integrate(paused, [0.6]) == integrate(whole, [0.6]) == (ROWS_FULL, 1.2)
    assert paused.clock == whole.clock


def test_steps_below_the_resolution_of_time_are_not_made():
    assert integrate(march_at(1e-14, t=10.0), [11.0])[0] == STEP_VANISHED


def test_steps_much_shorter_than_the_longest_need_the_agreement_of_the_caller():
    assert integrate(march_at(1e-8, longest=0.1), [1.0])[0] == STEP_SHORT
    assert integrate(march_at(1e-8, longest=0.1, short_step_allowed=1), [1.0])[0] == ROWS_FULL


@pytest.mark.parametrize(
    "march_type",
    [
        constrained_dop853.Integration,
        generalised_alpha.AlphaIntegration,
        radau5.RadauIntegration,
        sdirk4.Implicit,
        tree_dop853.Integration,
    ],
)
def test_every_method_keeps_the_same_clock(march_type):
    """Fields of a method alone stand in its MEMORY, none of which hides one of the clock."""
    assert march_type._fields[0] == "clock"
    for module in (generalised_alpha, radau5, sdirk4):
        assert not set(module.MEMORY.names) & set(CLOCK.names)
