"""Supplied decks in Exudyn: each that converts, moves there as in flexmb."""

import numpy as np
import pytest

from flexmb_cli.errors import ModelError
from flexmb_cli.interface import solve
from flexmb_cli.run.convert import converted
from tests.run.convert.test_convert_decks import DECKS, SUPPLIED
from tests.run.convert.test_points_apart import by_exudyn

# Largest difference of positions, m: Exudyn's steps are halved until their error is below 1e-7 m.
CONVERTED = {
    "young/dynamics/IN-ANDREWS.dat": 1e-9,
    "young/dynamics/IN-BRICARD.dat": 5e-7,
    "dafms/fourbar_rigid.DAT": 1e-8,
    "dafms/sliding_mass.DAT": 1e-9,
    "dafms/spatial_rigid.DAT": 1e-8,
}
SOON = ("dafms/sliding_mass.DAT", "young/dynamics/IN4-BAR-MASS.dat")


@pytest.mark.processes
@pytest.mark.parametrize(
    "deck", [pytest.param(deck, marks=[pytest.mark.campaign] * (deck not in SOON)) for deck in SUPPLIED]
)
def test_a_supplied_deck_moves_alike_in_exudyn_or_is_refused(deck, tmp_path):
    try:
        converted(str(DECKS / deck), "exudyn")
    except ModelError:
        assert deck not in CONVERTED
        return
    (found,) = by_exudyn(tmp_path, [(DECKS / deck).read_text()])
    head = (tmp_path / "d0-exudyn.csv").read_text().partition("\n")[0].split(",")[1::3]
    bodies = [int(name.split(".")[1]) - 1 for name in head]
    moving = solve(DECKS / deck)["body/position"][:, bodies].reshape(len(found), -1)
    assert np.ptp(moving, axis=0).max() > 0.01
    assert np.abs(found - moving).max() < CONVERTED[deck]
