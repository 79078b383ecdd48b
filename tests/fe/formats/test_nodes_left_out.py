"""Nodes that a node table lacks are refused by their numbers; elements' own degrees of freedom are not."""

import numpy as np
import pytest
from scipy.io import hb_write
from scipy.sparse import csc_matrix

from flexmb_cli.errors import ModelError
from flexmb_cli.fe.flexible_bodies import flexible_body
from flexmb_cli.fe.formats.formats import read_matrix
from flexmb_cli.model.flexible_body import FEFile, FlexibleInput
from tests.fe.formats.bars import BAR, MASS, OF_MATRICES, POINTS, by_matrices, inp_nodes, refusal
from tests.fe.formats.test_fe_files import full

LABELS = [(node, axis) for node in range(1, 17) for axis in (1, 2, 3)]


def matrix(letter):
    return full(read_matrix(BAR / f"{letter}a.mtx", "ABQ", letter))


def write_abaqus(path, A, labels):
    rows = [(*labels[i], *labels[j], A[i, j]) for i, j in zip(*np.nonzero(np.tril(A)), strict=True)]
    path.write_text("".join(f"{a},{b}, {c},{d}, {value:.15e}\n" for a, b, c, d, value in rows))


def write_dmig(path, A, labels):
    lines = [f"DMIG,{path.name},0,6,2,0"]
    for column, label in enumerate(labels):
        lines.append(f"DMIG,{path.name},{label[0]},{label[1]}")
        lines += [f",{labels[i][0]},{labels[i][1]},{float(A[i, column])!r}" for i in range(column, len(A))]
    path.write_text("\n".join(lines) + "\n")


def write_boeing(path, A, labels):
    hb_write(path, csc_matrix(A))
    rows = [f"{i} {node} U{'XYZ'[axis - 1]}\n" for i, (node, axis) in enumerate(labels, 1)]
    path.with_suffix(".map").write_text("".join(rows))


def write_calculix(path, A, labels):
    rows = [f"{i + 1} {j + 1} {A[i, j]:.15e}\n" for i, j in zip(*np.nonzero(np.triu(A)), strict=True)]
    path.write_text("".join(rows))
    path.with_suffix(".map").write_text("".join(f"{node}.{axis}\n" for node, axis in labels))


WRITERS = {"ABQ": write_abaqus, "DMIG": write_dmig, "HB": write_boeing, "CCX": write_calculix}


def bar(folder, form, nodes, M=None, K=None, labels=LABELS):
    """The bar by files of one format beside a table of the nodes `nodes`."""
    for letter, A in (("M", M), ("K", K)):
        WRITERS[form](folder / letter, matrix(letter) if A is None else A, labels)
    mapping = {"HB": "ANS", "CCX": "CCX"}.get(form)
    given = FlexibleInput(
        "body 1",
        FEFile(folder / "M", form),
        FEFile(folder / "K", form),
        np.array(nodes),
        np.array([POINTS[node - 1] for node in nodes]),
        mapping and FEFile(folder / "M.map", mapping),
        modes=3,
    )
    return flexible_body(given, cached=False)[0]


@pytest.mark.parametrize("form", WRITERS)
def test_a_short_table_is_refused_with_the_nodes_that_it_lacks(tmp_path, form):
    """It gave 18.144 kg and 2202.96 Hz; 23.328 kg and 1310.97 Hz are right (bars.py)."""
    found = bar(tmp_path, form, range(1, 17))
    assert found.m == pytest.approx(MASS, rel=1e-6)
    assert found.frequencies == pytest.approx(OF_MATRICES, rel=1e-6)
    (message,) = refusal(bar, tmp_path, form, range(1, 13))
    assert "K has rows with stiffness or mass of nodes that the node table lacks: 13, 14, 15, 16;" in message


@pytest.mark.parametrize("lacking", [[1], [16], [5, 10], [2, 4, 6, 8, 10, 12, 14, 16], list(range(5, 17))])
def test_any_nodes_that_are_left_out_are_found(tmp_path, lacking):
    nodes = [node for node in range(1, 17) if node not in lacking]
    (message,) = refusal(bar, tmp_path, "ABQ", nodes)
    named = message.partition("lacks: ")[2].partition(";")[0].replace(", …", "").split(", ")
    assert named and set(map(int, named)) <= set(lacking)


def test_a_body_without_joint_to_the_nodes_is_found_by_its_mass(tmp_path):
    """Its rows of K have nothing to do with the nodes, so that only their mass tells."""
    zeros = np.zeros((48, 48))
    M, K = (np.block([[A, zeros], [zeros, A]]) for A in map(matrix, "MK"))
    labels = [*LABELS, *((node + 100, axis) for node, axis in LABELS)]
    (message,) = refusal(lambda: bar(tmp_path, "ABQ", range(1, 17), M, K, labels))
    assert "M has rows with stiffness or mass of nodes" in message and "101, 102, 103" in message


def test_degrees_of_freedom_of_elements_are_condensed_as_before(tmp_path):
    """Three that couple to bending, as incompatible modes do: rows orthogonal to every translation.

    Expected: `numpy.linalg.solve` of the whole, whose condensation is the stiffness of the bar itself.
    """
    random = np.random.default_rng(3)
    B = random.normal(size=(3, 16, 3)) * 1e8
    B = (B - B.mean(axis=1, keepdims=True)).reshape(3, 48)
    D = np.diag([3e9, 4e9, 5e9])
    K = np.block([[matrix("K") + B.T @ np.linalg.solve(D, B), B.T], [B, D]])
    M = np.block([[matrix("M"), np.zeros((48, 3))], [np.zeros((3, 48)), np.eye(3)]])
    labels = [*LABELS, (-1, 1), (-1, 2), (-1, 3)]
    found = bar(tmp_path, "ABQ", range(1, 17), M, K, labels)
    assert found.dropped.internal == 3
    assert found.frequencies == pytest.approx(OF_MATRICES, rel=1e-6)


LABELLED = (BAR / "Ka.mtx").read_text()


def by_labels(folder, change):
    lines = [change(*line.split(",")) for line in LABELLED.splitlines()]
    (folder / "K.mtx").write_text("\n".join(lines) + "\n")
    given = FlexibleInput(
        "body 1",
        FEFile(BAR / "Ma.mtx", "ABQ"),
        FEFile(folder / "K.mtx", "ABQ"),
        np.arange(1, 17),
        np.array(POINTS),
        modes=3,
    )
    return flexible_body(given, cached=False)[0]


@pytest.mark.parametrize("name", ["PART-1-1", "Bar.2-1", "my part", "A_1"])
def test_labels_of_one_instance_are_read(tmp_path, name):
    """FORMAT=LABELS; frequencies of `scipy.linalg.eigh`, bars.py."""
    found = by_labels(tmp_path, lambda a, i, b, j, k: f"{name}.{a},{i}, {name}.{b.strip()},{j},{k}")
    assert found.frequencies == pytest.approx(OF_MATRICES, rel=1e-6)


@pytest.mark.parametrize("other", ["PART-2-1.{}", "{}"])
def test_labels_of_two_instances_lead_to_another_format(tmp_path, other):
    def change(a, i, b, j, k):
        column = other.format(b.strip()) if int(b) == 9 else f"PART-1-1.{b.strip()}"
        return f"PART-1-1.{a},{i}, {column},{j},{k}"

    (message,) = refusal(by_labels, tmp_path, change)
    assert "no two nodes of instance PART-1-1; write the matrices with FORMAT=MATRIX INPUT" in message


def test_a_table_of_selected_nodes_is_refused(tmp_path):
    with pytest.raises(ModelError, match="node table lacks: 5, 6, 7, 8"):
        by_matrices(tmp_path, "INP", "*NODE\n" + inp_nodes(1, 4) + inp_nodes(9, 16))
