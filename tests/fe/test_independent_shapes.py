"""Static shapes beside eigenmodes: all that bend the body otherwise remain, and those dropped are named."""

import math
from dataclasses import dataclass

import numpy as np
import pytest

from flexmb_cli.deck.body_text import body_lines
from flexmb_cli.errors import ModelError
from flexmb_cli.fe import body_basis
from flexmb_cli.fe.flexible_bodies import flexible_body
from flexmb_cli.fe.formats.formats import read_matrix
from flexmb_cli.fe.formats.node_table import read_node_table
from flexmb_cli.fe.nodal_matrices import condensed
from flexmb_cli.model.flexible_body import FEFile, FlexibleInput
from scripts.brick_beam import Beam, run_calculix
from tests.fe.calculix import needs_ccx
from tests.fe.supplied import body, pendulum
from tests.fe.tetrahedra import tetrahedra
from tests.fe.trusses import files_input

ROOT = (1, 2, 3, 4, 5, 6)
AXES = ("e1", "e2", "e3")


def flexibility(found):
    """Displacements under unit forces, as the basis has them."""
    return found.Phi @ np.linalg.solve(found.Kr, found.Phi.T)


def test_attachment_modes_of_all_nodes_bend_as_the_whole_stiffness(tmp_path):
    """A block of 48 tetrahedra of one point each: every unit force on a free node has the answer of K^-1.

    The mass matrix sees neighbouring nodes' shapes as equal, and has shapes that it does not see at all.
    """
    placed, elements = Beam((0.3, 0.2, 0.2), (2, 2, 2), "C3D4").mesh()
    positions = np.array(list(placed.values()))
    K, S = tetrahedra(positions, elements, 2.0e11, 0.3, 7800.0)
    root = [node + 10 for node in placed if positions[node - 1, 0] == 0]
    every = tuple(range(11, 11 + len(positions)))
    given = files_input(tmp_path, positions, S, K, clamped=tuple(root), attachment=every, modes=1)
    found = body(given)
    free = np.setdiff1d(np.arange(len(K)), [3 * (node - 11) + axis for node in root for axis in range(3)])
    wanted = np.zeros_like(K)
    wanted[np.ix_(free, free)] = np.linalg.inv(K[np.ix_(free, free)])
    np.testing.assert_allclose(flexibility(found), wanted, atol=1e-11 * np.abs(wanted).max())
    assert found.modes == len(free)
    # As many modes as degrees of freedom: none is left out.
    assert found.dropped.modes == 0
    assert not any("modes left out" in line for line in body_lines(found))


def test_superfluous_static_shapes_are_named_with_node_and_axis():
    """All modes leave nothing to add; what is clamped cannot move; the text names all of them."""
    found = body(pendulum(clamped=ROOT, attachment=(6, 51), modes=0))
    assert found.dropped.shapes == tuple((node, axis) for node in (6, 51) for axis in AXES)
    assert "      at nodes 6 e1 e2 e3, 51 e1 e2 e3" in body_lines(found)


def test_one_static_shape_for_a_force_that_the_frame_takes_is_dropped():
    """Reference nodes 1, 13, 9: node 13 moves along e1 only, so that its two other forces bend nothing."""
    found = body(pendulum(reference=(1, 13, 9), attachment=(13,), modes=3))
    assert found.modes == 4
    assert found.dropped.shapes == ((13, "e2"), (13, "e3"))


def test_each_static_shape_is_one_mode_less_that_is_left_out():
    """48 free nodes have 144 directions: three modes and 102 shapes of 34 nodes leave 39 of them."""
    found = body(pendulum(clamped=ROOT, attachment=tuple(range(7, 41)), modes=3))
    assert (found.modes, found.dropped.shapes) == (105, ())
    assert any(line.startswith("    modes left out: 39, ") for line in body_lines(found))


def test_more_shapes_than_memory_bears_are_refused_with_the_reason(monkeypatch):
    """144 free directions and 144 static shapes; 72 bytes for every two of 288 shapes are 0.006 GB."""
    monkeypatch.setattr(body_basis, "LARGEST_BASIS", 200)
    every = tuple(range(7, 55))
    with pytest.raises(ModelError) as refused:
        flexible_body(pendulum(clamped=ROOT, attachment=every, modes=0), cached=False)
    message = refused.value.faults[0].message
    assert message.startswith("288 shapes are more than the 200 that can be kept")
    assert "(0.006 GB)" in message


@dataclass(frozen=True)
class Plate(Beam):
    """A quarter of a plate, 1 m square, 20 mm thick, with a hole of radius 0.2 m; cells: radius, angle."""

    def mesh(self):
        nodes, elements = super().mesh()
        return {node: self._bent(*place) for node, place in nodes.items()}, elements

    def _bent(self, radial, around, through):
        direction = np.array([math.cos(around * math.pi / 2), math.sin(around * math.pi / 2)])
        outer = 0.5 * direction / np.abs(direction).max()
        x, y = 0.2 * direction * (1 - radial) + outer * radial
        # CalculiX reads twenty columns of a number.
        return round(float(x), 9), round(float(y), 9), round(0.02 * through, 9)


@needs_ccx
@pytest.mark.processes
@pytest.mark.parametrize("element, cells", [("C3D20R", (4, 6, 1)), ("C3D10", (2, 4, 1))])
def test_a_plate_with_a_hole_keeps_the_shapes_of_all_its_loaded_nodes(tmp_path, element, cells):
    """CalculiX's stiffness of the plate, solved whole, for forces on 17 nodes of an edge under tension.

    Its condition is 7e7 (C3D20R), 4e7 (C3D10): half a unit of the last digit that
    CalculiX writes moves displacements by 1e-8, so that no basis can have them to 6e-12.
    """
    plate = Plate((1.0, 1.0, 1.0), cells, element)
    (tmp_path / "plate.inp").write_text(plate.input())
    run_calculix(tmp_path, "plate")
    table = read_node_table(tmp_path / "plate.inp", "INP")
    y = table.positions[:, 1]
    held, loaded = np.flatnonzero(y == 0), np.argsort(-y, kind="stable")[:17]
    files = [FEFile(tmp_path / f"plate.{suffix}", "CCX") for suffix in ("mas", "sti", "dof")]
    given = FlexibleInput(
        "body 1", *files[:2], table.numbers, table.positions, files[2],
        clamped=tuple(map(int, table.numbers[held])), attachment=tuple(map(int, table.numbers[loaded])),
        modes=10,
    )  # fmt: skip
    found = body(given)
    assert (found.modes, found.dropped.shapes) == (61, ())
    matrix = read_matrix(files[1].path, "CCX", "K", files[2].path, "CCX")
    K = condensed("K", matrix, table.numbers).matrix
    force = np.zeros(K.shape[0])
    force[3 * loaded + 1] = 1000.0 / 17
    bent = found.Phi @ np.linalg.solve(found.Kr, found.Phi.T @ force)
    free = np.setdiff1d(np.arange(K.shape[0]), (3 * held[:, None] + np.arange(3)).ravel())
    stiffness = K[np.ix_(free, free)]
    wanted = refined(stiffness, force[free])
    known = np.abs(refined(within_last_digit(stiffness), force[free]) - wanted).max()
    assert known > 1e-9 * np.abs(wanted).max()
    assert np.abs(bent[free] - wanted).max() < 0.1 * known
    # Thin plates lose digits in solving: the forces that the deformation answers have more of them.
    assert (K @ bent)[free] == pytest.approx(force[free], abs=1e-6 * np.abs(force).max())


def within_last_digit(K):
    """`K` with numbers that CalculiX would write alike: at most half a unit of their 14th digit off."""
    size = np.where(K == 0, 1.0, np.abs(K))
    off = np.triu(np.random.default_rng(1).uniform(-0.5, 0.5, K.shape)) * 10.0 ** (
        np.floor(np.log10(size)) - 13
    )
    return K + np.where(K == 0, 0.0, off + np.triu(off, 1).T)


def refined(A, b):
    """The solution of A x = b whose residuals are computed with the 64 bits of long doubles."""
    inverse, x = np.linalg.inv(A), np.zeros(b.shape, np.longdouble)
    for _ in range(8):
        x += inverse @ (b - A.astype(np.longdouble) @ x).astype(float)
    return x.astype(float)
