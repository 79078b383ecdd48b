"""The methods that step a constrained mechanism through time, behind one face.

Each imports its own kernels when it is used.
"""

from collections.abc import Callable
from importlib import import_module
from typing import TYPE_CHECKING, Any

import numpy as np

from ...errors import Fault
from ...model.integrators import METHODS, Integrator, steps_at_limit

if TYPE_CHECKING:
    from ...kernels.constrained.system import Work


KERNELS = "flexmb_cli.kernels.integrators"


class Steps:
    """Steps of an integrator, of lengths that its method chooses by the tolerance, or of a given length."""

    def __init__(self, integrator: Integrator):
        self.card, self.tolerance = integrator.method, integrator.tolerance
        self.type = METHODS[integrator.method]
        self.length = integrator.step if self.type.given_step else 0.0  # s, 0: chosen
        self._radius = integrator.radius

    @property
    def chosen(self) -> bool:
        """Return whether the lengths of its steps are its own choice."""
        return self.length == 0.0

    @property
    def keeps_accelerations(self) -> bool:
        """Return whether a step of chosen length begins with accelerations of the step before."""
        return self.chosen and self.type.radius is not None

    @property
    def _module(self) -> str:
        return f"{KERNELS}.{self.type.module}"

    @property
    def entry(self) -> str:
        """Name of the kernel that is compiled."""
        return f"{self._module.partition('.kernels.')[2]}.integrate_rows"

    @property
    def integrate_rows(self) -> Callable[..., Any]:
        """The kernel."""
        return import_module(self._module).integrate_rows

    def new_integration(self, work: "Work", angles: int, works: int, states: int) -> Any:
        """Return an integration at time 0 with an empty state, for this work and so many angles.

        The works of the first `works` loads are kept; `states`: those of signals.  A given length of its
        steps is clock["step"].
        """
        integration = import_module(self._module).new_integration(
            work, angles, works, *([states] if states else [])
        )
        integration.clock["step"] = self.length
        if self.type.radius is not None:
            integration.memory["rho"] = self._radius
        return integration

    def warnings(self, clock: np.void) -> list[Fault]:
        """Return what is doubtful about the steps taken: some of given length had to be divided, or they lie
        at the limit of stability.
        """
        if self.chosen:
            return steps_at_limit(clock, "GALF or RAD5 (--method alpha, radau)")
        if not clock["rejections"]:
            return []
        message = (
            f"the iterations of {clock['rejections']} steps of {self.length:g} s did not converge, and the "
            "steps were divided; take a smaller step"
        )
        return [Fault("warning", message, id="SOLVE-006")]
