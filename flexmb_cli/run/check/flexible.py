"""Diagnose a mechanism of flexible bodies: assembly, rank, repeated equations, what is free to move."""

from collections import Counter
from typing import Any

import numpy as np

from ...deck.lazy import Made
from ...model.flexible_mechanism import FlexibleMechanism, FloatingBody
from ...model.joints import BY_NAME
from ...model.unit_checks import unit_warnings
from ..outcome import Run
from .check import (
    CheckReport,
    gaps_of,
    is_small,
    is_too_large,
    note_moves,
    record_assembly,
    record_mobility,
    refuse_jacobian,
    report_times,
    start_of,
)

CENTRE_ROUND_OFF = 1e-12


def check(report: CheckReport, mechanism: FlexibleMechanism, run: Run, jacobian: str | None) -> None:
    """Fill the `CheckReport`; raises FlexmbError for what cannot be run."""
    refuse_jacobian(jacobian, "it is printed of mechanisms that drivers move, and of rigid bodies only")
    run.outcome.faults += unit_warnings(mechanism, run.outcome.system)
    from ...solvers.compilation import interpreting

    counts = _parts(mechanism) | report_times(mechanism.time)
    if is_too_large(report, counts, 6 * counts["bodies"] + counts["modes"], _equations(mechanism, counts)):
        report.bodies = Made(mechanism.bodies, _body)
        return
    with interpreting(_is_small(mechanism)):
        _diagnose(report, mechanism)
    run.warn(())


def _coordinates(mechanism: FlexibleMechanism) -> int:
    return sum(6 + body.modes for body in mechanism.bodies)


def _is_small(mechanism: FlexibleMechanism) -> bool:
    loads = mechanism.forces, mechanism.torques, mechanism.springs
    constraints = mechanism.joints, mechanism.pins, mechanism.motions
    return is_small(_coordinates(mechanism), *loads, *constraints, *mechanism.elements.groups())


def _equations(mechanism: FlexibleMechanism, counts: dict[str, Any]) -> int:
    """Return the equations of joints, pins and motions: some may repeat others, and be any number."""
    of_joints: int = sum(number * BY_NAME[kind].equations for kind, number in counts["joints"].items())
    return of_joints + sum(sum(pin.directions) for pin in mechanism.pins) + len(mechanism.motions)


def _diagnose(report: CheckReport, mechanism: FlexibleMechanism) -> None:
    from ...solvers.constrained.flexible_dynamics import FlexibleDynamics

    analysis = FlexibleDynamics(mechanism)
    arrays = analysis.arrays
    report.bodies = [_body(body) for body in mechanism.bodies]
    report.time = mechanism.time.start
    before = gaps_of(analysis.gaps, arrays, arrays.q, report.time, arrays.angles)
    try:
        freedom = start_of(analysis, report)
    finally:
        report.outcome.faults += analysis.warnings
    report.counts = _parts(mechanism) | {
        "equations": int(freedom.equations),
        "coordinates": int(freedom.coordinates),
        "degrees_of_freedom": int(freedom.coordinates - freedom.rank) + len(mechanism.motions),
        **report_times(mechanism.time),
    }
    assembled = analysis.integration.z[: arrays.q.size]
    after = gaps_of(analysis.gaps, arrays, assembled, report.time, arrays.angles)
    record_assembly(report, before, after)
    note_moves(report, arrays, arrays.q, assembled)
    record_mobility(report, freedom)


def _parts(mechanism: FlexibleMechanism) -> dict[str, dict[str, int] | int]:
    modes = [body.modes for body in mechanism.bodies]
    return {
        "bodies": len(mechanism.bodies),
        "flexible": sum(count > 0 for count in modes),
        "modes": sum(modes),
        "joints": dict(Counter(joint.kind for joint in mechanism.joints)),
        "pins": len(mechanism.pins),
        "motions": len(mechanism.motions),
        "loads": len(mechanism.forces) + len(mechanism.torques),
        "springs": len(mechanism.springs),
        "outputs": len(mechanism.outputs),
    }


def _body(body: FloatingBody) -> dict[str, Any]:
    """Return what is reported of a body; frequencies in Hz."""
    record = {"name": body.name, "mass": body.m, "centre": _centre(body), "modes": body.modes}
    if body.flexible is None:
        return record | {"kind": "rigid"}
    flexible = body.flexible
    return record | {
        "kind": "flexible",
        "nodes": len(flexible.numbers),
        "frequencies": flexible.frequencies.tolist(),
        "frequency_errors": flexible.frequency_errors[: flexible.modes - flexible.massless].tolist(),
        "mass_deviation": flexible.mass_deviation,
        "rigid_residual": flexible.rigid_residual,
        **({"elements": flexible.stress.text} if flexible.stress else {}),
    }


def _centre(body: FloatingBody) -> list[float]:
    """Centre of mass, m, components that are round-off of the body's size as 0."""
    centre = body.s0 / body.m
    size = max(np.abs(centre).max(), np.sqrt(np.trace(body.J0) / body.m))
    return list(np.where(np.abs(centre) > CENTRE_ROUND_OFF * size, centre, 0.0).tolist())
