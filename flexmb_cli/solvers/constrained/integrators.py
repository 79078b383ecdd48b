"""The methods that step a constrained mechanism through time, behind one face.

Each imports its own kernels when it is used.
"""

from collections.abc import Callable
from importlib import import_module
from typing import TYPE_CHECKING, Any, NamedTuple

from ...errors import Fault

if TYPE_CHECKING:
    import numpy as np

    from ...kernels.constrained.system import Work
    from ...kernels.integrators.generalised_alpha import AlphaIntegration


KERNELS = "flexmb_cli.kernels.integrators"


class Steps:
    """Steps whose lengths a method chooses by the tolerance.

    `module`, of `kernels/integrators`, has new_integration(work, angles, works) and the kernel
    integrate_rows(task, system, work, integration, report, budget).
    """

    length = 0.0  # s, of its steps; 0 where they are its own choice
    card = ""  # the word for it on cards

    def __init__(self, module: str):
        self._module = f"{KERNELS}.{module}"

    @property
    def chosen(self) -> bool:
        """Return whether the lengths of its steps are its own choice."""
        return self.length == 0.0

    @property
    def entry(self) -> str:
        """Name of the kernel that is compiled."""
        return f"{self._module.partition('.kernels.')[2]}.integrate_rows"

    @property
    def integrate_rows(self) -> Callable[..., Any]:
        """The kernel."""
        found: Callable[..., Any] = import_module(self._module).integrate_rows
        return found

    def new_integration(self, work: Any, angles: int, works: int) -> Any:
        """Return an integration at time 0 with an empty state, for this work and so many angles.

        The works of the first `works` loads are kept.
        """
        return import_module(self._module).new_integration(work, angles, works)

    def doubts(self, clock: Any) -> list[Fault]:
        """Return what is doubtful about the steps taken."""
        return []


class ExplicitSteps(Steps):
    """DOP853."""

    card = "RK45"

    def __init__(self) -> None:
        super().__init__("constrained_dop853")


class RadauSteps(Steps):
    """Radau IIA of order 5, however stiff modes, springs and dampers are."""

    card = "RAD5"

    def __init__(self) -> None:
        super().__init__("radau5")


class GeneralisedAlpha(Steps):
    """Steps of `length` seconds, or chosen by the tolerance where it is 0.

    `radius`: the spectral radius at infinity, 1 for no numerical damping, 0 for the most.
    """

    card = "GALF"

    def __init__(self, radius: float = 0.9, length: float = 0.0):
        super().__init__("generalised_alpha")
        self.radius, self.length = radius, length

    def new_integration(self, work: "Work", angles: int, works: int) -> "AlphaIntegration":
        """Return an integration with the settings of the method."""
        integration = super().new_integration(work, angles, works)
        integration.memory["rho"], integration.memory["fixed"] = self.radius, self.length
        found: AlphaIntegration = integration
        return found

    def doubts(self, clock: "np.void") -> list[Fault]:
        """Return what is doubtful about the steps taken: some of given length had to be divided."""
        if not self.length or not clock["rejections"]:
            return []
        message = (
            f"the iterations of {clock['rejections']} steps of {self.length:g} s did not converge, and the "
            "steps were divided; take a smaller step"
        )
        return [Fault("warning", message, id="SOLVE-006")]


class Method(NamedTuple):
    """A method that a deck may name: its meaning, what makes it, and its number in the deck.

    `make(number, length)`: the number is a tolerance or, of `by_radius`, the spectral radius at infinity;
    length is that of a step, s, 0 where it is chosen.
    """

    meaning: str  # in words
    make: Callable[..., Any]  # (number, length): the Integrator
    default: float  # number of a deck that gives none
    by_radius: bool = False  # whether the number is the spectral radius at infinity, and no tolerance


# By the words of the card INTG; the first is that of a deck without one.
METHODS = {
    "GALF": Method("generalised alpha", GeneralisedAlpha, 0.9, by_radius=True),
    "RAD5": Method("Radau", lambda tolerance, length: RadauSteps(), 1e-8),
    "RK45": Method("Runge-Kutta", lambda tolerance, length: ExplicitSteps(), 1e-12),
}
