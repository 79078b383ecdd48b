"""A body of a tree as a body in its floating frame: the nodes' displacements are its modal coordinates.

What the nodes leave of the mass and the inertia stays with the frame, which is clamped to the body's root.
"""

from typing import Any

import numpy as np
from scipy import sparse

from ..model.arrays.tree import hanging_masses
from ..model.flexible_body import FlexibleBody
from ..model.flexible_mechanism import FloatingBody
from ..model.geometric_stiffness import across, beam_direction, geometric_stiffness
from ..model.tree import Tree
from ..model.tree_as_mechanism.frames import NodeFrame, shape_of
from ..model.tree_as_mechanism.poses import Pose
from ..model.vectors import euler_parameters
from .invariants import inertia_invariants


def floating_body(tree: Tree, k: int, pose: Pose) -> FloatingBody:
    """Body k of a tree in its frame at O_k."""
    body = tree.bodies[k]
    flexible = None if body.elastic is None else lumped_body(tree, k)
    s0 = body.mass * np.array(body.centre, float) if flexible is None else flexible.s0
    inertia = np.array(body.inertia, float)
    stiffened = flexible is not None and flexible.KG.size > 0
    return FloatingBody(  # type: ignore[call-arg, misc]
        body.name, *_motion(pose), body.mass, s0, inertia, flexible, stiffened, place=body.place
    )


def massless_body(node_frame: NodeFrame, pose: Pose) -> FloatingBody:
    """A node frame: its hinge to the body it sits on leaves it no motion of its own."""
    return FloatingBody(node_frame.name, *_motion(pose), 0.0, np.zeros(3), np.zeros((3, 3)))  # type: ignore[call-arg]


def _motion(pose: Any) -> Any:
    return pose.r, euler_parameters(pose.A), pose.v, pose.A.T @ pose.w


def lumped_body(tree: Tree, k: int) -> FlexibleBody:
    """The flexible body k of a tree, its NM elastic coordinates as modal ones."""
    body, elastic = tree.bodies[k], tree.bodies[k].elastic
    count, N = len(elastic.masses), elastic.coordinates  # type: ignore[union-attr]
    Phi = np.vstack([shape_of(elastic, node) for node in range(count)])
    found = inertia_invariants(elastic.positions, Phi, sparse.diags(elastic.masses))  # type: ignore[union-attr]
    # Of these two the nodes are not the whole.
    found |= {"m": body.mass, "J0": np.array(body.inertia, float)}  # type: ignore[dict-item]
    unknown = np.full((N, 6), np.nan)
    return FlexibleBody(
        name=body.name,
        numbers=np.arange(1, count + 1),
        r0=elastic.positions,  # type: ignore[union-attr]
        origin=np.zeros(3),
        axes=np.eye(3),
        Phi=Phi,
        **found,  # type: ignore[arg-type]
        Kr=elastic.stiffness,  # type: ignore[union-attr]
        Dr=np.zeros((N, N)) if elastic.damping is None else elastic.damping,  # type: ignore[union-attr]
        KG=_stiffening(tree, k),
        frequencies=unknown[:, 0],
        frequency_errors=unknown[:, 0],
        effective_mass=unknown,
        effective_limit=unknown[0],
        mass_deviation=0.0,
        rigid_residual=0.0,
    )


def _stiffening(tree: Any, k: Any) -> Any:
    """KG (3, 3, NM, NM): a pull by w² - (w d)² along the beam d; empty for a body that is not stiffened."""
    elastic = tree.bodies[k].elastic
    if elastic.stiffened_from is None:
        return np.zeros((0, 0, elastic.coordinates, elastic.coordinates))
    d = beam_direction(elastic.positions, elastic.stiffened_from)
    axial_forces = (elastic.masses + hanging_masses(tree, k)) * (elastic.positions @ d)
    matrix = across(
        geometric_stiffness(elastic.positions, elastic.stiffened_from, axial_forces),
        d,  # type: ignore[arg-type]
        elastic.axes,
    )
    return -np.multiply.outer(np.outer(d, d), matrix)  # type: ignore[arg-type]
