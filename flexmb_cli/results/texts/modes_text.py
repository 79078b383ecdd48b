"""Text of the linearised motion of a mechanism: frequencies, damping, what moves most, and the position."""

from typing import TYPE_CHECKING, Any

import numpy as np

from ...deck.body_text import body_lines
from ...errors import visible
from ...model.by_size import by_size

if TYPE_CHECKING:
    from collections.abc import Iterator


SHOWN_PARTS = 3
NAMED_PART = 0.1  # of the largest part


def modes_text(report: Any) -> str:
    """Return what `flexmb modes` found (`run.modes.ModesReport`): flexible bodies, then the mechanism."""
    dialect = report.deck.dialect.upper()
    # Those of trees, which have no modes of their own here, are not counted.
    count = f", flexible bodies {len(report.bodies)}" if report.bodies else ""
    lines = [f"{visible(report.outcome.deck)}: {dialect} deck{count}"]
    for body in report.bodies:
        lines += body_lines(body, precision=True)
    if report.mechanism:
        lines += _mechanism_lines(report.mechanism)
    return "".join(f"{line.rstrip()}\n" for line in lines)


def _mechanism_lines(found: Any) -> "Iterator[Any]":
    modes = found.modes
    where = "about the equilibrium" if found.equilibrium else "of the mechanism"
    yield f"  linearised motion {where} at t = {found.time:.6g} s: DOF {len(modes.eigenvalues) // 2}"
    if not modes.constant:
        yield f"    frozen at t = {found.time:.6g} s: the coefficients change along the motion"
    if found.equilibrium:
        yield from _position_lines(found.position)
    if len(modes.frequency):
        yield f"    {'mode':>4} {'Hz':>13} {'damping ratio':>14}  moves most"
    for number, (frequency, damping, shape) in enumerate(
        zip(modes.frequency, modes.damping, modes.shapes, strict=True), start=1
    ):
        ratio = damping if abs(damping) > 1e-9 else 0.0
        yield f"    {number:4d} {frequency:13.6f} {ratio:14.6f}  {_parts(found.names, shape)}"
    for values, what in ((modes.growing, "grows"), (modes.decaying, "fades")):
        for value in values:
            yield f"    {what} without oscillating: {abs(value):.6g} 1/s"
    if modes.unheld:
        yield f"    eigenvalues of motions that nothing holds: {modes.unheld}"


def _position_lines(position: Any) -> "Iterator[Any]":
    for name, values in position:
        yield f"    {name}: " + " ".join(f"{value:.6g}" for value in np.array(values) + 0.0)


def _parts(names: Any, shape: Any) -> str:
    sizes = np.abs(shape)
    order = [k for k in by_size(sizes)[:SHOWN_PARTS] if sizes[k] >= NAMED_PART]
    return ", ".join(f"{names[k]} {sizes[k]:.2f}" for k in order)
