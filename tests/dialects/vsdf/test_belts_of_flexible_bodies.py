"""A belt between two flexible bodies: eigenvalues of their finite-element matrices, from these alone.

Both bodies are trusses in all their modes, which turn about the line through two of their clamped nodes.  A
belt leaves their turns φ and ρ φ.  Small motions are u = φ e × r + u_free of the first and ρ φ e × r + u_free
of the second; with T their columns, the frequencies solve (Tᵀ K T - ω² Tᵀ M T) q = 0.
"""

import numpy as np
import pytest
from scipy.linalg import block_diag, eigh

from flexmb_cli.dialects.vsdf.build import build_vsdf
from flexmb_cli.fe.build_mechanism import flexible_mechanism
from flexmb_cli.run.mechanism_modes import Wish, flexible_modes
from flexmb_cli.run.outcome import Listener, Outcome, Run, RunOptions
from tests.dialects.vsdf.vsdf_decks import read
from tests.fe.trusses import truss, write_matrix

pytestmark = pytest.mark.long_motion
BODIES = [truss(seed, 6) for seed in (5, 8)]
FREE = slice(9, None)  # freedoms of nodes 14, 15, 16; 11, 12, 13 are clamped
SPRING = 12.0  # N m/rad, at the first joint


def words(values) -> str:
    return ",".join(f"{value:.17g}" for value in values)


def deck(folder, radii) -> str:
    """Two trusses on axles of the ground, with a belt over pulleys of two radii."""
    nodes = []
    for body, (r, _, M, K) in enumerate(BODIES, 1):
        write_matrix(folder / f"M{body}.mtx", M)
        write_matrix(folder / f"K{body}.mtx", K)
        table = [f"{11 + k} {words(place).replace(',', ' ')}" for k, place in enumerate(r)]
        (folder / f"nodes{body}.txt").write_text("\n".join(table) + "\n")
        nodes += [f" 0,{2 * body - 1 + k},{words(r[k])}" for k in (0, 1)]
    files = "".join(
        f"{word}\n 1,{kind},{name}1.{end}\n 2,{kind},{name}2.{end}\n"
        for word, kind, name, end in (
            ("FEMN", "TXT", "nodes", "txt"), ("FEMM", "MM", "M", "mtx"), ("FEMK", "MM", "K", "mtx"),
        )
    )  # fmt: skip
    return (
        f"VSDF BELT\nBODY\n 1,FLEX,0,11,12,13\n 2,FLEX,0,11,12,13\n{files}"
        "CLMP\n 1,11,12,13\n 2,11,12,13\nNODE\n" + "\n".join(nodes) + "\n"
        "JOIN\n"
        " 1,REVO,0,1,2,1,11,12\n"
        " 2,REVO,0,3,4,2,11,12\n"
        "ELEMENTS\n"
        f"  SPRING tspr-1 at=1.angle stiffness={SPRING}\n"
        f"ELEMENTS\n  COUPLING coup-1 1.angle={radii[0]} 2.angle={-radii[1]}\nTIME\n 1,0.1\nEND\nSTAR\nSTOP\n"
    )


def turn(r):
    """Displacements (18,) of the nodes by a unit turn about the line from the first to the second."""
    axis = (r[1] - r[0]) / np.linalg.norm(r[1] - r[0])
    return np.cross(axis, r - r[0]).ravel()


def frequencies(ratio):
    """Angular frequencies, rad/s, of the two trusses, the second turned `ratio` times as far."""
    T = np.zeros((36, 19))
    T[:18, 0], T[18:, 0] = turn(BODIES[0][0]), ratio * turn(BODIES[1][0])
    T[:18, 1:10][FREE], T[18:, 10:][FREE] = np.eye(9), np.eye(9)
    M, K = (block_diag(BODIES[0][k], BODIES[1][k]) for k in (2, 3))
    stiffness = T.T @ K @ T
    stiffness[0, 0] += SPRING
    return np.sqrt(eigh(stiffness, T.T @ M @ T, eigvals_only=True))


@pytest.mark.parametrize(
    "radii", [pytest.param((0.3, 0.1), marks=pytest.mark.campaign), (0.2, -0.5)], ids=["belt", "crossed belt"]
)
def test_a_belt_between_two_flexible_bodies_has_the_frequencies_of_their_matrices(tmp_path, radii):
    model = flexible_mechanism(build_vsdf(read(deck(tmp_path, radii)), tmp_path)[0], cached=False)[0]
    found = flexible_modes(model, Wish(), Run(Outcome("x"), RunOptions(), Listener())).modes.eigenvalues
    wanted = frequencies(radii[0] / radii[1])
    assert np.sort(found.imag[found.imag > 1e-3]) == pytest.approx(wanted, rel=1e-6)
    assert found.real == pytest.approx(0, abs=1e-4)
    # The belt is felt: other radii, other frequencies.
    assert np.max(np.abs(frequencies(1.0) / wanted - 1)) > 0.01
