"""Linearised motion of the mechanism of a deck, about a time or an equilibrium."""

from collections.abc import Callable
from contextlib import AbstractContextManager, nullcontext
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any

import numpy as np

from ..errors import Fault, ModelError
from ..model.flexible_mechanism import FlexibleMechanism
from ..model.joint_elements import JointElements
from ..model.loads import DynamicModel
from ..model.mechanism import TimeGrid
from ..model.signals import SAMPLE_SIGNAL
from ..model.tree import Tree
from ..solvers.compilation import Notices, announce_compiling
from .check.check import FARTHEST_STEPS
from .outcome import Run

if TYPE_CHECKING:
    from ..solvers.constrained.analysis import LinearisableMotion
    from ..solvers.linearisation.state_space import StateSpace


# Speeds up to which uncompiled kernels answer before compiled ones would be ready.
MOST_SPEEDS_INTERPRETED = 30


@dataclass(frozen=True)
class Wish:
    """State to linearise about: `time`, s (None: the start), or the `equilibrium` found from there.

    `state_space`: whether B, C and D are requested; `out`: the file that they go to; `responds`: a frequency
    response is requested.
    """

    time: float | None = None
    equilibrium: bool = False
    state_space: bool = False
    out: str | None = None
    responds: bool = False

    @property
    def of_mechanism(self) -> bool:
        """Return whether a place to linearise at is named, or a file for the state space."""
        return self.equilibrium or self.time is not None or self.out is not None or self.responds


@dataclass(frozen=True)
class MechanismModes:
    """Linearised motion about `position` at `time`.

    `modes` is a `solvers.linearisation.constrained.Modes`; `names` (n,) of the speeds its shapes have;
    `position`: name and numbers of each body or coordinate, which lengths in m, Euler parameters and angles
    in rad make up.
    `space`: its `solvers.linearisation.state_space.StateSpace`, where that is wanted.
    """

    time: float
    equilibrium: bool
    modes: Any
    names: tuple[str, ...]
    position: tuple[tuple[str, tuple[float, ...]], ...]
    space: Any = None

    def as_dict(self) -> dict[str, Any]:
        """The record that `--json` prints."""
        modes = self.modes
        return {
            "time": self.time,
            "equilibrium": self.equilibrium,
            "frozen": not modes.constant,
            "degrees_of_freedom": modes.degrees_of_freedom,
            "frequency": modes.frequency.tolist(),
            "damping": modes.damping.tolist(),
            "growing": modes.growing.tolist(),
            "decaying": modes.decaying.tolist(),
            "unheld": modes.unheld,
            "eigenvalues": [[value.real, value.imag] for value in modes.eigenvalues.tolist()],
            "speeds": list(self.names),
            "shapes": [{"real": shape.real.tolist(), "imag": shape.imag.tolist()} for shape in modes.shapes],
            "position": {name: list(values) for name, values in self.position},
            "state_space": self.space and self.state_space,
        }

    @property
    def state_space(self) -> dict[str, Any]:
        """The record of the state space."""
        return {"time": self.time, **record_of(self.space)}


def record_of(space: "StateSpace") -> dict[str, Any]:
    """Return a StateSpace as lists and words."""
    signals = {
        what: [{"name": s.name, "unit": s.unit} for s in getattr(space, what)]
        for what in ("inputs", "outputs")
    }
    states = [vars(s) for s in space.states]
    matrices = {name: getattr(space, name).tolist() for name in "ABCD"}
    return {**matrices, "states": states, **signals, "axes": space.axes, "constant": space.constant}


def flexible_modes(mechanism: FlexibleMechanism, wish: Wish, run: Run) -> MechanismModes:
    """Linearised motion of a mechanism of flexible bodies; raises AnalysisError where there are none."""
    speeds = sum(6 + body.modes for body in mechanism.bodies)
    with kernels_for(speeds, wish, mechanism.time, run.listener):
        from ..solvers.constrained.flexible_dynamics import FlexibleDynamics

        return _of_mechanism(FlexibleDynamics(mechanism), wish, run)


def dynamic_modes(model: DynamicModel, wish: Wish, run: Run) -> MechanismModes:
    """Linearised motion of a dynamic model; raises AnalysisError where there are none."""
    run.warn(())
    with kernels_for(6 * len(model.mechanism.bodies), wish, model.mechanism.time, run.listener):
        from ..solvers.constrained.young_dynamics import ForwardDynamics

        return _of_mechanism(ForwardDynamics(model), wish, run)


def kernels_for(
    speeds: int,
    wish: Wish,
    grid: TimeGrid,
    listener: Notices,
    entry: str = "integrators.constrained_dop853.integrate_rows",
) -> AbstractContextManager[None]:
    """Return a block whose kernels are uncompiled for small mechanisms that need not move first.

    Raises ModelError for a time to linearise at that is too late.
    """
    from ..solvers.compilation import interpreting

    if wish.time is not None and wish.time - grid.start > FARTHEST_STEPS * grid.step:
        message = (
            f"--at {wish.time:g}: later than {FARTHEST_STEPS} of the deck's steps; ask for an earlier time"
        )
        raise ModelError([Fault("error", message, id="RUN-017")])
    if speeds <= MOST_SPEEDS_INTERPRETED and (wish.time is None or wish.time <= grid.start):
        return interpreting()
    announce_compiling(listener, entry)
    return nullcontext()


def _check_lines(elements: JointElements, wish: Wish) -> None:
    """Refuse what signals do not have: a linear law if they are sampled, and an equilibrium of their states.

    Discs and spheres that roll have more positions than motions, which no equations of vibrations are for.
    """
    faults = []
    for roll in elements.rolls:
        if len(roll.directions) > 2:
            message = "rolls on a plane: it has more positions than motions, and no modes; leave the line out"
            faults.append(Fault("error", message, roll.place, roll.name, id="SOLVE-200"))
    for signal in elements.signals:
        if signal.kind == SAMPLE_SIGNAL:
            message = "is sampled: motion between samples has no modes; leave out period= to linearise"
            faults.append(Fault("error", message, signal.place, signal.name, id="RUN-140"))
        elif signal.states and wish.equilibrium:
            message = (
                "has states of its own, which an equilibrium does not include; take --at and a time at which "
                "the motion is at rest"
            )
            faults.append(Fault("error", message, signal.place, signal.name, id="RUN-141"))
    if faults:
        raise ModelError(faults)


def _linearised(
    analysis: Any, wish: Wish, run: Run, begin: Callable[[], object], motion_type: type, responses: type,
    signals: Callable[..., Any], elements: JointElements,
) -> tuple[Any, Any, "StateSpace | None"]:  # fmt: skip
    """Return the linearised motion where `begin` leads or at the equilibrium, its modes and state space."""
    from ..solvers.linearisation.constrained import linearised, modes_of
    from ..solvers.linearisation.equilibrium import find_equilibrium
    from ..solvers.linearisation.state_space import state_space

    try:
        begin()
    finally:
        run.outcome.faults += analysis.warnings
    run.warn(())
    _check_lines(elements, wish)
    if wish.equilibrium:
        find_equilibrium(analysis, motion_type)
    motion, A, constant = linearised(analysis, motion_type)
    f, space = motion.dofs, None
    if wish.state_space or wish.out is not None:
        space = state_space(responses(motion), responses(motion.soon(A[: 2 * f, : 2 * f])), signals(motion))
    return motion, modes_of(motion, A, constant), space


def _of_mechanism(analysis: "LinearisableMotion", wish: Wish, run: Run) -> MechanismModes:
    from ..solvers.linearisation.constrained import ConstrainedLinearised, bring_to
    from ..solvers.linearisation.constrained_responses import ConstrainedResponses, constrained_signals

    time, arrays = analysis.grid.start if wish.time is None else wish.time, analysis.arrays
    motion, modes, space = _linearised(
        analysis, wish, run, lambda: bring_to(analysis, time), ConstrainedLinearised, ConstrainedResponses,
        constrained_signals, analysis.elements,
    )  # fmt: skip
    names = tuple(arrays.speed_name(k) for k in range(arrays.speeds))
    z = motion.q
    position = [(name, tuple(z[7 * b : 7 * b + 7].tolist())) for b, name in enumerate(arrays.body_names)]
    first = 7 * arrays.bodies
    for f in arrays.flexible:
        eta = z[first + f["first"] : first + f["first"] + f["modes"]]
        position.append((f"{arrays.body_names[f['body']]} modal", tuple(eta.tolist())))
    return MechanismModes(motion.t, wish.equilibrium, modes, names, tuple(position), space)


def tree_modes(tree: Tree, wish: Wish, run: Run) -> MechanismModes:
    """Linearised motion of a tree; raises ModelError, AnalysisError."""
    entry = "integrators.tree_dop853.integrate_rows"
    with kernels_for(len(tree.coordinates), wish, tree.time, run.listener, entry):
        return _of_tree(tree, wish, run)


def _of_tree(tree: Tree, wish: Wish, run: Run) -> MechanismModes:
    from ..solvers.linearisation.tree import TreeLinearised, start_tree
    from ..solvers.linearisation.tree_responses import TreeResponses, tree_signals
    from ..solvers.tree.analysis import TreeAnalysis

    grid = tree.time
    time = grid.start if wish.time is None else wish.time
    if time > grid.start:
        tree = replace(tree, time=replace(grid, end=time, step=time - grid.start))
    analysis = TreeAnalysis(tree)
    motion, modes, space = _linearised(
        analysis,
        wish,
        run,
        lambda: start_tree(analysis, time),
        TreeLinearised,
        TreeResponses,
        tree_signals,
        tree.elements,
    )
    names = tuple(coordinate.name for coordinate in tree.coordinates)
    q = np.asarray(motion.z[len(names) : 2 * len(names)]).tolist()
    position = tuple((name, (value,)) for name, value in zip(names, q, strict=True))
    return MechanismModes(motion.t, wish.equilibrium, modes, names, position, space)
