"""Text about the flexible bodies of a deck: inertia, tests passed, frequencies, effective masses."""

import itertools
import math
import textwrap
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from collections.abc import Iterator

    import numpy as np


ZERO_COMPONENT = 1e-12
_SHARES = ("x", "y", "z", "about x", "about y", "about z")


def body_lines(body: Any, precision: bool = False) -> list[str]:
    """Return inertia, what was left out, frequencies and effective masses of one flexible body.

    With `precision` each frequency has the relative error that the digits of the files leave it.
    """
    return [*_inertia_lines(body), *_dropped_lines(body), *_mode_lines(body, precision)]


def _inertia_lines(body: Any) -> "Iterator[str]":
    yield f"  {body.name}: nodes {len(body.numbers)}, modes {body.modes}, mass {body.m:.9g} kg"
    size, J = abs(body.r0).max(), body.J0
    yield f"    frame at {_vector(body.origin, size)} m of the node table, e1 {_vector(body.axes[:, 0], 1.0)}"
    yield f"    centre of mass {_vector(body.centre, size)} m"
    yield f"    inertia about the origin: xx yy zz {_vector(J.diagonal(), J.max())} kg m^2"
    yield f"                              xy yz zx {_vector([J[0, 1], J[1, 2], J[2, 0]], J.max())} kg m^2"
    yield (
        f"    mass differs between directions by {body.mass_deviation:.1e}, "
        f"stiffness resists rigid motion by {body.rigid_residual:.1e} of the largest entry"
    )


def _vector(values: "list[float] | np.ndarray", scale: float) -> str:
    """Components, those that are zero but for round-off as 0."""
    return " ".join(f"{value:.6g}" if abs(value) > ZERO_COMPONENT * scale else "0" for value in values)


def _dropped_lines(body: Any) -> "Iterator[Any]":
    dropped = body.dropped
    if dropped.internal:
        yield f"    internal degrees of freedom condensed: {dropped.internal}"
    if dropped.dependent:
        yield f"    static shapes dropped, superfluous beside the others or held: {dropped.dependent}"
        names = _of_nodes(dropped.shapes)
        yield from textwrap.wrap(f"at nodes {names}", 100, initial_indent=6 * " ", subsequent_indent=8 * " ")
    if body.massless:
        yield (
            f"    shapes without mass: {body.massless}; they answer loads as in statics (the last, with the "
            "highest frequency of the others)"
        )
    if body.massless_in_motion:
        yield (
            f"    deformations without mass once the nodes of the frame move: {body.massless_in_motion}; "
            "they answer loads as in statics"
        )
    if dropped.modes:
        following = dropped.next_frequency
        first = "" if math.isnan(following) else f", the first at {following:.6g} Hz"
        yield f"    modes left out: {dropped.modes}{first}"


def _of_nodes(shapes: tuple[tuple[int, str], ...]) -> str:
    """Nodes, each with its axes: 5 e1 e2, 7 e3."""
    nodes = itertools.groupby(shapes, key=lambda shape: shape[0])
    return ", ".join(" ".join([str(node), *(axis for _, axis in group)]) for node, group in nodes)


def _mode_lines(body: Any, precision: bool) -> "Iterator[str]":
    """Frequencies, and the share that each mode has in motion along and about the body's axes."""
    error = f" {'error':>8}" if precision else ""
    yield (
        f"    {'mode':>4} {'rad/s':>13} {'Hz':>13}{error}  share of effective mass, %: " + ", ".join(_SHARES)
    )
    limits = [limit if limit > 1e-12 * body.m else math.inf for limit in body.effective_limit]
    for row, masses in enumerate(body.effective_mass):
        yield f"    {row + 1:4d} {_frequency(body, row, precision)}  {_percent(masses, limits)}"
    empty = " " * len(error)
    yield f"    {'sum':>4} {'':13} {'':13}{empty}  {_percent(body.effective_mass.sum(axis=0), limits)}"


def _frequency(body: Any, row: int, precision: bool) -> str:
    """rad/s, Hz and relative error; a shape without mass has none."""
    if row >= body.modes - body.massless:
        return f"{'static':>13} {'':13}" + " " * 9 * precision
    frequency, error = body.frequencies[row], body.frequency_errors[row]
    return f"{frequency * math.tau:13.6f} {frequency:13.6f}" + (f" {error:8.0e}" if precision else "")


def _percent(masses: "np.ndarray", limits: list[float]) -> str:
    return " ".join(f"{100 * mass / limit:6.2f}" for mass, limit in zip(masses, limits, strict=True))
