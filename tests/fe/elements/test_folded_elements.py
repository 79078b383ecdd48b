"""Elements that are folded are refused, distorted ones reported, and sound curved ones taken."""

from dataclasses import dataclass

import numpy as np
import pytest

from flexmb_cli.errors import ModelError
from flexmb_cli.fe.elements.body_elements import element_table, warn_of_distortion
from flexmb_cli.fe.elements.solid_elements import FORMULATIONS, solid_elements
from flexmb_cli.fe.flexible_bodies import flexible_body
from flexmb_cli.model.diagnostics import Findings
from scripts.brick_beam import Beam
from tests.fe.test_assembled_matrices import meshed

KINDS = ("C3D4", "C3D8", "C3D10", "C3D20R")
INTERCHANGED = {"C3D4": (0, 1), "C3D8": (0, 1), "C3D10": (4, 5), "C3D20R": (0, 1)}  # nodes, from 0
TURN, INNER, OUTER = np.pi / 2, 0.1, 0.3  # of a quarter of a ring


@dataclass(frozen=True)
class Ring(Beam):
    """A quarter of a thick ring of one element along the arc: its middles lie on the arcs."""

    def mesh(self):
        """Bend the block about z: x goes around, y outwards."""
        placed, elements = super().mesh()
        x, y, z = np.array(list(placed.values())).T / np.array(self.size)[:, None]
        radius, angle = INNER + (OUTER - INNER) * y, TURN * (1 - x)
        places = np.stack([radius * np.cos(angle), radius * np.sin(angle), self.size[2] * z], axis=1)
        return dict(zip(placed, map(tuple, places.tolist()), strict=True)), elements


@dataclass(frozen=True)
class Moved(Beam):
    """One brick whose middles along x lie at `part` of their edges."""

    part: float = 0.5

    def mesh(self):
        """Move what lies between the ends."""
        placed, elements = super().mesh()
        length = self.size[0]
        return {
            node: (self.part * length if 0 < x < length else x, y, z) for node, (x, y, z) in placed.items()
        }, elements


@dataclass(frozen=True)
class Interchanged(Beam):
    """A block in which two nodes of the first element have changed places."""

    def mesh(self):
        """Interchange the two of `INTERCHANGED`."""
        placed, elements = super().mesh()
        a, b = INTERCHANGED[self.element]
        elements[0][a], elements[0][b] = elements[0][b], elements[0][a]
        return placed, elements


@pytest.mark.parametrize("kind", KINDS)
def test_an_element_with_two_nodes_interchanged_is_refused(tmp_path, kind):
    """Those of 10 and 20 nodes have positive determinants at their points of integration.

    A C3D20R was taken in silence, with 17 % more volume and a third more stress.
    """
    given = meshed(tmp_path, Interchanged((0.3, 0.2, 0.1), (2, 1, 1), kind))
    with pytest.raises(ModelError, match=r"b\.inp: element 1 is turned inside out or folded"):
        flexible_body(given, cached=False)


def looked_at(given):
    """Return the table of the elements, None for a fault, and what is said of them."""
    findings = Findings()
    table = element_table(given, given.material.file, given.positions, findings)
    if table:
        warn_of_distortion(given, table, given.positions, findings)
    return table, [fault.message for fault in findings.faults]


@pytest.mark.parametrize("kind", ["C3D10", "C3D20", "C3D20R"])
def test_a_quarter_of_a_ring_is_sound(tmp_path, kind):
    """One element along a quarter of a turn; the volume of the ring is pi/4 (R^2 - r^2) h."""
    given = meshed(tmp_path, Ring((1.0, 1.0, 0.1), (1, 1, 1), kind))
    table, said = looked_at(given)
    volumes = solid_elements(given.positions, table.rows, FORMULATIONS[table.rows.shape[1]][-1]).volumes
    assert volumes.sum() == pytest.approx(np.pi / 4 * (OUTER**2 - INNER**2) * 0.1, rel=0.03)
    assert said == []


@pytest.mark.parametrize("part, reported", [(0.25, ""), (0.2, "-0.2"), (0.15, "-0.4"), (0.1, "folded")])
def test_middles_beyond_a_quarter_of_their_edge_are_reported(tmp_path, part, reported):
    """x = xi (1 + xi)/2 + part (1 - xi^2) has the slope 2 part - 1/2 at xi = -1, and 1/2 on average.

    With middles at a quarter (Barsoum 1976, for cracks) it is 0.
    """
    table, said = looked_at(meshed(tmp_path, Moved((0.3, 0.2, 0.1), (1, 1, 1), "C3D20R", part=part)))
    if reported in ("", "folded"):
        assert (table is None) == bool(reported) == len(said)
        return
    assert len(said) == 1
    assert "element 1 is distorted" in said[0] and f"is {reported} of its mean; stresses there" in said[0]
