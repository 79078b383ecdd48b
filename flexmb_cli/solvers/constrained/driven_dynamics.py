"""Inverse dynamics of a mechanism whose drivers at joints, couplings and supports prescribe its motion.

The equations leave no speed free: every row is found by projection, and the steps only lead from one to the
next.
"""

from ..kinematics.inverse_dynamics import undetermined
from ..singular.mobility import Mobility
from .young_dynamics import ForwardDynamics


class DrivenDynamics(ForwardDynamics):
    """One run over the report times of a model whose motion is prescribed."""

    def start_position(self) -> Mobility:
        """As `ForwardDynamics.start_position`; raises AnalysisError where something is free to move."""
        found = super().start_position()
        if found.free:
            raise undetermined(self.model.mechanism.time.start)
        return found
