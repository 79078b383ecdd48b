"""Cards of the integration of a YOUNG deck: TOLERANCE, GALF, RAD5, and the times of the rows."""

import math

from ...deck.record import Deck
from ...model.diagnostics import Findings
from ...model.integrators import Integrator
from ...model.loads import DynamicModel
from ...model.time_checks import unsteppable
from .dynamic_cards import FORWARD, analysis_of

DEFAULT_TOLERANCE = 1e-9
LEAST_TOLERANCE, MOST_TOLERANCE = 1e-13, 1e-2


def tolerance_of(deck: Deck, findings: Findings) -> float:
    """Return the tolerance of card RAD5, else that of TOLERANCE, else the default."""
    tolerance = DEFAULT_TOLERANCE
    for section, key in (("tolerance", "relative"), ("radau", "tolerance")):
        for record in deck.section(section):
            number = record.at(key)
            if section == "radau" and number.value == 0.0:
                continue
            if not (math.isfinite(number.value) and LEAST_TOLERANCE <= number.value <= MOST_TOLERANCE):
                message = f"must lie between {LEAST_TOLERANCE:g} and {MOST_TOLERANCE:g}; read {number.text}"
                findings.error(section, message, number.place, id="YOUNG-009")
            tolerance = float(number.value)
    return tolerance


def check_method(deck: Deck, findings: Findings) -> None:
    """A deck has one method, which only a forward analysis uses."""
    for record in deck.section("radau"):
        if deck.section("generalised-alpha"):
            message = "the deck asks for GALF as well; remove one of them"
            findings.error(record.subject, message, record.place, id="YOUNG-010")
        if analysis_of(deck) != FORWARD:
            findings.warn(record.subject, "is not used: nothing is integrated", record.place, id="YOUNG-011")


def integrator_of(deck: Deck, findings: Findings) -> Integrator:
    """Return the method of GALF or RAD5, else the explicit one, with its tolerance."""
    tolerance = tolerance_of(deck, findings)
    records = deck.section("generalised-alpha")
    if not records:
        return Integrator("RAD5" if deck.section("radau") else "RK45", tolerance=tolerance)
    step, radius = records[0].at("step"), records[0].at("radius")
    if not (math.isfinite(step.value) and step.value >= 0.0):
        findings.error(
            records[0].subject, f"a step must not be negative; read {step.text}", step.place, id="YOUNG-012"
        )
    if not 0.0 <= radius.value <= 1.0:
        message = f"the spectral radius lies between 0 and 1; read {radius.text}"
        findings.error(records[0].subject, message, radius.place, id="YOUNG-013")
    if analysis_of(deck) != FORWARD:
        findings.warn(
            records[0].subject, "is not used: nothing is integrated", records[0].place, id="YOUNG-014"
        )
    return Integrator("GALF", float(step.value), tolerance, float(radius.value))


def check_time(model: DynamicModel, findings: Findings) -> None:
    """Refuse times that double precision cannot step through."""
    grid = model.mechanism.time
    fault = unsteppable(max(abs(grid.start), abs(grid.end)), grid.step)
    if fault and model.analysis == FORWARD:
        findings.error("time", fault, grid.place, id="YOUNG-015")
