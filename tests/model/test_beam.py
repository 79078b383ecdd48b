"""The beam after `flexmb beam`: Euler–Bernoulli theory, and the blocks of the supplied decks."""

import math
from pathlib import Path

import numpy as np
import pytest

from flexmb_cli.deck.fortran_fields import integer_list, real_list
from flexmb_cli.deck.record import DeckText
from flexmb_cli.dialects.dafms.beam import Beam
from flexmb_cli.dialects.dafms.beam_cards import beam_block, beam_deck, with_beam
from flexmb_cli.dialects.dafms.build import build_dafms
from flexmb_cli.dialects.dafms.reader import read_dafms
from flexmb_cli.errors import DeckError

DECKS = Path(__file__).parents[2] / "decks" / "dafms"

# Data of the thesis (Zhao, 1992), 4.3 and 4.4; the others are those of the decks' headings.
SUPPLIED = [
    ("shaft_beam_n2", Beam(0.5, 2, 5.5, 0.0858, offset=0.05), 2),
    ("shaft_beam_n5", Beam(0.5, 5, 5.5, 0.0858, offset=0.05), 2),
    ("shaft_beam_n10", Beam(0.5, 10, 5.5, 0.0858, offset=0.05), 2),
    ("two_link_n2", Beam(1.0, 2, 1000.0, 5.0), 2),
    ("two_link_n4", Beam(1.0, 4, 1000.0, 5.0), 2),
    ("fourbar_flex", Beam(0.6, 4, 20.0, 0.5), 2),
    ("slider_crank_flex", Beam(0.5, 2, 30.0, 0.6, tip_mass=0.4), 2),
    ("spatial_flex", Beam(0.8, 2, 90.0, 1.5, EA=4000.0, EI_1=40.0), 3),
]


def text(name):
    return (DECKS / f"{name}.DAT").read_text()


def read(content):
    return read_dafms(DeckText("x.DAT", content, ""))


@pytest.mark.parametrize(("name", "beam", "dimension"), SUPPLIED, ids=[case[0] for case in SUPPLIED])
def test_blocks_of_the_supplied_decks_are_written_to_the_last_column(name, beam, dimension):
    assert beam_block(beam, dimension) in text(name)


def test_inertia_is_that_of_the_nodes_and_the_root_half_element():
    """two_link: 1.875 + rho h^3/24 = 1.90104167; fourbar_flex: 0.037195313 (INER of the decks)."""
    assert Beam(1.0, 2, 1000.0, 5.0).inertia == pytest.approx(1.90104167, abs=5e-9)
    assert Beam(0.6, 4, 20.0, 0.5).inertia == pytest.approx(0.037195313, abs=5e-10)
    assert Beam(0.5, 2, 30.0, 0.6, tip_mass=0.4).inertia == pytest.approx(0.128515625, abs=5e-10)


@pytest.mark.parametrize("nodes", [1, 2, 7, 40])
def test_deflections_under_a_tip_force_are_exact(nodes):
    """Cantilever: w(x) = P x^2 (3 L - x) / (6 EI)."""
    beam = Beam(2.0, nodes, 3.0, 1.0)
    force = np.zeros(nodes)
    force[-1] = 0.7
    x = beam.positions
    exact = 0.7 * x**2 * (3 * 2.0 - x) / (6 * 3.0)
    assert np.linalg.solve(beam.stiffness, force) == pytest.approx(exact, rel=1e-9)


def test_slopes_under_a_tip_force_are_exact():
    """Cantilever: w'(x) = P x (2 L - x) / (2 EI); along axis 3 it turns about +1, along axis 1 about -3."""
    beam = Beam(2.0, 5, 3.0, 1.0, EA=10.0, EI_1=4.0)
    force = np.zeros(15)
    force[-1], force[-3] = 0.7, 0.4
    displacement = np.linalg.solve(beam.stiffness, force)
    for node, x in enumerate(beam.positions, 1):
        slopes = x * (2 * 2.0 - x) / 2 * np.array([0.7 / 3.0, 0.0, -0.4 / 4.0])
        assert beam.nodal_rotation(node) @ displacement == pytest.approx(slopes, rel=1e-10)


def test_axial_displacement_is_exact():
    """Bar under a tip force: u(x) = P x / EA."""
    beam = Beam(2.0, 4, 3.0, 1.0, EA=10.0)
    force = np.zeros(8)
    force[6] = 5.0
    assert np.linalg.solve(beam.stiffness, force)[0::2] == pytest.approx(
        5.0 * beam.positions / 10.0, rel=1e-12
    )


def test_frequencies_approach_those_of_the_cantilever():
    """w1 = 1.8751^2 sqrt(EI / rho L^4); lumped masses converge with h^2."""
    exact = 1.875104068711961**2 * math.sqrt(5.5 / (0.0858 * 0.5**4))
    errors = []
    for nodes in (10, 20):
        beam = Beam(0.5, nodes, 5.5, 0.0858)
        scale = 1 / np.sqrt(beam.masses)
        lowest = np.linalg.eigvalsh(scale[:, None] * beam.stiffness * scale)[0]
        errors.append(abs(math.sqrt(lowest) / exact - 1))
    assert errors[0] < 1e-2
    assert errors[0] / errors[1] == pytest.approx(4.0, rel=0.1)


def test_ten_nodes_give_the_recomputed_frequency_after_a_way_through_the_columns():
    """Clamped-root w1 of shaft + beam with 10 nodes is 112.0883 rad/s, deck columns filled."""
    tree = build_dafms(read(text("shaft_beam_n10")))[0]
    elastic = tree.bodies[0].elastic
    scale = 1 / np.sqrt(elastic.masses)
    lowest = np.linalg.eigvalsh(scale[:, None] * elastic.stiffness * scale)[0]
    assert math.sqrt(lowest) == pytest.approx(112.0883, abs=5e-5)


@pytest.mark.parametrize("beam", [Beam(1.0, 3, 10.0, 2.0), Beam(1.0, 3, 10.0, 2.0, EA=1e4, EI_1=20.0)])
def test_a_beam_deck_can_be_run_as_it_is(beam):
    deck = read(beam_deck(beam, "CANTILEVER"))
    tree, warnings = build_dafms(deck)
    assert not deck.warnings
    assert not warnings
    assert tree.bodies[0].elastic.stiffness == pytest.approx(beam.stiffness, rel=1e-9, abs=1e-9)
    assert len(tree.q) == 1 + 3 * len(beam.axes)


def test_a_finer_beam_takes_the_place_of_a_body_and_keeps_the_rest():
    beam = Beam(1.0, 4, 1000.0, 5.0)
    deck = read(text("two_link_n2"))
    finer = with_beam(read(with_beam(deck, 1, beam)), 2, beam)
    wanted = read(text("two_link_n4"))
    built = read(finer)
    for section in ("counts", "node.1", "node.2", "bkp", "bmi", "speed", "coordinate", "first_coordinate"):
        old = [[n.value for n in record.numbers] for record in wanted.section(section)]
        assert [[n.value for n in record.numbers] for record in built.section(section)] == old, section


def test_a_rigid_body_becomes_flexible():
    deck = read(text("fourbar_rigid"))
    built = read(with_beam(deck, 2, Beam(0.6, 4, 20.0, 0.5)))
    wanted = read(text("fourbar_flex"))
    for section in ("counts", "node.2", "bkp", "bmi", "speed", "coordinate"):
        old = [[n.value for n in record.numbers] for record in wanted.section(section)]
        assert [[n.value for n in record.numbers] for record in built.section(section)] == old, section


def rotation_card(beam, body, node):
    """Card NROT: the elastic rotation of one node of the beam, for a hinge that sits there."""
    rows = "".join(real_list(row, 13, 6) for row in beam.nodal_rotation(node))
    return f"NROT\n{integer_list([1])}{integer_list([body, node])}{rows}"


def test_the_rotation_card_is_read_back():
    beam = Beam(1.0, 2, 1000.0, 5.0)
    content = text("two_link_n2").replace("END \n", rotation_card(beam, 1, 2) + "END \n")
    rotation = build_dafms(read(content))[0].hinges[1].elastic_rotation
    assert rotation == pytest.approx(beam.nodal_rotation(2), rel=1e-10)


@pytest.mark.parametrize(
    ("data", "message"),
    [
        ({"length": 0.0}, "beam: length must be above zero, read 0"),
        ({"EI": -1.0}, "beam: EI must be above zero, read -1"),
        ({"nodes": 0}, "beam: nodes must be above zero, read 0"),
        ({"rho": math.nan}, "beam: rho must be above zero, read nan"),
        ({"EA": 0.0}, "beam: EA must be above zero, read 0"),
        ({"EI_1": 1.0}, "beam: deflection along axis 1 needs EA: nodes have axes 3, 2-3 or 1-3"),
        ({"tip_mass": -1.0}, "beam: offset and tip mass must be finite, the mass not negative"),
    ],
)
def test_what_is_no_beam_is_refused(data, message):
    with pytest.raises(DeckError) as stopped:
        Beam(**{"length": 1.0, "nodes": 2, "EI": 1.0, "rho": 1.0, **data})
    assert [fault.sentence for fault in stopped.value.faults] == [message]


def test_a_beam_whose_skyline_does_not_fit_is_refused():
    with pytest.raises(DeckError, match="450 elastic coordinates: skyline addresses end at 99999"):
        beam_block(Beam(1.0, 450, 1.0, 1.0))


def test_a_beam_needs_a_body_and_room_for_its_axes():
    deck = read(text("two_link_n2"))
    with pytest.raises(DeckError, match="body 3: the deck has bodies 1 to 2"):
        with_beam(deck, 3, Beam(1.0, 2, 1.0, 1.0))
    with pytest.raises(DeckError, match="needs a deck with NDM = 3"):
        with_beam(deck, 1, Beam(1.0, 2, 1.0, 1.0, EA=1.0, EI_1=1.0))
