"""What makes one doubt that a deck is in SI units, and bodies that have no mass: notes of `flexmb check`.

A deck drawn in millimetres with masses in kilograms runs without complaint and gives nonsense.  Its
gravity, its lengths, the radii of gyration of its bodies and the density of their nodes tell.
"""

from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np

from ..errors import Fault, Place
from .dynamics import DynamicModel
from .flexible_mechanism import FlexibleMechanism
from .tree import Tree

IN_MILLIMETRES = (9.5e3, 10.1e3)  # gravity of the earth, mm/s²
ON_EARTH = (9.5, 10.1)  # m/s²
FASTEST_SOUND = 2e4  # m/s; 18,000 in diamond
LARGE = 50.0  # m between the joints of one body, for a mechanism under gravity
WIDE = 30.0  # radius of gyration over the distance of joints: inertia in kg mm² would be 1000
NARROW = 1e-2  # the other way round: 1e-3
THIN = 1e-3  # kg/m³ of the box around its nodes; air has 1.2, osmium in millimetres 2e-5


@dataclass(frozen=True)
class Extent:
    """A body: mass, kg; largest principal inertia about the mass centre, kg m²; farthest joint from it, m."""

    name: str
    mass: float
    inertia: float
    size: float
    place: Place | None = None

    @property
    def radius(self) -> float:
        """Radius of gyration, m."""
        return (max(self.inertia, 0.0) / self.mass) ** 0.5 if self.mass > 0 else 0.0


def unit_doubts(model: DynamicModel | FlexibleMechanism | Tree) -> list[Fault]:
    """Notes on the bodies and the gravity of any model with masses."""
    extents, gravity = _EXTENTS[type(model)](model), float(np.linalg.norm(model.gravity))
    notes = [Fault("note", note, body.place, body.name) for body in extents for note in _of_body(body)]
    if isinstance(model, FlexibleMechanism):
        notes += [*_of_frequencies(model), *_of_densities(model)]
    longest = max(extents, key=lambda body: body.size, default=None)
    if IN_MILLIMETRES[0] <= gravity <= IN_MILLIMETRES[1]:
        notes.append(Fault("note", f"gravity {gravity:.6g} looks like mm/s²; decks are in SI units, m/s²"))
    elif longest and ON_EARTH[0] <= gravity <= ON_EARTH[1] and longest.size > LARGE:
        message = f"a joint is {longest.size:.4g} m from the mass centre: are lengths in mm? Decks are in m"
        notes.append(Fault("note", message, longest.place, longest.name))
    return notes


def _of_body(body):
    if body.mass == 0.0 and body.inertia == 0.0:
        yield "has neither mass nor inertia: only what it is joined to can carry it"
    if body.radius and body.size and not NARROW <= body.radius / body.size <= WIDE:
        yield (
            f"mass {body.mass:.4g} kg and inertia {body.inertia:.4g} kg m² make a radius of gyration of "
            f"{body.radius:.3g} m, joints are up to {body.size:.3g} m from the mass centre: "
            "are all in SI units?"
        )


def _of_frequencies(mechanism: FlexibleMechanism):
    """Sound crosses no solid faster than 2e4 m/s, and a body vibrates slower than sound crosses it."""
    for body in mechanism.bodies:
        if body.flexible is None or not body.modes:
            continue
        size = float(np.ptp(body.flexible.r0, axis=0).max())
        lowest = float(body.flexible.frequencies[0])
        if lowest * size > FASTEST_SOUND:
            message = (
                f"the lowest frequency is {lowest:.3g} Hz in a body of {size:.3g} m, as if sound went at "
                f"{lowest * size:.1g} m/s or faster: are mass in kg, stiffness in N/m, nodes in m?"
            )
            yield Fault("note", message, body.place, body.name)


def _of_densities(mechanism: FlexibleMechanism):
    """Nodes in millimetres with matrices in SI units pass every test of them: they know no lengths."""
    for body in mechanism.bodies:
        if body.flexible is None:
            continue
        sides = np.ptp(body.flexible.r0, axis=0)
        if body.m < THIN * float(np.prod(sides)):
            message = (
                f"{body.m:.3g} kg in a box of {sides[0]:.3g} by {sides[1]:.3g} by {sides[2]:.3g} m are less "
                "than a thousandth of air: are the nodes in m?"
            )
            yield Fault("note", message, body.place, body.name)


def _farthest(points, centre) -> float:
    return max((float(np.linalg.norm(np.subtract(point, centre))) for point in points), default=0.0)


def _largest(inertia) -> float:
    return float(np.linalg.eigvalsh(np.asarray(inertia, dtype=float))[-1])


def _about_centre(inertia, mass, centre):
    c = np.asarray(centre, dtype=float)
    return inertia - mass * (c @ c * np.eye(3) - np.outer(c, c))


def _of_young(model: DynamicModel) -> Iterable[Extent]:
    """Bodies that something moves: those held by ground constraints need no mass."""
    mechanism = model.mechanism
    held = {item.body for item in mechanism.grounds}
    masses = {item.body: item for item in model.masses}
    found = []
    for k, body in enumerate(mechanism.bodies):
        if k in held:
            continue
        points = [j.P_i for j in mechanism.joints if j.i == k] + [j.P_j for j in mechanism.joints if j.j == k]
        given = masses.get(k)
        if given is None:
            found.append(Extent(body.name, 0.0, 0.0, _farthest(points, (0.0, 0.0, 0.0)), body.place))
            continue
        xx, yy, zz, xy, yz, zx = given.inertia
        inertia = _largest([[xx, xy, zx], [xy, yy, yz], [zx, yz, zz]])
        found.append(Extent(body.name, given.mass, inertia, _farthest(points, given.centre), given.place))
    return found


def _of_mechanism(mechanism: FlexibleMechanism) -> Iterable[Extent]:
    """Rigid bodies; those of finite elements have what their files say."""
    found = []
    for k, body in enumerate(mechanism.bodies):
        if body.flexible is not None:
            continue
        ends = [end for joint in mechanism.joints for end in (*joint.a, *joint.b) if end.body == k]
        centre = body.s0 / body.m if body.m else np.zeros(3)
        inertia = _largest(_about_centre(body.J0, body.m, centre))
        found.append(Extent(body.name, body.m, inertia, _farthest([e.r0 for e in ends], centre), body.place))
    return found


def _of_tree(tree: Tree) -> Iterable[Extent]:
    """Rigid bodies; the root of each is its own hinge."""
    found = []
    for k, body in enumerate(tree.bodies):
        if body.elastic is not None:
            continue
        points = [(0.0, 0.0, 0.0), *(hinge.point for hinge in tree.hinges if hinge.parent == k)]
        inertia = _largest(_about_centre(body.inertia, body.mass, body.centre))
        size = _farthest(points, body.centre)
        found.append(Extent(body.name, body.mass, inertia, size, body.place))
    return found


_EXTENTS = {DynamicModel: _of_young, FlexibleMechanism: _of_mechanism, Tree: _of_tree}
