"""A VSDF deck with all modes in two floating frames, with the reference nodes n1 and n2 exchanged.

n2 keeps to the axis through n1: the second frame has another origin, which moves against the first as the
body stretches, other axes, modes and invariants.  With all modes both hold the same deformations, and a shift
of the origin strains nothing: the two models are one and the same.
"""

from pathlib import Path

import numpy as np

from ...deck.record import Deck
from ...dialects.vsdf.build import build_vsdf
from ...errors import Fault, ModelError
from ...model.fe_model import Integrator
from ...model.flexible_mechanism import FlexibleMechanism
from ...model.vectors import rotation_matrix
from ...quick_dataclass import fields, replace
from ..outcome import Listener, Outcome, RunOptions, Stop
from ..vsdf import mechanism_of
from .difference import Difference, largest_difference

FORMULATIONS = "two floating frames, nodes n1 and n2 exchanged, all modes"
TOLERANCE = 1e-9
SERIES = (
    ("point position", "m", "point_position"),
    ("point velocity", "m/s", "point_velocity"),
    ("point acceleration", "m/s^2", "point_acceleration"),
)
FORCES = (
    ("reaction force", "N", "reaction_force"),
    ("reaction torque", "N m", "reaction_torque"),
    ("force of pins", "N", "holding_force"),
    ("driver effort", "N, N m", "driver_effort"),
)
ENERGIES = ("kinetic", "potential", "strain")


def frame_differences(
    deck: Deck, options: RunOptions, outcome: Outcome, listener: Listener
) -> tuple[Difference, ...]:
    """Run `deck` in both frames and return what the motions differ in.  Raises FlexmbError."""
    _refuse_unequal(deck)
    first = mechanism_of(deck, options, outcome)
    second = _exchanged(deck, first, outcome)
    runs = [_rows(_finely(mechanism, options)) for mechanism in (first, second)]
    (one, unique), (other, _) = runs
    outcome.rows = one["time"].size
    return tuple(_differences(first, one, other, unique))


def _refuse_unequal(deck):
    """Only with all modes, and frames by three nodes, is there another frame of the same model."""
    faults, elastic = [], [record for record in deck.section("body") if record["kind"] == "FLEX"]
    clamped = {r["body"] for name in ("clamped", "interface") for r in deck.section(name)}
    for record in elastic:
        nodes = [record[f"n{k}"] for k in (1, 2, 3)]
        if record["modes"]:
            message = "verify compares two frames of the same body, which takes all modes: give 0 modes"
            faults.append(Fault("error", message, record.at("modes").place, record.subject, id="RUN-019"))
        if not all(nodes) or record["number"] in clamped:
            message = "verify exchanges the reference nodes n1 and n2: give three, and neither CLMP nor CRBN"
            faults.append(Fault("error", message, record.place, record.subject, id="RUN-020"))
    if not elastic:
        faults.append(
            Fault("error", "verify compares two frames of a FLEX body; the deck has none", id="RUN-021")
        )
    numbers = {record["number"] for record in elastic}
    for motion in deck.section("motion"):
        if motion["kind"] not in ("ANGL", "STRK") and motion["object"] in numbers:
            message = "it moves the frame of a FLEX body, which is another in the second model"
            faults.append(Fault("error", message, motion.place, motion.subject, id="RUN-022"))
    if faults:
        raise ModelError(faults)


def _exchanged(deck, first: FlexibleMechanism, outcome) -> FlexibleMechanism:
    """Return the mechanism in the other frames, its bodies moving as those of the first."""
    from ...fe.build_mechanism import flexible_mechanism

    changes = {}
    for record in deck.section("body"):
        if record["kind"] == "FLEX":
            changes |= {f"{record.prefix}.n1": record["n2"], f"{record.prefix}.n2": record["n1"]}
    model, _ = build_vsdf(deck.with_values(changes), Path(outcome.deck).parent)
    second, _ = flexible_mechanism(model)
    pairs = list(zip(first.bodies, second.bodies, strict=True))
    forces = tuple(_turned(force, *pairs[force.point.body]) for force in second.forces)
    return replace(second, bodies=tuple(_moving(*pair) for pair in pairs), forces=forces)


def _moving(body, other):
    """Return `other` with the motion that `body` has at the start."""
    A, B = rotation_matrix(body.p), rotation_matrix(other.p)
    omega = A @ body.omega
    return replace(other, velocity=body.velocity + np.cross(omega, other.r - body.r), omega=B.T @ omega)


def _turned(force, body, other):
    """Return a force that follows its body in the axes of the other frame."""
    if not force.follows:
        return force
    turned = rotation_matrix(other.p).T @ rotation_matrix(body.p) @ force.force
    return replace(force, force=tuple(turned))


def _finely(mechanism, options):
    """Return the mechanism with steps finer than it is compared."""
    given = mechanism.integrator
    method = given.method if given.method in ("RK45", "RAD5") else "RAD5"
    tolerance = options.integration.get("rtol", TOLERANCE)
    return replace(mechanism, integrator=Integrator(method, 0.0, tolerance))


def _rows(mechanism):
    """Return the rows by their fields, and whether no equation repeats others."""
    from ...solvers.constrained.flexible_dynamics import FlexibleDynamics

    analysis, blocks = FlexibleDynamics(mechanism), []
    for block in analysis.rows():
        blocks.append(block)
        Stop.heed()
    names = [each.name for each in fields(blocks[0]) if not each.name.startswith("amplitude")]
    rows = {name: np.concatenate([getattr(block, name) for block in blocks]) for name in names}
    return rows, not analysis.found.redundant


def _differences(mechanism, one, other, unique):
    time = one["time"]
    for name, unit, key in SERIES + (FORCES if unique else ()):
        if one[key].size:
            yield largest_difference(name, unit, time, one[key], other[key])
    rigid = [k for k, body in enumerate(mechanism.bodies) if body.flexible is None]
    if rigid:
        for name, unit, key in (("position", "m", "position"), ("velocity", "m/s", "velocity")):
            yield largest_difference(
                f"rigid body {name}", unit, time, one[key][:, rigid], other[key][:, rigid]
            )
    moved = max(np.max(np.abs(one[name])) for name in ("kinetic", "strain"))
    for name in ENERGIES:
        yield largest_difference(f"{name} energy", "J", time, one[name], other[name], moved)
