"""A tree by two formulations: Kane's equations and absolute coordinates."""

from collections.abc import Iterator
from dataclasses import replace
from functools import partial
from typing import Any

import numpy as np

from ...deck.record import Deck
from ...model.integrators import IMPLICIT_TREE_METHODS
from ...model.laws import DRIVING
from ...model.tree import ELASTIC, ROTATION, TRANSLATION, Tree
from ...solvers.tree.breakpoints import breakpoints
from ..outcome import Listener, Run
from ..solutions.tree import absolute_analysis, kane_analysis, values_of
from .verify import ELEMENTS, Difference, Size, compared_rows, largest_difference

FORMULATIONS = "Kane's equations and absolute coordinates"
# Both integrate more closely than they are compared; deflections are small against a metre.
EXPLICIT = {"method": "dop853", "rtol": 1e-11, "atol": 1e-13}
# Steps of Radau's method are many more by each power of ten.
IMPLICIT = {"method": "radau", "rtol": 1e-10, "atol": 1e-12}

ENERGIES = ("kinetic", "potential", "strain", "total")
POINTS = {"position": "m", "velocity": "m/s"}


def differences(tree: Tree, deck: Deck, run: Run) -> tuple[Difference, ...]:
    """Run `tree` both ways and return what the motions differ in.  Raises FlexmbError."""
    # Elastic bodies alone are slow, but not too slow, by explicit steps.
    acting = any(item.law not in DRIVING for item in tree.elements.forces)
    stiff = acting and tree.integration.method in IMPLICIT_TREE_METHODS
    given: dict[str, Any] = (IMPLICIT if stiff else EXPLICIT) | run.options.integration
    tree = replace(tree, integration=replace(tree.integration, **given))
    largest = compare(tree, *_motions(tree, run))
    run.outcome.rows = tree.time.rows
    return largest


def _motions(tree: Tree, run: Run) -> Any:
    """Values of both formulations, whole runs by the paths of their datasets."""
    analyses = absolute_analysis(tree, run), kane_analysis(tree, run)
    run.listener.begin(2 * tree.time.rows)
    absolute, kane = (
        _joined([values_of(tree, rows) for rows in _heard(compared_rows(analysis), run.listener)])
        for analysis in analyses
    )
    return kane, absolute


def _heard(blocks: Any, listener: Listener) -> Iterator[Any]:
    for block in blocks:
        yield block
        listener.advance(len(block.time))


def _joined(blocks: Any) -> Any:
    return {path: np.concatenate([block[path] for block in blocks]) for path in blocks[0]}


def compare(
    tree: Tree, kane: dict[str, np.ndarray], absolute: dict[str, np.ndarray]
) -> tuple[Difference, ...]:
    """Return what two motions of a tree differ in, quantity by quantity."""
    size = _size(tree, kane)
    differ = partial(largest_difference, time=kane["time"], size=size)
    differences = [*_coordinates(tree, size, kane, absolute)]
    for kind, unit in POINTS.items():
        for place in ("body", "point"):
            path = f"{place}/{kind}"
            differences.append(differ(f"{place} {kind}", unit, one=kane[path], other=absolute[path]))
    attitudes = kane["body/euler_parameters"], absolute["body/euler_parameters"]
    # p and -p are one attitude.
    signs = np.where(np.sum(attitudes[0] * attitudes[1], axis=-1, keepdims=True) < 0, -1.0, 1.0)
    differences.append(differ("body attitude", "1", one=attitudes[0], other=signs * attitudes[1]))
    path = "body/angular_velocity"
    differences.append(differ("body angular velocity", "rad/s", one=kane[path], other=absolute[path]))
    moved = max(np.max(np.abs(kane[f"energy/{name}"])) for name in ("kinetic", "strain"))
    for name in ENERGIES if _moves_freely(tree) else ENERGIES[:-1]:
        one, other = kane[f"energy/{name}"], absolute[f"energy/{name}"]
        differences.append(differ(f"{name} energy", "J", one=one, other=other, scale=moved))
    compared = ELEMENTS | {"driver/effort": ("driver effort", "N, N m")}
    start, end = tree.time.start, tree.time.end
    jumps = np.array(breakpoints(tree, start, end))
    # Where a table jumps, one formulation has the efforts before it and the other those after it.
    steady = ~np.isclose(kane["time"][:, None], jumps, rtol=0.0, atol=1e-9 * (end - start)).any(axis=1)
    for path, (name, unit) in compared.items():
        if path in kane and kane[path].size:
            pair = kane[path][steady], absolute[path][steady]
            if path == "coupling/effort":
                # Where couplings repeat each other, only what they do along the coordinates is unique.
                pair = pair[0] @ _factors(tree), pair[1] @ _factors(tree)
            differences.append(largest_difference(name, unit, kane["time"][steady], *pair, size, None))
    if "element/work" in kane and kane["element/work"].size and _moves_freely(tree):
        pair = kane["element/work"], absolute["element/work"]
        # No step controls the error of a work: against all energy that moves, it is as small as theirs.
        most = max(moved, float(np.max(np.abs(pair[0]))))
        differences.append(differ("element work", "J", one=pair[0], other=pair[1], scale=most))
    return tuple(differences)


def _factors(tree: Tree) -> np.ndarray:
    """Factors (couplings, NS) of the coordinates."""
    number = {(c.body, f"{c.motion} {c.axis}"): m for m, c in enumerate(tree.coordinates)}
    factors = np.zeros((len(tree.elements.couplings), len(number)))
    for row, item in zip(factors, tree.elements.couplings, strict=True):
        for body, coordinate, factor in item.terms[: 1 if item.function else None]:
            row[number[body, coordinate]] += factor
    return factors


def _size(tree: Tree, kane: dict[str, np.ndarray]) -> Size:
    """Return the size of a tree, its length from where bodies and points come."""
    places = (kane["body/position"], kane["point/position"])
    length = max(float(np.max(np.abs(place), initial=0.0)) for place in places)
    return Size(length, tree.time.end - tree.time.start, sum(body.mass for body in tree.bodies))


def _moves_freely(tree: Tree) -> bool:
    """Return whether a coordinate is left free; else the work of drivers is a sum that no step controls."""
    elements = tree.elements
    held = len(tree.prescribed) + len(elements.drivers) + len(elements.couplings)
    return held + sum(len(c.directions) for c in tree.closures) < len(tree.coordinates)


def _coordinates(tree: Tree, size: Size, kane: dict[str, np.ndarray], absolute: Any) -> Iterator[Any]:
    """Coordinates and speeds by type; integrals of angular velocities are no coordinates of a position."""
    kinds = np.array([c.motion for c in tree.coordinates])
    ball = [c.motion == ROTATION and len(tree.hinges[c.body].rotations) == 3 for c in tree.coordinates]
    for kind, unit in ((ROTATION, "rad"), (TRANSLATION, "m"), (ELASTIC, "m")):
        for path, name, per in (("coordinate/q", "coordinates", ""), ("coordinate/u", "speeds", "/s")):
            own = kinds == kind
            if path == "coordinate/q":
                own &= ~np.array(ball, bool)
            if own.any():
                pair = kane[path][:, own], absolute[path][:, own]
                yield largest_difference(f"{kind} {name}", unit + per, kane["time"], *pair, size)
