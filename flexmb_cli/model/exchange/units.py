"""A rigid model in other units: numbers of a deck in millimetres, kilograms and seconds in SI, and back."""

from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any

from ..joints import ANGLE
from ..laws import FUNCTIONS, OF_TIME, VECTOR, Element, Frames, Line, Parameter
from .functions import scaled, stretched
from .rigid_model import RigidModel, vector
from .shapes import scaled_shape

if TYPE_CHECKING:
    from .rigid_model import RigidBody, RigidJoint


_INCH, _POUND_FORCE = 0.0254, 4.4482216152605


@dataclass(frozen=True)
class Units:
    """A consistent system: its units of length, m, and mass, kg; times are in s.  `reported`: it in words."""

    length: float
    mass: float
    reported: str


UNITS = {
    "m": Units(1.0, 1.0, "m, kg, s, N"),
    "mm": Units(1e-3, 1e3, "mm, t, s, N"),
    "mm-kg": Units(1e-3, 1.0, "mm, kg, s, mN"),
    "cm": Units(1e-2, 1e-3, "cm, g, s, dyn"),
    "in": Units(_INCH, _POUND_FORCE / _INCH, "in, lbf s^2/in, s, lbf"),
}


def in_units(model: RigidModel, old: Units, new: Units) -> RigidModel:
    """Return a model whose numbers are in `old` units with numbers in `new` ones."""
    L, M = old.length / new.length, old.mass / new.mass
    return model if L == 1.0 == M else _Scaling(L, M).model(model)


class _Scaling:
    """Factors of lengths and masses; those of all else follow, times being the same."""

    def __init__(self, L: float, M: float):
        self.L, self.M, self.force, self.torque = L, M, M * L, M * L * L

    def model(self, model: RigidModel) -> Any:
        parts: dict[str, Any] = {
            name: tuple(rescale(item) for item in getattr(model, name))
            for name, rescale in self._by_part().items()
        }
        return replace(model, gravity=_times(self.L, model.gravity), **parts)

    def _by_part(self) -> dict[str, Callable[[Any], Any]]:
        return {
            "bodies": self._body,
            "joints": self._joint,
            "drivers": self._driver,
            "joint_drivers": self._joint_driver,
            "elements": self._element,
            "couplings": self._coupling,
            "forces": self._force,
            "torques": self._torque,
            "points": self._point,
            "shapes": self._shape,
        }

    def _driver(self, item: Any) -> Any:
        return replace(item, function=scaled(item.function, self.L if item.direction <= 3 else 1.0))

    def _joint_driver(self, item: Any) -> Any:
        return replace(item, function=scaled(item.function, 1.0 if item.coordinate == ANGLE else self.L))

    def _force(self, item: Any) -> Any:
        return replace(item, force=_times(self.force, item.force), point=_times(self.L, item.point))

    def _torque(self, item: Any) -> Any:
        return replace(item, torque=_times(self.torque, item.torque))

    def _point(self, item: Any) -> Any:
        return replace(item, s=_times(self.L, item.s))

    def _shape(self, item: Any) -> Any:
        return scaled_shape(item, self.L)

    def _body(self, body: "RigidBody") -> Any:
        L = self.L
        return replace(
            body,
            r=L * body.r,
            velocity=L * body.velocity,
            mass=self.M * body.mass,
            centre=L * body.centre,
            inertia=self.torque * body.inertia,
        )

    def _joint(self, joint: "RigidJoint") -> Any:
        points = {name: _times(self.L, getattr(joint, name)) for name in ("P_i", "P_j")}
        return replace(joint, **points, size=self.L * joint.size)

    def _element(self, item: Element) -> Element:
        def changed(p: Parameter, value: Any) -> Any:
            turning = item.turning if p.turning is None else p.turning
            effort, length = (self.torque, 1.0) if turning else (self.force, self.L)
            factor = effort**p.effort * length**p.length
            if p.kind in FUNCTIONS:
                return value and stretched(scaled(value, factor), 1.0 if p.kind == OF_TIME else length)
            return _times(factor, value) if p.kind == VECTOR else factor * value

        ends = item.measure
        if isinstance(ends, Line | Frames):
            ends = ends._replace(P_i=_times(self.L, ends.P_i), P_j=_times(self.L, ends.P_j))
        return replace(item, measure=ends, values=item.changed(changed))

    def _coupling(self, item: Any) -> Any:
        terms = tuple(
            (joint, coordinate, factor if coordinate == ANGLE else factor / self.L)
            for joint, coordinate, factor in item.terms
        )
        return replace(item, terms=terms)


def _times(factor: float, values: tuple[float, float, float]) -> Any:
    return vector(factor * value for value in values)
