"""The listing of a VSDF deck: cards, bodies, frequencies, constraints, and output nodes in time."""

import numpy as np

from ...deck.body_text import body_lines
from ...deck.fortran_format import SAFE, I, Layout, P
from ...deck.record import Deck
from ...model.flexible_mechanism import FlexibleMechanism

_RULE = "*" * 78


class VsdfTable:
    """The listing in the making.

    `constraints()` tells (equations, speeds, rank, smallest singular value), or None where the mechanism
    could not be assembled.
    """

    def __init__(self, stream, deck: Deck, layout: str, mechanism: FlexibleMechanism, constraints):
        self.stream, self.deck, self.mechanism, self.constraints = stream, deck, mechanism, constraints
        time, energy = (" TIME =", P(13, 5), "\n"), (" ENERGY", *4 * (P(13, 5),), "\n")
        node = (I(10), I(8), *6 * (P(13, 5),), "\n")
        self.row = Layout(*time, *len(mechanism.outputs) * node, *energy, layout=layout or SAFE)

    def begin(self) -> None:
        """Everything above the rows."""
        lines = [_RULE, *self._cards(), _RULE]
        for body in self.mechanism.bodies:
            lines += body_lines(body.flexible) if body.flexible else _rigid_lines(body)
        lines += [*self._constraint_lines(), "", *_HEADINGS, ""]
        self.stream.write("".join(f"{line.rstrip()}\n" for line in lines))

    def _cards(self):
        """The deck's lines up to STOP."""
        for line in self.deck.source.lines:
            yield line
            if line[:4].strip().upper() == "STOP":
                return

    def _constraint_lines(self):
        found = self.constraints()
        if found is None:
            yield "  the mechanism could not be assembled"
            return
        equations, speeds, rank, smallest = found
        yield f"  constraint equations {equations}, independent {rank}, speeds {speeds}"
        yield f"  degrees of freedom {speeds - rank}, smallest singular value {smallest:.3E}"

    def rows(self, rows) -> None:
        """Report rows: time, position and velocity of every output node, energies."""
        numbers = np.array([_numbers(point) for point in self.mechanism.outputs], float).reshape(-1, 2)
        count = len(rows.time)
        numbers = np.broadcast_to(numbers, (count, *numbers.shape))
        nodes = np.concatenate([numbers, rows.point_position, rows.point_velocity], axis=2)
        energies = [rows.kinetic, rows.strain, rows.potential, rows.kinetic + rows.strain + rows.potential]
        self.stream.write(self.row.lines(np.column_stack([rows.time, nodes.reshape(count, -1), *energies])))

    def failed(self) -> None:
        """The last line of a run that did not come to its end."""
        self.stream.write(" THE RUN ENDED BEFORE THE LAST TIME\n")

    stopped = failed


_HEADINGS = (
    "      BODY    NODE            X            Y            Z           VX           VY           VZ",
    "             KINETIC       STRAIN      GRAVITY          SUM   (J; gravity with springs)",
)


def _rigid_lines(body):
    centre = body.s0 / body.m
    J = body.J0
    yield f"  {body.name}: rigid, mass {body.m:.9g} kg, centre of mass {_vector(centre)} m"
    yield f"    inertia about the origin: xx yy zz {_vector(J.diagonal())} kg m^2"
    yield f"                              xy yz zx {_vector([J[0, 1], J[1, 2], J[2, 0]])} kg m^2"


def _vector(values):
    return " ".join(f"{value + 0.0:.6g}" for value in values)


def _numbers(point):
    """Numbers of a point's body, 0 for the ground, and of its node."""
    return point.body + 1, int(point.name.rpartition(" ")[2])
