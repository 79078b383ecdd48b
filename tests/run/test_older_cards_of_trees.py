"""Cards DAMP, MOTR and TABM of a deck that has newer cards, too: all are elements of its results."""

import h5py
import numpy as np
import pytest

from flexmb_cli.run.outcome import RunOptions
from flexmb_cli.run.solution import run_deck
from flexmb_cli.run.verify.verify import verify_deck
from tests.dialects.dafms.dafms_decks import deck_text
from tests.dialects.dafms.test_dafms_elements import TWO_LINKS, card, deck, integers, reals

pytestmark = pytest.mark.long_motion
# The second link welded to the first, no weight, 2 rad/s at the start; a stop that nothing reaches.
WELDED = (
    TWO_LINKS.replace("    2    1    0    0    1\n", "    2    0    0    0    0\n", 1)
    .replace("-9.81", "  0.0")
    .replace("Y(L)\n       0.0       0.0       0.0       0.0", "Y(L)\n       2.0       0.0")
)
STOP = "ELEMENTS\n  STOP hsto-1 at=1.r3 lower=-6 upper=6 stiffness=1"
INERTIA = 0.44 + 0.172 + 0.8 * (1 + 2 * 0.3)  # kg m2, of both links about the hinge
DAMPING, TORQUE = 0.5, 0.3


def test_older_dampers_and_motors_are_elements_and_dissipate(tmp_path):
    """J w' = T - c w: w = T/c + (2 - T/c) exp(-c t/J); the damper takes the integral of c w2."""
    cards = [
        card("DAMP", integers(1, 3) + reals(DAMPING)),
        card("MOTR", integers(1, 3) + reals(TORQUE)),
        STOP,
    ]
    (tmp_path / "x.DAT").write_text(deck("\n".join(cards), WELDED))
    outcome = run_deck(str(tmp_path / "x.DAT"), RunOptions(folder=str(tmp_path)))
    assert (outcome.exit_code, outcome.faults) == (0, [])
    with h5py.File(tmp_path / "x.h5") as file:
        assert [text.decode() for text in file["element/name"][:]] == ["damper 1", "motor 1", "hsto-1"]
        t, found = file["time"][:], {name: file[f"energy/{name}"][:] for name in ("dissipated", "total")}
        power, work = file["element/power"][:], file["element/work"][:]
    last, slow = TORQUE / DAMPING, np.exp(-DAMPING * t / INERTIA)
    rate, swing = last + (2 - last) * slow, 2 - last
    turned = last * t + swing * INERTIA / DAMPING * (1 - slow)
    taken = DAMPING * last**2 * t + 2 * last * swing * INERTIA * (1 - slow)
    taken += swing**2 * INERTIA / 2 * (1 - slow**2)
    assert found["dissipated"] == pytest.approx(taken, abs=1e-9)
    assert power[:, 0] == pytest.approx(-DAMPING * rate**2, abs=1e-9)
    assert work[:, 1] == pytest.approx(TORQUE * turned, abs=1e-9)
    kinetic = INERTIA / 2 * rate**2
    assert kinetic + found["dissipated"] - work[:, 1] == pytest.approx(INERTIA / 2 * 4, abs=1e-8)
    assert found["total"] == pytest.approx(np.full(t.size, found["total"][0]), abs=1e-8)


def test_a_table_that_jumps_agrees_with_kanes_equations(tmp_path):
    """Springs, dampers, a motor and a table of the supplied deck with a stop that nothing reaches."""
    text = deck_text(
        "motor_gear", ("END \n", "ELEMENTS\n  STOP hsto-1 at=2.r1 lower=-9 upper=9 stiffness=1" + "\nEND \n")
    )
    (tmp_path / "x.DAT").write_text(text.replace("  300\n      .005", "  120\n      .005"))
    found = verify_deck(str(tmp_path / "x.DAT"), RunOptions(), 1e-8)
    assert found.outcome.exit_code == 0, [each for each in found.differences if each.relative > 1e-8]
    assert {"element effort", "element work"} <= {each.name for each in found.differences if each.scale > 0}
