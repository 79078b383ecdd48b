"""Integrators of mechanisms: their words on cards and for `--method`, and what a deck says of one."""

from dataclasses import dataclass
from typing import TYPE_CHECKING

from ..errors import Fault

if TYPE_CHECKING:
    import numpy as np


@dataclass(frozen=True)
class IntegratorType:
    """A method that steps mechanisms under constraints through time.

    `module` of `kernels/integrators` has new_integration(work, angles, n_loads) and the kernel
    integrate_rows(task, system, work, integration, report, budget).
    """

    option: str  # word for `--method`
    meaning: str  # in words
    module: str  # its file
    tolerance: float  # of a VSDF deck that gives none
    radius: float | None = None  # spectral radius at infinity of a deck that gives none; None: has no radius
    given_step: bool = False  # whether a deck may give the length of its steps
    implicit: bool = False  # whether it is for stiff springs, dampers and modes, too


# By the words of cards (INTG of VSDF decks).
METHODS = {
    "RK45": IntegratorType("dop853", "Runge-Kutta", "constrained_dop853", 1e-12),
    "RAD5": IntegratorType("radau", "Radau", "radau5", 1e-8, implicit=True),
    # Ten times the tolerance of its steps keeps a thousandth of it.
    "GALF": IntegratorType(
        "alpha", "generalised alpha", "generalised_alpha", 1e-6, radius=0.9, given_step=True, implicit=True
    ),
}
METHOD_OPTIONS = tuple(method.option for method in METHODS.values())
# Of trees by Kane's equations, in the order of their numbers on the card METH.
TREE_METHODS = ("dop853", "radau", "lsoda", "sdirk4")
LIBRARY_TREE_METHODS = ("radau", "lsoda")  # those of SciPy
# Those that Radau's method stands for where a tree has elements.
IMPLICIT_TREE_METHODS = ("radau", "sdirk4")


@dataclass(frozen=True)
class Integrator:
    """Settings of an integrator: its method, its steps and their accuracy."""

    method: str = "RK45"  # one of METHODS
    step: float = 0.0  # length of its steps, s; 0: chosen by the tolerance
    tolerance: float = 1e-9  # relative and absolute error of a chosen step
    radius: float = 0.9  # spectral radius at infinity of GALF: 1 for no numerical damping, 0 for the most


def word_of(option: str) -> str:
    """Return the card's word for a method of `--method`."""
    return next(word for word, method in METHODS.items() if method.option == option)


FEWEST, SHARE = 4, 0.05  # steps of those looked at (a quarter), and of all, that make a warning
LOOSE = 1e-5  # tolerance from which on they do


def steps_at_limit(clock: "np.void", methods: str) -> list[Fault]:
    """Return a warning where an explicit method made steps as long as its stability allows; else nothing.

    Its error estimate does not see there what becomes of the vibrations that its steps do not resolve.
    """
    if clock["rtol"] < LOOSE or clock["stiff"] < max(FEWEST, SHARE * clock["steps"]):
        return []
    message = (
        f"of {clock['steps']} steps about {min(4 * clock['stiff'], clock['steps'])} are as long as the "
        "stability of the explicit method allows: the fastest vibrations limit them, and errors may exceed "
        f"the tolerance a thousandfold; take {methods}, or a tolerance a hundred times as small"
    )
    return [Fault("warning", message, id="SOLVE-060")]
