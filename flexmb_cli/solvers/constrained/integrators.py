"""The methods that step a constrained mechanism through time, behind one face.

Each imports its own kernels when it is used.
"""

from collections.abc import Callable
from typing import NamedTuple

from ...errors import Fault


class ExplicitSteps:
    """DOP853: steps chosen by the tolerance."""

    entry = "integrators.constrained_dop853.integrate_rows"  # the kernel that is compiled
    chosen = True  # whether the lengths of its steps are its own choice

    @property
    def integrate_rows(self):
        """The kernel."""
        from ...kernels.integrators import constrained_dop853

        return constrained_dop853.integrate_rows

    def new_integration(self, work, angles: int):
        """An integration at time 0 with an empty state for a mechanism with this work and so many angles."""
        from ...kernels.integrators import constrained_dop853

        return constrained_dop853.new_integration(2 * work.jacobian.shape[1] + work.mass.shape[0] + 1, angles)

    def doubts(self, clock) -> list[Fault]:
        """Return what is doubtful about the steps taken."""
        return []


class GeneralisedAlpha:
    """Steps of `length` seconds, or chosen by the tolerance where it is 0.

    `radius`: the spectral radius at infinity, 1 for no numerical damping, 0 for the most.
    """

    entry = "integrators.generalised_alpha.integrate_rows"

    def __init__(self, radius: float = 0.9, length: float = 0.0):
        self.radius, self.length = radius, length

    @property
    def integrate_rows(self):
        """The kernel."""
        from ...kernels.integrators import generalised_alpha

        return generalised_alpha.integrate_rows

    @property
    def chosen(self) -> bool:
        """Whether the lengths of its steps are its own choice."""
        return self.length == 0.0

    def new_integration(self, work, angles: int):
        """An integration at time 0 with an empty state; see `generalised_alpha.new_integration`."""
        from ...kernels.integrators import generalised_alpha

        integration = generalised_alpha.new_integration(work, angles)
        integration.clock["rho"], integration.clock["fixed"] = self.radius, self.length
        return integration

    def doubts(self, clock) -> list[Fault]:
        """Return what is doubtful about the steps taken: some of given length had to be divided."""
        if not self.length or not clock["rejections"]:
            return []
        message = (
            f"the iterations of {clock['rejections']} steps of {self.length:g} s did not converge, and the "
            "steps were divided; take a smaller step"
        )
        return [Fault("warning", message, id="SOLVE-006")]


class RadauSteps:
    """Radau IIA of order 5: steps chosen by the tolerance, however stiff modes, springs and dampers are."""

    entry = "integrators.radau5.integrate_rows"
    chosen = True

    @property
    def integrate_rows(self):
        """The kernel."""
        from ...kernels.integrators import radau5

        return radau5.integrate_rows

    def new_integration(self, work, angles: int):
        """An integration at time 0 with an empty state; see `radau5.new_integration`."""
        from ...kernels.integrators import radau5

        return radau5.new_integration(work, angles)

    def doubts(self, clock) -> list[Fault]:
        """Return what is doubtful about the steps taken."""
        return []


class Method(NamedTuple):
    """A method that a deck may name: its meaning, what makes it, and its number in the deck.

    `make(number, length)`: the number is a tolerance or, of `by_radius`, the spectral radius at infinity;
    length is that of a step, s, 0 where it is chosen.
    """

    meaning: str
    make: Callable
    default: float
    by_radius: bool = False


# By the words of the card INTG; the first is that of a deck without one.
METHODS = {
    "GALF": Method("generalised alpha", GeneralisedAlpha, 0.9, by_radius=True),
    "RAD5": Method("Radau", lambda tolerance, length: RadauSteps(), 1e-8),
    "RK45": Method("Runge-Kutta", lambda tolerance, length: ExplicitSteps(), 1e-12),
}
