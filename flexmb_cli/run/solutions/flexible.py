"""Dynamics of a mechanism of rigid and flexible bodies."""

import math
from collections.abc import Iterator, Mapping
from dataclasses import replace
from functools import partial
from hashlib import sha256
from typing import Any

import numpy as np

from ...model.flexible_mechanism import FlexibleMechanism
from ...model.integrators import METHODS, Integrator, word_of
from ...model.unit_checks import unit_warnings
from ...results.hdf5.flexible import flexible_layout, flexible_values
from ...solvers.compilation import announce_compiling
from ...solvers.constrained.flexible_dynamics import FlexibleDynamics
from ..energy_drift import ConstrainedDrift, StepCount
from ..error_estimate import finer_motion
from ..outcome import Run
from ..python_options import set_tolerances
from ..stiffening_notes import SoftBody, SpinCount
from . import Solution
from .at_rest import begin_at_rest

TOO_COARSE = (
    "too coarse a tolerance (card INTG), or steps of GALF that are too long (card TIME) or damp too much (a "
    "spectral radius below 1)"
)
STIFFENING = "switch it on (card GEOS) by the elements and MATL, or by matrices of the program (cards FEMG)"


def solution(mechanism: FlexibleMechanism, run: Run) -> Solution:
    """Return the motion of `mechanism`, ready to be solved."""
    mechanism = as_asked(mechanism, run.options.integration)
    analysis, values = _analysis(mechanism, run), partial(flexible_values, mechanism)
    return Solution(
        analysis,
        mechanism.time.rows,
        lambda: flexible_layout(mechanism),
        values,
        StepCount(
            analysis.clock, ConstrainedDrift(TOO_COARSE), SpinCount(_soft_bodies(mechanism), STIFFENING)
        ),
        partial(unit_warnings, mechanism, run.outcome.system),
        analysis.warnings,
        partial(finer_motion, partial(_analysis, mechanism), values),
        {"bodies": _digest(analysis.system), **run.options.integration},
    )


def _soft_bodies(mechanism: FlexibleMechanism) -> Iterator[SoftBody]:
    for k, body in enumerate(mechanism.bodies):
        if body.flexible and body.modes and not body.stiffened:
            lowest = math.tau * float(body.flexible.frequencies.min())
            yield SoftBody(k, body.name, lowest, body.place)


def as_asked(mechanism: FlexibleMechanism, given: Mapping[str, Any]) -> FlexibleMechanism:
    """Return the mechanism with the method and the tolerance of the options `given`."""
    integrator = mechanism.integrator
    word = word_of(given["method"]) if "method" in given else integrator.method
    if word != integrator.method:
        integrator = Integrator(word, integrator.step, METHODS[word].tolerance)
    if "rtol" in given:
        integrator = replace(integrator, tolerance=given["rtol"])
    return replace(mechanism, integrator=integrator)


def _digest(system: Any) -> str:
    """A digest of the reduced bodies: a deck names files that may have changed since."""
    digest = sha256()
    # The rest of contacts changes with time, and what signals do is in the deck.
    contacts = system.contacts
    shapes = np.concatenate([contacts.touches["offset_j"].ravel(), contacts.triangles.ravel()])
    arrays = system._replace(contacts=shapes)._asdict()
    for name, array in arrays.items():
        if name != "signals":
            digest.update(array.tobytes())
    return digest.hexdigest()


def _analysis(mechanism: FlexibleMechanism, run: Run) -> FlexibleDynamics:
    analysis = FlexibleDynamics(mechanism)
    set_tolerances(analysis, run.options, run.outcome)
    begin_at_rest(
        analysis,
        partial(FlexibleDynamics, mechanism),
        run,
        analysis.arrays.speeds,
        mechanism.time,
        mechanism.elements,
    )
    announce_compiling(run.listener, analysis.integrator.entry)
    return analysis
