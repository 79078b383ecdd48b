"""The methods that step a constrained mechanism through time, behind one face."""

from ..errors import Fault
from ..kernels import alpha_march, constrained_march, radau_march


class ExplicitSteps:
    """DOP853: steps chosen by the tolerance."""

    march_rows = staticmethod(constrained_march.march_rows)
    entry = "constrained_march.march_rows"  # the kernel that is compiled
    chosen = True  # whether the lengths of its steps are its own choice

    def new_march(self, work, turns: int):
        """A march at time 0 with an empty state for a mechanism with this work and so many angles."""
        return constrained_march.new_march(2 * work.jacobian.shape[1] + work.mass.shape[0] + 1, turns)

    def doubts(self, clock) -> list[Fault]:
        """What is doubtful about the steps taken."""
        return []


class GeneralisedAlpha:
    """Steps of `length` seconds, or chosen by the tolerance where it is 0.

    `radius`: the spectral radius at infinity, 1 for no numerical damping, 0 for the most.
    """

    march_rows = staticmethod(alpha_march.march_rows)
    entry = "alpha_march.march_rows"

    def __init__(self, radius: float = 0.9, length: float = 0.0):
        self.radius, self.length = radius, length

    @property
    def chosen(self) -> bool:
        """Whether the lengths of its steps are its own choice."""
        return self.length == 0.0

    def new_march(self, work, turns: int):
        """A march at time 0 with an empty state; see `alpha_march.new_march`."""
        march = alpha_march.new_march(work, turns)
        march.clock["rho"], march.clock["fixed"] = self.radius, self.length
        return march

    def doubts(self, clock) -> list[Fault]:
        """What is doubtful about the steps taken: some of given length had to be divided."""
        if not self.length or not clock["rejections"]:
            return []
        message = (
            f"the iterations of {clock['rejections']} steps of {self.length:g} s did not converge, and the "
            "steps were divided; take a smaller step"
        )
        return [Fault("warning", message)]


class RadauSteps:
    """Radau IIA of order 5: steps chosen by the tolerance, however stiff modes, springs and dampers are."""

    march_rows = staticmethod(radau_march.march_rows)
    entry = "radau_march.march_rows"
    chosen = True

    def new_march(self, work, turns: int):
        """A march at time 0 with an empty state; see `radau_march.new_march`."""
        return radau_march.new_march(work, turns)

    def doubts(self, clock) -> list[Fault]:
        """What is doubtful about the steps taken."""
        return []
