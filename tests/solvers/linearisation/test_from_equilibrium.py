"""`run --from-equilibrium`: motions that begin at rest under the loads, in every dialect.

The buckled pendulum: `reference/motion`, problem equilibrium-buckled-pendulum, closed form k a = m g l sin a.
"""

import math
from pathlib import Path

import h5py
import numpy as np
import pytest

from flexmb_cli.interface import solve_to_files
from flexmb_cli.run.outcome import RunOptions
from tests.dialects.dafms.test_dafms_elements import TWO_LINKS

DECKS = Path(__file__).resolve().parents[3] / "decks"
BUCKLED = """2 0 0 0 0 1 0 0 0 0 0 1
0 0 0 1 0 0 0
0 0 0 {} 0 {} 0
1 2 0 0 0 0 0 0 0 1 0 0 1 0
1 0 0 0 0 0 0
0 1 0.25
DYNAMICS {}
MASS 2 1 0 0 0.5 0.1 0.1 0.1
GRAVITY 0 0 -9.81
ELEMENTS
  SPRING hinge at=1.angle stiffness=3 rest={}
{}END
"""
ROTOR_OF_VSDF = (
    "VSDF ROTOR\nBODY\n 1,RIGD\nRIGI\n 1,1,0,0,0\n 0.1,0.1,0.02,0,0,0\n"
    "NODE\n 0,1,0,0,0\n 0,2,0,0,1\n 1,1,0,0,0\n 1,2,0,0,1\n"
    "JOIN\n 1,REVO,0,1,2,1,1,2\nGRAV\n 0,0,0\n"
)


def buckled(guess, analysis="forward", more=""):
    c, s = math.cos(guess / 2), math.sin(guess / 2)
    return BUCKLED.format(repr(c), repr(s), analysis, repr(-guess), more)


def run(folder, name, text, **options):
    """Outcome of a deck that begins at rest, and its result."""
    deck = folder / name
    deck.write_text(text)
    settings = RunOptions(
        folder=str(folder), no_out=True, h5=str(folder / "x.h5"), from_equilibrium=True, **options
    )
    return solve_to_files(deck, settings), folder / "x.h5"


@pytest.mark.parametrize("guess", [0.3, -0.3])
def test_an_inverted_pendulum_with_a_spring_begins_buckled(tmp_path, guess):
    outcome, result = run(tmp_path, "INB", buckled(guess))
    assert outcome.exit_code == 0
    with h5py.File(result) as h5:
        angle = h5["coordinate/q"][:, 0] + guess
        assert angle == pytest.approx(np.full(5, math.copysign(1.63194426255, guess)), abs=1e-10)
        assert h5["element/effort"][:, 0] == pytest.approx(
            np.full(5, -math.copysign(4.89583278765, guess)), abs=1e-9
        )
        assert np.abs(h5["body/velocity"][:]).max() < 1e-10


def test_an_unstable_equilibrium_is_named(tmp_path):
    """Upright the eigenvalue is sqrt((m g l - k)/(I + m l²)), 1/0.428 s with the moment of inertia 0.1."""
    outcome, _ = run(tmp_path, "INB", buckled(0.0))
    time = math.sqrt((0.1 + 0.25) / (9.81 * 0.5 - 3))
    warned = [fault.message for fault in outcome.faults if fault.id == "SOLVE-112"]
    assert warned and f"grows by e in {time:.3g} s" in warned[0]


def test_a_motion_that_drivers_prescribe_is_refused(tmp_path):
    driven = "  FUNCTION turn polynomial 0 1\n  DRIVE motor at=1.angle value=turn\n"
    outcome, _ = run(tmp_path, "INB", buckled(0.3, "inverse", driven))
    assert outcome.exit_code == 2
    assert any(fault.id == "SOLVE-111" for fault in outcome.faults)


def test_two_links_of_a_tree_hang_down(tmp_path):
    outcome, result = run(tmp_path, "arm.DAT", f"{TWO_LINKS}END \nSTAR\nSTOP\n")
    assert outcome.exit_code == 0
    with h5py.File(result) as h5:
        q = h5["coordinate/q"][:]
        assert np.sin(q[:, 0]) == pytest.approx(np.full(len(q), -1), abs=1e-12)
        assert q[:, 1] == pytest.approx(np.zeros(len(q)), abs=1e-9)
        # Masses 1.5 and 0.8 at 0.4 m and 1.3 m below the hinge.
        assert h5["energy/potential"][0] == pytest.approx(-9.81 * (1.5 * 0.4 + 0.8 * 1.3), abs=1e-9)


@pytest.mark.long_motion
def test_a_flexible_body_hangs_in_its_deflected_shape(tmp_path):
    """It stays at rest, with the energy that its weight has stored in it."""
    text = (
        (DECKS / "vsdf" / "pendulum.vsdf").read_text().replace("       0.5    5.0E-4", "      0.01    5.0E-3")
    )
    (tmp_path / "fe").symlink_to(DECKS / "vsdf" / "fe")
    outcome, result = run(tmp_path, "pendulum.vsdf", text)
    assert outcome.exit_code == 0
    with h5py.File(result) as h5:
        assert h5["energy/strain"][0] > 0
        assert h5["energy/strain"][:] == pytest.approx(h5["energy/strain"][0], rel=1e-6)
        assert np.abs(h5["body/velocity"][:]).max() < 1e-6


@pytest.mark.parametrize("dialect", ["young", "dafms", "vsdf"])
def test_states_of_signals_are_refused(tmp_path, dialect):
    lines = "  SIGNAL angle sum {}.{}\n  SIGNAL all integral of=angle\n"
    if dialect == "young":
        name, text = "INB", buckled(0.3, more=lines.format(1, "angle"))
    elif dialect == "dafms":
        name, text = "arm.DAT", f"{TWO_LINKS}ELEMENTS\n{lines.format(1, 'r3')}END \nSTAR\nSTOP\n"
    else:
        block = f"ELEMENTS\n{lines.format(1, 'angle')}"
        name, text = "rotor.vsdf", f"{ROTOR_OF_VSDF}{block}\nTIME\n 1,0.1\nEND\nSTAR\nSTOP\n"
    outcome, _ = run(tmp_path, name, text)
    assert outcome.exit_code == 2
    [fault] = [fault for fault in outcome.faults if fault.severity == "error"]
    assert (fault.id, fault.subject) == ("SOLVE-150", "all")
    assert text.splitlines()[fault.place.line - 1].startswith("  SIGNAL all")
