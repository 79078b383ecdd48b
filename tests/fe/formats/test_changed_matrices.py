"""Cards NODM and SCAL: frequencies against scipy's of K s and M + added masses; faults at their places."""

import math
import re

import numpy as np
import pytest
from scipy.io import mmread
from scipy.linalg import eigh

from flexmb_cli.dialects.vsdf.build import build_model
from flexmb_cli.errors import ModelError
from flexmb_cli.fe.flexible_bodies import key_of
from tests.dialects.vsdf.vsdf_decks import DECKS, read, supplied
from tests.fe.formats.test_modal_body import body_of as modal_body_of
from tests.fe.formats.test_modal_body import text as modal_text
from tests.fe.row_bodies.row_decks import FILES as REDUCED
from tests.fe.row_bodies.row_decks import body_of, free_deck
from tests.fe.supplied import FILES, pendulum

HELD = [0, 1, 2, 3 * 12 + 1, 3 * 12 + 2, 3 * 8 + 2]  # of the frame by nodes 1, 13 and 9
ADDED, FACTOR = {54: 0.05, 20: 0.02}, 1.7
CARDS = "".join(f"NODM\n    1,{node},{mass}\n" for node, mass in ADDED.items()) + f"SCAL\n    1,{FACTOR}\n"


def with_cards(name, cards):
    """A supplied deck with cards in front of its first mass matrix."""
    return supplied(name, ("FEMM\n", f"{cards}FEMM\n"))


def frequencies(M, K):
    M, K = (np.delete(np.delete(matrix, HELD, 0), HELD, 1) for matrix in (M, K))
    return np.sqrt(eigh(K, M, eigvals_only=True)[:9]) / math.tau


def test_added_masses_and_a_factor_give_the_frequencies_of_the_changed_matrices():
    M, K = (mmread(FILES / f"pendulum_{letter}.mtx").toarray() for letter in "MK")
    for node, mass in ADDED.items():
        rows = np.arange(3 * node - 3, 3 * node)
        M[rows, rows] += mass
    found, warnings = body_of(with_cards("pendulum", CARDS), DECKS)
    assert warnings == []
    np.testing.assert_allclose(found.frequencies, frequencies(M, FACTOR * K), rtol=1e-8)
    plain, _ = body_of(supplied("pendulum"), DECKS)
    assert found.m == pytest.approx(plain.m + sum(ADDED.values()), rel=1e-12)
    # The static moment about the origin of the node table, of the masses at their nodes.
    places = {node: plain.origin + plain.axes @ plain.position(node) for node in ADDED}
    moments = [body.m * body.origin + body.axes @ body.s0 for body in (found, plain)]
    expected = sum(mass * places[node] for node, mass in ADDED.items())
    assert moments[0] - moments[1] == pytest.approx(expected, abs=1e-12)


def test_a_mass_on_a_carried_node_is_that_of_its_interface_node():
    """The rod of decks/vsdf/hinge_moment, whose hinge carries nodes."""
    text = supplied("hinge_moment")
    carried = int(re.search(r"RBE2\n +\d+,\d+,(\d+)", text)[1])
    found, _ = body_of(with_cards("hinge_moment", f"NODM\n    1,{carried},0.25\n"), DECKS)
    plain, _ = body_of(text, DECKS)
    assert found.m - plain.m == pytest.approx(0.25, rel=1e-9)


@pytest.mark.parametrize(("name", "number"), [("shell_panel", 1), ("slider_crank_stress", 2)])
def test_a_factor_of_the_stiffness_scales_stresses_and_the_squares_of_frequencies(name, number):
    """Shapes of unit modal mass stay; shells have matrices of elements and no stresses."""
    text = supplied(name)
    scaled, _ = body_of(text.replace("MATL\n", f"SCAL\n    {number},4.0\nMATL\n", 1), DECKS)
    plain, _ = body_of(text, DECKS)
    np.testing.assert_allclose(scaled.frequencies, 2 * plain.frequencies, rtol=1e-8)
    if plain.stress:
        expected = 4 * np.abs(plain.stress.nodal)
        np.testing.assert_allclose(np.abs(scaled.stress.nodal), expected, atol=1e-6 * expected.max())


def test_bodies_with_other_numbers_are_other_files_of_the_cache():
    keys = {
        key_of(pendulum(**changed))
        for changed in ({}, {"nodal_masses": ((54, 0.05),)}, {"stiffness_factor": 1.7})
    }
    assert len(keys) == 3


@pytest.mark.parametrize(
    ("name", "cards", "id", "line"),
    [
        ("pendulum", "NODM\n    1,999,0.1\n", "VSDF-255", "1,999"),
        ("pendulum", "NODM\n    1,54,-0.1\n", "VSDF-256", "1,54"),
        ("pendulum", "SCAL\n    1,0.0\n", "VSDF-258", "1,0.0"),
        ("spinup", "NODM\n    1,54,0.1\n", "VSDF-257", "1    4 MM"),
    ],
)
def test_what_cannot_be_meant_is_refused_at_its_card(name, cards, id, line):
    text = with_cards(name, cards)
    with pytest.raises(ModelError) as refused:
        build_model(read(text), DECKS)
    found = {fault.id: fault.place for fault in refused.value.faults if fault.severity == "error"}
    assert text.splitlines()[found[id].line - 1].strip().startswith(line)


def test_a_node_without_rows_bears_no_mass(tmp_path):
    (tmp_path / "four.txt").write_text((REDUCED / "beam_nodes.txt").read_text() + "104 2 0 0\n")
    files = f"TXT {tmp_path}/four.txt", "ABQ beam_g_MASS1.mtx", "ABQ beam_g_STIF1.mtx"
    text = free_deck(REDUCED, *files, more="NODM\n    1,104,1.0\n").replace(
        f"{REDUCED}/{tmp_path}", str(tmp_path)
    )
    with pytest.raises(ModelError, match="node 104 has no three displacements"):
        body_of(text, DECKS)


def test_the_modes_of_a_file_take_a_factor_and_no_masses(tmp_path):
    plain, _ = modal_body_of(tmp_path, modal_text())
    scaled, _ = modal_body_of(tmp_path, modal_text(), stiffness_factor=4.0)
    np.testing.assert_allclose(scaled.frequencies, 2 * plain.frequencies, rtol=1e-12)
    with pytest.raises(ModelError, match="no added masses"):
        modal_body_of(tmp_path, modal_text(), nodal_masses=((101, 1.0),))
