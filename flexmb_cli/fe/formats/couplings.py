"""Nodes that carry others rigidly or move as their mean, in the files of node tables: INP and BDF.

MSC Nastran Quick Reference Guide, RBE2, RBE3; CalculiX manual and Abaqus Keywords Reference Guide,
*RIGID BODY, *KINEMATIC COUPLING, *DISTRIBUTING COUPLING with an element DCOUP3D.
"""

from collections.abc import Callable, Iterator
from pathlib import Path
from typing import NamedTuple

from .abaqus_input import Block, blocks, integers_of, reals_of, words_of
from .abaqus_nodes import node_sets
from .bulk_data import BulkCard, bulk_cards
from .file_text import Line
from .matrix_file import FEFileFault

TRANSLATIONS, ALL = "123", "123456"

NodeSets = Callable[[str], list[int]]  # the nodes of a set by its name


class Coupling(NamedTuple):
    """A node and those that it carries (`rigid`), or whose weighted mean it is; `turns`: rotations, too."""

    node: int  # number of the node that couples
    rigid: bool  # whether it carries the members
    members: tuple[int, ...]  # numbers of their nodes
    weights: tuple[float, ...]  # of the members in the mean, no unit
    turns: bool  # whether rotations are carried, too
    line: Line  # where it stands


def read_coupling(path: Path, form: str, node: int, rigid: bool) -> Coupling:
    """Return the coupling of `node` in the file of format INP or BDF, several joined.  Raises FEFileFault."""
    readers = {"INP": _inp_couplings, "BDF": _bdf_couplings}
    if form not in readers:
        message = f"{path.name}: files of format {form} have no couplings; name the nodes on the card"
        raise FEFileFault(message, id="FE-257")
    couplings = [one for one in readers[form](path, node) if (one.node, one.rigid) == (node, rigid)]
    if not couplings:
        names = "*RIGID BODY, *KINEMATIC COUPLING; RBE2" if rigid else "*DISTRIBUTING COUPLING; RBE3"
        raise FEFileFault(f"{path.name} couples no nodes to node {node} ({names})", id="FE-258")
    first = couplings[0]
    if any(one.turns != first.turns for one in couplings):
        raise first.line.fault(f"node {node} is coupled with rotations and without; take one", id="FE-259")
    members = tuple(member for one in couplings for member in one.members)
    return first._replace(members=members, weights=tuple(w for one in couplings for w in one.weights))


def _bdf_couplings(path: Path, _node: int) -> Iterator[Coupling]:
    for card in bulk_cards(path, ("RBE2", "RBE3")):
        if card.name == "RBE2":
            turns = _turns(card, 2)
            fields = [i for i in range(3, len(card.fields)) if card.fields[i] and "." not in card.fields[i]]
            members = tuple(card.integer(i, "a grid point") for i in fields)
            weights = (1.0,) * len(members)
            yield Coupling(card.integer(1, "a grid point"), True, members, weights, turns, card.line)
        else:
            members, weights = _weighted(card)
            yield Coupling(card.integer(2, "a grid point"), False, members, weights, False, card.line)


def _turns(card: BulkCard, field: int) -> bool:
    """Return whether components are 123456; False for 123."""
    if card.field(field) not in (TRANSLATIONS, ALL):
        message = f"components {card.field(field)}: expected 123456 or 123"
        raise card.card_fault(message, id="FE-260")
    return card.field(field) == ALL


def _weighted(card: BulkCard) -> tuple[tuple[int, ...], tuple[float, ...]]:
    """Return points and weights of RBE3: a weight, components, and their points, again and again."""
    members: list[int] = []
    weights: list[float] = []
    weight, fields = 0.0, iter([i for i in range(4, len(card.fields)) if card.fields[i]])
    for i in fields:
        if card.fields[i].upper() == "ALPHA":
            break
        if card.fields[i].upper() == "UM":
            raise card.card_fault("dependent points of UM are not read; leave them out", id="FE-261")
        if "." in card.fields[i]:
            weight = card.real(i, "a weight")
            _turns(card, next(fields, len(card.fields)))
            continue
        members.append(card.integer(i, "a grid point"))
        weights.append(weight)
    return tuple(members), tuple(weights)


def _inp_couplings(path: Path, node: int) -> Iterator[Coupling]:
    """Couplings, of which only those of `node` must be readable."""
    members = node_sets(path)
    readers = {"RIGID BODY": _rigid_body, "KINEMATIC COUPLING": _kinematic, "COUPLING": _of_surface}
    of_elements: dict[str, int] = {}  # the node of an element DCOUP3D, by the name of its set
    for block in blocks(path):
        named = block.options.get("ELSET", "")
        if block.keyword == "ELEMENT" and block.options.get("TYPE") == "DCOUP3D" and block.data:
            of_elements[named] = integers_of(block.data[0], words_of(block.data[0]))[1]
        elif block.keyword == "DISTRIBUTING COUPLING" and of_elements.get(named) == node:
            rows = [(member, weight) for line in block.data for member, weight in _loaded(line, members)]
            yield Coupling(
                node, False, tuple(m for m, _ in rows), tuple(w for _, w in rows), False, block.line
            )
        elif block.keyword in readers and block.options.get("REF NODE") == str(node):
            numbers, turns = readers[block.keyword](block, members)
            yield Coupling(node, True, tuple(numbers), (1.0,) * len(numbers), turns, block.line)


def _rigid_body(block: Block, members: NodeSets) -> tuple[list[int], bool]:
    block.refuse_others("NSET", "TIE NSET", "PIN NSET", "REF NODE", "ROT NODE")
    pinned = "PIN NSET" in block.options
    names = [block.options[name] for name in ("NSET", "TIE NSET", "PIN NSET") if name in block.options]
    if len(names) != 1:
        raise block.line.fault("expected one set of nodes: NSET, TIE NSET or PIN NSET", id="FE-262")
    return members(names[0]), not pinned


def _kinematic(block: Block, members: NodeSets) -> tuple[list[int], bool]:
    numbers: list[int] = []
    ends: set[tuple[str, ...]] = set()
    for line in block.data:
        name, *directions = words_of(line)
        ends.add(tuple(directions) or ("1", "6"))
        numbers += _nodes(line, name, members)
    if not ends <= {("1", "3")} and not ends <= {("1", "6")}:
        message = "expected directions 1 to 6, or 1 to 3, the same for all nodes"
        raise block.line.fault(message, id="FE-263")
    return numbers, ends != {("1", "3")}


def _of_surface(block: Block, members: NodeSets) -> tuple[list[int], bool]:
    message = "surfaces of *COUPLING are not read; name the nodes on the card, or on *KINEMATIC COUPLING"
    raise block.line.fault(message, id="FE-264")


def _loaded(line: Line, members: NodeSets) -> list[tuple[int, float]]:
    """Return the nodes of a line, a node or a set, with their weight, 1 without one."""
    name, *weights = words_of(line)
    weight = reals_of(line._replace(text=weights[0]), 1)[0] if weights and weights[0] else 1.0
    return [(number, weight) for number in _nodes(line, name, members)]


def _nodes(line: Line, name: str, members: NodeSets) -> list[int]:
    """Return the nodes of a set, or the one of that number."""
    numbers = integers_of(line, [name]) if name.isdecimal() else members(name)
    if not numbers:
        raise line.fault(f"there is no node set {name}", id="FE-265")
    return numbers
