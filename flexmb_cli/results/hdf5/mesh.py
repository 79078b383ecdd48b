"""Elements of flexible bodies without a material, by which pictures show them."""

from collections.abc import Iterator

import numpy as np

from ...model.flexible_mechanism import FloatingBody
from .layout import Axis, Constant


def mesh_axes(body: FloatingBody) -> list[Axis]:
    """The elements of a body of no known material, and their nodes."""
    mesh = body.reduced.mesh
    return [] if mesh is None else cell_axes(body.name, mesh.rows, mesh.numbers)


def cell_axes(name: str, rows: np.ndarray, numbers: np.ndarray) -> list[Axis]:
    """The elements of the body `name` by their `numbers` (m,), and the nodes of `rows` (m, k)."""
    group, corners = f"elastic/{name}", tuple(range(1, rows.shape[1] + 1))
    return [
        Axis(f"{group}/element", tuple(map(int, numbers)), f"element of {name}, its number"),
        Axis(f"{group}/corner", corners, "node of an element, as Abaqus counts them"),
    ]


def mesh_constants(body: FloatingBody) -> Iterator[Constant]:
    """Nodes of the elements."""
    mesh, group = body.reduced.mesh, f"elastic/{body.name}"
    if mesh is None:
        return
    axes, numbers = (f"{group}/element", f"{group}/corner"), body.reduced.numbers[mesh.rows]
    meaning = f"numbers of the nodes of every element of {body.name}"
    yield Constant(f"{group}/cell", axes, numbers, "1", meaning)
