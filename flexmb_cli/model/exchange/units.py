"""A rigid model in other units: numbers of a deck in millimetres, kilograms and seconds in SI, and back."""

from dataclasses import replace
from typing import Any, NamedTuple

from ...deck.units import Units
from ..joint_elements import Coupling
from ..laws import OF_TIME, Cam, Element, Frames, Line, Parameter, is_angle
from ..time_functions import MotionFunction
from .functions import transformed
from .rigid_model import RigidModel, vector

# Powers of the units of length and of mass of the numbers of each part; those of time are the same.
_POWERS = {
    "bodies": {"r": (1, 0), "velocity": (1, 0), "mass": (0, 1), "centre": (1, 0), "inertia": (2, 1)},
    "joints": {"P_i": (1, 0), "P_j": (1, 0), "size": (1, 0)},
    "forces": {"force": (1, 1), "point": (1, 0)},
    "torques": {"torque": (2, 1)},
    "points": {"s": (1, 0)},
    "shapes": {"sizes": (1, 0), "offset": (1, 0), "unit": (1, 0)},
}


def in_units(model: RigidModel, old: Units, new: Units) -> RigidModel:
    """Return a model whose numbers are in `old` units with numbers in `new` ones."""
    times = _Scaling(old.length / new.length, old.mass / new.mass)
    parts: dict[str, Any] = {
        part: tuple(
            replace(item, **{name: times(getattr(item, name), *powers) for name, powers in fields.items()})
            for item in getattr(model, part)
        )
        for part, fields in _POWERS.items()
    }
    return replace(
        model,
        gravity=times(model.gravity),
        drivers=tuple(replace(d, function=times(d.function, d.direction <= 3)) for d in model.drivers),
        joint_drivers=tuple(
            replace(d, function=times(d.function, not is_angle(d.coordinate))) for d in model.joint_drivers
        ),
        elements=tuple(map(times.element, model.elements)),
        couplings=tuple(map(times.coupling, model.couplings)),
        **parts,
    )


class _Scaling(NamedTuple):
    """Old units of length and mass in new ones."""

    L: float  # old unit of length in new ones, no unit
    M: float  # old unit of mass in new ones, no unit

    def __call__(self, value: Any, length: int = 1, mass: int = 0, stretch: int = 0) -> Any:
        """Return a number, vector or function of these powers; the argument of a function has `stretch`."""
        factor = self.M**mass * self.L**length
        if isinstance(value, MotionFunction):
            return transformed(value, factor=factor, stretch=self.L**stretch)
        return vector(factor * x for x in value) if isinstance(value, tuple) else factor * value

    def element(self, item: Element) -> Element:
        """Return a force element, whose parameters have powers of its effort and of its coordinate."""

        def changed(p: Parameter, value: Any) -> Any:
            turning = item.turning if p.turning is None else p.turning
            length = p.effort * (2 if turning else 1) + p.length * (not turning)
            stretch = int(p.kind != OF_TIME and not turning)
            return value if value is None else self(value, length, p.effort, stretch)

        ends = item.measure
        if isinstance(ends, Line | Frames):
            ends = ends._replace(P_i=self(ends.P_i), P_j=self(ends.P_j))
        if isinstance(ends, Cam):
            ends = ends._replace(function=self._of_cam(ends.function, ends.coordinate, ends.cam_coordinate))
        return replace(item, measure=ends, values=item.changed(changed))

    def coupling(self, item: Coupling) -> Coupling:
        """Return a coupling, whose factors are of angles and strokes."""
        terms = (
            (joint, name, self(factor, 0 if is_angle(name) else -1)) for joint, name, factor in item.terms
        )
        function = item.function and self._of_cam(item.function, item.terms[0][1], item.terms[-1][1])
        return replace(item, terms=tuple(terms), function=function)

    def _of_cam(self, function: MotionFunction, follower: str, cam: str) -> Any:
        """Return the function of a cam's coordinate that a follower's coordinate equals."""
        return self(function, int(not is_angle(follower)), stretch=int(not is_angle(cam)))
