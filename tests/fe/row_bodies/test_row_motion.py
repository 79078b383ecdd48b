"""Motions of bodies with rotations: joints whose axes turn with nodes, torques, invariance, energy.

Expected: motions of a geometrically exact beam and of a second program for the same equations (README.md);
momentum and energy; a body seen from a moving frame; closed forms of statics.
"""

import numpy as np
import pytest

from flexmb_cli.interface import read_deck, solve, solve_to_files
from flexmb_cli.result import Result
from flexmb_cli.run.outcome import RunOptions
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
                    more=SPIN.format(velocity) + f"OUTN\n    1,{node},\nFORC\n    1,{node},0.0,2.0,3.0,\n",
                    modes=3,
                    time="0.05,0.01,0.0",
                )
            )
        )
        for velocity in ("0.0,0.0,0.0", "10.0,-20.0,20.0")
    )
    moved = place(fast, 1) - np.outer(fast["time"], [10.0, -20.0, 20.0])
    assert np.abs(moved - place(still, 1)).max() < 1e-9
    assert np.abs(still["energy.strain"]).max() > 1e-5
    energy = still["energy.total"]
    assert energy == pytest.approx(np.full(len(energy), energy[0]), rel=1e-8)


WELDED = """ARMN
    1,901,101,1.0,0.0,0.0
    1,902,101,0.0,1.0,0.0
    1,911,103,1.0,0.0,0.0
    1,912,103,0.0,1.0,0.0
    1,913,103,0.0,0.0,1.0
JOIN
    1,FIXD,0,0,0,1,101,901,0,902,
OUTN
    1,103,911,912,913
"""
EI_Z, EI_Y = 70e9 * 0.02 * 0.01**3 / 12, 70e9 * 0.01 * 0.02**3 / 12
GJ = 70e9 / 2.66 * 0.02 * 0.01**3 * (1 / 3 - 0.105 * (1 - 0.5**4 / 12))  # facts of the beam, README.md
M = 1e-3


def at_rest(folder, more, block=""):
    """Turn (3,) of the tip of the welded beam, and its deflection (3,), in equilibrium."""
    files = "TXT beam_nodes.txt", "ABQ beam_g_MASS1.mtx", "ABQ beam_g_STIF1.mtx"
    text = free_deck(FILES, *files, more=WELDED + more, time="0.0,1.0,0.0").replace("END\n", block + "END\n")
    (folder / "rest.vsdf").write_text(text)
    solve_to_files(folder / "rest.vsdf", RunOptions(folder=str(folder), from_equilibrium=True))
    _, places, axes = seen(Result.open(folder / "rest.h5"))
    turn = (axes[-1] - axes[-1].T) / 2.0
    return np.array([turn[2, 1], turn[0, 2], turn[1, 0]]), places[-1] - [1.0, 0.0, 0.0]


@pytest.mark.parametrize(
    ("torque", "turn", "deflection"),
    [
        ((M, 0, 0), (M / GJ, 0, 0), (0, 0, 0)),
        ((0, M, 0), (0, M / EI_Y, 0), (0, 0, -M / (2 * EI_Y))),
        ((0, 0, M), (0, 0, M / EI_Z), (0, M / (2 * EI_Z), 0)),
    ],
)
def test_a_torque_at_a_node_bends_and_twists_a_beam_as_in_the_books(tmp_path, torque, turn, deflection):
    """A cantilever under a moment at its end: θ = M L / EI, w = M L² / 2 EI; twist M L / GJ; L = 1 m."""
    found, moved = at_rest(tmp_path, f"TORQ\n    1,{','.join(map(str, torque))},0,,103\n")
    assert found == pytest.approx(turn, rel=1e-6, abs=2e-11)
    assert moved == pytest.approx(deflection, rel=1e-6, abs=5e-11)


def test_a_bushing_about_an_axis_turns_with_the_node(tmp_path):
    """Rotational springs in parallel: θ = M / (EI / L + kr), under a torque of a line TORQUE."""
    block = (
        f"ELEMENTS\n  FUNCTION unit polynomial {M}\n"
        "  TORQUE push to=1:103 direction=(0,0,1) effort=unit\n"
        "  BUSHING hold from=0(1,0,0) to=1:103 k=(0,0,0) kr=(0,0,50)\nEND ELEMENTS\n"
    )
    found, _ = at_rest(tmp_path, "", block)
    assert found == pytest.approx((0, 0, M / (EI_Z + 50.0)), rel=1e-6, abs=2e-11)
