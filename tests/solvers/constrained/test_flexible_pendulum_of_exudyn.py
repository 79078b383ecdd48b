"""The flexible pendulum of decks/vsdf, the same motion in Exudyn: hinge, shapes and gravity as in the deck.

Exudyn integrates by the generalised-α method (steps of 4e-5 and 2e-5 s, extrapolated), flexmb by DOP853.
With the hinge 7.5 mm higher, at the middle of the root face, the tips come 1.4 mm apart within 0.05 s.
"""

import sys
from pathlib import Path

import numpy as np
import pytest

sys.path.insert(0, str(Path(__file__).parents[3] / "scripts/bench"))
from flexible import ROWS, integration, mechanism
from flexible_pendulum import converged

pytestmark = [pytest.mark.long_motion, pytest.mark.filterwarnings("ignore::DeprecationWarning")]
END = 0.05  # s, in which the tip falls by 18 mm
APART = 1e-9  # m


def test_the_tip_of_the_pendulum_falls_as_in_exudyn():
    given = mechanism(8)
    ours = integration(given, "RK45", 0.0, 1e-11, END)[0]
    places, corrected = converged(given.bodies[0].flexible, END, ROWS)
    assert np.ptp(ours[:, 2]) > 0.01
    assert corrected < 1e-8
    assert np.abs(places - ours).max() < APART
