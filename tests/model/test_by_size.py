"""What is listed by singular vectors stands in the same order whatever LAPACK leaves in their last digits.

Other processors are stood for by noise of 1e-13 and by any rotation of a null space's basis, which no
singular value decomposition prescribes.
"""

from pathlib import Path

import numpy as np
import pytest

from flexmb_cli.deck.text import read_text
from flexmb_cli.dialects.recognise import read_deck
from flexmb_cli.dialects.young.build_dynamics import build_young_dynamics
from flexmb_cli.model.by_size import by_size, first_of_largest
from flexmb_cli.solvers.constrained.young_dynamics import ForwardDynamics
from flexmb_cli.solvers.singular.mobility import involved, sparse_basis

BRICARD = Path(__file__).resolve().parents[2] / "decks/young/dynamics/IN-BRICARD.dat"


def test_equal_shares_stand_in_the_decks_order_whatever_their_last_digits():
    shares = np.array([0.5, 1.0, 0.2, 1.0, 0.5, 1.0])
    for seed in range(20):
        noisy = shares * (1.0 + 1e-13 * np.random.default_rng(seed).standard_normal(6))
        assert by_size(noisy) == [1, 3, 5, 0, 4, 2]
        assert first_of_largest(noisy) == 1


@pytest.mark.parametrize("count", [1, 2, 4])
def test_the_parts_of_a_null_space_do_not_depend_on_its_basis(count):
    """Symmetric parts: every vector of the space has many entries of equal size."""
    random = np.random.default_rng(count)
    space = np.linalg.qr(random.choice([-1.0, 0.0, 1.0], (12, count)) + np.eye(12, count))[0].T
    found = set()
    for seed in range(20):
        turn = np.linalg.qr(np.random.default_rng(seed).standard_normal((count, count)))[0]
        basis, pivots = sparse_basis(turn @ space * (1.0 + 1e-14 * seed))
        np.testing.assert_allclose(basis @ (np.eye(12) - space.T @ space), 0.0, atol=1e-12)
        found.add((pivots, *(tuple(involved(row)) for row in basis)))
    assert len(found) == 1


def test_bricards_notes_name_its_joints_in_the_decks_order():
    analysis = ForwardDynamics(build_young_dynamics(read_deck(read_text(str(BRICARD))))[0])
    analysis.start()
    (warning,) = analysis.warnings
    names = ", ".join(f"revolute joint {k}" for k in range(1, 7))
    assert f"among those of {names};" in warning.message
