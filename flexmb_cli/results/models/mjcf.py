"""A rigid tree as MJCF, the model format of MuJoCo.

Bodies, hinges and joint coordinates correspond one to one: the frame of a MuJoCo body is that of P_k at zero
coordinates, its joints are the free translations and then the rotations, in the order of the tree.  MuJoCo's
XML reference (body, joint, inertial, keyframe) is the source of the elements.
"""

from collections.abc import Iterator
from itertools import chain
from typing import Any
from xml.etree import ElementTree

import numpy as np

from ...errors import Fault, ModelError
from ...model.exchange.functions import value_of
from ...model.joint_elements import Coupling
from ...model.laws import MOTOR, SPRING, At, Element, Line
from ...model.tree import INERTIAL, ROTATION, TRANSLATION, Body, Tree
from ...model.vectors import euler_parameters, rotation_matrix

# Loops are held by forces: as stiff as the step allows (MuJoCo keeps to twice its length).
STIFF = {"solref": "2e-4 1", "solimp": "0.9999 0.9999 1e-3"}
TIME_STEP = 1e-4  # s; RK4 keeps errors of usual mechanisms below 1e-8 with it


def mjcf(tree: Tree, name: str, note: str = "") -> str:
    """Return the file's text, with a `note`; `name` is the deck's.

    Raises ModelError for what MJCF cannot hold.
    """
    _refuse_foreign(tree)
    top = ElementTree.Element("mujoco", {"model": name})
    if note:
        top.append(ElementTree.Comment(f" {note} "))
    ElementTree.SubElement(top, "compiler", {"angle": "radian", "autolimits": "true"})
    option = {"timestep": repr(TIME_STEP), "integrator": "RK4", "gravity": _numbers(tree.gravity)}
    ElementTree.SubElement(top, "option", option)
    _add_meshes(top, tree)
    parents = {INERTIAL: ElementTree.SubElement(top, "worldbody")}
    for k in range(len(tree.bodies)):
        parents[k] = _add_body(parents[tree.hinges[k].parent], tree, k)
    for number, shape in enumerate(tree.shapes, start=1):
        # For pictures: without mass, and nothing touches it.
        about = {"type": "mesh", "mesh": f"shape {number}", "mass": "0", "contype": "0", "conaffinity": "0"}
        ElementTree.SubElement(parents[shape.body - 1], "geom", about)
    sites = _Sites(parents)
    _add_loops(top, tree, sites)
    _add_tendons(top, tree, sites)
    controls = _add_actuators(top, tree, sites)
    qpos, qvel = _start(tree)
    frame = ElementTree.SubElement(top, "keyframe")
    start = {"name": "start", "qpos": _numbers(qpos), "qvel": _numbers(qvel)}
    if controls:
        start["ctrl"] = _numbers(controls)
    ElementTree.SubElement(frame, "key", start)
    ElementTree.indent(top)
    return ElementTree.tostring(top, encoding="unicode") + "\n"


def _refuse_foreign(tree: Tree) -> None:
    faults = [*_foreign_bodies(tree), *_foreign_loads(tree)]
    if faults:
        raise ModelError(faults)


def _foreign_bodies(tree: Tree) -> Iterator[Fault]:
    for body in tree.bodies:
        if body.elastic is not None:
            message = "the body is flexible; --to mjcf is for rigid trees"
            yield Fault("error", message, body.place, body.name, id="RESULT-057")
        elif body.mass <= 0 or np.linalg.eigvalsh(_central_inertia(body)).min() <= 0:
            message = "MuJoCo needs a positive mass and inertia about the mass centre"
            yield Fault("error", message, body.place, body.name, id="RESULT-058")
        elif not _is_real(np.linalg.eigvalsh(_central_inertia(body))):
            message = "MuJoCo refuses an inertia larger than the sum of the two others"
            yield Fault("error", message, body.place, body.name, id="RESULT-059")


def _foreign_loads(tree: Tree) -> Iterator[Fault]:
    for items, what in ((tree.torques, "torques over time"), (tree.prescribed, "prescribed motions")):
        for item in items:
            name = tree.bodies[item.body].name
            yield Fault("error", f"MJCF holds no {what}", item.place, name, id="RESULT-061")
    for closure in tree.closures:
        if closure.curve is not None or len(closure.directions) < 2:
            message = "of closed loops, MJCF holds points that meet"
            yield Fault("error", message, closure.place, closure.name, id="RESULT-062")
    for element in chain(*tree.elements.groups()):
        if not _is_held(element):
            message = "MJCF holds linear springs, constant motors and couplings of two coordinates only"
            yield Fault("error", message, element.place, element.name, id="RESULT-032")
        elif isinstance(element, Element) and _is_of_ball(element, tree):
            message = "a damper of three free rotations does not convert"
            yield Fault("error", message, element.place, element.name, id="RESULT-063")


def _is_held(element: Any) -> bool:
    """Return whether MJCF holds an element without change."""
    if isinstance(element, Coupling):
        return element.function is None and len(element.terms) == 2
    if not isinstance(element, Element) or not isinstance(element.measure, At | Line):
        return False
    if element.law is MOTOR:
        return isinstance(element.measure, At) and value_of(element["function"]) is not None
    preloaded = bool(element["preload"]) if element.law is SPRING else False
    linear = element.law is SPRING and not (element["curve"] or element["damper"])
    return linear and (not preloaded or (isinstance(element.measure, At) and bool(element["stiffness"])))


def _is_of_ball(element: Element, tree: Tree) -> bool:
    return element.turning and len(tree.hinges[element.measure.joint].rotations) == 3


class _Sites:
    """Points of bodies that tendons and actuators name."""

    def __init__(self, parents: dict[int, Any]):
        self.parents, self.count = parents, 0

    def at(self, body: int, point: Any) -> str:
        """Return the name of a new site at a point of a body."""
        self.count += 1
        about = {"name": f"point {self.count}", "pos": _numbers(getattr(point, "r0", point)), "size": "1e-3"}
        ElementTree.SubElement(self.parents[body], "site", about)
        return about["name"]


def _add_loops(top: ElementTree.Element, tree: Tree, sites: _Sites) -> None:
    """Add closed loops, and couplings of two coordinates; MuJoCo holds them by forces."""
    if not (tree.closures or tree.elements.couplings):
        return
    equality = ElementTree.SubElement(top, "equality")
    for closure in tree.closures:
        # Two points, for an anchor would be one where both bodies meet at zero coordinates.
        ends = {"site1": (closure.a, closure.a_point), "site2": (closure.b, closure.b_point)}
        about = {"name": closure.name} | {key: sites.at(*end) for key, end in ends.items()}
        ElementTree.SubElement(equality, "connect", about | STIFF)
    for item in tree.elements.couplings:
        (first, one, a), (second, other, b) = item.terms
        names = {
            "joint1": f"{tree.bodies[first].name} {one}",
            "joint2": f"{tree.bodies[second].name} {other}",
        }
        # Coordinates of MuJoCo count from the tree's own zero, as those of equalities do.
        about = {"name": item.name, "polycoef": _numbers([0.0, -b / a, 0.0, 0.0, 0.0])}
        ElementTree.SubElement(equality, "joint", about | names | STIFF)


def _add_tendons(top: ElementTree.Element, tree: Tree, sites: _Sites) -> None:
    """Add springs between two points."""
    lines = [item for item in tree.elements.forces if isinstance(item.measure, Line)]
    tendons = ElementTree.SubElement(top, "tendon") if lines else top
    for item in lines:
        i, j, P_i, P_j = item.measure
        stiffness, rest, damping = map(float, item.values[:3])
        about = {"stiffness": repr(stiffness), "damping": repr(damping), "springlength": repr(rest)}
        tendon = ElementTree.SubElement(tendons, "spatial", {"name": item.name} | about)
        for end in ((i, P_i), (j, P_j)):
            ElementTree.SubElement(tendon, "site", {"site": sites.at(*end)})


def _add_actuators(top: ElementTree.Element, tree: Tree, sites: _Sites) -> list[float]:
    """Add constant motors, forces and torques; return the controls with which they act."""
    loads = [(k, [*body.force, *body.torque]) for k, body in enumerate(tree.bodies)]
    loads = [(k, load) for k, load in loads if any(load)]
    motors = [item for item in tree.elements.forces if item.law is MOTOR]
    if not loads and not motors:
        return []
    actuators = ElementTree.SubElement(top, "actuator")
    for item in motors:
        joint = f"{tree.bodies[item.measure.joint].name} {item.measure.coordinate}"
        ElementTree.SubElement(actuators, "motor", {"name": item.name, "joint": joint})
    world = sites.at(INERTIAL, (0.0, 0.0, 0.0)) if loads else ""
    for k, load in loads:
        about = {"site": sites.at(k, (0.0, 0.0, 0.0)), "refsite": world, "gear": _numbers(load)}
        ElementTree.SubElement(actuators, "general", {"name": f"load of {tree.bodies[k].name}"} | about)
    return [*(float(value_of(item["function"]) or 0.0) for item in motors), *[1.0] * len(loads)]


def _is_real(moments: np.ndarray) -> bool:
    return bool(moments[2] <= moments[0] + moments[1] + 1e-12 * moments[2])


def _add_meshes(top: ElementTree.Element, tree: Tree) -> None:
    """Add the surfaces of the shapes; their inertia is that of a shell, which no volume is needed for."""
    assets = ElementTree.SubElement(top, "asset") if tree.shapes else top
    for number, shape in enumerate(tree.shapes, start=1):
        about = {"name": f"shape {number}", "inertia": "shell", "vertex": _numbers(shape.vertices.ravel())}
        about["face"] = " ".join(map(str, shape.triangles.ravel()))
        ElementTree.SubElement(assets, "mesh", about)


def _add_body(parent: Any, tree: Tree, k: int) -> Any:
    body, hinge = tree.bodies[k], tree.hinges[k]
    turned = rotation_matrix(hinge.frame)
    if not hinge.rotations:
        turned = turned @ rotation_matrix(hinge.attitude)
    about = {"name": body.name, "pos": _numbers(hinge.point), "quat": _numbers(euler_parameters(turned))}
    element = ElementTree.SubElement(parent, "body", about)
    ElementTree.SubElement(element, "inertial", _inertial(body))
    # With no free rotation the body's frame is turned against P_k, along whose axes it slides.
    axes = np.eye(3) if hinge.rotations else rotation_matrix(hinge.attitude).T
    for axis in hinge.translations:
        _add_joint(element, tree, (k, TRANSLATION, axis), "slide", axes[:, axis - 1])
    if len(hinge.rotations) == 3:
        ElementTree.SubElement(element, "joint", {"name": f"{body.name} rotation", "type": "ball"})
    else:
        for axis in hinge.rotations:
            _add_joint(element, tree, (k, ROTATION, axis), "hinge", np.eye(3)[axis - 1])
    return element


def _add_joint(
    element: Any, tree: Tree, place: tuple[int, str, int], kind: str, direction: np.ndarray
) -> None:
    k, motion, axis = place
    about = {"name": f"{tree.bodies[k].name} {motion} {axis}", "type": kind, "axis": _numbers(direction)}
    for spring in tree.elements.forces:
        if spring.measure == (k, f"{motion} {axis}"):
            if spring.law is not SPRING:
                continue
            stiffness, rest, damping = map(float, spring.values[:3])
            if stiffness:
                rest -= spring["preload"] / stiffness
            about |= {"stiffness": repr(stiffness), "damping": repr(damping), "springref": repr(rest)}
    ElementTree.SubElement(element, "joint", about)


def _inertial(body: Body) -> dict[str, str]:
    inertia = _central_inertia(body)
    full = [inertia[0, 0], inertia[1, 1], inertia[2, 2], inertia[0, 1], inertia[0, 2], inertia[1, 2]]
    return {"pos": _numbers(body.centre), "mass": repr(float(body.mass)), "fullinertia": _numbers(full)}


def _central_inertia(body: Body) -> np.ndarray:
    """Inertia about the mass centre: that about O_k less the mass's."""
    c = np.array(body.centre)
    return np.asarray(body.inertia, float) - body.mass * (c @ c * np.eye(3) - np.outer(c, c))


def _start(tree: Tree) -> tuple[Any, Any]:
    """Initial qpos and qvel in MuJoCo's order: body by body, translations first."""
    place = {(c.body, c.motion, c.axis): n for n, c in enumerate(tree.coordinates)}
    qpos, qvel = [], []
    for k, hinge in enumerate(tree.hinges):
        single = [(TRANSLATION, axis) for axis in hinge.translations]
        ball = len(hinge.rotations) == 3
        single += [] if ball else [(ROTATION, axis) for axis in hinge.rotations]
        for motion, axis in single:
            qpos.append(tree.q[place[k, motion, axis]])
            qvel.append(tree.y[place[k, motion, axis]])
        if ball:
            turned = rotation_matrix(hinge.attitude)
            qpos += list(euler_parameters(turned))
            # The tree has the relative angular velocity in the axes of P_k, MuJoCo in those of the body.
            qvel += list(turned.T @ np.array([tree.y[place[k, ROTATION, axis]] for axis in (1, 2, 3)]))
    return qpos, qvel


def _numbers(values: list[float] | np.ndarray | tuple[float, float, float]) -> str:
    return " ".join(repr(float(value)) for value in values)
