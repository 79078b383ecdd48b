"""Which places of condensed matrices count."""

import numpy as np

from flexmb_cli.dialects.dafms.beam import Beam
from flexmb_cli.model.arrays.tree import NEGLIGIBLE, row_reach


def test_stiffness_of_a_beam_falls_by_the_ratio_of_cubic_splines_from_node_to_node():
    """Cubic splines (Ahlberg, Nilson and Walsh, 1967) forget by 2 - sqrt(3) a node: 30 nodes to 1e-17."""
    K = Beam(0.5, 200, 5.5, 0.0858).stiffness
    reach = row_reach([K, None, None])
    falls = np.log(NEGLIGIBLE) / np.log(2 - np.sqrt(3))
    assert abs((reach[100, 1] - 100) - falls) < 3
    assert np.array_equal(reach[100] - 100, [-(reach[100, 1] - 100 - 1), reach[100, 1] - 100])


def test_what_is_left_out_is_below_round_off():
    K = Beam(0.5, 120, 5.5, 0.0858).stiffness
    x = np.random.default_rng(1).normal(size=120)
    kept = [K[i, a:b] @ x[a:b] for i, (a, b) in enumerate(row_reach([K, None, None]))]
    assert np.max(np.abs(kept - K @ x) / (np.abs(K) @ np.abs(x))) < 1e-15


def test_every_place_of_a_full_matrix_counts_and_of_two_matrices_what_counts_in_either():
    full, narrow = np.full((4, 4), 2.0), np.eye(4)
    assert row_reach([full, None, None]).tolist() == [[0, 4]] * 4
    assert row_reach([narrow, None, None]).tolist() == [[i, i + 1] for i in range(4)]
    bent = narrow + np.eye(4, k=1) + np.eye(4, k=-1)
    assert row_reach([narrow, None, np.stack([narrow, bent])]).tolist() == [[0, 2], [0, 3], [1, 4], [2, 4]]
