"""A VSDF deck from its records to OUT listing and HDF5 result."""

from functools import partial
from pathlib import Path

from ..deck.record import Deck
from ..dialects.vsdf.build import build_vsdf
from ..model.flexible_mechanism import FlexibleMechanism
from ..model.unit_checks import unit_doubts
from ..results.files.file_names import STANDARD_INPUT, ResultPaths
from ..solvers.compilation import tell_of_compiling
from .energy_drift import ConstrainedDrift
from .error_estimate import with_estimate
from .integration_options import mechanism_as_asked, refuse_foreign_method, set_tolerances
from .outcome import Outcome, RunOptions, Stop, refuse_warnings
from .young import Contents, Solution, write_solution
from .young_dynamics import StepCount

TOO_COARSE = (
    "too coarse a tolerance (card INTG), or steps of GALF that are too long (card TIME) or damp too much (a "
    "spectral radius below 1)"
)


def run_vsdf(deck: Deck, paths: ResultPaths, options: RunOptions, outcome: Outcome, listener, stdout) -> None:
    """Move the mechanism of `deck` and write its results; `outcome` records how it went.

    Raises FlexmbError, and KeyboardInterrupt or Terminated after keeping the rows so far.
    """
    with Stop.released():
        solution = vsdf_solution(deck, options, outcome, listener)
        if options.estimate_error:
            second = vsdf_solution(deck, options, Outcome(outcome.deck), listener)
            solution = with_estimate(solution, second, outcome)
    write_solution(solution, deck, paths, options, outcome, listener, stdout)


def vsdf_solution(deck: Deck, options: RunOptions, outcome: Outcome, listener) -> Solution:
    """The motion of the mechanism of `deck`, ready to be solved; warnings go into `outcome`."""
    mechanism = mechanism_of(deck, options, outcome)
    from ..dialects.vsdf.listing import VsdfTable
    from ..results.hdf5.flexible import flexible_layout, flexible_values
    from ..solvers.constrained.flexible_dynamics import FlexibleDynamics

    refuse_foreign_method("vsdf", options)
    mechanism = mechanism_as_asked(mechanism, options)
    analysis = FlexibleDynamics(mechanism)
    set_tolerances(analysis, options, outcome)
    tell_of_compiling(listener, analysis.stepper.entry)

    def constraints():
        found = analysis.found
        return found and (found.equations, found.coordinates, found.rank, found.smallest)

    contents = Contents(
        lambda: flexible_layout(mechanism),
        lambda rows: flexible_values(mechanism, rows),
        lambda stream, deck, layout: VsdfTable(stream, deck, layout, mechanism, constraints),
    )
    drift = ConstrainedDrift(TOO_COARSE)
    count, doubts = StepCount(analysis.clock, drift), partial(unit_doubts, mechanism)
    return Solution(analysis, mechanism.time.rows, contents, count, doubts)


def mechanism_of(deck: Deck, options: RunOptions, outcome: Outcome) -> FlexibleMechanism:
    """The mechanism of `deck`, bodies reduced; file names are relative to the deck.  Raises ModelError."""
    from ..fe.build_mechanism import flexible_mechanism

    folder = Path() if outcome.deck == STANDARD_INPUT else Path(outcome.deck).parent
    model, doubts = build_vsdf(deck, folder)
    outcome.faults += doubts
    mechanism, doubts = flexible_mechanism(model)
    outcome.faults += doubts
    refuse_warnings(outcome, options)
    return mechanism
