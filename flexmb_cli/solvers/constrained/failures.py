"""Failures of the integration of a mechanism, and messages about redundant equations."""

from typing import Any

import numpy as np

from ...errors import AnalysisError, Fault
from ...kernels.constrained.accelerations import accelerations
from ...kernels.constrained.angle_unwrapping import NEW
from ...kernels.constrained.elements import FRICTION
from ...kernels.constrained.report import Report
from ...kernels.constrained.speeds import move
from ...kernels.constrained.system import NO_INERTIA
from ...kernels.integrators.clock import CONTRADICTION
from ...kernels.laws import COORDINATE
from ...model.arrays.contacts import PAIRS_OF_AN_END
from ...model.arrays.records import ELEMENT
from ...model.integrators import METHODS
from ...model.laws import CONTACT
from ...model.unit_checks import uneven_masses
from ..singular.conditioning import owners_text
from ..singular.dynamic_singularities import (
    SINGULAR_CONDITION,
    has_gained_rank,
    repeating_here_only,
    weakest_of_speeds,
)
from ..singular.mobility import Gap, Mobility, about
from .breakpoints import jump_of_table
from .start import inertia_failure
from .state import ConstrainedState

SHOWN_OWNERS = 6
SHOWN_TIMES = 10
UNDETERMINED = "SOLVE-041"
GO_ON = (
    "; if the motion locks, free it or end the run before; if it should pass, try a tolerance ten "
    "times as large or as small"
)
IMPLICIT = tuple(word for word, method in METHODS.items() if method.implicit)
MOMENTS = (1e-9, 1e-7, 1e-5)  # of a run: how far behind the state loads without force are looked for


def step_failure(analysis: Any, answer: int) -> AnalysisError:
    """Return why a ConstrainedState could make no step."""
    clock = analysis.clock[0]
    t, step = float(clock["t"]), float(clock["step"])
    norms = {"reached": t, "step": step}
    if answer == CONTRADICTION:
        worst = analysis.arrays.equations[int(clock["equation"])]
        gap = Gap(worst, float(clock["gap"]) * worst.scale)
        reason = (
            "they did so at the start only, which is a singular position (rods in line); begin elsewhere"
            if has_gained_rank(analysis)
            else "a driver or a joint asks for a motion that the others forbid"
        )
        message = f"at t = {t:.6g} s equations that repeated others contradict them: {gap.text}; {reason}"
        return AnalysisError(about("error", message, worst, id="SOLVE-046"), t, norms)
    # Friction that only a trial jammed is not what ends the run.
    if not rows_with_forces(analysis.work.responses[None]) and (
        _overturned(analysis, analysis.work.responses).size or not _has_forces(analysis, t)
    ):
        return force_failure(analysis, analysis.work.responses, t)
    if _is_without_forces_ahead(analysis, t):
        return force_failure(analysis, analysis.work.responses, t)
    if clock["fault"] == NO_INERTIA:
        return inertia_failure(analysis, t)
    reason, owners = _why_steps_fall(analysis, norms)
    message = f"at t = {t:.6g} s the step length falls to {step:.1e} s: {reason}"
    return AnalysisError(about("error", message, *owners[:1], id="SOLVE-047"), t, norms)


def _is_without_forces_ahead(analysis: Any, t: float) -> bool:
    """Return whether friction or a bushing has no force where its speeds lead the state in a moment.

    Steps come as near to such a place as they like, and none leads over it.
    """
    if not np.isin(analysis.arrays.loads["kind"], (FRICTION, ELEMENT)).any():
        return False
    span = analysis.grid.end - analysis.grid.start
    return any(not _has_forces(analysis, t, share * span) for share in MOMENTS)


def _has_forces(analysis: ConstrainedState, t: float, ahead: float = 0.0) -> bool:
    """Return whether all loads have forces at the state that the steps have reached, or so much later, s."""
    work, ud = analysis.work, np.zeros(analysis.arrays.speeds)
    work.angles[:] = analysis.integration.angles[NEW]
    end = ud.size + analysis.arrays.bodies
    q, u = np.split(analysis.integration.z[: end + ud.size].copy(), [end])
    move(analysis.arrays.bodies, q, ahead * u)
    accelerations(analysis.system, work, q, u, t + ahead, ud)
    return bool(rows_with_forces(work.responses[None]))


def rows_with_forces(responses: np.ndarray) -> int:
    """Return how many rows of responses (T, loads, columns) come before one that has no force."""
    known: np.ndarray = np.isfinite(responses).all(axis=(1, 2))
    return int(known.size if known.all() else np.argmin(known))


def force_failure(analysis: ConstrainedState, responses: np.ndarray, t: float) -> AnalysisError:
    """Return why loads (responses, (loads, columns)) have no force at t: a bushing, else friction."""
    turned = _overturned(analysis, responses)
    if not turned.size:
        return jam_failure(t)
    load = analysis.arrays.loads[turned[0]]
    if load["shape"] == CONTACT.code:
        return crowd_failure(t)
    return bushing_failure(int(load["group"]), t)


def _overturned(analysis: ConstrainedState, responses: np.ndarray) -> np.ndarray:
    """Return which loads are bushings whose bodies have turned too far."""
    elements = analysis.arrays.loads["kind"] == ELEMENT
    return np.flatnonzero(elements & ~np.isfinite(responses[:, COORDINATE]))


def crowd_failure(t: float) -> AnalysisError:
    """Return that more pairs of shapes are near each other than there is room for."""
    message = (
        f"at t = {t:.6g} s each shape of a contact of many is near to more than {PAIRS_OF_AN_END} others on "
        "average, before or after it; give contacts of large and of small shapes lines of their own"
    )
    return AnalysisError(Fault("error", message, None, "contact", id="SOLVE-120"), t)


def bushing_failure(number: int, t: float) -> AnalysisError:
    """Return that the bodies of the bushing `number`, from 0, have turned too far."""
    message = (
        f"at t = {t:.6g} s the bodies of bushing {number + 1} have turned by a quarter turn against each "
        "other, beyond which its angles jump; end the run before, make it stiffer, or give it stiffness and "
        "damping only about the one axis that the bodies turn about"
    )
    return AnalysisError(Fault("error", message, None, f"bushing {number + 1}", id="SOLVE-039"), t)


def jam_failure(t: float) -> AnalysisError:
    """Return that no normal force of a friction agrees with the accelerations that it causes."""
    message = (
        f"at t = {t:.6g} s friction jams a joint: no normal force agrees with the accelerations that it "
        "causes; end the run before, or give less friction or another load there"
    )
    return AnalysisError(Fault("error", message, None, "friction", id="SOLVE-038"), t)


def _why_steps_fall(analysis: ConstrainedState, norms: dict[str, float]) -> tuple[Any, Any]:
    """The reason in words, and the equations it lies in; the condition goes into `norms`."""
    condition, owners = weakest_of_speeds(analysis, analysis.integration.z)
    norms["condition"] = condition
    size = f"condition {condition:.0e}"
    if condition > SINGULAR_CONDITION:
        joints = owners_text(owners)
        return (
            f"a singular position of {joints} ({size}), a dead centre or a branching, is reached{GO_ON}"
            + (", or GALF" if analysis.integrator.card != "GALF" else ""),
            owners,
        )
    if owners := repeating_here_only(analysis):
        reason = (
            f"this is a singular position of {owners_text(owners)} (rods in line), where equations repeat "
            "others that they contradict beside it; begin elsewhere"
        )
        return reason, owners
    bodies = list(zip(analysis.arrays.body_names, analysis.system.masses["mass"].tolist(), strict=True))
    if reason := jump_of_table(analysis, norms["reached"]) or uneven_masses(bodies):
        return reason, []
    return (
        f"the joints are far from singular ({size}), so a load, stiffness or speed is too great; "
        + _remedies(analysis),
        [],
    )


def _remedies(analysis: ConstrainedState) -> str:
    """The remedies where forces are too stiff for the method in use, which is none of them."""
    methods = " or ".join(card for card in IMPLICIT if card != analysis.integrator.card)
    creep = ", or a larger creep speed" if np.any(analysis.arrays.loads["kind"] == FRICTION) else ""
    return f"try {methods}, or a smaller one{creep}"


def repetition(mobility: Mobility, usual: int | None, kind: str, each: str) -> Fault:
    """Some equations repeat others: the motion is unique, the split of forces between them is a choice.

    A warning, or a note where they are as many as `usual`, `each` in a mechanism of this `kind`.
    """
    if len(mobility.redundant) == usual:
        total = mobility.equations
        message = (
            f"{kind}: {usual} of {total} equations repeat{'s' * (usual == 1)} others, {each}, as "
            f"{'it' if usual == 1 else 'they'} must; the motion is unique, reactions are those of least norm"
        )
        return Fault("note", message, id="SOLVE-034")
    # In the deck's order: shares that symmetry makes equal differ by round-off, another on every processor.
    repeated = sorted(
        {equation for group in mobility.redundant for equation in group},
        key=lambda one: (one.place or (0, 0), one.owner, one.part),
    )
    owners = list(dict.fromkeys(equation.owner for equation in repeated))
    placed = [equation for equation in repeated if equation.place]
    count = len(mobility.redundant)
    shown = ", ".join(owners[:SHOWN_OWNERS]) + (" and others" if len(owners) > SHOWN_OWNERS else "")
    message = (
        f"{count} equation{' repeats' if count == 1 else 's repeat'} others, among those of {shown}; the "
        "motion is unique, reactions are those of least norm"
    )
    return about("warning", message, *placed, id="SOLVE-048")


def note_undetermined_rows(analysis: ConstrainedState, report: Report) -> None:
    """Note the times of all rows so far, those of a report among them, that round-off rules."""
    times, warnings = analysis.undetermined, analysis.warnings
    undetermined = report.times[np.isnan(report.multipliers).any(axis=1)].tolist()
    if not undetermined:
        return
    warnings[:] = [fault for fault in warnings if fault.id != UNDETERMINED]
    times += undetermined
    shown = ", ".join(f"{t:.6g}" for t in times[:SHOWN_TIMES])
    others = f" s and {len(times) - SHOWN_TIMES} others" if len(times) > SHOWN_TIMES else " s"
    message = (
        f"at t = {shown}{others} a row is so near to a singular position that round-off rules what the "
        "equations say: accelerations are those of the step over it (nan at the end of the run), reactions "
        "are not determined (nan)"
    )
    warnings.append(Fault("note", message, id="SOLVE-041"))
