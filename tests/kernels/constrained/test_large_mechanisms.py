"""Large mechanisms against the equations of motion as one dense matrix, written out with numpy.

    [ M  Jᵀ ] [ u̇ ]   [ f ]
    [ J  0  ] [ -λ ] = [ γ ]

of independent equations, and the shortest λ with Jᵀ λ = M u̇ - f.  M, f, J and γ are those of the bodies and
joints one by one, which `tests/kernels/constrained` compares with differences.
"""

import math
import sys
from pathlib import Path

import numpy as np
import pytest

sys.path.insert(0, str(Path(__file__).parents[3] / "scripts/bench"))
from four_bars import BAR, deck_of

from flexmb_cli.deck.text import read_text
from flexmb_cli.dialects.young.build_dynamics import build_young_dynamics
from flexmb_cli.dialects.young.dynamic_cards import read_young_deck
from flexmb_cli.kernels.constrained.accelerations import accelerations, factorise_order
from flexmb_cli.kernels.constrained.mass_matrix import mass_times
from flexmb_cli.kernels.constrained.multipliers import fill_multipliers
from flexmb_cli.kernels.constrained.system import FORCES, GAMMA
from flexmb_cli.solvers.constrained.system import dense_jacobian
from flexmb_cli.solvers.constrained.young_dynamics import ForwardDynamics


def branched_deck(count, step=3):
    """A deck of `count` pendulums: body k hangs on body k - 1, every third one on that three before it.

    Their pins point into three directions.
    """
    bodies, joints, masses = ["0 0 0 1 0 0 0"], [], []
    for k in range(count):
        bodies.append(f"{k + 1} 0 0 1 0 0 0")
        parent = 1 if k == 0 else k + 1 if k % step else max(1, k + 2 - step)
        axis = [(0, 0, 1), (0, 1, 0), (0.6, 0, 0.8)][k % 3]
        point = "{} {} {}".format(*axis)
        back = k + 1 - (0 if parent == 1 else parent - 1)
        tip = f"{back} 0 0 {back + axis[0]} {axis[1]} {axis[2]}"
        joints.append(f"{parent} {k + 2} {tip} 0 0 0 {point}")
        masses.append(f"MASS {k + 2} {BAR}")
    counts = f"{len(bodies)} 0 0 0 0 {len(joints)} 0 0 0 0 0 1"
    cards = ["DYNAMICS forward", "GRAVITY 0.3 -9.81 1", *masses]
    return "\n".join([counts, *bodies, *joints, "1 0 0 0 0 0 0", "0 1 1", *cards]) + "\nEND\n"


def analysis_of(deck, tmp_path):
    path = tmp_path / "IN.dat"
    path.write_text(deck)
    analysis = ForwardDynamics(build_young_dynamics(read_young_deck(read_text(str(path))))[0])
    analysis.start()
    return analysis


def state_aside(analysis):
    """A position near the start, brought onto the joints, with speeds that they allow."""
    n = analysis.arrays.coordinate_scale.size
    z = analysis.integration.z
    return z[:n].copy(), z[n : n + analysis.arrays.speeds].copy()


def dense_solution(analysis, ud):
    """u̇ and scaled λ by one matrix, where `accelerations` has left forces and right-hand side."""
    system, work = analysis.system, analysis.work
    scale, rows = analysis.arrays.speed_scale, analysis.arrays.row_scale
    M, column = np.empty((ud.size, ud.size)), np.empty(ud.size)
    for k, unit in enumerate(np.eye(ud.size)):
        mass_times(system, work, unit, column)
        M[k] = column
    J, forces = dense_jacobian(work), work.vectors[FORCES, : ud.size] * scale
    M = M * scale[:, None] * scale
    kept = np.sort(work.order[: work.rank[0]])
    assert kept.size == np.linalg.matrix_rank(J, 1e-9)
    matrix = np.block([[M, J[kept].T], [J[kept], np.zeros((kept.size, kept.size))]])
    x = np.linalg.solve(matrix, np.append(forces, (work.rows[GAMMA] / rows)[kept]))[: ud.size]
    return x * scale, np.linalg.lstsq(J.T, M @ x - forces, rcond=1e-10)[0]


DECKS = {"four-bars": lambda count: deck_of(count, "DOP853", 1e-8), "branched pendulums": branched_deck}


@pytest.mark.parametrize(
    ("kind", "count"),
    [("four-bars", 1), ("four-bars", 6), ("four-bars", 15), ("branched pendulums", 1),
     ("branched pendulums", 12), ("branched pendulums", 20),
     pytest.param("branched pendulums", 150, marks=pytest.mark.campaign)],
)  # fmt: skip
def test_accelerations_and_reactions_are_those_of_one_dense_matrix(kind, count, tmp_path):
    analysis = analysis_of(DECKS[kind](count), tmp_path)
    q, u = state_aside(analysis)
    ud, lam = np.empty(u.size), np.empty(analysis.arrays.row_scale.size)
    assert accelerations(analysis.system, analysis.work, q, u, 0.0, ud)[0] == 0
    wanted, forces = dense_solution(analysis, ud)
    np.testing.assert_allclose(ud, wanted, atol=1e-8 * np.abs(wanted).max())
    fill_multipliers(analysis.system, analysis.work, ud, lam)
    found = lam * analysis.arrays.row_scale
    np.testing.assert_allclose(found, forces, atol=1e-7 * max(1.0, np.abs(forces).max()))


@pytest.mark.parametrize("count", [11, 40, 150])
def test_all_cranks_of_a_long_chain_turn_like_its_pendulum(count, tmp_path):
    """(J₀ + …) θ̈ = -g (…) cos θ of equal bars: cranks of 1/3 kg m², couplers that only shift."""
    analysis, angle = analysis_of(deck_of(count, "DOP853", 1e-6), tmp_path), 1.2
    q, (u, ud) = analysis.arrays.q.copy().reshape(-1, 7), np.zeros((2, analysis.arrays.speeds))
    q[1::2, 3], q[1::2, 6] = math.cos(0.5 * angle), math.sin(0.5 * angle)
    q[2::2, 0], q[2::2, 1] = np.arange(count) + math.cos(angle), math.sin(angle)
    assert accelerations(analysis.system, analysis.work, q.ravel(), u, 0.0, ud)[0] == 0
    inertia, arm = (count + 1) / 3.0 + count, (count + 1) / 2.0 + count
    wanted = -9.81 * arm * math.cos(angle) / inertia
    np.testing.assert_allclose(ud.reshape(-1, 6)[1::2, 5], wanted, rtol=1e-9)
    np.testing.assert_allclose(ud.reshape(-1, 6)[2::2, 3:], 0.0, atol=1e-9)


def test_the_elimination_keeps_few_entries_where_nothing_is_zero(tmp_path):
    """Out of the plane, too: the order of the flat start left 55,000 entries at 100 four-bars."""
    analysis = analysis_of(deck_of(40, "DOP853", 1e-6), tmp_path)
    work, random = analysis.work, np.random.default_rng(1)
    work.jacobian[:] += 1e-3 * random.standard_normal(work.jacobian.shape)
    factorise_order(work)
    assert work.ends[: work.rank[0], 3].max() < 16 * work.rank[0]
