"""Inertia left in every body of a tree where it moves, its nodes being free to stay behind.

A node that moves against the turning body takes no part in the coupled inertia: what resists the
hinge is the inertia of the whole body less that of its nodes along their free axes.  DAFMS decks
that give rho L^3/3 with lumped masses leave less than nothing, and the coupled equations of the
thesis (Zhao, 1992, eq. 3.16) then have no positive definite mass matrix.
"""

from typing import Any

import numpy as np

from ...deck.many_records import DeckValues
from ...model.diagnostics import Findings
from ...model.tree import INERTIAL, UNTURNED, Body, Tree

# Share of a body's inertia below which what its nodes leave counts as rounding.
_ROUNDING = 1e-11


def check_inertia(tree: Tree, values: DeckValues, findings: Findings) -> None:
    """Name every body whose inertia is negative, or zero where only its own can resist its hinge."""
    for k, body in enumerate(tree.bodies):
        left = moving_inertia(body, tree.one_way)
        value, motion = _smallest(left, moving_inertia(body, True), _allowed_motions(tree, k))
        if value < -_ROUNDING:
            _report(body, k, motion, values, findings)
        elif _stands_alone(tree, k):
            hinged = hinge_motions(tree, k)
            value, motion = _smallest(left, moving_inertia(body, True), hinged)
            if value <= _ROUNDING:
                _report(body, k, motion, values, findings)


def moving_inertia(body: Body, nodes_held: bool) -> np.ndarray:
    """Inertia (6, 6) of a body against the velocity of O_k and its angular velocity, in O_k axes.

    Unless `nodes_held`, the nodes follow neither along their free axes.
    """
    elastic = body.elastic
    moment = body.mass * np.array(body.centre) if elastic is None else elastic.masses @ elastic.positions
    inertia = np.zeros((6, 6))
    inertia[:3, :3] = body.mass * np.eye(3)
    inertia[3:, :3] = _cross(moment)
    inertia[:3, 3:] = inertia[3:, :3].T
    inertia[3:, 3:] = body.inertia
    if elastic is None or nodes_held:
        return inertia
    for axis in elastic.axes:
        e = np.eye(3)[axis - 1]
        rows = np.hstack([np.tile(e, (len(elastic.masses), 1)), np.cross(elastic.positions, e)])
        inertia -= rows.T @ (elastic.masses[:, None] * rows)
    return inertia


def hinge_motions(tree: Tree, k: int) -> np.ndarray:
    """Columns (6, free motions): velocity of O_k and angular velocity that hinge k allows, O_k axes."""
    hinge = tree.hinges[k]
    angles = [
        q for q, c in zip(tree.q, tree.coordinates, strict=True) if (c.body, c.motion) == (k, "rotation")
    ]
    directions, frame = [], np.eye(3)
    for axis, angle in zip(hinge.rotations, angles, strict=True):
        directions.append(frame[:, axis - 1])
        if len(hinge.rotations) < 3:
            frame = frame @ _rotation(axis, angle)
    if not hinge.rotations:
        frame = _matrix(hinge.attitude)
    slides = [frame[axis - 1] for axis in hinge.translations]
    columns = [np.concatenate([np.zeros(3), frame.T @ turn]) for turn in directions]
    columns += [np.concatenate([slide, np.zeros(3)]) for slide in slides]
    return np.array(columns).reshape(-1, 6).T


def _stands_alone(tree: Tree, k: int) -> bool:
    """Return whether no child adds inertia to hinge k: each sits on a node and turns back with its own hinge.

    Where the nodes of body k can stay behind altogether, such children stay with them.
    """
    turned = set(tree.hinges[k].rotations)
    children = [hinge for hinge in tree.hinges if hinge.parent == k]
    return all(
        child.node is not None and turned <= set(child.rotations) and child.frame == UNTURNED
        for child in children
    )


def _allowed_motions(tree: Tree, k: int) -> np.ndarray:
    """Columns (6, n): any velocity of O_k, and the turning that the hinges on the way to body k allow.

    Decks leave the moments about axes that never turn at zero: with turning about one axis only, the
    others do not count.
    """
    path = [tree.hinges[k]]
    while path[-1].parent != INERTIAL:
        path.append(tree.hinges[path[-1].parent])
    axes = {axis for hinge in path for axis in hinge.rotations}
    for attitude in (quadruple for hinge in path for quadruple in (hinge.frame, hinge.attitude)):
        axes |= {axis for axis in (1, 2, 3) if attitude[axis]} if axes else set()
    turning = sorted(axes) if len(axes) < 2 else (1, 2, 3)
    return np.eye(6)[:, [0, 1, 2, *(2 + axis for axis in turning)]]


def _smallest(left: np.ndarray, whole: np.ndarray, motions: np.ndarray) -> tuple[float, np.ndarray]:
    """Smallest eigenvalue of `left` over the motions, as a share of `whole`, and where it lies."""
    if motions.shape[1] == 0:
        return 1.0, np.zeros(6)
    scale = np.sqrt(np.diag(motions.T @ whole @ motions))
    # A tiny scale would blow the products of inertia up beyond the doubles.
    scaled = motions / np.where(scale > 1e-50, scale, 1.0)
    shares, shapes = np.linalg.eigh(scaled.T @ left @ scaled)
    return shares[0], scaled @ shapes[:, 0]


def _report(body: Body, k: int, motion: np.ndarray, values: Any, findings: Findings) -> None:
    turning = np.abs(motion[3:])
    if not turning.any():
        axis = int(np.argmax(np.abs(motion[:3]))) + 1
        message = f"no mass resists its hinge along axis {axis}: BM = {body.mass:g} kg, too little at O_k"
        findings.error(body.name, message, values.place("mass", k + 1), id="MODEL-004")
        return
    axis = int(np.argmax(turning))
    number = values.record("inertia", k + 1).numbers[axis]
    findings.error(body.name, _sentence(body, axis), number.place, id="MODEL-005")


def _sentence(body: Body, axis: int) -> str:
    given = body.inertia[axis, axis]
    if body.elastic is not None:
        nodes = given - moving_inertia(body, False)[3 + axis, 3 + axis]
        return (
            f"INER about axis {axis + 1} is {given:.9g} kg m^2, of which its nodes take sum m x^2 = "
            f"{nodes:.9g}: the mass matrix is not positive definite; add the inertia of the root's half "
            "element (rho h^3/24) and of any hub, or uncouple with card UNCO"
        )
    centre = np.array(body.centre)
    steiner = body.mass * (centre @ centre - centre[axis] ** 2)
    if steiner:
        return (
            f"INER about axis {axis + 1} is {given:.9g} kg m^2, less than m rc^2 = {steiner:.9g} of its mass "
            "centre: INER is about O_k, not about the mass centre"
        )
    return f"INER about axis {axis + 1} is {given:.9g} kg m^2: no inertia resists its hinge"


def _cross(v: np.ndarray) -> np.ndarray:
    return np.array([[0, -v[2], v[1]], [v[2], 0, -v[0]], [-v[1], v[0], 0]])


def _rotation(axis: int, angle: float) -> np.ndarray:
    return _matrix((np.cos(angle / 2), *(np.sin(angle / 2) * np.eye(3)[axis - 1])))


def _matrix(attitude: tuple[float, float, float, float]) -> np.ndarray:
    """T of DAFMS (listing, SOK), with the scalar first: components in P_k = T x components in O_k."""
    e0, e = attitude[0], np.array(attitude[1:])
    return 2 * np.outer(e, e) + (2 * e0 * e0 - 1) * np.eye(3) + 2 * e0 * _cross(e)
