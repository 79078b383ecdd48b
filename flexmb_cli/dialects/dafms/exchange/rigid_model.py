"""Rigid model of a DAFMS deck, in the terms of `model.exchange`."""

from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from ....deck.record import Deck
from ....errors import Fault, ModelError
from ....model.exchange.conversion import Conversion, Start, about_centre
from ....model.exchange.rigid_model import RigidBody, RigidJoint, RigidModel, vector
from ....model.integrators import Integrator
from ....model.joint_elements import JointDriver
from ....model.joints import ANGLE, STROKE
from ....model.loads import AppliedForce, AppliedTorque
from ....model.time_functions import POLYNOMIAL, MotionFunction
from ....model.tree import ROTATION, TRANSLATION, Hinge, Tree
from ....model.vectors import rotation_matrix

# Types of joints by the numbers of free rotations and translations.
_KINDS = {
    (0, 0): "fixed", (1, 0): "revolute", (2, 0): "universal", (3, 0): "spherical", (0, 1): "translational",
    (1, 1): "cylindrical",
}  # fmt: skip
FREE = (3, 3)
_PARALLEL = 1e-9
_OPEN = 1e-9  # m


@dataclass(frozen=True)
class _Named:
    """An item that has no name of its own, for messages."""

    name: str
    place: object = None


def rigid_model(deck: Deck, build: Callable[[], Tree], start: Callable[[Tree], Start]) -> RigidModel:
    """Return the rigid model of a deck at its start; raises ModelError with all that is not converted."""
    tree = build()
    _refuse_flexible(tree)
    return _Conversion(tree, start(tree)).converted(tree.shapes, tree.elements)


def _refuse_flexible(tree: Tree) -> None:
    message = "the body is flexible; only rigid bodies are converted"
    flexible = [body for body in tree.bodies if body.elastic is not None]
    if flexible:
        raise ModelError(
            [Fault("error", message, body.place, body.name, id="DAFMS-189") for body in flexible]
        )


class _Conversion(Conversion):
    """Collects the parts of the model."""

    def __init__(self, tree: Tree, start: Start):
        super().__init__(start)
        self.tree, self.first, self.t_start = tree, self.now, tree.time.start
        self.A = [A for _, A in self.now]
        self.number: dict[int, int] = {}  # of the joint of a body's hinge
        self.q = {
            (c.body, c.motion, c.axis): float(q) for c, q in zip(tree.coordinates, start.q, strict=True)
        }

    def model(self) -> RigidModel:
        tree, time = self.tree, self.tree.time
        joints: list[RigidJoint] = []
        for k in range(len(tree.bodies)):
            self._add_hinge(joints, k)
        joints += self._closures()
        explicit = tree.integration.method in ("dop853", "lsoda")
        integrator = Integrator("RK45" if explicit else "RAD5", tolerance=tree.integration.rtol)
        return RigidModel(
            tuple(self._body(k) for k in range(len(tree.bodies))),
            replace(time, start=0.0, end=time.end - time.start),
            vector(tree.gravity),
            tuple(joints),
            joint_drivers=tuple(self.joint_drivers((*self._prescribed(), *tree.elements.drivers))),
            forces=tuple(
                AppliedForce(f"force of {body.name}", k, vector(body.force), place=body.place)
                for k, body in enumerate(tree.bodies)
                if any(body.force)
            ),
            torques=tuple(self._torques()),
            integrator=integrator,
            elements=self.elements(tree.elements.forces),
            couplings=tuple(self.couplings(tree.elements.couplings)),
        )

    def _body(self, k: int) -> RigidBody:
        body = self.tree.bodies[k]
        c = np.array(body.centre, float)
        inertia = about_centre(body.mass, c, body.inertia)
        # What the difference leaves of a thin rod's moment is round-off of the numbers given.
        inertia[np.abs(inertia) < 1e-12 * np.abs(body.inertia).max()] = 0.0
        return self.rigid_body(k, body.name, (body.mass, c, inertia), body.place)

    def _add_hinge(self, joints: list[RigidJoint], k: int) -> None:
        hinge = self.tree.hinges[k]
        free = len(hinge.rotations), len(hinge.translations)
        if free == FREE:
            return
        kind = _KINDS.get(free)
        if kind is None or (kind == "cylindrical" and hinge.rotations != hinge.translations):
            name = self.tree.bodies[k].name
            reported = "free rotations {} and translations {}".format(*(_axes(a) for a in _dofs(hinge)))
            self.refusals.add(
                _Named(f"hinge of {name}", hinge.place),
                f"a hinge with {reported} is not a single joint",
                id="DAFMS-182",
            )
            return
        self.number[k] = len(joints)
        joints.append(self._joint(k, hinge, kind))

    def _joint(self, k: int, hinge: Hinge, kind: str) -> Any:
        frame = rotation_matrix(hinge.frame)
        axes = {ROTATION: hinge.rotations, TRANSLATION: hinge.translations}
        first = (axes[ROTATION] or axes[TRANSLATION] or (1,))[0]
        s_i = frame[:, first - 1]
        if kind == "universal":
            s_j = np.eye(3)[hinge.rotations[1] - 1]
        else:
            # The axis is the same in both bodies.
            s_j = self.A[k].T @ (self.A[hinge.parent] @ s_i)
        names = f"hinge of {self.tree.bodies[k].name}", kind, hinge.parent, k
        return RigidJoint(*names, vector(hinge.point), (0.0, 0.0, 0.0), vector(s_i), vector(s_j),
                          place=hinge.place)  # fmt: skip

    def _closures(self) -> Iterator[Any]:
        for closure in (c for c in self.tree.closures if not (c.curve or c.general or c.roll)):
            if len(closure.directions) < 3 and not self._is_planar(closure):
                message = "a closure of some directions is converted in planar mechanisms only"
                self.refusals.add(closure, message, id="DAFMS-183")
                continue
            yield RigidJoint(
                closure.name, "spherical", closure.b, closure.a, vector(closure.b_point),
                vector(closure.a_point), place=closure.place,
            )  # fmt: skip

    def _is_planar(self, closure: Any) -> Any:
        """Return whether all moves in the plane of the closed directions, so that the third is closed
        anyway.
        """
        left = [axis for axis in (1, 2, 3) if axis not in closure.directions]
        if len(left) != 1:
            return False
        normal = self.A[closure.b][:, left[0] - 1]
        for hinge in self.tree.hinges:
            F = self.A[hinge.parent] @ rotation_matrix(hinge.frame)
            along = [abs(F[:, axis - 1] @ normal) for axis in hinge.rotations]
            beside = [abs(F[:, axis - 1] @ normal) for axis in hinge.translations]
            if any(abs(x - 1.0) > _PARALLEL for x in along) or any(x > _PARALLEL for x in beside):
                return False
        (r_a, A_a), (r_b, A_b) = self.now[closure.a], self.now[closure.b]
        gap = r_a + A_a @ np.array(closure.a_point) - r_b - A_b @ np.array(closure.b_point)
        return abs(gap @ normal) < _OPEN

    def joint_of(self, joint: int) -> int | None:
        """Return the number of the joint of a body's hinge, None if it has none."""
        return self.number.get(joint)

    def joint_coordinate(self, item: Any, body: int, coordinate: str) -> tuple[int, str, float] | None:
        """Number of the joint of a body's hinge, the coordinate there, and its value at the start."""
        hinge, (motion, axis) = self.tree.hinges[body], coordinate.split()
        free = len(hinge.rotations), len(hinge.translations)
        if body not in self.number or free not in ((1, 0), (0, 1), (1, 1)):
            message = "in a hinge with several free rotations or translations it is not converted"
            self.refusals.add(item, message, id="DAFMS-173")
            return None
        return self.number[body], ANGLE if motion == ROTATION else STROKE, self.q[body, motion, int(axis)]

    def _prescribed(self) -> Iterator[JointDriver]:
        for item in self.tree.prescribed:
            function = MotionFunction(POLYNOMIAL, (0.0, item.B, 0.5 * item.A, 0.0))
            name = f"motion of {self.tree.bodies[item.body].name}"
            yield JointDriver(name, item.body, f"{item.motion} {item.axis}", function, item.place)

    def _torques(self) -> Iterator[Any]:
        for k, body in enumerate(self.tree.bodies):
            if any(body.torque):
                yield AppliedTorque(f"torque of {body.name}", k, vector(body.torque), place=body.place)
        for item in self.tree.torques:
            name = f"torque of {self.tree.bodies[item.body].name}"
            axis = vector(np.eye(3)[item.axis - 1])
            yield AppliedTorque(name, item.body, axis, factor=item.function, place=item.place)


def _dofs(hinge: Any) -> Any:
    return hinge.rotations, hinge.translations


def _axes(axes: tuple[int, ...]) -> Any:
    return ", ".join(map(str, axes)) or "none"
