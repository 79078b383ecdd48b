"""The listing of a VSDF deck: cards, bodies, frequencies, constraints, and output nodes in time."""

from collections.abc import Iterator
from typing import TYPE_CHECKING, Any

import numpy as np

from ...deck.body_text import body_lines
from ...deck.edit import SAFE, I, P
from ...deck.fortran_format import Layout
from ...deck.record import Deck

if TYPE_CHECKING:
    from ...model.flexible_mechanism import FloatingBody


_RULE = "*" * 78
FAILED = "THE RUN ENDED BEFORE THE LAST TIME"
TIME_FIELDS, ENERGY_FIELDS = (P(13, 5),), 4 * (P(13, 5),)
NODE_FIELDS = (I(10), I(8), *6 * (P(13, 5),))  # body, node, position and velocity
SMALLEST_PRINTED = 1e-12  # smaller singular values are round-off, another on other processors


class VsdfTable:
    """The listing in the making, in the first of `streams`.

    `analysis` has the `mechanism` and, where that could be assembled, what was `found` of its equations.
    """

    def __init__(self, streams: tuple[Any, ...], deck: Deck, layout: str, analysis: Any):
        self.stream, self.deck, self.analysis = streams[0], deck, analysis
        self.mechanism = analysis.mechanism
        nodes = len(self.mechanism.outputs) * (*NODE_FIELDS, "\n")
        parts = " TIME =", *TIME_FIELDS, "\n", *nodes, " ENERGY", *ENERGY_FIELDS, "\n"
        self.row = Layout(*parts, layout=layout or SAFE)

    def begin(self) -> None:
        """Everything above the rows."""
        lines = [_RULE, *self._cards(), _RULE]
        for body in self.mechanism.bodies:
            lines += body_lines(body.flexible) if body.flexible else _rigid_lines(body)
        lines += [*self._constraint_lines(), "", *_HEADINGS, ""]
        self.stream.write("".join(f"{line.rstrip()}\n" for line in lines))

    def _cards(self) -> Iterator[str]:
        """The deck's lines up to STOP."""
        for line in self.deck.source.lines:
            yield line
            if line[:4].strip().upper() == "STOP":
                return

    def _constraint_lines(self) -> Iterator[str]:
        mobility = self.analysis.mobility
        if mobility is None:
            yield "  the mechanism could not be assembled"
            return
        speeds, rank = mobility.coordinates, mobility.rank
        yield f"  constraint equations {mobility.equations}, independent {rank}, speeds {speeds}"
        known = mobility.smallest >= SMALLEST_PRINTED
        smallest = f"{mobility.smallest:.3E}" if known else f"below {SMALLEST_PRINTED:.0E}"
        yield f"  degrees of freedom {speeds - rank}, smallest singular value {smallest}"

    def rows(self, values: dict[str, np.ndarray]) -> None:
        """Report rows: time, position and velocity of every output node, energies."""
        numbers = np.array([_numbers(point) for point in self.mechanism.outputs], float).reshape(-1, 2)
        count = len(values["time"])
        numbers = np.broadcast_to(numbers, (count, *numbers.shape))
        nodes = np.concatenate([numbers, values["point/position"], values["point/velocity"]], axis=2)
        kinetic, strain, potential = (values[f"energy/{name}"] for name in ("kinetic", "strain", "potential"))
        energies = [kinetic, strain, potential, kinetic + strain + potential]
        self.stream.write(
            self.row.lines(np.column_stack([values["time"], nodes.reshape(count, -1), *energies]))
        )

    def failed(self) -> None:
        """The last line of a run that did not come to its end."""
        self.stream.write(f" {FAILED}\n")

    stopped = failed


_HEADINGS = (
    "      BODY    NODE            X            Y            Z           VX           VY           VZ",
    "             KINETIC       STRAIN      GRAVITY          SUM   (J; gravity with springs)",
)


def _rigid_lines(body: "FloatingBody") -> Iterator[str]:
    centre = body.s0 / body.m
    J = body.J0
    yield f"  {body.name}: rigid, mass {body.m:.9g} kg, centre of mass {_vector(centre)} m"
    yield f"    inertia about the origin: xx yy zz {_vector(J.diagonal())} kg m^2"
    yield f"                              xy yz zx {_vector([J[0, 1], J[1, 2], J[2, 0]])} kg m^2"


def _vector(values: list[float] | np.ndarray) -> str:
    return " ".join(f"{value + 0.0:.6g}" for value in values)


def _numbers(point: Any) -> tuple[int, int]:
    """Numbers of a point's body, 0 for the ground, and of its node."""
    return point.body + 1, int(point.name.rpartition(" ")[2])
