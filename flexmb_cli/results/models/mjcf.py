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
from ...model.laws import At, Element
from ...model.tree import INERTIAL, ROTATION, TRANSLATION, Body, Tree
from ...model.vectors import euler_parameters, rotation_matrix

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
    qpos, qvel = _start(tree)
    frame = ElementTree.SubElement(top, "keyframe")
    ElementTree.SubElement(frame, "key", {"name": "start", "qpos": _numbers(qpos), "qvel": _numbers(qvel)})
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
        if any((*body.force, *body.torque)):
            message = "MJCF holds no constant external force or torque"
            yield Fault("error", message, body.place, body.name, id="RESULT-060")


def _foreign_loads(tree: Tree) -> Iterator[Fault]:
    for items, what in ((tree.torques, "torques over time"), (tree.prescribed, "prescribed motions")):
        for item in items:
            name = tree.bodies[item.body].name
            yield Fault("error", f"MJCF holds no {what}", item.place, name, id="RESULT-061")
    for closure in tree.closures:
        message = "MuJoCo closes loops softly, which is another motion; only trees convert"
        yield Fault("error", message, closure.place, closure.name, id="RESULT-062")
    for element in chain(*tree.elements.groups()):
        if not isinstance(element, Element) or not element.linear or not isinstance(element.measure, At):
            message = "of elements, MJCF holds springs in hinge coordinates without preload and functions"
            yield Fault("error", message, element.place, element.name, id="RESULT-032")
        elif element.turning and len(tree.hinges[element.measure.joint].rotations) == 3:
            message = "a damper of three free rotations does not convert"
            yield Fault("error", message, element.place, element.name, id="RESULT-063")


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
            stiffness, rest, damping = map(float, spring.values[:3])
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
