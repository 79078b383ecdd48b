"""A mechanism by two formulations: Euler parameters, and natural coordinates.

Both begin at the position that flexmb assembles.
"""

from dataclasses import replace
from typing import Any

import numpy as np

from ...deck.record import Deck
from ...errors import Fault, ModelError
from ...model.loads import DynamicModel
from ...model.mechanism import Mechanism
from ..outcome import Run
from .verify import Difference, Size, compared_rows, finely_stepped, joined, largest_difference

FORMULATIONS = "Euler parameters and natural coordinates"
EXPLICIT_TOLERANCE = 1e-11  # of the explicit steps
COMPARED = (
    "position", "euler_parameters", "velocity", "angular_velocity", "acceleration", "angular_acceleration",
    "kinetic", "driver_effort",
)  # fmt: skip


def differences(model: DynamicModel, deck: Deck, run: Run) -> tuple[Difference, ...]:
    """Run a dynamic model both ways and return what the motions differ in.  Raises FlexmbError."""
    from ...solvers.constrained.young_dynamics import ForwardDynamics
    from ...solvers.kinematics.inverse_dynamics import InverseDynamics

    _refuse_elements(model)
    if model.analysis != "forward":
        return compare(InverseDynamics(model), model.mechanism, model, run)
    finer = finely_stepped(model.integrator, run.options, "RK45", EXPLICIT_TOLERANCE)
    model = replace(model, integrator=finer)
    return compare(ForwardDynamics(model), model.mechanism, model, run)


def compare(
    analysis: Any, mechanism: Mechanism, model: DynamicModel | None, run: Run
) -> tuple[Difference, ...]:
    """Return what the motion of an analysis and that in natural coordinates differ in."""
    from ...solvers.natural_coordinates.motion import NaturalMotion, coordinates_of, speeds_of

    motion = NaturalMotion(mechanism, model)
    blocks = list(compared_rows(analysis))
    run.outcome.rows = sum(block.time.size for block in blocks)
    start = blocks[0]
    X = coordinates_of(start.position[0], start.euler_parameters[0])
    if model is None or model.analysis != "forward":
        rows = motion.kinematic(X)
    else:
        rows = motion.forward(X, speeds_of(X, start.velocity[0], start.angular_velocity[0]))
    return _differences(joined(blocks, COMPARED), rows, motion, _size(mechanism, model))


def _size(mechanism: Mechanism, model: DynamicModel | None) -> Size:
    from ...model.arrays.kinematic import length_scale

    time = mechanism.time
    mass = sum(item.mass for item in model.masses) if model else 0.0
    return Size(length_scale(mechanism), time.end - time.start, mass)


def _refuse_elements(model: Any) -> None:
    """Natural coordinates know the joints and loads of the dissertation, and no functions."""
    factors = [item.name for item in (*model.forces, *model.torques) if item.factor is not None]
    ends = [item.name for item in model.springs if -1 in item.measure[:2]]
    # What lines START say is in the first row.
    if replace(model.elements, starts=()) or factors or ends:
        what = next(iter((*factors, *ends)), "a block ELEMENTS")
        message = (
            "natural coordinates hold no block ELEMENTS, no loads by functions and no springs on the ground; "
            f"this deck has {what}: leave it out in a copy of the deck to compare the rest"
        )
        raise ModelError([Fault("error", message, id="RUN-030")])


def _differences(
    motions: dict[str, np.ndarray], rows: Any, motion: Any, size: Size
) -> tuple[Difference, ...]:
    """Return the differences of positions, attitudes and their derivatives, and of efforts."""
    from ...solvers.natural_coordinates.equations import rotation_of

    shape = len(rows.time), -1, 4, 3
    speed, turning = (np.max(np.abs(motions[name])) for name in ("velocity", "angular_velocity"))
    X, V, A = (part.reshape(shape) for part in (rows.X, rows.V, rows.A))
    turned = np.array([[rotation_of(p).T for p in row] for row in motions["euler_parameters"]])
    pairs: list[tuple[Any, ...]] = [
        ("body position", "m", motions["position"], X[:, :, 0]),
        ("body attitude", "1", turned, X[:, :, 1:]),
        ("body velocity", "m/s", motions["velocity"], V[:, :, 0]),
        ("body angular velocity", "rad/s", motions["angular_velocity"], _omega(X, V)),
        ("body acceleration", "m/s^2", motions["acceleration"], A[:, :, 0], speed * turning),
        ("body angular acceleration", "rad/s^2", motions["angular_acceleration"], _omega(X, A), turning**2),
    ]
    if "kinetic" in motions:
        kinetic = 0.5 * np.einsum("ti,ij,tj->t", rows.V, motion.M, rows.V)
        pairs.append(("kinetic energy", "J", motions["kinetic"], kinetic))
    if rows.effort.size:
        efforts = motions["driver_effort"]
        known = np.isfinite(rows.effort)
        pairs.append(
            ("driver effort", "N, N m", np.where(known, efforts, 0.0), np.where(known, rows.effort, 0.0))
        )
    # What should be zero is measured by the size of what it is made of.
    return tuple(
        largest_difference(name, unit, rows.time, one, other, size, max([*least, float(np.max(np.abs(one)))]))
        for name, unit, one, other, *least in pairs
    )


def _omega(X: np.ndarray, rates: np.ndarray) -> np.ndarray:
    """Return Σ d_a × (dd_a/dt) / 2: angular velocities of rates, angular accelerations of their rates."""
    twice: np.ndarray = np.cross(X[:, :, 1:], rates[:, :, 1:]).sum(axis=2)
    return 0.5 * twice
