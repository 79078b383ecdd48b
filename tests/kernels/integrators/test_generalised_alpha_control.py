"""Lengths of the steps of the generalised-α method."""

import numpy as np

from flexmb_cli.kernels._jit import interpreting
from flexmb_cli.kernels.integrators.clock import crosses_singularity, new_clock
from flexmb_cli.kernels.integrators.generalised_alpha import MEMORY
from flexmb_cli.kernels.integrators.generalised_alpha_step import next_length, retreat


def test_another_try_is_always_shorter():
    """Near a singular position the steps are laid out anew: no layout may bring the failed one back."""
    rng = np.random.default_rng(1)
    clock, memory = new_clock()[0], np.zeros(1, MEMORY)[0]
    over = 0
    with interpreting():
        for _ in range(1000):
            clock["step"], clock["stop"] = rng.uniform(0.1, 1.0), rng.choice([0.3, np.inf, np.inf])
            memory["passing"] = clock["step"] * rng.uniform(0.1, 30.0)
            clock["singular"] = memory["passing"] * rng.uniform(0.0, 1.0)
            tried = next_length(clock, memory)
            for _ in range(4):
                over += crosses_singularity(clock, tried)
                retreat(clock, memory, tried, rng.uniform(0.1, 0.85) * tried)
                again = next_length(clock, memory)
                assert again < tried
                tried = again
    assert over > 100
