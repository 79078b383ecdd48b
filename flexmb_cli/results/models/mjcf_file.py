"""Reader of the rigid part of MJCF, the model format of MuJoCo.

MuJoCo's XML reference (compiler, default, body, joint, inertial, geom, equality, keyframe) is the source.
Geoms are masses and shapes here: nothing touches.
"""

from collections.abc import Iterator
from typing import Any
from xml.etree.ElementTree import Element

import numpy as np

from ...errors import Fault
from ...model.exchange.rigid_model import RigidModel, angles_of, vector
from ...model.mechanism import GROUND
from ...model.shapes import ShapeCard
from ...model.vectors import rotation_matrix
from .links import (
    BALL,
    FREE,
    HINGE,
    SLIDE,
    Frame,
    Gear,
    Link,
    LinkJoint,
    Mass,
    Tie,
    joined,
    model_of_links,
    refuse,
    rotation,
)
from .urdf import attributes, numbers, unit

# Parts that act on bodies; what else stands in a file is for pictures, sensors and MuJoCo itself.
_FOREIGN = ("tendon", "actuator", "deformable", "plugin")
_IGNORED = (
    "contacts of geoms and limits of joints are left out: lines CONTACT and STOP of the new deck give them"
)


def mjcf_model(top: Element, notes: list[Fault]) -> RigidModel:
    """Return the model of a file's element `mujoco`; `notes` receives what is left out.

    Raises ModelError for what flexmb does not have, and for parts that would act.
    """
    for part in _FOREIGN:
        if any(len(item) for item in top.findall(part)):
            raise refuse(
                part, "it does not convert: remove it, and give the new deck springs or motors", "RESULT-171"
            )
    reader = _Reader(top)
    world = top.find("worldbody")
    if world is None:
        raise refuse("mujoco", "the file has no worldbody", "RESULT-172")
    reader.take_sites(world, GROUND)
    for body in world.findall("body"):
        reader.body(body, GROUND, "")
    reader.begin(top)
    if any(geom.get("contype") != "0" for geom in top.iter("geom")) or any(
        j.get("range") for j in top.iter("joint")
    ):
        notes.append(Fault("note", _IGNORED, id="RESULT-173"))
    option = top.find("option")
    gravity = numbers(attributes(option).get("gravity", "0 0 -9.81"), 3, "option")
    return model_of_links(reader.links, gravity, *reader.equalities(top))


class _Reader:
    """The links of a file, and how its numbers are meant."""

    def __init__(self, top: Element):
        compiler = top.find("compiler")
        self.compiler = attributes(compiler)
        self.angle = 1.0 if self.compiler.get("angle") == "radian" else np.pi / 180
        self.defaults: dict[str, dict[str, dict[str, str]]] = {"": {}}
        for item in top.findall("default"):
            self._default(item, "")
        self.links: list[Link] = []
        self.number: dict[str, int] = {}
        self.sites: dict[str, tuple[int, np.ndarray]] = {}  # links and places, axes of the link
        self.frames: list[Frame] = []  # of the links in their parents, in the reference position

    def _default(self, item: Element, parent: str) -> None:
        """Take a class of defaults, which has those of its parent."""
        name = "" if item.get("class", "main") == "main" else item.get("class", "")
        self.defaults[name] = {tag: dict(about) for tag, about in self.defaults[parent].items()}
        for part in item:
            if part.tag == "default":
                continue
            self.defaults[name].setdefault(part.tag, {}).update(part.attrib)
        for part in item.findall("default"):
            self._default(part, name)

    def about(self, item: Element, childclass: str) -> dict[str, str]:
        """Return the attributes of an element with those of its class."""
        name = item.get("class", childclass)
        if name not in self.defaults:
            raise refuse(item.get("name", item.tag), f"there is no class {name}", "RESULT-174")
        return self.defaults[name].get(item.tag, {}) | item.attrib

    def body(self, item: Element, parent: int, childclass: str) -> None:
        """Add a body and those in it."""
        childclass, number = item.get("childclass", childclass), len(self.links)
        link = Link(item.get("name", f"body {number + 1}"), parent, self.frame(dict(item.attrib)))
        self.links.append(link)
        self.frames.append(link.frame)
        self.number[link.name] = number
        for joint in (*item.findall("freejoint"), *item.findall("joint")):
            about = (
                {"type": FREE} | dict(joint.attrib)
                if joint.tag == "freejoint"
                else self.about(joint, childclass)
            )
            link.joints.append(self.joint(about, link))
        geoms = [self.about(geom, childclass) for geom in item.findall("geom")]
        link.shapes = [shape for geom in geoms for shape in self.shapes(geom)]
        inertial = item.find("inertial")
        if inertial is not None and self.compiler.get("inertiafromgeom") != "true":
            link.masses = [self.inertial(dict(inertial.attrib), link.name)]
        else:
            link.masses = [mass for geom in geoms for mass in self.mass(geom, link.name)]
        self.take_sites(item, number)
        for inner in item.findall("body"):
            self.body(inner, number, childclass)

    def take_sites(self, item: Element, number: int) -> None:
        """Take the sites of a body, which equalities name."""
        for site in item.findall("site"):
            name = site.get("name", "")
            self.sites[name] = number, numbers(site.get("pos", "0 0 0"), 3, name)

    def frame(self, about: dict[str, str]) -> Frame:
        """Return position and axes of an element; raises ModelError for an unknown way to turn."""
        name, place = about.get("name", ""), numbers(about.get("pos", "0 0 0"), 3, about.get("name", ""))
        if "quat" in about:
            quat = numbers(about["quat"], 4, name)
            return place, rotation_matrix(unit(quat))
        if "axisangle" in about:
            *axis, angle = numbers(about["axisangle"], 4, name)
            return place, rotation(unit(np.array(axis)), angle * self.angle)
        if "xyaxes" in about:
            x, y = numbers(about["xyaxes"], 6, name).reshape(2, 3)
            x = unit(x)
            y = unit(y - (x @ y) * x)
            return place, np.column_stack([x, y, np.cross(x, y)])
        if "zaxis" in about:
            return place, turned_to(numbers(about["zaxis"], 3, name))
        return place, self._euler(numbers(about.get("euler", "0 0 0"), 3, name))

    def _euler(self, angles: np.ndarray) -> np.ndarray:
        """Return the axes by the compiler's sequence: small letters turn with the body."""
        axes = np.eye(3)
        for letter, angle in zip(self.compiler.get("eulerseq", "xyz"), angles, strict=True):
            turn = rotation(np.eye(3)["xyz".index(letter.lower())], angle * self.angle)
            axes = axes @ turn if letter.islower() else turn @ axes
        return axes

    def joint(self, about: dict[str, str], link: Link) -> LinkJoint:
        """Return a joint at the reference position."""
        kind, name = about.get("type", HINGE), about.get("name", f"joint {link.name}")
        for word in ("frictionloss", "armature"):
            if float(about.get(word, 0)):
                message = f"{word} does not convert: set it to 0, and give the new deck FRICTION or a mass"
                raise refuse(name, message, "RESULT-175")
        if kind not in (HINGE, SLIDE, BALL, FREE):
            raise refuse(name, f"there is no joint of the type {kind}", "RESULT-176")
        # Angles of springs and references are in the compiler's unit.
        scale = self.angle if kind == HINGE else 1.0
        if float(about.get("ref", 0)):
            raise refuse(name, "a reference other than 0 does not convert", "RESULT-177")
        axis, point = (
            numbers(about.get(key, default), 3, name)
            for key, default in (("axis", "0 0 1"), ("pos", "0 0 0"))
        )
        q: Any = (0.0, np.eye(3), link.frame)[(kind == BALL) + 2 * (kind == FREE)]
        u: Any = (0.0, np.zeros(3), np.zeros((2, 3)))[(kind == BALL) + 2 * (kind == FREE)]
        stiffness, damping, rest = (float(about.get(key, 0)) for key in ("stiffness", "damping", "springref"))
        if kind == FREE:
            link.frame = (np.zeros(3), np.eye(3))
        return LinkJoint(name, kind, unit(axis), point, q, u, stiffness, damping, rest * scale)

    def inertial(self, about: dict[str, str], name: str) -> Mass:
        """Return the mass of an element `inertial`."""
        centre, axes = self.frame({"name": name} | about)
        if "fullinertia" in about:
            xx, yy, zz, xy, xz, yz = numbers(about["fullinertia"], 6, name)
            own = np.array([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]])
        else:
            own = np.diag(numbers(about.get("diaginertia", "0 0 0"), 3, name))
        return Mass(float(about.get("mass", 0)), centre, axes @ own @ axes.T)

    def mass(self, geom: dict[str, str], name: str) -> Iterator[Mass]:
        """Yield the mass of a geom."""
        (centre, axes), kind, sizes = self._solid(geom)
        if kind in ("plane", "hfield"):
            return
        volume_and_moments = solid(kind, sizes)
        if volume_and_moments is None and geom.get("mass") != "0":
            message = f"the mass of a geom {kind} is unknown here: give the body an element inertial"
            raise refuse(name, message, "RESULT-178")
        if volume_and_moments is not None:
            volume, moments = volume_and_moments
            mass = float(geom["mass"]) if "mass" in geom else float(geom.get("density", 1000)) * volume
            yield Mass(mass, centre, axes @ np.diag(mass * moments) @ axes.T)

    def shapes(self, geom: dict[str, str]) -> Iterator[ShapeCard]:
        """Yield the shapes that flexmb has as well."""
        (place, axes), kind, sizes = self._solid(geom)
        about = vector(place), angles_of(axes)
        if kind == "box":
            yield ShapeCard(GROUND, "box", vector(2 * sizes), *about)
        elif kind in ("cylinder", "capsule"):
            yield ShapeCard(GROUND, "cylinder", (float(sizes[0]), float(2 * sizes[1]), 0.0), *about)
        elif kind == "sphere":
            yield ShapeCard(GROUND, "sphere", (float(sizes[0]), 0.0, 0.0), *about)

    def _solid(self, geom: dict[str, str]) -> tuple[Frame, str, np.ndarray]:
        """Return frame, type and sizes (3,) of a geom."""
        kind, text = geom.get("type", "sphere"), geom.get("size", "")
        sizes = np.zeros(3)
        given = numbers(text, len(text.split()), geom.get("name", "geom"))[:3]
        sizes[: len(given)] = given
        if "fromto" not in geom:
            return self.frame(geom), kind, sizes
        ends = numbers(geom["fromto"], 6, geom.get("name", "geom")).reshape(2, 3)
        half = float(np.linalg.norm(ends[1] - ends[0])) / 2
        sizes = (
            np.array([sizes[0], half, 0.0])
            if kind in ("capsule", "cylinder")
            else np.array([*sizes[[0, 0]], half])
        )
        return (ends.mean(axis=0), turned_to(ends[1] - ends[0])), kind, sizes

    def begin(self, top: Element) -> None:
        """Set the joints at the first key of the file."""
        key = next(iter(top.iter("key")), None)
        joints = [joint for link in self.links for joint in link.joints]
        for word, counts in (("qpos", {BALL: 4, FREE: 7}), ("qvel", {BALL: 3, FREE: 6})):
            values = attributes(key).get(word)
            if values is None:
                continue
            left = numbers(values, sum(counts.get(joint.kind, 1) for joint in joints), f"key {word}")
            for joint in joints:
                own, left = np.split(left, [counts.get(joint.kind, 1)])
                _set(joint, word, own)

    def equalities(self, top: Element) -> tuple[list[Gear], list[Tie]]:
        """Return gears and closed loops; raises ModelError for other equalities."""
        gears: list[Gear] = []
        ties: list[Tie] = []
        for number, item in enumerate((one for part in top.findall("equality") for one in part), start=1):
            name, about = item.get("name", f"equality {number}"), item.attrib
            if item.tag == "connect" and "body1" in about:
                ties.append(self._tie(name, about))
            elif item.tag == "connect" and {about.get("site1"), about.get("site2")} <= self.sites.keys():
                (i, P_i), (j, P_j) = self.sites[about["site1"]], self.sites[about["site2"]]
                ties.append(Tie(name, "spherical", i, j, P_i, P_j))
            elif item.tag == "joint" and "joint2" in about and _is_linear(about.get("polycoef", "0 1 0 0 0")):
                ratio = float(about.get("polycoef", "0 1").split()[1])
                gears.append(Gear(name, about["joint1"], about["joint2"], ratio))
            else:
                raise refuse(name, f"an equality {item.tag} of this form does not convert", "RESULT-179")
        return gears, ties

    def _tie(self, name: str, about: dict[str, str]) -> Tie:
        """Return a loop that a connect closes, whose anchor is where both bodies meet at the reference."""
        bodies = [self.number.get(about.get(key, ""), GROUND) for key in ("body1", "body2")]
        frames = [self._reference(body) for body in bodies]
        anchor = joined(frames[0], (numbers(about.get("anchor", ""), 3, name), np.eye(3)))[0]
        ends = [A.T @ (anchor - r) for r, A in frames]
        return Tie(name, "spherical", bodies[0], bodies[1], ends[0], ends[1])

    def _reference(self, body: int) -> Frame:
        """Return the frame of a body in the file's reference position, global axes."""
        if body == GROUND:
            return np.zeros(3), np.eye(3)
        return joined(self._reference(self.links[body].parent), self.frames[body])


def _is_linear(text: str) -> bool:
    c = [float(x) for x in text.split()]
    return not c[0] and not any(c[2:])


def _set(joint: LinkJoint, word: str, own: np.ndarray) -> None:
    """Set position or speed of a joint, as MuJoCo's arrays have them."""
    if word == "qpos":
        turned = rotation_matrix(unit(own[-4:])) if joint.kind in (BALL, FREE) else None
        joint.q = {BALL: turned, FREE: (own[:3], turned)}.get(joint.kind, float(own[0]))
    else:
        joint.u = {BALL: own, FREE: own.reshape(-1, 3)}.get(joint.kind) if len(own) > 1 else float(own[0])


def turned_to(z: np.ndarray) -> np.ndarray:
    """Return axes (3, 3) whose third one is along a vector, by the smallest turn, as MuJoCo has them."""
    x, y, along = unit(z)
    sine = float(np.hypot(x, y))
    axis = np.array([-y, x, 0.0]) / sine if sine > 1e-10 else np.array([1.0, 0.0, 0.0])
    return rotation(axis, float(np.arctan2(sine, along)))


def solid(kind: str, sizes: np.ndarray) -> tuple[float, np.ndarray] | None:
    """Return volume, m³, and moments (3,) of a mass of 1 of a solid, None if unknown.

    `sizes`: half sizes, as MuJoCo has them.  The moments are those of textbooks;
    a capsule is a cylinder and two half spheres.
    """
    a, b, c = sizes
    if kind == "sphere":
        return 4 / 3 * np.pi * a**3, np.full(3, 0.4 * a * a)
    if kind == "box":
        return 8 * a * b * c, np.array([b * b + c * c, a * a + c * c, a * a + b * b]) / 3
    if kind == "ellipsoid":
        return 4 / 3 * np.pi * a * b * c, np.array([b * b + c * c, a * a + c * c, a * a + b * b]) / 5
    around, along = a * a / 4 + b * b / 3, a * a / 2
    if kind == "cylinder":
        return 2 * np.pi * a * a * b, np.array([around, around, along])
    if kind == "capsule":
        middle, ends = 2 * np.pi * a * a * b, 4 / 3 * np.pi * a**3
        # Centre of a half sphere: 3/8 of its radius from its plane; moment about its centre: (2/5 - 9/64) a².
        side = ends * (0.4 * a * a + b * b + 0.75 * a * b)
        moments = np.array(
            [middle * around + side, middle * around + side, middle * along + ends * 0.4 * a * a]
        )
        return middle + ends, moments / (middle + ends)
    return None
