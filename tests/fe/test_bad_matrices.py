"""Matrices and nodes that can be read and describe no body, and what is said of them."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from flexmb_cli.errors import ModelError, Place
from flexmb_cli.fe.flexible_bodies import flexible_body
from flexmb_cli.model.flexible_body import FEFile
from tests.fe.trusses import files_input, truss


def messages(given):
    """Severity and sentence of all faults of a body's files."""
    try:
        faults = flexible_body(given, cached=False)[1]
    except ModelError as stopped:
        faults = stopped.faults
    return [f"{fault.severity}: {fault.message}" for fault in faults]


def spoilt(folder, change, symmetric=True, **choices):
    """Messages for the truss after `change(r, M, K)` edited its arrays."""
    r, _, M, K = truss(1)
    change(r, M, K)
    return messages(files_input(folder, r, M, K, symmetric, **choices))


def test_matrices_of_another_mesh(tmp_path):
    r, _, M, K = truss(1)
    assert messages(files_input(tmp_path, r[:5], M, K)) == [
        "error: K.mtx has 21 rows; the 5 nodes of the table need 15, three each; "
        "has it other nodes, or rotations of beams and shells?",
        "error: M.mtx has 21 rows; the 5 nodes of the table need 15, three each; "
        "has it other nodes, or rotations of beams and shells?",
    ]


def test_an_unsymmetric_matrix(tmp_path):
    def change(_r, _M, K):
        K[0, 4] = 7.0
        K[4, 0] = 9.0

    assert spoilt(tmp_path, change, symmetric=False) == [
        "error: K.mtx is not symmetric: entries (1, 5) and (5, 1) are 7 and 9"
    ]


def test_a_node_without_mass(tmp_path):
    def change(_r, M, _K):
        M[3:6] = M[:, 3:6] = 0.0

    assert spoilt(tmp_path, change) == [
        "error: the mass of node 12 along x is 0; is the node in no element? "
        "(3 of 21 such degrees of freedom)"
    ]


def test_a_node_that_no_element_has(tmp_path):
    def change(_r, _M, K):
        K[18:] = K[:, 18:] = 0.0

    found = spoilt(tmp_path, change)
    assert found[0] == (
        "error: the stiffness of node 17 along x is 0; is the node in no element? "
        "(3 of 21 such degrees of freedom)"
    )


def test_a_mass_that_differs_by_directions(tmp_path):
    def change(_r, M, _K):
        M[0, 1] = M[1, 0] = 0.5 * np.abs(M).max()

    (said,) = spoilt(tmp_path, change)
    assert said.startswith("error: its masses in translations along x, y, z are ")
    assert "a body has one mass; are rows missing, or has it masses in one direction alone" in said


def test_a_mass_matrix_of_few_digits(tmp_path):
    def change(_r, M, _K):
        M[0, 0] += 1e-5 * np.abs(M).max()

    assert spoilt(tmp_path, change, modes=2) == [
        "warning: the mass of directions x, y, z differs by 6.7e-06 of the largest entry, most at node 11: "
        "the equations need equal masses in all directions and none between them; their mean is taken"
    ]


def test_a_supported_body(tmp_path):
    def change(_r, _M, K):
        K[:3, :3] += np.diag([5.0, 5.0, 5.0]) * np.abs(K).max()

    K = truss(1)[3]
    share = 5.0 * np.abs(K).max() / (5.0 * np.abs(K).max() + np.diag(K)[:3].max())
    assert spoilt(tmp_path, change) == [
        f"error: the stiffness resists a translation by {share:.1e} of the largest entry, most at node 11; "
        "is the body supported, or joined to another? export it free"
    ]


def test_nodes_in_another_order_or_unit(tmp_path):
    def change(r, _M, _K):
        r[[0, 1]] = r[[1, 0]]

    (message,) = spoilt(tmp_path, change)
    assert message.startswith("error: the stiffness resists a rotation by ")
    assert message.endswith(
        ", but no translation: the node table does not belong to the matrix (order of the nodes, unit of "
        "length, rotated nodal axes)"
    )


def test_a_stiffness_of_few_digits(tmp_path):
    def change(_r, _M, K):
        K[0, 0] *= 1 + 1e-6

    K = truss(1)[3]
    share = 1e-6 * K[0, 0] / np.abs(K).max()
    assert spoilt(tmp_path, change, modes=2) == [
        f"warning: the stiffness resists rigid motion by {share:.1e} of the largest entry, most at node 11; "
        "export it with more digits"
    ]


def test_reference_nodes_on_one_line(tmp_path):
    def change(r, _M, _K):
        r[2] = 2 * r[1] - r[0]

    assert spoilt(tmp_path, change, reference=(11, 12, 13))[0] == (
        "error: the reference nodes 11, 12, 13 lie on one line; three that span a plane are needed"
    )


def test_clamped_nodes_on_one_line_leave_a_rotation(tmp_path):
    (message,) = spoilt(tmp_path, lambda r, M, K: None, clamped=(11, 12))
    assert message.startswith(
        "error: the clamped nodes do not hold the body in its frame: three that are not on one line are "
        "needed "
    )


@pytest.mark.parametrize("name, what", [("M.mtx", "mass"), ("K.mtx", "stiffness")])
@pytest.mark.filterwarnings("error")
def test_a_matrix_of_zeros_is_told_of_its_freedoms(tmp_path, name, what):
    """The largest entry, 0, was divided by; found by fuzzing."""
    r, _, M, K = truss(1)
    given = files_input(tmp_path, r, M, K)
    head, size, *lines = (tmp_path / name).read_text().splitlines()
    zeros = [f"{line.rpartition(' ')[0]} 0.0" for line in lines]
    (tmp_path / name).write_text("\n".join([head, size, *zeros]) + "\n")
    assert any(f"error: the {what} of node" in message for message in messages(given))


def test_mass_and_stiffness_exchanged_are_called_so(tmp_path):
    def change(_r, M, K):
        M[:], K[:] = K.copy(), M.copy()

    assert (
        "error: this mass matrix looks like a stiffness; it gives no force in a translation, and the "
        "stiffness does: are the files exchanged?"
    ) in spoilt(tmp_path, change)


def test_a_mesh_in_two_pieces(tmp_path):
    def change(_r, M, K):
        r, _, piece_M, piece_K = truss(2, 4)
        for whole, piece in ((M, piece_M), (K, piece_K)):
            whole[:] = 0.0
            whole[:12, :12] = piece
            whole[12:, 12:] = piece[:9, :9]
        _r[:4] = r
        _r[4:] = r[:3] + 5.0
        K[12:, 12:] = 0.0
        for i, j in ((4, 5), (5, 6), (4, 6)):
            along = (_r[i] - _r[j]) / np.linalg.norm(_r[i] - _r[j])
            bar = np.zeros(21)
            bar[3 * i : 3 * i + 3], bar[3 * j : 3 * j + 3] = along, -along
            K += 100 * np.outer(bar, bar)

    for choices in ({"reference": (11, 12, 13)}, {}):
        (message,) = spoilt(tmp_path, change, modes=2, **choices)
        assert message.startswith("error: held in its frame the body still moves without strain")


def test_two_interface_nodes_do_not_hold_a_body(tmp_path):
    (message,) = spoilt(tmp_path, lambda r, M, K: None, interface=(11, 12), modes=2)
    assert message.startswith(
        "error: the interface nodes do not hold the body: three that are not on one line are needed"
    )


def test_more_modes_than_the_body_has(tmp_path):
    assert spoilt(tmp_path, lambda r, M, K: None, modes=16) == [
        "error: 16 modes are requested, and the body has 15; 0 takes all"
    ]


def test_an_indefinite_mass_matrix(tmp_path):
    def change(_r, M, _K):
        m = np.eye(7) + 0.0
        m[0, 1] = m[1, 0] = 2.0
        M[:] = np.kron(m, np.eye(3))

    assert spoilt(tmp_path, change) == [
        "error: the mass matrix is not positive definite; is it complete, or of another model?"
    ]


def test_a_held_node_is_missing_from_the_equations(tmp_path):
    r, _, M, K = truss(1, 4)
    given = files_input(tmp_path, r, M, K)
    lines = []
    for letter, matrix in (("M", M), ("K", K)):
        entries = [
            f"{i // 3 + 11},{i % 3 + 1},{j // 3 + 11},{j % 3 + 1},{matrix[i, j]:.17g}"
            for i in range(11)
            for j in range(i + 1)
        ]
        (tmp_path / f"{letter}.abq").write_text("\n".join(entries) + "\n")
        lines.append(FEFile(tmp_path / f"{letter}.abq", "ABQ", Place(len(lines) + 1, 1)))
    given = replace(given, mass=lines[0], stiffness=lines[1])
    assert messages(given)[1] == (
        "error: K.abq has no row for direction 3 of node 14, and lacks 1 in all: is the node held by a "
        "boundary condition, tied to others (*RIGID BODY, *EQUATION, *MPC; RBE2, MPC; CE, CERIG), or in no "
        "element? export the body unsupported, without ties, with the nodes of its elements only"
    )


def test_a_fault_stands_at_the_card_of_its_file(tmp_path):
    given = files_input(tmp_path, *(truss(1)[i] for i in (0, 2, 3)))
    given = replace(
        given,
        mass=FEFile(Path("none"), "MM", Place(5, 12)),
        stiffness=FEFile(Path("also none"), "MM", Place(7, 12)),
    )
    with pytest.raises(ModelError) as stopped:
        flexible_body(given, cached=False)
    assert [(fault.place, fault.sentence) for fault in stopped.value.faults] == [
        (Place(5, 12), "body 1: none: no such file in ."),
        (Place(7, 12), "body 1: also none: no such file in ."),
    ]
