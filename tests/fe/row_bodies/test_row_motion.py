"""Motions of bodies with rotations: joints whose axes turn with nodes, torques, invariance, energy.

Expected: motions of a geometrically exact beam and of a second program for the same equations (README.md);
momentum and energy; a body seen from a moving frame; closed forms of statics.
"""

import numpy as np
import pytest

from flexmb_cli.interface import read_deck, solve
from tests.fe.row_bodies.row_decks import DECKS, FILES, free_deck, motion, rotation

pytestmark = pytest.mark.long_motion
SPIN = "VELO\n    1,{},2.0,-3.0,12.0\n"


def place(result, point):
    """Places (k, 3) of a point of the output, by its number."""
    return np.column_stack([result[f"point.{point}.{x}"] for x in "xyz"])


def seen(result):
    """Times, places of a node and its axes (k, 3, 3): points 1, and 2 to 4 on arms of 1 m."""
    axes = [place(result, point) - place(result, 1) for point in (2, 3, 4)]
    return result["time"], place(result, 1), np.stack(axes, axis=2)


@pytest.mark.parametrize(
    ("deck", "equations", "beam"),
    [
        ("beam_on_crank", "beam_cb_ffrf_v2_mean", "beam_pendulum_truth"),
        ("frame_on_shaft", "frame_cb_ffrf_v2_mean", "frame_spinup_truth"),
    ],
)
def test_bodies_move_as_in_two_other_programs(deck, equations, beam):
    t, places, axes = seen(solve(DECKS / f"{deck}.vsdf"))
    for name, far, turn in ((equations, 3e-5, 2e-4), (beam, 3e-4, 1e-3)):
        times, x, vectors = motion(name)
        assert times == pytest.approx(t, abs=1e-12)
        assert np.linalg.norm(places - x, axis=1).max() < far, name
        between = np.einsum("tji,tjk->tik", rotation(vectors), axes)
        cosine = (np.trace(between, axis1=1, axis2=2) - 1.0) / 2.0
        assert np.arccos(np.clip(cosine, -1.0, 1.0)).max() < turn, name
    squares = np.einsum("tji,tjk->tik", axes, axes)
    assert squares == pytest.approx(np.broadcast_to(np.eye(3), axes.shape), abs=1e-9)


@pytest.mark.parametrize("name", ["beam_g", "beam_cb", "beam_n6", "frame_cb"])
def test_a_steady_velocity_changes_no_deformation(name):
    """Galilei: 30 m/s added to a free body that turns; energy is kept, and momentum of the centre."""
    files = f"BDF {name}.pch", f"DMIG {name}.pch", f"DMIG {name}.pch"
    node = 13 if name == "frame_cb" else 103
    still, fast = (
        solve(
            read_deck(
                free_deck(
                    FILES,
                    *files,
                    more=SPIN.format(velocity) + f"OUTN\n    1,{node},\n",
                    modes=3,
                    time="0.05,0.01,0.0",
                )
            )
        )
        for velocity in ("0.0,0.0,0.0", "10.0,-20.0,20.0")
    )
    moved = place(fast, 1) - np.outer(fast["time"], [10.0, -20.0, 20.0])
    assert np.abs(moved - place(still, 1)).max() < 1e-9
    amplitudes = [name for name in still if name.startswith("modal.")]
    assert max(np.abs(still[name]).max() for name in amplitudes) > 1e-7
    energy = still["energy.total"]
    assert energy == pytest.approx(np.full(len(energy), energy[0]), rel=1e-9)
