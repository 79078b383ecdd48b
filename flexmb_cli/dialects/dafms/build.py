"""FMBD.DAT → Tree: what the cards of DAFMS mean (thesis of Zhao, 1992, chapter 2 and appendix C)."""

from pathlib import Path
from typing import Any

from ...deck.record import Deck
from ...deck.records import DeckValues
from ...errors import Fault, ModelError
from ...model.diagnostics import LARGEST_NUMBER, Findings
from ...model.inertia_checks import check_inertia
from ...model.tree import Tree
from ..elements_block.line import SECTION as ELEMENTS
from .bodies import build_bodies
from .hinges import build_hinges
from .start import build_integration, build_start, build_time
from .time_functions import build_closures, build_functions_of_time

HERE = Path()
GRAVITY = (0.0, 9.8, 0.0)


def build_dafms(deck: Deck, folder: Path = HERE) -> tuple[Tree, list[Fault]]:
    """The tree that `deck` describes, and what was doubtful.

    Raises `ModelError` with all faults found, the deck's own warnings among them.
    """
    values, findings = DeckValues(deck), Findings()
    _check_magnitudes(deck, findings)
    _stop_at_errors(deck, findings)
    bodies = build_bodies(values, findings)
    hinges = build_hinges(values, bodies, findings)
    time = build_time(values, findings)
    integration = build_integration(values, findings)
    _stop_at_errors(deck, findings)
    functions = build_functions_of_time(values, bodies, hinges, findings)
    closures = build_closures(values, bodies, findings)
    _stop_at_errors(deck, findings)
    q, y = build_start(values, bodies, hinges, functions["prescribed"], findings)
    shapes = _shapes(values, findings)
    one_way = values.record("one_way") is not None
    gravity = tuple(values.values("gravity", 0, (0, *GRAVITY))[1:])
    tree = Tree(
        bodies,
        hinges,
        q,
        y,
        time,
        gravity,
        closures=closures,
        one_way=one_way,
        integration=integration,
        shapes=shapes,
        **functions,
    )
    if lines := values.section(ELEMENTS):
        # They need much of the models of other dialects.
        from .block_elements import with_elements

        tree = with_elements(tree, lines, folder, findings)
    _stop_at_errors(deck, findings)
    _check_dof(tree, values, findings)
    check_inertia(tree, values, findings)
    _stop_at_errors(deck, findings)
    return tree, findings.in_order


def _shapes(values: DeckValues, findings: Findings) -> Any:
    if not values.section("shape"):
        return ()
    from ..body_shapes import Keys, build_shapes

    keys = Keys("K", "IS", ("SA", "SB", "SC"), ("SO1", "SO2", "SO3"), ("SW1", "SW2", "SW3"))
    count = values.number("counts", 0, "N").value
    rigid = [values.number("counts", k, "NUMNP").value == 0 for k in range(1, count + 1)]
    return build_shapes(values, rigid, HERE, findings, keys)


def _stop_at_errors(deck: Deck, findings: Findings) -> None:
    if any(fault.severity == "error" for fault in findings.faults):
        raise ModelError((*deck.warnings, *findings.in_order))


def _check_magnitudes(deck: Deck, findings: Findings) -> None:
    for name, number in deck.numbers():
        if not isinstance(number.value, str) and not abs(number.value) <= LARGEST_NUMBER:
            findings.error(
                name,
                f"{number.value:g} is too large: numbers end at {LARGEST_NUMBER:g}",
                number.place,
                id="DAFMS-021",
            )


def _check_dof(tree: Tree, values: DeckValues, findings: Findings) -> None:
    if not tree.coordinates:
        message = "no hinge is free and no body is flexible: nothing can move"
        findings.error("counts", message, values.place("counts"), id="DAFMS-022")
