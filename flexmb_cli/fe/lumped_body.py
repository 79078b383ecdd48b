"""A body of a tree as a body in its floating frame: the nodes' displacements are its modal coordinates.

What the nodes leave of the mass and the inertia stays with the frame, which is clamped to the body's root.
"""

from typing import Any

import numpy as np
from scipy import sparse

from ..model.arrays.tree import stiffened_by
from ..model.flexible_body import FlexibleBody
from ..model.flexible_mechanism import FloatingBody
from ..model.geometric_stiffness import beam_direction
from ..model.tree import Elasticity, Tree
from ..model.tree_as_mechanism.frames import NodeFrame, shape_of
from ..model.tree_as_mechanism.poses import Pose
from ..model.vectors import euler_parameters
from .invariants import inertia_invariants


def floating_body(tree: Tree, k: int, pose: Pose) -> FloatingBody:
    """Body k of a tree in its frame at O_k."""
    body = tree.bodies[k]
    flexible = None if body.elastic is None else lumped_body(tree, k, body.elastic)
    s0 = body.mass * np.array(body.centre, float) if flexible is None else flexible.s0
    inertia = np.array(body.inertia, float)
    stiffened = flexible is not None and flexible.KG.size > 0
    return FloatingBody(
        body.name, *_motion(pose), body.mass, s0, inertia, flexible, stiffened, place=body.place
    )


def massless_body(node_frame: NodeFrame, pose: Pose) -> FloatingBody:
    """A node frame: its hinge to the body it sits on leaves it no motion of its own."""
    return FloatingBody(node_frame.name, *_motion(pose), 0.0, np.zeros(3), np.zeros((3, 3)))


def _motion(pose: Pose) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
    return pose.r, euler_parameters(pose.A), pose.v, pose.A.T @ pose.w


def lumped_body(tree: Tree, k: int, elastic: Elasticity) -> FlexibleBody:
    """The flexible body k of a tree, its NM elastic coordinates as modal ones."""
    body = tree.bodies[k]
    count, N = len(elastic.masses), elastic.coordinates
    Phi = np.vstack([shape_of(elastic, node) for node in range(count)])
    values: dict[str, Any] = dict(inertia_invariants(elastic.positions, Phi, sparse.diags(elastic.masses)))
    # Of these two the nodes are not the whole.
    values |= {"m": body.mass, "J0": np.array(body.inertia, float)}
    unknown = np.full((N, 6), np.nan)
    return FlexibleBody(
        name=body.name,
        numbers=np.arange(1, count + 1),
        r0=elastic.positions,
        origin=np.zeros(3),
        axes=np.eye(3),
        Phi=Phi,
        **values,
        Kr=elastic.stiffness,
        Dr=np.zeros((N, N)) if elastic.damping is None else elastic.damping,
        KG=_stiffening(tree, k, elastic),
        frequencies=unknown[:, 0],
        frequency_errors=unknown[:, 0],
        effective_mass=unknown,
        effective_limit=unknown[0],
        mass_deviation=0.0,
        rigid_residual=0.0,
    )


def _stiffening(tree: Tree, k: int, elastic: Elasticity) -> np.ndarray:
    """KG (3, 3, NM, NM): a pull by w² - (w d)² along the beam d; empty for a body that is not stiffened."""
    if elastic.stiffened_from is None:
        return np.zeros((0, 0, elastic.coordinates, elastic.coordinates))
    d = beam_direction(elastic.positions, elastic.stiffened_from)
    assert d is not None, "a stiffened body has a direction"
    return -np.multiply.outer(np.outer(d, d), stiffened_by(tree, k, 1))
