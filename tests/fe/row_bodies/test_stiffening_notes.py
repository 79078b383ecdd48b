"""Notes on bodies that turn fast without geometric stiffness: figures, place, and bodies that have it.

Expected: the law of motion of spinup.vsdf, and the first frequency of its beam in the thin direction,
3.5160 √(E I/(m L³)) rad/s (Blevins (1979), table 8-1) with E I = 14000 N m² in the other (Simo and Vu-Quoc).
"""

import re

import numpy as np
import pytest

from flexmb_cli.interface import solve
from tests.dialects.vsdf.vsdf_decks import DECKS, supplied

# Of the decks' own time steps these are the first.
SHORT = ("      20.0      0.05    0.0025", "       3.0      0.05    0.0025")


def notes(path):
    """Notes of a run about missing stiffening."""
    return [fault for fault in solve(path).warnings if fault.id == "SOLVE-250"]


def figures(note):
    """Speed, lowest frequency and share that a note names."""
    return [float(number) for number in re.findall(r"(?:with|is|about) (\S+?)(?: rad|,)", note.message)]


@pytest.mark.long_motion
@pytest.mark.parametrize("on", [True, False])
def test_a_beam_that_is_spun_up_has_a_note_without_stiffening(tmp_path, on):
    path = tmp_path / "x.vsdf"
    text = supplied("spinup", SHORT, ("GEOS\n    1    1", f"GEOS\n    1    {int(on)}"))
    path.write_text(text.replace("fe/", f"{DECKS}/fe/"))
    found = notes(path)
    assert len(found) == (not on)
    if found:
        speed, lowest, share = figures(found[0])
        table = np.loadtxt(DECKS / "fe/spinup_nodes.txt")
        thick, thin = np.sort(np.ptp(table[:, 2:], axis=0))[::-1]
        assert speed == pytest.approx(0.4 * (3 - 15 / (2 * np.pi) * np.sin(0.4 * np.pi)), abs=1e-3)
        assert lowest == pytest.approx(3.516 * np.sqrt(14000 / 12e3) * thin / thick, rel=0.02)
        assert share == pytest.approx((speed / lowest) ** 2, rel=0.05)
        assert (found[0].severity, found[0].subject) == ("note", "body 1")
        assert found[0].place.line == 4 and "GEOS" in found[0].message


def test_a_beam_of_a_tree_has_a_note_unless_it_is_stiffened():
    """spinning_beams.DAT: bodies 2 and 3 are the same beam at 5 rad/s, GSTF stiffens body 2 alone."""
    (note,) = notes(DECKS.parent / "dafms/spinning_beams.DAT")
    speed, lowest, share = figures(note)
    assert note.subject == "body 3" and speed == 5.0
    assert share == pytest.approx((speed / lowest) ** 2, rel=0.05)
    assert "GSTF" in note.message


@pytest.mark.long_motion
def test_slow_bodies_have_no_notes():
    assert not notes(DECKS.parent / "dafms/pendulum.DAT")
