"""The kinematics of a mechanism by two formulations: Euler parameters, and natural coordinates."""

from ...deck.record import Deck
from ...model.mechanism import Mechanism
from ..outcome import Run
from .dynamic import FORMULATIONS as FORMULATIONS
from .dynamic import compare
from .verify import Difference


def differences(mechanism: Mechanism, deck: Deck, run: Run) -> tuple[Difference, ...]:
    """Move `mechanism` both ways and return what the motions differ in.  Raises FlexmbError."""
    from ...solvers.kinematics.analysis import KinematicAnalysis
    from ...solvers.kinematics.position import KinematicSettings

    analysis = KinematicAnalysis(mechanism, KinematicSettings(**run.options.solver))
    return compare(analysis, mechanism, None, run)
