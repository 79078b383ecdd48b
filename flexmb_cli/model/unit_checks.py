"""Warnings about a deck that may not be in SI units, and about bodies without mass, for all commands.

A deck drawn in millimetres with masses in kilograms runs without complaint and gives nonsense.  It is
recognised by its gravity, its lengths, and the radii of gyration and densities of its bodies.  Masses in
tonnes with all else in SI units divide densities by a thousand.
"""

import math
from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any, cast

import numpy as np

from ..deck.units import UNITS as SYSTEMS
from ..deck.units import Units
from ..errors import Fault, FaultList, Place

if TYPE_CHECKING:  # a run imports the models of its own dialect only
    from .flexible_mechanism import FlexibleMechanism, FloatingBody
    from .loads import DynamicModel
    from .tree import Tree

IN_MILLIMETRES = (9.5e3, 10.1e3)  # gravity of the earth, mm/s²
ON_EARTH = (9.5, 10.1)  # m/s²
FASTEST_SOUND = 2e4  # m/s; 18,000 in diamond
LARGE = 50.0  # m between the joints of one body, for a mechanism under gravity
# Radius of gyration over the distance of joints.  A rod between joints at its ends has 0.58, with its mass in
# tonnes 18, with its inertia in kg mm² 580.  A flywheel may have its joint beside its centre: a wide body is
# doubted if it is too light for its size as well, or wider than any.
WIDE, WIDE_WITHOUT_AXIS, WIDEST_OF_ALL = 30.0, 12.0, 300.0
NARROW = 1e-2  # the other way round: 1e-3
FOAM = 20.0  # kg/m³ of the box around a body; light foams have 20, tungsten in tonnes 19, steel 7.9
OSMIUM = 2.3e4  # kg/m³, rounded up
SOLID = 300.0  # kg/m³; light wood, or aluminium that fills a ninth of its box
# Units that a file may have, and what they multiply the density by, once they are converted.
UNITS = {
    "nodes in mm (times 0.001)": 1e9,
    "nodes in cm (times 0.01)": 1e6,
    "nodes in inches (times 0.0254)": 0.0254**-3,
    "masses in tonnes (times 1000)": 1e3,
    "nodes in mm and masses in tonnes": 1e12,
    "masses in g (times 0.001)": 1e-3,
    "nodes converted from mm twice (times 1000)": 1e-9,
}
# kg/m³ of the ellipsoid with a rigid body's mass and inertia.  With a mass in tonnes it grows √1000 times in
# every direction: osmium gets 7e-4, steel 2.5e-4.  1 kg with 1 kg m² about all axes has 6e-2.
HOLLOW = 1e-3
# Of the homogeneous ellipsoid, disc or rod with a body's mass and inertia: kg/m³, kg/m² (paper has 0.08) and
# kg/m, above which the body is heavy enough for its size.  Steel wire of 1.3 mm has 0.01 kg/m.
HEAVY = {3: 1.0, 2: 0.1, 1: 0.01}
FLAT = 1e-6  # of the largest semi-axis: a body without extent in that direction

UNEVEN_MASSES = 1e9  # ratio of two masses that double precision does not bear


@dataclass(frozen=True)
class Extent:
    """A body: mass, kg; principal moments about the mass centre, kg m²; farthest joint from it, m."""

    name: str
    mass: float
    moments: tuple[float, ...]
    size: float
    place: Place | None = None

    def in_si(self, units: Units) -> "Extent":
        """Return a body whose numbers are in `units` in SI units."""
        moments = tuple(units.mass * units.length**2 * moment for moment in self.moments)
        return replace(self, mass=units.mass * self.mass, moments=moments, size=units.length * self.size)

    @property
    def inertia(self) -> float:
        """Largest principal moment of inertia, kg m²."""
        return max(self.moments)

    @property
    def axes(self) -> np.ndarray:
        """Semi-axes of the homogeneous ellipsoid with this mass and these moments, m; 0 where it has none."""
        squares = [2.5 * (sum(self.moments) - 2.0 * moment) for moment in self.moments]
        return np.sqrt(np.maximum(squares, 0.0) / self.mass) if self.mass > 0.0 else np.zeros(3)

    @property
    def density(self) -> float:
        """Density of that ellipsoid, kg/m³; inf of a thin one."""
        axes = self.axes
        return self.mass / (4.0 / 3.0 * np.pi * float(np.prod(axes))) if np.all(axes > 0.0) else np.inf

    @property
    def heavy(self) -> bool:
        """Return whether ellipsoid, disc or rod has the density of a material."""
        axes = self.axes[self.axes > FLAT * self.axes.max()]
        volume = {3: 4.0 / 3.0 * np.pi, 2: np.pi, 1: 2.0}.get(axes.size, 1.0) * float(np.prod(axes))
        return self.mass > HEAVY.get(axes.size, 0.0) * volume

    @property
    def radius(self) -> float:
        """Radius of gyration, m."""
        return (max(self.inertia, 0.0) / self.mass) ** 0.5 if self.mass > 0 else 0.0


def unit_warnings(model: "DynamicModel | FlexibleMechanism | Tree", system: str = "") -> list[Fault]:
    """Notes on the bodies and the gravity of any model with masses; `system`: units that its deck says."""
    kind = type(model).__name__
    if kind == "DynamicModel" and cast("DynamicModel", model).without_masses:
        return FaultList()
    units, longest = SYSTEMS[system or "m"], None
    gravity = float(np.linalg.norm(model.gravity)) * units.length
    notes, masses = FaultList(), []
    for body in (stored.in_si(units) for stored in _EXTENTS[kind](model)):
        notes += _of_body(body)
        masses.append((body.name, body.mass))
        if longest is None or body.size > longest.size:
            longest = body
    if kind == "FlexibleMechanism":
        bodies = cast("FlexibleMechanism", model).bodies
        flexible = [body for body in bodies if body.flexible is not None]
        notes += [*_of_frequencies(flexible, units), *_of_densities(flexible, units)]
    if message := uneven_masses(masses):
        notes.append(Fault("note", message, id="MODEL-022"))
    if IN_MILLIMETRES[0] <= gravity <= IN_MILLIMETRES[1]:
        notes.append(
            Fault(
                "note", f"gravity {gravity:.6g} looks like mm/s²; decks are in SI units, m/s²", id="MODEL-011"
            )
        )
    elif longest and ON_EARTH[0] <= gravity <= ON_EARTH[1] and longest.size > LARGE:
        message = f"a joint is {longest.size:.4g} m from the mass centre: are lengths in mm? Decks are in m"
        notes.append(Fault("note", message, longest.place, longest.name, id="MODEL-012"))
    return notes


def uneven_masses(bodies: Sequence[tuple[str, float]]) -> str:
    """Return that masses, kg, of two bodies are too far apart to solve for both; "" where none are."""
    given = [body for body in bodies if body[1] > 0.0]
    if not given:
        return ""
    (light, least), (heavy, most) = (pick(given, key=lambda body: body[1]) for pick in (min, max))
    if most < UNEVEN_MASSES * least:
        return ""
    return (
        f"the masses of {heavy} and {light} are {most:g} and {least:g} kg, in a ratio of {most / least:.0e}, "
        "at which round-off dominates the lighter one; give it more mass, or leave it out"
    )


def _of_body(body: Extent) -> Iterator[Fault]:
    if body.mass == 0.0 and body.inertia == 0.0:
        message = "has neither mass nor inertia: only what it is joined to can carry it"
        yield Fault("note", message, body.place, body.name, id="MODEL-010")
    if body.radius and body.size and _is_doubtful(body):
        message = (
            f"mass {body.mass:.4g} kg and inertia {body.inertia:.4g} kg m² make a radius of gyration of "
            f"{body.radius:.3g} m, joints are up to {body.size:.3g} m from the mass centre: "
            "are all in SI units?"
        )
        yield Fault("note", message, body.place, body.name, id="MODEL-020")
    elif body.density < HOLLOW:
        message = (
            f"mass {body.mass:.4g} kg and inertia {body.inertia:.4g} kg m² are those of an ellipsoid of "
            f"{body.density:.2g} kg/m³, air has 1.2: is the mass in kg, and not in tonnes?"
        )
        yield Fault("note", message, body.place, body.name, id="MODEL-021")


def _is_doubtful(body: Extent) -> bool:
    """Return whether radius of gyration and distance of joints belong to different units."""
    ratio = body.radius / body.size
    wide = WIDE if np.isfinite(body.density) else WIDE_WITHOUT_AXIS
    return ratio < NARROW or ratio > WIDEST_OF_ALL or (ratio > wide and not body.heavy)


def _of_frequencies(bodies: "Iterable[FloatingBody]", units: Units) -> Any:
    """Sound crosses no solid faster than 2e4 m/s, and a body vibrates slower than sound crosses it."""
    for body in bodies:
        if not body.modes:
            continue
        size = float(np.ptp(body.reduced.r0, axis=0).max()) * units.length
        lowest = float(body.reduced.frequencies[0])
        if lowest * size > FASTEST_SOUND:
            message = (
                f"the lowest frequency is {lowest:.3g} Hz in a body of {size:.3g} m, as if sound went at "
                f"{lowest * size:.1g} m/s or faster: are mass in kg, stiffness in N/m, nodes in m?"
            )
            yield Fault("note", message, body.place, body.name, id="MODEL-013")


def _of_densities(bodies: "Iterable[FloatingBody]", units: Units) -> Any:
    """Matrices know no lengths: nodes in millimetres, and masses in tonnes, pass every test of them."""
    for body in bodies:
        mass, sides = body.m * units.mass, _sides(body.reduced.r0) * units.length
        density = mass / (float(np.prod(sides)) or math.nan)
        if not (density < FOAM or density > OSMIUM):
            continue
        likely = [
            f"{words} would make {_two_digits(density * factor)} kg/m³"
            for words, factor in UNITS.items()
            if SOLID <= density * factor <= OSMIUM
        ]
        message = (
            f"{mass:.3g} kg in a box of {sides[0]:.3g} by {sides[1]:.3g} by {sides[2]:.3g} m are "
            f"{_two_digits(density)} kg/m³, {'less than foam' if density < FOAM else 'more than osmium'}: "
            f"{', '.join(likely) or 'are nodes in m and masses in kg?'}"
        )
        yield Fault("note", message, body.place, body.name, id="MODEL-015")


def _two_digits(value: float) -> str:
    return f"{float(f'{value:.2g}'):g}"


def _sides(points: np.ndarray) -> np.ndarray:
    """Lengths of the box around points (n, 3), along their principal axes: slender bodies may lie askew."""
    centred = points - points.mean(axis=0)
    return np.ptp(centred @ np.linalg.eigh(centred.T @ centred)[1], axis=0)[::-1]


def _farthest(points: Sequence[Any], centre: np.ndarray | tuple[float, float, float]) -> float:
    return max((float(np.linalg.norm(np.subtract(point, centre))) for point in points), default=0.0)


def _moments(inertia: list[list[float]] | np.ndarray) -> tuple[float, ...]:
    return tuple(np.linalg.eigvalsh(np.asarray(inertia, dtype=float)).tolist())


def _about_centre(
    inertia: np.ndarray, mass: float, centre: np.ndarray | tuple[float, float, float]
) -> np.ndarray:
    c = np.asarray(centre, dtype=float)
    return inertia - mass * (c @ c * np.eye(3) - np.outer(c, c))


def _of_young(model: "DynamicModel") -> Iterable[Extent]:
    """Bodies that something moves: those held by ground constraints need no mass."""
    mechanism = model.mechanism
    held = {item.body for item in mechanism.grounds}
    masses = {item.body: item for item in model.masses if item.body not in held}
    joined: dict[int, list[Any]] = {}
    for joint in mechanism.joints:
        for body, point in ((joint.i, joint.P_i), (joint.j, joint.P_j)):
            if body not in held:
                joined.setdefault(body, []).append(point)
    extents = []
    for k, item in enumerate(mechanism.bodies):
        if k in held:
            continue
        points, given = joined.get(k, ()), masses.get(k)
        if given is None:
            extents.append(Extent(item.name, 0.0, (0.0,) * 3, _farthest(points, (0.0, 0.0, 0.0)), item.place))
            continue
        xx, yy, zz, xy, yz, zx = given.inertia
        moments = _moments([[xx, xy, zx], [xy, yy, yz], [zx, yz, zz]])
        extents.append(Extent(item.name, given.mass, moments, _farthest(points, given.centre), given.place))
    return extents


def _of_mechanism(mechanism: "FlexibleMechanism") -> Iterable[Extent]:
    """Rigid bodies; those of finite elements have what their files say."""
    centres = np.zeros((len(mechanism.bodies), 3))
    for k, body in enumerate(mechanism.bodies):
        if body.m:
            centres[k] = body.s0 / body.m
    # Points are made and dropped: those of 70,000 bodies would take 150 MB.
    sizes = np.zeros(len(mechanism.bodies))
    for joint in mechanism.joints:
        for end in (*joint.a, *joint.b):
            if end.body >= 0:
                sizes[end.body] = max(sizes[end.body], _farthest([end.r0], centres[end.body]))
    for k, body in enumerate(mechanism.bodies):
        if body.flexible is None:
            moments = _moments(_about_centre(body.J0, body.m, centres[k]))
            yield Extent(body.name, body.m, moments, float(sizes[k]), body.place)


def _of_tree(tree: "Tree") -> Iterable[Extent]:
    """Rigid bodies; the root of each is its own hinge."""
    extents = []
    borne: dict[int, list[Any]] = {}
    for hinge in tree.hinges:
        borne.setdefault(hinge.parent, []).append(hinge.point)
    for k, body in enumerate(tree.bodies):
        if body.elastic is not None:
            continue
        points = [(0.0, 0.0, 0.0), *borne.get(k, ())]
        moments = _moments(_about_centre(body.inertia, body.mass, body.centre))
        size = _farthest(points, body.centre)
        extents.append(Extent(body.name, body.mass, moments, size, body.place))
    return extents


_EXTENTS: dict[str, Callable[[Any], Iterable[Extent]]] = {
    "DynamicModel": _of_young,
    "FlexibleMechanism": _of_mechanism,
    "Tree": _of_tree,
}
