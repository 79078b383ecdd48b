"""Printed digits at the default tolerance: speeds of unit 2 have seven decimals.

The reference is the same tree at rtol 1e-13, atol 1e-16.  With 1e-9, the default before, speeds of the
two-link manipulator were 6.7e-6 off, 67 units of the last digit.
"""

from dataclasses import replace

import numpy as np
import pytest

from flexmb_cli.model.tree import Integration
from tests.solvers.tree.tree_runs import DECKS, build_dafms, read_dafms, read_text, run

LAST_DIGIT = 1e-7


@pytest.mark.long_motion
def test_every_printed_speed_and_coordinate_is_right_by_default():
    tree, _ = build_dafms(read_dafms(read_text(DECKS / "two_link_n2.DAT")))
    rows = run(tree)
    exact = run(replace(tree, integration=Integration("dop853", 1e-13, 1e-16)))
    for name in ("q", "y"):
        np.testing.assert_allclose(getattr(rows, name), getattr(exact, name), rtol=0, atol=0.5 * LAST_DIGIT)
