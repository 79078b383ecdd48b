"""Reader of URDF, the robot format of ROS.

The specification is wiki.ros.org/urdf/XML (link, joint).  The frame of a link is that of the joint that moves
it; the link that no joint moves is fixed to the ground.
"""

from collections.abc import Iterator
from typing import Any
from xml.etree.ElementTree import Element

import numpy as np

from ...errors import Fault
from ...model.exchange.rigid_model import RigidModel, angles_of, vector
from ...model.mechanism import GROUND
from ...model.shapes import ShapeCard, turning
from .links import FREE, HINGE, SLIDE, Gear, Link, LinkJoint, Mass, model_of_links, refuse

GRAVITY = np.array([0.0, 0.0, -9.81])
_KINDS = {"revolute": HINGE, "continuous": HINGE, "prismatic": SLIDE, "floating": FREE, "fixed": ""}
_STILL = np.zeros(3), np.eye(3)


def urdf_model(top: Element, notes: list[Fault]) -> RigidModel:
    """Return the model of a file's element `robot`; `notes` receives what is left out.

    Raises ModelError for what flexmb does not have.
    """
    bodies = {_name(item): item for item in top.findall("link")}
    moving = {_end(joint, "child", bodies): joint for joint in top.findall("joint")}
    links: list[Link] = []
    number: dict[str, int] = {}
    waiting = [name for name in bodies if name not in moving]
    if len(waiting) != 1:
        raise refuse(
            "robot", f"one link is moved by no joint, the root; here {len(waiting)} are", "RESULT-163"
        )
    while waiting:
        name = waiting.pop(0)
        number[name] = len(links)
        links.append(_link(bodies[name], moving.get(name), number))
        waiting += [child for child, joint in moving.items() if _end(joint, "parent", bodies) == name]
    if len(links) < len(bodies):
        lost = next(name for name in bodies if name not in number)
        raise refuse(lost, "its joints lead to no root; joints of URDF make no loops", "RESULT-164")
    if any(joint.find("limit") is not None and joint.get("type") == "revolute" for joint in moving.values()):
        message = "limits are left out: a line STOP of the new deck, with a stiffness, holds a coordinate"
        notes.append(Fault("note", message, id="RESULT-165"))
    return model_of_links(links, GRAVITY, list(_gears(moving)))


def _name(item: Element) -> str:
    return item.get("name") or item.tag


def _end(joint: Element, tag: str, bodies: dict[str, Element]) -> str:
    """Return the link that a joint names as its parent or child."""
    item = joint.find(tag)
    name = "" if item is None else item.get("link", "")
    if name not in bodies:
        raise refuse(_name(joint), f"its {tag} is not a link: {name or 'none'}", "RESULT-166")
    return name


def _link(item: Element, joint: Element | None, number: dict[str, int]) -> Link:
    link = Link(_name(item), GROUND, _STILL)
    if joint is not None:
        link.parent = number[joint.find("parent").get("link")]  # type: ignore[union-attr, index]
        link.frame = _origin(joint)
        kind = _KINDS.get(joint.get("type", ""))
        if kind is None:
            message = f"a joint {joint.get('type')} is not a joint of flexmb"
            raise refuse(_name(joint), message, "RESULT-167")
        link.joints = [_joint(joint, kind)] if kind else []
    inertial = item.find("inertial")
    if inertial is not None:
        link.masses = [_mass(inertial)]
    link.shapes = [shape for seen in item.findall("visual") for shape in _shapes(seen)]
    return link


def _joint(joint: Element, kind: str) -> LinkJoint:
    axis, dynamics = joint.find("axis"), joint.find("dynamics")
    direction = numbers(attributes(axis).get("xyz", "1 0 0"), 3, _name(joint))
    about = attributes(dynamics)
    if float(about.get("friction", 0)):
        message = "constant friction does not convert: set it to 0; a line FRICTION of the new deck gives it"
        raise refuse(_name(joint), message, "RESULT-168")
    q, u = (_STILL, np.zeros((2, 3))) if kind == FREE else (0.0, 0.0)
    return LinkJoint(
        _name(joint), kind, unit(direction), np.zeros(3), q, u, damping=float(about.get("damping", 0))
    )


def _gears(moving: dict[str, Element]) -> Iterator[Gear]:
    for joint in moving.values():
        mimic = joint.find("mimic")
        if mimic is None:
            continue
        if float(mimic.get("offset", 0)):
            message = "offsets of mimic do not convert: coordinates are 0 at the start"
            raise refuse(_name(joint), message, "RESULT-169")
        ratio = float(mimic.get("multiplier", 1))
        yield Gear(f"mimic {_name(joint)}", _name(joint), mimic.get("joint", ""), ratio)


def _mass(item: Element) -> Mass:
    mass, inertia = item.find("mass"), item.find("inertia")
    centre, axes = _origin(item)
    about = attributes(inertia)
    xx, yy, zz, xy, yz, zx = (
        float(about.get(f"i{pair}", 0)) for pair in ("xx", "yy", "zz", "xy", "yz", "xz")
    )
    own = np.array([[xx, xy, zx], [xy, yy, yz], [zx, yz, zz]])
    return Mass(float(mass.get("value", 0)) if mass is not None else 0.0, centre, axes @ own @ axes.T)


def _origin(item: Element) -> Any:
    """Return the frame of `origin`: roll, pitch and yaw about the fixed axes x, y, z."""
    origin = item.find("origin")
    about = attributes(origin)
    place = numbers(about.get("xyz", "0 0 0"), 3, item.tag)
    return place, turning(vector(numbers(about.get("rpy", "0 0 0"), 3, item.tag)))


def _shapes(seen: Element) -> Iterator[ShapeCard]:
    place, axes = _origin(seen)
    about = vector(place), angles_of(axes)
    for form in seen.find("geometry") or ():
        if form.tag == "box":
            yield ShapeCard(GROUND, "box", vector(numbers(form.get("size", ""), 3, form.tag)), *about)
        elif form.tag == "cylinder":
            sizes = float(form.get("radius", 0)), float(form.get("length", 0)), 0.0
            yield ShapeCard(GROUND, "cylinder", sizes, *about)
        elif form.tag == "sphere":
            yield ShapeCard(GROUND, "sphere", (float(form.get("radius", 0)), 0.0, 0.0), *about)
        elif form.get("filename", "").lower().endswith(".stl"):
            scale = numbers(form.get("scale", "1 1 1"), 3, form.tag)
            name = form.get("filename", "").rpartition("/")[2]
            yield ShapeCard(GROUND, "stl", (0.0, 0.0, 0.0), *about, name, float(scale[0]))


def attributes(item: Element | None) -> dict[str, str]:
    """Return the attributes of an element, none of no element."""
    return {} if item is None else item.attrib


def numbers(text: str, count: int, name: str) -> np.ndarray:
    """Return the numbers of an attribute; raises ModelError if there are others than `count`."""
    try:
        values = np.array(text.split(), float)
    except ValueError:
        values = np.empty(0)
    if len(values) != count or not np.isfinite(values).all():
        raise refuse(name, f"expected {count} numbers; read {text!r}", "RESULT-170")
    return values


def unit(direction: np.ndarray) -> np.ndarray:
    """Return the unit vector (3,) of a direction."""
    return direction / (np.linalg.norm(direction) or 1.0)
