"""Bodies from matrices with rotations, modal rows and condensed masses: figures, frames, and faults of files.

Expected: mass, centre, inertia and frequencies of the program that reduced the matrices (facts.json), scipy's
eigenvalues, sums over the particles of a body whose fields are known.
"""

import json

import numpy as np
import pytest

from flexmb_cli.errors import ModelError
from flexmb_cli.fe.estimated_moments import row_invariants
from flexmb_cli.fe.formats.formats import read_matrix
from flexmb_cli.fe.reduction import reduced_body
from flexmb_cli.fe.row_body import row_body
from flexmb_cli.fe.rows import RowMatrices, Rows
from flexmb_cli.model.diagnostics import Findings
from tests.fe.row_bodies.row_decks import FILES, body_of, free_deck, market_deck
from tests.fe.trusses import truss_input

FACTS = json.loads((FILES / "facts.json").read_text())
# Model, node table, mass, stiffness, further cards, relative error that the digits of the file leave.
LAYOUTS = {
    "DMIG, Guyan": ("beam_g", "BDF beam_g.pch", "DMIG beam_g.pch", "DMIG beam_g.pch", "", 1e-8),
    "DMIG, modes": ("beam_cb", "BDF beam_cb.pch", "DMIG beam_cb.pch", "DMIG beam_cb.pch", "", 2e-7),
    "DMIG, frame": ("frame_cb", "BDF frame_cb.pch", "DMIG frame_cb.pch", "DMIG frame_cb.pch", "", 2e-6),
    "DMIG, three rows": ("beam_n6", "BDF beam_n6.pch", "DMIG beam_n6.pch", "DMIG beam_n6.pch", "", 1e-8),
    "Abaqus": ("beam_g", "INP beam_nodes.inp", "ABQ beam_g_MASS1.mtx", "ABQ beam_g_STIF1.mtx", "", 1e-12),
    "substructure": ("beam_g", "TXT beam_nodes.txt", "ABQ beam_g_sub.mtx", "ABQ beam_g_sub.mtx", "", 1e-12),
    "CalculiX": ("beam_g", "TXT beam_nodes.txt", "ABQ beam_g_MASS1.mtx", "ABQ beam_g_ccx.mtx", "", 1e-12),
    "ANSYS": (
        *("beam_g", "TXT beam_nodes.txt", "HB beam_g_M.hb", "HB beam_g_K.hb"),
        *(f"FEMP\n    1,ANS,{FILES}/beam_g.mapping\n", 1e-12),
    ),
    "OP4": (
        *("beam_cb", "BDF beam_cb_op4.pch", "OP4 beam_cb.op4", "OP4 beam_cb.op4"),
        *(f"FEMP\n    1,BDF,{FILES}/beam_cb_op4.pch\n", 1e-12),
    ),
}


@pytest.mark.parametrize("layout", LAYOUTS)
def test_the_figures_of_the_program_that_reduced_the_matrices(layout):
    model, *files, more, precise = LAYOUTS[layout]
    body, _ = body_of(free_deck(FILES, *files, more=more))
    facts = FACTS[model]
    inertia = np.array(facts["inertia_about_centre"])
    assert body.m == pytest.approx(facts["mass"], rel=1e-9)
    assert body.origin + body.axes @ body.centre == pytest.approx(facts["centre"], abs=1e-9)
    assert body.axes @ body.J0 @ body.axes.T == pytest.approx(inertia, abs=1e-9 * inertia.max())
    assert body.frequencies[:8] == pytest.approx(facts["free_Hz"], rel=precise)


def test_a_clamped_node_with_six_rows_is_a_frame():
    body, _ = body_of(free_deck(FILES, *LAYOUTS["Abaqus"][1:4], more="CLMP\n    1,101,\n", modes=8))
    assert body.frequencies == pytest.approx(FACTS["beam_g"]["clamped_Hz"], rel=1e-12)


def matrices(name):
    stored = np.load(FILES / f"{name}.npz")
    return stored["X"], stored["M"], stored["K"]


def test_rows_without_labels_are_six_a_node_then_modal_ones(tmp_path):
    X, M, K = matrices("frame_cb")
    body, _ = body_of(market_deck(tmp_path, X, M, K))
    assert body.frequencies[:8] == pytest.approx(FACTS["frame_cb"]["free_Hz"], rel=1e-8)
    assert np.isfinite(body.Psi).all()


def test_modal_rows_of_any_scale_and_other_units_give_the_same_body(tmp_path):
    """Rows q' = q / s have M' = S M S: an eigenvalue problem does not see the scale."""
    X, M, K = matrices("beam_cb")
    scale = np.diag([1.0] * 18 + [1e5, 1e-4, 30.0, 1.0])
    body, _ = body_of(market_deck(tmp_path, X, scale @ M @ scale, scale @ K @ scale))
    assert body.frequencies[:8] == pytest.approx(FACTS["beam_cb"]["free_Hz"], rel=1e-8)


def carried(rho):
    """Motion (6, 6) of a point at `rho` (3,) that is rigidly joined to a node."""
    return np.block([[np.eye(3), np.cross(np.eye(3), rho).T], [np.zeros((3, 3)), np.eye(3)]])


def test_rows_without_mass_follow_as_in_statics(tmp_path):
    """A node without mass on a spring at the end of the beam changes no frequency; its rows are named."""
    X, M, K = matrices("beam_g")
    stretch = np.hstack([np.zeros((6, 12)), -carried([0.1, 0.2, 0.3]), np.eye(6)])
    more = np.zeros((24, 24))
    more[:18, :18] = K
    stiffness = more + stretch.T @ np.diag([3e4, 2e4, 4e4, 50.0, 60.0, 70.0]) @ stretch
    mass = np.zeros((24, 24))
    mass[:18, :18] = M
    X = np.vstack([X, X[2] + [0.1, 0.2, 0.3]])
    body, warnings = body_of(market_deck(tmp_path, X, mass, stiffness))
    assert [fault.id for fault in warnings] == ["FE-137"]
    assert "6 rows have stiffness and no mass" in warnings[0].message
    assert "node 4, component 1; node 4, component 2" in warnings[0].message
    assert body.massless == 6
    assert body.frequencies[:8] == pytest.approx(FACTS["beam_g"]["free_Hz"], rel=1e-8)


@pytest.mark.parametrize("reference", [(), (11, 12, 13)])
def test_rows_of_solid_elements_give_the_invariants_of_their_masses(tmp_path, reference):
    """For three rows a node whose masses are equal in all directions the estimates are exact."""
    given = truss_input(tmp_path, 3, reference=reference)
    files = read_matrix(given.mass.path, "MM", "M"), read_matrix(given.stiffness.path, "MM", "K")
    exact, found = reduced_body(given, Findings()), row_body(given, files, Findings())
    assert found.frequencies == pytest.approx(exact.frequencies, rel=1e-9)
    for name in ("m", "s0", "S1", "J0", "J1", "J2", "C0", "C1", "Mff", "Phi", "effective_limit"):
        wanted = getattr(exact, name)
        assert getattr(found, name) == pytest.approx(wanted, abs=1e-9 * max(np.abs(wanted).max(), 1.0)), name


def test_second_moments_of_nodes_with_inertia_and_offset_are_sums_over_particles():
    """Every node carries five particles off it; fields of the rows are rigid about each node."""
    random = np.random.default_rng(5)
    nodes, M, parts = random.uniform(-1, 1, (4, 3)), np.zeros((24, 24)), []
    for k, place in enumerate(nodes):
        for rho in random.uniform(-0.2, 0.2, (5, 3)):
            field = np.zeros((3, 24))
            field[:, 6 * k : 6 * k + 6] = carried(rho)[:3]
            mass = random.uniform(0.5, 1.5)
            M += mass * field.T @ field
            parts.append((mass, place + rho, field))
    labels = np.array([(k, c) for k in range(4) for c in range(1, 7)])
    rows = Rows(labels, labels[:, 0], np.tile(np.eye(3), (8, 1)), np.repeat(nodes, 6, axis=0))
    matrices = RowMatrices(M, np.eye(24), rows, np.arange(24), np.arange(24))
    Phi = random.uniform(-1, 1, (24, 5))
    R = rows.rigid
    Phi -= R @ np.linalg.solve(R.T @ M @ R, R.T @ M @ Phi)
    found = row_invariants(matrices, Phi)
    x = np.array([place for _, place, _ in parts])
    fields = np.array([field @ Phi for _, _, field in parts])  # (particles, 3, 5)
    m = np.array([mass for mass, _, _ in parts])
    assert found["s0"] == pytest.approx(m @ x, abs=1e-12)
    assert found["S1"] == pytest.approx(np.einsum("p,pak->ak", m, fields), abs=1e-12)
    moments = -np.einsum("p,pak->ak", m, np.cross(x[:, :, None], fields, axis=1))
    assert found["C0"] == pytest.approx(moments, abs=1e-12)
    T = np.einsum("p,pak,pbl->klab", m, fields, fields)
    J2 = np.einsum("klaa->kl", T)[:, :, None, None] * np.eye(3) - T.transpose(0, 1, 3, 2)
    assert found["J2"] == pytest.approx(J2, abs=1e-12)
    assert found["Mff"] == pytest.approx(np.einsum("klaa->kl", T), abs=1e-12)
    C1 = -np.einsum("p,pakl->kal", m, np.cross(fields[:, :, :, None], fields[:, :, None, :], axis=1))
    assert found["C1"] == pytest.approx(C1, abs=1e-12)


def reported(text):
    """Identifiers and messages of the errors of a deck."""
    with pytest.raises(ModelError) as refused:
        body_of(text)
    return {fault.id: fault.message for fault in refused.value.faults if fault.severity == "error"}


def test_other_displacement_axes_are_told_with_their_node(tmp_path):
    X, M, K = matrices("beam_g")
    angle = np.radians(30.0)
    turn = np.array([[np.cos(angle), -np.sin(angle), 0], [np.sin(angle), np.cos(angle), 0], [0, 0, 1]])
    T = np.eye(18)
    T[6:9, 6:9] = T[9:12, 9:12] = turn
    said = reported(market_deck(tmp_path, X, T @ M @ T.T, T @ K @ T.T, numbers=(101, 102, 103)))
    assert "the displacement axes (CD, *TRANSFORM) of node 102 alone would explain it" in said["FE-139"]


def test_a_node_that_is_elsewhere_is_told(tmp_path):
    X, M, K = matrices("frame_cb")
    X = X.copy()
    X[2, 1] += 0.05
    said = reported(market_deck(tmp_path, X, M, K, numbers=(1, 7, 13)))
    assert "the place of node 13 alone would explain it" in said["FE-139"]


def test_a_supported_body_is_refused(tmp_path):
    X, M, K = matrices("beam_g")
    said = reported(market_deck(tmp_path, X, M, K + np.diag([1e6] * 6 + [0.0] * 12)))
    assert "is the body supported or tied to another" in said["FE-139"]


def test_exchanged_files_are_told(tmp_path):
    X, M, K = matrices("beam_cb")
    assert "are they exchanged?" in reported(market_deck(tmp_path, X, K, M))["FE-138"]


def test_three_different_masses_are_printed(tmp_path):
    X, M, K = matrices("beam_g")
    M = M.copy()
    M[8, 8] += 5.0
    said = reported(market_deck(tmp_path, X, M, K))
    assert "its masses in translations along x, y, z are 0.54, 0.54, 5.54 kg" in said["FE-142"]


def test_rows_that_the_stiffness_lacks_are_named(tmp_path):
    X, M, K = matrices("beam_g")
    K = K.copy()
    K[13], K[:, 13] = 0.0, 0.0
    said = reported(market_deck(tmp_path, X, M, K))
    assert "node 3, component 2" in said["FE-136"]


def test_a_negative_diagonal_is_named(tmp_path):
    X, M, K = matrices("beam_g")
    M = M.copy()
    M[9, 9] = -1e-3
    said = reported(market_deck(tmp_path, X, M, K))
    assert "that of the mass is below zero: node 2, component 4" in said["FE-135"]


def test_a_line_of_nodes_without_rotations_is_no_body(tmp_path):
    """A rod with nodes on a line, masses that couple them along it: it has no inertia about its line."""
    X = np.array([[0.0, 0, 0], [0.5, 0, 0], [1.0, 0, 0]])
    K, M = np.zeros((9, 9)), np.zeros((9, 9))
    bend = np.outer([1.0, -2.0, 1.0], [1.0, -2.0, 1.0])
    stretch = np.array([[1.0, -1.0, 0.0], [-1.0, 2.0, -1.0], [0.0, -1.0, 1.0]])
    along, across = np.array([[2.0, 1, 0], [1, 4, 1], [0, 1, 2]]), np.diag([2.0, 8.0, 2.0])
    for axis in range(3):
        K[axis::3, axis::3] = 1e3 * (bend if axis else stretch)
        M[axis::3, axis::3] = across if axis else along
    said = reported(market_deck(tmp_path, X, M, K))
    assert "all must be above zero: a line of nodes needs the rotations" in said["FE-144"]


def test_rows_of_nodes_that_the_table_lacks_are_refused(tmp_path):
    (tmp_path / "two.txt").write_text("101 0 0 0\n102 0.5 0 0\n")
    text = free_deck(FILES, "TXT two.txt", *LAYOUTS["Abaqus"][2:4])
    text = text.replace(f"{FILES}/two.txt", f"{tmp_path}/two.txt")
    assert "rows of nodes that the node table lacks: 103" in reported(text)["FE-134"]


def test_stresses_need_solid_elements():
    text = free_deck(FILES, *LAYOUTS["Abaqus"][1:4], more="MATL\n    1,7e10,0.33,\n")
    assert "need full matrices of solid elements" in reported(text)["FE-145"]


def test_a_clamped_node_without_rows_is_refused(tmp_path):
    nodes = (FILES / "beam_nodes.txt").read_text() + "104 2 0 0\n"
    (tmp_path / "four.txt").write_text(nodes)
    text = free_deck(FILES, "TXT four.txt", *LAYOUTS["Abaqus"][2:4], more="CLMP\n    1,104,\n")
    said = reported(text.replace(f"{FILES}/four.txt", f"{tmp_path}/four.txt"))
    assert "the matrices have no rows of node 104" in said["FE-146"]
