"""Elastic bodies as `flexmb new dafms` asks for them: a uniform beam, or nodes and stiffness typed."""

from ...deck import number
from ...deck.questions import INTEGER, Cell, Entry
from ...errors import DeckError
from .beam import Beam
from .deck_writer import beam_of

MOST_TYPED = 60
"""Largest number of elastic coordinates whose stiffness is asked for entry by entry."""


class Answers:
    """Answers so far as integers; what is missing or misspelt counts as `default`."""

    def __init__(self, values: dict[str, str]):
        self.values = values

    def integer(self, name: str, default: int = 0) -> int:
        """The integer of that name."""
        try:
            return number.integer(self.values[name])[0]
        except (KeyError, number.Misspelt):
            return default

    def kind(self, k: int) -> str:
        """RIGID, BEAM or TYPED."""
        return self.values.get(f"body.{k}.kind", "").upper()

    def beam(self, k: int) -> Beam | None:
        """The beam of body `k`, None before all of it is known."""
        texts = {cell.key: self.values.get(f"beam.{k}.{cell.key}") for cell in _beam_entry(k).cells}
        try:
            return beam_of({key: float(number.real(t)[0]) if t else None for key, t in texts.items()})
        except (DeckError, number.Misspelt, TypeError, ValueError):
            return None

    def axes(self, k: int) -> tuple[tuple[int, ...], int]:
        """Axes of the nodal displacements of body `k` and its number of nodes."""
        if self.kind(k) == "BEAM" and (beam := self.beam(k)):
            return beam.axes, beam.nodes
        if self.kind(k) != "TYPED":
            return (), 0
        dofs, nodes = self.integer(f"elastic.{k}.NDF"), self.integer(f"elastic.{k}.NUMNP")
        sensible = 1 <= dofs <= 3 and 1 <= nodes * dofs <= MOST_TYPED
        return (tuple(range(4 - dofs, 4)), nodes) if sensible else ((), 0)


def _beam_entry(k: int) -> Entry:
    cells = (
        Cell("length", "length, clamped at its first end, along axis 2", "m"),
        Cell("nodes", "elements, each with a node at its end", letter=INTEGER),
        Cell("EI", "bending stiffness for deflection along axis 3", "N m^2"),
        Cell("rho", "mass per length", "kg/m"),
        Cell("offset", "clamped end from O_k", "m", default="0"),
        Cell("EA", "axial stiffness; adds displacement along axis 2", "N", default=""),
        Cell("EI_1", "bending stiffness for deflection along axis 1; needs EA", "N m^2", default=""),
        Cell("tip_mass", "mass added to the last node", "kg", default="0"),
    )
    return Entry("beam", k, f"beam of body {k}", cells)


def block_entries(answers: Answers, k: int) -> list[Entry]:
    """The records of the elastic block of body `k`."""
    if answers.kind(k) == "BEAM":
        return [_beam_entry(k)]
    if answers.kind(k) != "TYPED":
        return []
    counts = (
        Cell("NUMNP", "number of nodes", letter=INTEGER),
        Cell("NDF", "elastic degrees of freedom of a node: 1 axis 3, 2 axes 2 and 3, 3 all", letter=INTEGER),
    )
    entries = [Entry("elastic", k, f"nodes of body {k}", counts)]
    dofs, nodes = answers.axes(k)
    size = len(dofs) * nodes
    if not size:
        return entries
    axes = (2, 3) if answers.integer("counts.NDM") == 2 else (1, 2, 3)
    entries += [_node_entry(k, i, axes) for i in range(1, nodes + 1)]
    heights = [Cell(f"h({j})", f"stored entries of column {j}", "", INTEGER, str(j)) for j in counted(size)]
    entries.append(Entry("skyline", k, f"stiffness of body {k}", tuple(heights)))
    for j in counted(size):
        height = answers.integer(f"skyline.{k}.h({j})")
        rows = range(max(1, j - height + 1), j + 1) if height > 0 else ()
        if rows:
            cells = tuple(Cell(f"K({i},{j})", "stiffness", "N/m") for i in rows)
            entries.append(Entry(f"stiffness.{k}", j, f"stiffness of body {k}, column {j}", cells))
    masses = tuple(Cell(f"BMI({i})", "nodal mass", "kg") for i in counted(nodes))
    return [*entries, Entry("nodal_mass", k, f"nodal masses of body {k}", masses)]


def counted(last: int) -> range:
    """1 ... last."""
    return range(1, last + 1)


def _node_entry(k: int, i: int, axes: tuple[int, ...]) -> Entry:
    cells = [Cell(f"CO.{a}", f"position from O_k, axis {a}", "m") for a in axes]
    cells += [Cell(f"PI.{a}", f"force, inertial axes, axis {a}", "N", default="0") for a in axes]
    return Entry(f"node.{k}", i, f"node {i} of body {k}", tuple(cells))
