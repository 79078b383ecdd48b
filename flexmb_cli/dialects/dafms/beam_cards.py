"""A beam as cards of FMBD.DAT: its FE block, a deck around it, or in the place of a body of a deck."""

from typing import Any

import numpy as np

from ...deck.fortran_fields import indexed, integer_list, real_list
from ...deck.record import Deck, Number
from ...errors import DeckError, Fault
from .beam import Beam, full_columns

# Skyline addresses stand in I5 fields.
_LARGEST_ADDRESS = 99_999


def beam_block(beam: Beam, dimension: int = 2) -> str:
    """The records DFIN reads for `beam` (thesis of Zhao, 1992, appendix C), lines ended by LF.

    `dimension` is the deck's NDM: 2 gives axes 2 and 3 of the nodes, 3 all of them.  `DeckError` when
    the skyline does not fit its columns.
    """
    addresses, packed = full_columns(beam.stiffness)
    if addresses[-1] > _LARGEST_ADDRESS:
        message = f"{len(addresses)} elastic coordinates: skyline addresses end at {_LARGEST_ADDRESS} (I5)"
        raise DeckError([Fault("error", message, None, "beam", id="DAFMS-004")])
    if not np.isfinite(packed).all():
        raise DeckError(
            [
                Fault(
                    "error", "the stiffness of an element is too large a number", None, "beam", id="DAFMS-005"
                )
            ]
        )
    before = [0.0] * (dimension - 2)
    nodes = range(1, beam.nodes + 1)
    zero = [0.0] * dimension
    return "".join(
        (
            *(indexed(i, [*before, x, 0.0]) for i, x in zip(nodes, beam.positions, strict=True)),
            *(indexed(i, zero) for i in nodes),
            integer_list([len(addresses)]),
            integer_list(range(1, len(addresses) + 1)),
            integer_list(addresses),
            real_list(packed, 13, 6),
            real_list(beam.masses, 10, 10),
        )
    )


def beam_deck(beam: Beam, title: str, steps: int = 500, step: float = 0.001) -> str:
    """A whole deck: the beam turning about axis 1 of its root, at rest, under gravity along axis 2."""
    dimension = 3 if 1 in beam.axes else 2
    coordinates = 1 + beam.nodes * len(beam.axes)
    attitude = [0.0, 0.0, 0.0, 1.0]
    return "".join(
        (
            integer_list([1, dimension]),
            f"DFMB {title}"[:80] + "\n",
            integer_list([1, 0, 0, 0, 0]),
            integer_list([1, 1, 1, 0, 0]),
            integer_list([beam.nodes]),
            integer_list([len(beam.axes)]),
            integer_list([steps]),
            real_list([step], 10, 1),
            beam_block(beam, dimension),
            f"CONN\n{integer_list([0])}",
            f"MASS\n{indexed(1, [beam.mass])}",
            f"INER\n{indexed(1, [beam.inertia, 0.0, beam.inertia])}",
            f"EULT\n{indexed(1, attitude)}EULL\n{indexed(1, attitude)}",
            f"Y(L)\n{real_list(np.zeros(2 * coordinates), 10, 5)}",
            "END \nSTAR\nSTOP\n",
        )
    )


def with_beam(deck: Deck, body: int, beam: Beam) -> str:
    """The text of `deck` with `beam` as the FE block of `body`, counted from 1; all else is kept.

    NUMNP, NDF, X(L) and Y(L) follow; the body's own elastic coordinates start at rest from zero.  MASS
    and INER of the body stay as they are: `beam.mass` and `beam.inertia` are the beam's share of them.
    """
    counts = deck.section("counts")
    if not 1 <= body < len(counts):
        message = f"body {body}: the deck has bodies 1 to {len(counts) - 1}"
        raise DeckError([Fault("error", message, None, "beam", id="DAFMS-006")])
    if 1 in beam.axes and counts[0]["NDM"] == 2:
        message = "deflection along axis 1 needs a deck with NDM = 3"
        raise DeckError([Fault("error", message, counts[0].at("NDM").place, "beam", id="DAFMS-007")])
    lines = list(deck.source.lines)
    replaced = _replacements(deck, body, beam)
    for first, last, text in sorted(replaced, key=lambda item: item[0], reverse=True):
        lines[first - 1 : last] = text.splitlines()
    return "\n".join(lines)


def _replacements(deck: Deck, body: int, beam: Beam) -> list[tuple[int, int, str]]:
    """Triples (first line, last line, new text), not overlapping; an insertion has last = first - 1."""
    bodies = deck.section("counts")[1:]
    nodes = [record["NUMNP"] for record in bodies]
    dofs = [record["NDF"] for record in bodies]
    start = sum(record["NT"] + record["NR"] for record in bodies)
    start += sum(n * f for n, f in zip(nodes[: body - 1], dofs, strict=False))
    old = nodes[body - 1] * dofs[body - 1]
    new = beam.nodes * len(beam.axes)
    changes = [_block_change(deck, body, beam)]
    nodes[body - 1], dofs[body - 1] = beam.nodes, len(beam.axes)
    for key, values in (("NUMNP", nodes), ("NDF", dofs)):
        changes.append(_span([record.at(key) for record in bodies], integer_list(values)))
    vectors = {name: _numbers(deck, name) for name in ("speed", "coordinate", "first_coordinate")}
    if vectors["speed"]:
        values = [
            *_spliced(vectors["speed"], start, old, new),
            *_spliced(vectors["coordinate"], start, old, new),
        ]
        changes.append(_span(vectors["speed"] + vectors["coordinate"], real_list(values, 10, 5)))
    if vectors["first_coordinate"]:
        values = _spliced(vectors["first_coordinate"], start, old, new)
        changes.append(_span(vectors["first_coordinate"], real_list(values, 10, 5)))
    return changes


def _numbers(deck: Deck, section: str) -> list[Number]:
    return [record.numbers[0] for record in deck.section(section)]


def _span(numbers: Any, text: str) -> tuple[int, int, str]:
    lines = [number.place.line for number in numbers]
    return min(lines), max(lines), text


def _spliced(numbers: list[Number], start: int, old: int, new: int) -> list[float]:
    values = [number.value for number in numbers]
    return [*values[:start], *new * [0.0], *values[start + old :]]


def _block_change(deck: Any, body: Any, beam: Beam) -> tuple[int, int, str]:
    """The lines of the body's FE block, or the place where it must be inserted."""
    text = beam_block(beam, deck.one("counts")["NDM"])
    masses = {record.number: record.numbers[-1].place.line for record in deck.section("bmi")}
    if body in masses:
        first = deck.section(f"node.{body}")[0].place.line
        return first, masses[body], text
    before = [line for k, line in masses.items() if k < body]
    after = max(before) if before else deck.one("time").at("H").place.line
    return after + 1, after, text
