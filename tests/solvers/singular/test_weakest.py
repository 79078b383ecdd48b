"""What is weakest at a position: by a matrix whose singular values and vectors are given."""

import numpy as np
import pytest

from flexmb_cli.errors import Place
from flexmb_cli.model.joints import Equation
from flexmb_cli.solvers.singular.conditioning import (
    MOST_NOTES,
    SingularityNotes,
    condition_text,
    conditioning_of,
    owners_text,
    weakest_owners,
)


def equation(owner, line=None):
    return Equation(owner, "x", Place(line, 1) if line else None, 1.0)


DRIVER, FIRST, SECOND, UNIT = (
    equation("driver 1", 20),
    equation("spherical joint 1", 7),
    equation("hinge of body 2", 9),
    equation("body 1"),
)


@pytest.mark.parametrize(("rank", "condition"), [(3, 800.0), (2, 4.0)])
def test_condition_motion_and_combination_belong_to_the_last_singular_value_that_counts(rank, condition):
    random = np.random.default_rng(7)
    left, right = (np.linalg.qr(random.normal(size=(3, 3)))[0] for _ in range(2))
    found = conditioning_of(left @ np.diag([8.0, 2.0, 0.01]) @ right.T, rank)
    assert found.condition == pytest.approx(condition, rel=1e-9)
    assert abs(found.combination @ left[:, rank - 1]) == pytest.approx(1.0, rel=1e-9)
    assert abs(found.motion @ right[:, rank - 1]) == pytest.approx(1.0, rel=1e-9)


def test_joints_with_large_shares_are_named_in_the_order_of_the_deck():
    equations = [SECOND, DRIVER, UNIT, FIRST, FIRST]
    assert weakest_owners(equations, np.array([0.9, 0.8, 1.0, 0.1, -0.7]), 3) == [FIRST, SECOND]
    assert weakest_owners(equations, np.array([0.1, 0.8, 1.0, 0.1, 0.1]), 3) == [DRIVER]
    assert weakest_owners(equations, np.array([0.1, 0.1, 1.0, 0.1, 0.1]), 3) == [UNIT]
    assert owners_text([FIRST, UNIT]) == "spherical joint 1 (line 7), body 1"


def test_a_condition_of_round_off_is_no_number():
    assert condition_text(2.5e3, 1e6) == "condition 2e+03"
    assert condition_text(2.5e7, 1e6) == "condition above 1e+06"


def test_after_the_last_note_no_more_are_taken():
    warnings = []
    notes = SingularityNotes(warnings)
    while not notes.full:
        notes.add("passed", [FIRST])
    assert len(warnings) == MOST_NOTES
    assert [warning.message for warning in warnings[-2:]] == [
        "passed",
        "passed; later ones are not looked for",
    ]
    assert warnings[0].place == FIRST.place
