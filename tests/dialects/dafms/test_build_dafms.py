"""FMBD.DAT to Tree: what the cards mean (DAFMS thesis, Zhao 1992, chapter 2 and appendix C)."""

import math
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from flexmb_cli.deck.record import DeckText
from flexmb_cli.dialects.dafms.build import build_dafms
from flexmb_cli.dialects.dafms.reader import read_dafms
from flexmb_cli.errors import ModelError
from flexmb_cli.model.tree import INERTIAL, ROTATION, TRANSLATION

DECKS = Path(__file__).parents[3] / "decks" / "dafms"


def read(name, *cards):
    """A supplied deck with extension cards put in front of END."""
    text = (DECKS / f"{name}.DAT").read_text()
    return read_dafms(DeckText(name, text.replace("END \n", "".join(cards) + "END \n"), ""))


def tree(name, *cards):
    return build_dafms(read(name, *cards))[0]


def test_two_link_manipulator():
    """Thesis 4.4 with two nodes a link; figures typed in two_link_n2.DAT."""
    built = tree("two_link_n2")
    assert [hinge.parent for hinge in built.hinges] == [INERTIAL, 0]
    assert [hinge.node for hinge in built.hinges] == [None, 1]
    assert [hinge.rotations for hinge in built.hinges] == [(1,), (1,)]
    body = built.bodies[0]
    assert body.mass == 5.0
    assert body.inertia.tolist() == np.diag([1.90104167, 0.0, 1.90104167]).tolist()
    assert body.elastic.axes == (3,)
    assert body.elastic.positions.tolist() == [[0.0, 0.5, 0.0], [0.0, 1.0, 0.0]]
    assert body.elastic.masses.tolist() == [2.5, 1.25]
    assert body.elastic.stiffness.tolist() == [[109714.285714, -34285.714286], [-34285.714286, 13714.2857143]]
    assert built.q.tolist() == [0.0, 0.087266463, 0.0, 0.0, 0.0, 0.0]
    assert built.y.tolist() == [0.0] * 6
    assert built.gravity == (0.0, 9.8, 0.0)
    assert not built.one_way


def test_coordinates_are_rotations_then_translations_then_nodes():
    """Eq. (2.22)."""
    names = [c.name for c in tree("spatial_flex").coordinates]
    assert names[:5] == [
        "body 1 rotation 1",
        "body 1 rotation 2",
        "body 1 rotation 3",
        "body 2 rotation 1",
        "body 1 node 1 axis 1",
    ]
    assert names[-1] == "body 1 node 2 axis 3"
    assert [c.motion for c in tree("sliding_mass").coordinates] == [ROTATION, TRANSLATION]


def test_steps_and_their_length_make_the_report_times():
    """IT = 6000, H = 0.01 in pendulum.DAT: 6001 rows to 60 s."""
    time = tree("pendulum").time
    assert (time.rows, time.end, time.step) == (6001, 60.0, 0.01)


def test_the_scalar_of_euler_parameters_moves_to_the_front():
    hinges = tree("spatial_rigid").hinges
    assert hinges[0].attitude == pytest.approx((0.64, 0.48, 0.0, 0.6), abs=1e-15)
    assert hinges[1].frame == pytest.approx((0.8, 0.0, 0.6, 0.0), abs=1e-15)


def test_the_pulse_of_desn_follows_its_height_and_length():
    """Section 4.3 of the thesis: 1 N m up to 0.05 s, then nothing, then -1 N m up to 0.15 s."""
    (torque,) = tree("shaft_beam_n2").torques
    assert (torque.body, torque.axis) == (0, 1)
    assert [line[0] for line in torque.function.pieces[1:]] == pytest.approx([0, 0.05, 0.1, 0.15])
    assert [torque.function.at(t)[0] for t in (0.0, 0.049, 0.051, 0.099, 0.101, 0.149, 0.151)] == [
        *(1, 1, 0, 0, -1, -1, 0)
    ]


def test_gravity_one_way_and_closure_cards():
    assert tree("pendulum").gravity == (0.0, 0.0, 9.8)
    assert tree("two_link_n2_unco").one_way
    (closure,) = tree("fourbar_rigid").closures
    assert (closure.name, closure.a, closure.b, closure.directions) == ("closure 1", 2, INERTIAL, (2, 3))
    assert (closure.a_point, closure.b_point) == ((0.0, 0.5, 0.0), (0.0, 0.0, 0.6))
    (closure,) = tree("slider_crank_flex").closures
    assert (closure.a, closure.a_node, closure.directions) == (1, 1, (2,))


def test_products_of_inertia_fill_both_triangles():
    card = "PROD\n    1       .01       .02       .03\n    2       0.0       0.0       0.0\n"
    inertia = tree("spatial_rigid", card).bodies[0].inertia
    assert inertia.tolist() == [[0.25, 0.01, 0.02], [0.01, 0.05, 0.03], [0.02, 0.03, 0.22]]


def test_springs_dampers_and_motors_sit_on_their_freedom():
    built = tree(
        "sliding_mass",
        "SPRI\n    1\n    2    5     100.0        .1\n",
        "DAMP\n    1\n    1    1        .2\n",
        "MOTR\n    1\n    2    5       3.0\n",
        "TABM\n    1\n    1    1    2\n       0.0       1.0\n       2.0       4.0\n",
    )
    spring, damper, constant, table = built.elements.forces
    assert (spring.measure, *spring.values[:2]) == ((1, "translation 2"), 100, 0.1)
    assert (damper.measure, damper["damping"]) == ((0, "rotation 1"), 0.2)
    assert (constant.measure, constant["function"].at(7.0)[0]) == ((1, "translation 2"), 3.0)
    assert table.measure.joint == 0
    assert [table["function"].at(t)[0] for t in (-1.0, 1.0, 3.0)] == [1.0, 2.5, 4.0]


def test_a_tabulated_torque_is_external():
    built = tree("sliding_mass", "TABL\n    1\n    2    1    2\n       0.0       1.0\n       1.0       2.0\n")
    (torque,) = built.torques
    assert (torque.body, torque.axis) == (1, 1)
    assert [torque.function.at(t)[0] for t in (-1.0, 0.0, 0.25, 1.0, 3.0)] == [1.0, 1.0, 1.25, 2.0, 2.0]


def test_a_prescribed_coordinate_starts_where_its_law_says():
    built = tree("sliding_mass", "PRES\n    1\n    2    5        .2      -1.0        .5\n")
    (drive,) = built.prescribed
    assert (drive.body, drive.motion, drive.axis, drive.C, drive.B, drive.A) == (
        1,
        TRANSLATION,
        2,
        0.2,
        -1,
        0.5,
    )
    assert built.q.tolist() == [1.0, 0.2]
    assert built.y.tolist() == [2.0, -1.0]


def test_elastic_damping_is_proportional_to_mass_and_stiffness():
    elastic = tree("shaft_beam_n2", "ELDA\n    1        .5      .001\n").bodies[0].elastic
    assert elastic.damping == pytest.approx(0.5 * np.diag([0.02145, 0.010725]) + 0.001 * elastic.stiffness)


def test_beams_are_stiffened_from_their_clamped_end_on_request():
    assert tree("shaft_beam_n2", "GSTF\n    1    1       .05\n").bodies[0].elastic.stiffened_from == 0.05
    assert tree("two_link_n2", "GSTF\n    1    1\n    2    0\n").bodies[0].elastic.stiffened_from == 0.0
    assert tree("two_link_n2", "GSTF\n    1    1\n    2    0\n").bodies[1].elastic.stiffened_from is None


def test_nodal_rotations_go_to_the_hinge_on_that_node():
    rows = "          1.0          2.0\n          0.0          0.0\n          0.0          3.0\n"
    built = tree("two_link_n2", f"NROT\n    1\n    1    2\n{rows}")
    assert built.hinges[0].elastic_rotation is None
    assert built.hinges[1].elastic_rotation.tolist() == [[1.0, 2.0], [0.0, 0.0], [0.0, 3.0]]


def test_tolerance_and_integrator_are_taken_blank_ones_keep_their_default():
    integration = tree("pendulum", "TOLR\n       1.E-11\n", "METH\n    3\n").integration
    assert (integration.method, integration.rtol) == ("lsoda", 1e-11)
    # FORMAT.md: 1e-9 is the default of all methods but DOP853.
    assert integration.atol == 1e-9 and tree("pendulum").integration.atol == 1e-14


def test_a_skyline_stores_no_zeros_above_its_columns():
    """Columns of 1, 2, 1 entries: a 3 by 3 matrix whose last column holds the diagonal alone."""
    text = (DECKS / "shaft_beam_n2.DAT").read_text()
    text = text.replace("    2\n    1\n  500", "    3\n    1\n  500")
    text = text.replace(
        "    2       .55       0.0\n", "    2       .55       0.0\n    3       .60       0.0\n"
    )
    text = text.replace(
        "    2       0.0       0.0\n    2\n", "    2       0.0       0.0\n    3       0.0       0.0\n    3\n"
    )
    text = text.replace("    1    2\n    1    3\n", "    1    2    3\n    1    3    4\n")
    text = text.replace("603.428571429\n", "603.428571429         50.0\n")
    text = text.replace("    .02145   .010725\n", "    .02145   .010725     .0001\n")
    text = text.replace(
        "       0.0       0.0       0.0\nY(L)", "       0.0       0.0       0.0       0.0\nY(L)"
    )
    text = text.replace("       0.0\nRC(K", "       0.0       0.0       0.0\nRC(K")
    elastic = build_dafms(read_dafms(DeckText("x.DAT", text, "")))[0].bodies[0].elastic
    assert elastic.stiffness.tolist() == [
        [4827.42857143, -1508.5714286, 0.0],
        [-1508.5714286, 603.428571429, 0.0],
        [0.0, 0.0, 50.0],
    ]


@pytest.mark.parametrize(("inertia", "runs"), [(1.876, True), (1.875, False), (1.874, False)])
def test_a_flexible_body_needs_more_inertia_than_its_nodes_have(inertia, runs):
    """Two-link arm: sum m x^2 = 2.5 * 0.25 + 1.25 = 1.875 kg m^2 about the root."""
    deck = read("two_link_n2").with_values({f"inertia.{k}.BII1": inertia for k in (1, 2)})
    if runs:
        assert build_dafms(deck)[0].bodies[0].inertia[0, 0] == inertia
        return
    with pytest.raises(ModelError) as stopped:
        build_dafms(deck)
    assert [fault.subject for fault in stopped.value.faults] == ["body 1", "body 2"]


def test_the_one_way_assumption_accepts_the_inertia_of_the_continuous_beam():
    """rho L^3/3 = 1.6667 is less than 1.875, which the zeroed block of section 4.3 never sees."""
    assert tree("two_link_n2_unco").bodies[0].inertia[0, 0] == 1.66666667


def test_nodes_that_cannot_follow_the_rotation_count_as_rigid():
    """pendulum_strict: the node at axis 3 moves along axis 3 only, so INER = m x^2 = 0.018 suffices."""
    assert tree("pendulum_strict").bodies[0].inertia[0, 0] == 0.018


def test_changed_structure_numbers_end_in_faults_not_in_crashes():
    rows = 3 * "          0.0          0.0\n"
    deck = read("two_link_n2", f"NROT\n    1\n    1    2\n{rows}")
    with pytest.raises(ModelError, match="not the body whose rotations are given"):
        build_dafms(deck.with_values({"nodal_rotation.1.K": 7}))


def test_numbers_beyond_all_measure_are_refused():
    deck = read("pendulum")
    records = tuple(
        replace(r, numbers=tuple(replace(n, value=math.inf) for n in r.numbers))
        if r.section == "speed"
        else r
        for r in deck.records
    )
    with pytest.raises(ModelError, match="too large"):
        build_dafms(replace(deck, records=records))


def test_moments_about_axes_that_never_turn_may_be_left_out():
    """A base that turns about axis 1 only needs no moment about axis 3, however far its mass centre."""
    deck = read("spatial_rigid").with_values(
        {
            **{f"counts.1.{key}": value for key, value in (("NR", 1), ("NR2", 0), ("NR3", 0))},
            **{f"attitude.1.e{i}": float(i == 4) for i in (1, 2, 3, 4)},
            **{f"inertia.1.BII{i}": value for i, value in ((1, 0.25), (2, 0.0), (3, 0.0))},
        }
    )
    lists = ("speed", "coordinate", "first_coordinate")
    deck = replace(deck, records=tuple(r for r in deck.records if r.section not in lists))
    assert build_dafms(deck)[0].bodies[0].inertia[2, 2] == 0.0


def test_moments_about_axes_that_turn_must_hold_the_mass_centre():
    """spatial_rigid, body 1: m rc^2 = 2 * 0.3^2 = 0.18 about axes 1 and 3."""
    with pytest.raises(ModelError, match=r"INER about axis 3 is 0.17 kg m\^2, less than m rc\^2 = 0.18"):
        build_dafms(read("spatial_rigid").with_values({"inertia.1.BII3": 0.17}))


def test_an_initial_angle_set_from_outside_is_no_slip_of_the_deck():
    """X(L) and EULT echo the angle of Y(L); `--set` leaves a number without a place."""
    deck = read("two_link_n2")
    records = tuple(
        replace(r, numbers=tuple(replace(n, value=0.1, place=None) for n in r.numbers))
        if r.prefix == "coordinate.2"
        else r
        for r in deck.records
    )
    built, warnings = build_dafms(replace(deck, records=records))
    assert built.q[1] == 0.1
    assert warnings == []
