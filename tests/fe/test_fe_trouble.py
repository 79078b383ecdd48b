# ruff: noqa: E501
"""Ill-conditioned, indefinite and unsupported finite-element matrices, told with the node that shows it most.

A truss of seven nodes and all bars: six zero eigenvalues, the others above zero.  Each test spoils one thing.
"""

import numpy as np
import pytest

from flexmb_cli.errors import FlexmbError
from flexmb_cli.fe.build_mechanism import flexible_mechanism
from flexmb_cli.fe.flexible_bodies import flexible_body
from flexmb_cli.model.unit_checks import unit_warnings
from tests.dialects.vsdf.vsdf_decks import build, supplied
from tests.fe.formats import bar_files
from tests.fe.trusses import files_input, truss

FRAMES = pytest.mark.parametrize(
    "frame",
    [{"reference": (11, 12, 13)}, {}, {"clamped": (11, 12, 13)}],
    ids=["nodes", "mean axes", "clamped"],
)
NEGATIVE = (
    "gives energy away; is it a tangent stiffness beyond buckling, or spoilt on its way?",
    "the stiffness is not positive semidefinite: a deformation, largest at node ",
)


def reported(folder, r, M, K, **choices):
    """Sentences about a body of these matrices."""
    try:
        return [
            fault.sentence
            for fault in flexible_body(files_input(folder, r, M, K, **choices), cached=False)[1]
        ]
    except FlexmbError as failure:
        return [fault.sentence for fault in failure.faults]


def with_eigenvalue(K, k, factor):
    """The stiffness with its k-th eigenvalue times `factor`; 0 to 5 are those of rigid motions."""
    values, vectors = np.linalg.eigh(K)
    return K + (factor - 1.0) * values[k] * np.outer(vectors[:, k], vectors[:, k])


@FRAMES
@pytest.mark.parametrize("modes", [3, 0])
def test_a_stiffness_with_a_negative_eigenvalue_is_refused(frame, modes, tmp_path):
    r, _, M, K = truss(1)
    (message,) = reported(tmp_path, r, M, with_eigenvalue(K, 6, -1.0), modes=modes, **frame)
    assert message.startswith("body 1: " + NEGATIVE[1])
    assert message.endswith(NEGATIVE[0])


@pytest.mark.parametrize("frame", [{"reference": (11, 12, 13)}, {}], ids=["nodes", "mean axes"])
def test_a_mechanism_in_the_mesh_is_refused(frame, tmp_path):
    """A seventh zero: one deformation without strain, which three clamped nodes would hold."""
    r, _, M, K = truss(1)
    (message,) = reported(tmp_path, r, M, with_eigenvalue(K, 6, 0.0), modes=3, **frame)
    assert message.startswith("body 1: held in its frame the body still moves without strain, most at node ")
    assert ": is the mesh in one piece, without hinges, and, of elements with reduced integration " in message
    assert message.endswith("(C3D20R), with two or more across?")


@pytest.mark.parametrize("size", [1.0, 1e-3])
def test_a_stiffness_without_its_six_rigid_motions_is_refused(size, tmp_path):
    """A spring at node 11 to the ground, as strong as the largest entry or a thousandth of it."""
    r, _, M, K = truss(1)
    K[:3, :3] += size * np.abs(K).max() * np.eye(3)
    (message,) = reported(tmp_path, r, M, K, modes=3, reference=(11, 12, 13))
    found = size / (1.0 + size) if size == 1.0 else size
    share = float(message.partition("translation by ")[2].partition(" ")[0])
    assert share == pytest.approx(found, rel=0.5)
    assert message.endswith(
        " of the largest entry, most at node 11; is the body supported, or joined to another? export it free"
    )


def test_a_negative_stiffness_or_mass_is_told_by_its_diagonal(tmp_path):
    r, m, M, K = truss(1)
    assert reported(tmp_path, r, M, -K, modes=3) == [
        f"body 1: the stiffness of node 11 along x is {-K[0, 0]:.6g}; a diagonal must be positive (21 of 21 such degrees of freedom)"
    ]
    m[0, 0] -= 10.0
    assert reported(tmp_path, r, np.kron(m, np.eye(3)), K, modes=3) == [
        f"body 1: the mass of node 11 along x is {m[0, 0]:.6g}; a diagonal must be positive (3 of 21 such degrees of freedom)"
    ]


def test_a_node_in_no_element_is_refused(tmp_path):
    r, _, M, K = truss(1)
    K[:3], K[:, :3] = 0.0, 0.0
    assert reported(tmp_path, r, M, K, modes=3)[0] == (
        "body 1: the stiffness of node 11 along x is 0; is the node in no element? (3 of 21 such degrees of freedom)"
    )


@pytest.mark.parametrize("spoilt", ["nan", "inf"])
def test_entries_that_are_no_numbers_are_told_with_their_line(spoilt, tmp_path):
    r, _, M, K = truss(1)
    K[4, 4] = float(spoilt)
    (message,) = reported(tmp_path, r, M, K, modes=3)
    assert message.endswith(f": expected row, column and value; '{spoilt}' is not a finite number")


def test_frequencies_that_no_solid_has_point_to_the_units(tmp_path):
    """Masses of the pendulum in tonnes and stiffness in N/mm with nodes in m: 1e3 times too fast, twice
    over.
    """
    mechanism, _ = flexible_mechanism(build(supplied("pendulum")), cached=False)
    assert unit_warnings(mechanism) == []
    (body,) = mechanism.bodies
    body.flexible.frequencies[:] *= 1e6
    (note,) = unit_warnings(mechanism)
    assert note.severity == "note"
    assert note.sentence == (
        "body 1: the lowest frequency is 5.26e+06 Hz in a body of 0.1 m, as if sound went at 5e+05 m/s or faster: are "
        "mass in kg, stiffness in N/m, nodes in m?"
    )


def test_nodes_in_millimetres_are_told_though_the_matrices_fit_them():
    """0.26 kg of the pendulum in 100 m x 10 m x 15 m: 1.7e-5 kg/m3, where air has 1.2."""
    mechanism, _ = flexible_mechanism(build(supplied("pendulum")), cached=False)
    (body,) = mechanism.bodies
    body.flexible.r0[:] *= 1e3
    (note,) = unit_warnings(mechanism)
    assert note.severity == "note"
    assert note.sentence == (
        "body 1: 0.26 kg in a box of 100 by 15 by 10 m are 1.7e-05 kg/m³, less than foam: "
        "nodes in mm (times 0.001) would make 17000 kg/m³"
    )


@pytest.mark.parametrize(
    ("length", "mass", "words"),
    [
        (1000.0, 1.0, "2.7e-06 kg/m³, less than foam: nodes in mm (times 0.001) would make 2700 kg"),
        (100.0, 1.0, "0.0027 kg/m³, less than foam: nodes in cm (times 0.01) would make 2700 kg/m³"),
        (1 / 0.0254, 1.0, "0.044 kg/m³, less than foam: nodes in inches (times 0.0254) would make 2700 kg/m³"),
        (1000.0, 1e-3, "2.7e-09 kg/m³, less than foam: nodes in mm and masses in tonnes would make 2700"),
        (1.0, 1e-3, "2.7 kg/m³, less than foam: masses in tonnes (times 1000) would make 2700 kg/m³"),
        (0.001, 1.0, "2.7e+12 kg/m³, more than osmium: nodes converted from mm twice (times 1000) would make"),
        (1.0, 1e3, "2.7e+06 kg/m³, more than osmium: masses in g (times 0.001) would make 2700 kg/m³"),
    ],
)  # fmt: skip
def test_the_density_of_the_box_names_the_likely_unit(tmp_path, length, mass, words):
    """Aluminium that fills its box has 2700 kg/m³."""
    nodes = "".join(
        f"{number} {' '.join(repr(float(x) * length) for x in r)}\n"
        for number, *r in map(str.split, bar_files.NODES.splitlines())
    )
    files = [("MM", bar_files.market(A * mass)) for A in (bar_files.M, bar_files.K)]
    assert words in bar_files.said(tmp_path, *files, nodes=nodes).output
