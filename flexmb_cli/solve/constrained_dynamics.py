"""Forward dynamics of a YOUNG deck's mechanism: its motion under loads and drivers."""

import numpy as np

from ..kernels.constrained_report import Report
from ..model.dynamic_arrays import dynamic_arrays
from ..model.dynamics import DynamicModel
from .constrained_motion import ConstrainedMotion
from .constrained_start import assembled, given_speeds
from .constrained_system import AnyCountEvaluator
from .dynamic_rows import DynamicRows, dynamic_rows
from .steppers import ExplicitSteps, GeneralisedAlpha, RadauSteps


class ForwardDynamics(ConstrainedMotion):
    """One run over the report times of a dynamic model."""

    def __init__(self, model: DynamicModel):
        super().__init__(dynamic_arrays(model), model.mechanism.time, model.tolerance, _stepper(model))
        self.model = model
        self.mechanism = model.mechanism
        self.velocities = model.velocities

    @property
    def evaluator(self) -> AnyCountEvaluator:
        """Residuals and Jacobians in coordinates."""
        return AnyCountEvaluator(self.arrays.kinematic, self.system, self.work)

    def assembled(self, t: float) -> np.ndarray:
        """Coordinates that meet all equations, near the deck's estimates; raises AnalysisError."""
        return assembled(self, t)

    def given_speeds(self, q) -> tuple[np.ndarray, np.ndarray]:
        """Which of the speeds the deck gives, and their values."""
        return given_speeds(self.velocities, self.arrays.bodies, q)

    def block(self, report: Report) -> DynamicRows:
        """The rows of a report in the terms of the model."""
        return dynamic_rows(self.mechanism, report)


def _stepper(model):
    if model.radau:
        return RadauSteps()
    steps = model.alpha_steps
    return ExplicitSteps() if steps is None else GeneralisedAlpha(steps.radius, steps.length)
