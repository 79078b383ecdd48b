"""FMBD.DAT → Tree: what the cards of DAFMS mean (thesis of Zhao, 1992, chapter 2 and appendix C)."""

import math
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np

from ...deck.many_records import DeckValues
from ...deck.record import Deck
from ...errors import Fault, ModelError
from ...model.diagnostics import LARGEST_NUMBER, Findings
from ...model.integrators import TREE_METHODS
from ...model.mechanism import TimeGrid
from ...model.time_checks import MOST_ROWS, too_fine, unsteppable
from ...model.tree import (
    ROTATION,
    UNTURNED,
    Body,
    Coordinate,
    Hinge,
    Integration,
    Prescribed,
    Tree,
    default_tolerances,
    generalized_coordinates,
)
from ..elements_block.line import SECTION as ELEMENTS
from ..elements_block.line import mass_lines
from .bodies import build_bodies
from .hinges import build_hinges
from .inertia_checks import check_inertia
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
    if lines := values.section(ELEMENTS):
        bodies = _with_masses(bodies, lines, folder, findings)
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
    if lines:
        # They need much of the models of other dialects.
        from .block_elements import with_elements

        tree = with_elements(tree, lines, folder, findings)
    _stop_at_errors(deck, findings)
    _check_dof(tree, values, findings)
    check_inertia(tree, values, findings)
    _stop_at_errors(deck, findings)
    return tree, findings.in_order


def _with_masses(bodies: tuple[Body, ...], lines: Any, folder: Path, findings: Findings) -> tuple[Body, ...]:
    """The bodies with the masses of lines of the block; inertia is about O_k."""
    if not mass_lines(lines):
        return bodies
    # Few decks have any.
    from ...fe.solid_masses import about, combined, point_mass
    from ..elements_block.masses import added_masses

    heavier = list(bodies)
    for k, solids in added_masses(lines, [body.elastic is None for body in bodies], folder, findings).items():
        body = bodies[k]
        whole = combined([point_mass(body.mass, body.centre), *solids])
        own = sum(solid.inertia + about(solid.mass, np.array(solid.centre)) for solid in solids)
        heavier[k] = replace(body, mass=whole.mass, centre=whole.centre, inertia=body.inertia + own)
    return tuple(heavier)


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


# Five-decimal Euler parameters give an angle to about this, rad.
_ANGLE = 1e-3


def build_time(values: DeckValues, findings: Findings) -> TimeGrid:
    """IT output intervals of length H, from t = 0."""
    steps, step = values.number("time", 0, "IT"), values.number("time", 0, "H")
    if steps.value < 1:
        findings.error(
            "time", f"IT = {steps.value} integration steps, need at least 1", steps.place, id="DAFMS-045"
        )
    if steps.value >= MOST_ROWS:
        findings.error(
            "time", f"IT = {steps.value}: more than {MOST_ROWS} report times", steps.place, id="DAFMS-046"
        )
    if not step.value > 0 or not math.isfinite(step.value):
        message = f"H = {step.value} s: the length of a step must be above zero"
        findings.error("time", message, step.place, id="DAFMS-047")
    elif fault := unsteppable(steps.value * step.value, step.value):
        findings.error(
            "time", f"H = {step.value:g} s, IT = {steps.value}: {fault}", step.place, id="DAFMS-048"
        )
    return TimeGrid(0.0, steps.value * step.value, step.value, steps.place)


def build_integration(values: DeckValues, findings: Findings) -> Integration:
    """Cards TOLR and METH; a blank or missing tolerance keeps its default."""
    rtol, atol = values.values("tolerance", 0, (0.0, 0.0))
    if rtol < 0 or atol < 0 or rtol >= 1:
        message = f"RTOL = {rtol}, ATOL = {atol}: tolerances lie above 0, RTOL below 1"
        findings.error("TOLR", message, values.place("tolerance"), id="DAFMS-049")
    elif rtol and (fault := too_fine(rtol)):
        findings.error("TOLR", f"RTOL: {fault}", values.place("tolerance"), id="DAFMS-050")
    (method,) = values.values("method", 0, (1,))
    if not 1 <= method <= len(TREE_METHODS):
        choice = ", ".join(f"{i} {name}" for i, name in enumerate(TREE_METHODS, 1))
        findings.error(
            "METH", f"METH = {method} is not an integrator: {choice}", values.place("method"), id="DAFMS-051"
        )
        return Integration()
    relative, absolute = default_tolerances(TREE_METHODS[method - 1])
    return Integration(TREE_METHODS[method - 1], rtol or relative, atol or absolute)


def build_start(
    values: DeckValues,
    bodies: tuple[Body, ...],
    hinges: tuple[Hinge, ...],
    drives: tuple[Prescribed, ...],
    findings: Findings,
) -> tuple[np.ndarray, np.ndarray]:
    """Initial coordinates q and speeds y, both (NS,), from Y(L) and the prescribed motions at t = 0."""
    coordinates = generalized_coordinates(bodies, hinges)
    q = np.array([record["q"] for record in values.section("coordinate")] or [0.0] * len(coordinates), float)
    y = np.array([record["u"] for record in values.section("speed")] or [0.0] * len(coordinates), float)
    _check_first_coordinates(values, q, findings)
    for drive in drives:
        m = next(i for i, c in enumerate(coordinates) if (c.body, c.motion, c.axis) == _where(drive))
        _set_driven(values, (q, y), m, drive, coordinates[m].name, findings)
    _check_angles(values, coordinates, hinges, q, findings)
    return q, y


def _where(drive: Prescribed) -> tuple[int, str, int]:
    return drive.body, drive.motion, drive.axis


def _check_first_coordinates(values: DeckValues, q: np.ndarray, findings: Findings) -> None:
    if not values.section("speed"):
        message = "card 'Y(L)' is missing: the motion starts at rest from zero coordinates"
        findings.warn("", message, values.place("counts"), id="DAFMS-052")
    for m, record in enumerate(values.section("first_coordinate")):
        if abs(record["X"] - q[m]) > 1.1e-5 and not _is_set(values, m):
            message = f"X({m + 1}) = {record['X']} is not used: Y(L) gives {q[m]} for this coordinate"
            findings.warn("X(L)", message, record.place, id="DAFMS-053")
            return


def _is_set(values: DeckValues, m: int) -> bool:
    """Return whether `--set` gave the initial coordinate: old echoes are no slips then."""
    return bool(values.section("coordinate")) and values.place("coordinate", m + 1) is None


def _set_driven(
    values: DeckValues,
    state: tuple[np.ndarray, np.ndarray],
    m: int,
    drive: Prescribed,
    name: str,
    findings: Findings,
) -> None:
    """A driven coordinate starts where its function says; Y(L) may repeat it or leave it zero."""
    for vector, section, start in zip(state, ("coordinate", "speed"), (drive.C, drive.B), strict=True):
        if vector[m] and abs(vector[m] - start) > 1.1e-5 + 1e-6 * abs(start):
            message = f"{section} {m + 1} ({name}) is {vector[m]} in Y(L), but PRES starts it at {start}"
            findings.warn("Y(L)", message, values.place(section, m + 1), id="DAFMS-054")
        vector[m] = start


def _check_angles(
    values: DeckValues,
    coordinates: tuple[Coordinate, ...],
    hinges: tuple[Hinge, ...],
    q: np.ndarray,
    findings: Findings,
) -> None:
    """With one free rotation EULT is an echo of the angle in Y(L) (listing, SOK); say when it differs."""
    if not values.section("attitude"):
        return
    for m, c in enumerate(coordinates):
        hinge = hinges[c.body]
        if c.motion != ROTATION or len(hinge.rotations) != 1 or hinge.attitude == UNTURNED:
            continue
        if _is_set(values, m):
            continue
        echo = _quadruple(c.axis, q[m])
        if abs(np.dot(echo, hinge.attitude)) < math.cos(_ANGLE / 2):
            message = f"EULT is not used: the angle {q[m]} rad in Y(L) applies (coordinate {m + 1})"
            findings.warn(f"body {c.body + 1}", message, values.place("attitude", c.body + 1), id="DAFMS-055")


def _quadruple(axis: int, angle: float) -> list[float]:
    quadruple = [math.cos(angle / 2), 0.0, 0.0, 0.0]
    quadruple[axis] = math.sin(angle / 2)
    return quadruple
