"""A YOUNG deck with dynamic cards from its records to OUT table and HDF5 result."""

from functools import partial

from ..deck.record import Deck
from ..dialects.young.dynamic_cards import INVERSE, analysis_of
from ..errors import Fault, ModelError
from ..quick_dataclass import dataclass
from ..results.files.file_names import ResultPaths
from ..solvers.compilation import tell_of_compiling
from .energy_drift import ConstrainedDrift
from .error_estimate import with_estimate
from .integration_options import as_asked, refuse_foreign_method, set_tolerances
from .outcome import Listener, Outcome, RunOptions, Stop, refuse_warnings
from .young import Contents, Solution, kinematic_solution, write_solution

TOO_COARSE = (
    "too coarse a tolerance (card TOLERANCE), or steps of GALF that are too long or damp too much (a "
    "spectral radius below 1)"
)


def run_young_deck(
    deck: Deck, paths: ResultPaths, options: RunOptions, outcome: Outcome, listener, stdout
) -> None:
    """Run a YOUNG deck: kinematics, or dynamics where its cards ask for them.

    Raises FlexmbError, and KeyboardInterrupt or Terminated after keeping the rows so far.
    """
    with Stop.released():
        solution = young_solution(deck, options, outcome, listener)
        if options.estimate_error:
            second = young_solution(deck, options, Outcome(outcome.deck), listener)
            solution = with_estimate(solution, second, outcome)
    write_solution(solution, deck, paths, options, outcome, listener, stdout)


def young_solution(deck: Deck, options: RunOptions, outcome: Outcome, listener) -> Solution:
    """Return the solution that a YOUNG deck asks for; warnings go into `outcome`.  Raises ModelError."""
    if analysis_of(deck) is None:
        return kinematic_solution(deck, options, outcome, listener)
    if options.as_printed:
        told = "the program of 1996 knows no dynamics: leave out --as-printed, or the cards behind DYNAMICS"
        raise ModelError([Fault("error", told, id="RUN-027")])
    from ..dialects.young.build_dynamics import build_young_dynamics
    from ..model.unit_checks import unit_doubts
    from ..results.hdf5.dynamic import dynamic_layout, dynamic_values

    model, warnings = build_young_dynamics(deck)
    outcome.faults += warnings
    refuse_warnings(outcome, options)
    refuse_foreign_method("young", options)
    model = as_asked(model, options)
    analysis = _analysis(model, options, listener)
    if model.analysis != INVERSE:
        set_tolerances(analysis, options, outcome)
    if model.elements:
        from ..results.hdf5.elements import element_layout, element_values

        contents = Contents(lambda: element_layout(model), lambda rows: element_values(model, rows))
    else:
        contents = Contents(lambda: dynamic_layout(model), lambda rows: dynamic_values(model, rows))
    forward = model.analysis != INVERSE or bool(model.elements)
    count = StepCount(analysis.clock, ConstrainedDrift(TOO_COARSE)) if forward else StepCount()
    doubts = partial(unit_doubts, model)
    return Solution(analysis, model.mechanism.time.rows, contents, count, doubts)


def _analysis(model, options, listener: Listener):
    if model.analysis == INVERSE and not model.elements:
        from ..solvers.kinematics.inverse_dynamics import InverseDynamics
        from ..solvers.kinematics.settings import KinematicSettings

        tell_of_compiling(listener, "constrained.report.observe_rows")
        return InverseDynamics(model, KinematicSettings(**options.solver))
    from ..solvers.constrained.driven_dynamics import DrivenDynamics
    from ..solvers.constrained.young_dynamics import ForwardDynamics

    analysis = DrivenDynamics(model) if model.analysis == INVERSE else ForwardDynamics(model)
    tell_of_compiling(listener, analysis.stepper.entry)
    return analysis


@dataclass
class StepCount:
    """Steps, residuals and drift of energy so far; an inverse run takes no steps of its own."""

    clock: object = None
    drift: ConstrainedDrift | None = None
    residual: float = 0.0

    def add(self, rows):
        """Count report rows."""
        self.residual = max(self.residual, float(rows.constraint_residual.max()))
        if self.drift is not None:
            self.drift.add_rows(rows)

    @property
    def doubts(self) -> tuple[Fault, ...]:
        """Return what the energy of the rows makes doubtful."""
        return self.drift.doubts if self.drift else ()

    def __str__(self):
        worst = f"largest residual {self.residual:.1e}"
        if self.clock is None:
            return worst
        clock = self.clock[0]
        return (
            f"steps {clock['steps']}, evaluations {clock['evaluations']}, "
            f"rejected attempts {clock['rejections']}; {worst}; {self.drift}"
        )
