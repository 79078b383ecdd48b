"""Content of the HDF5 result of a tree's dynamics.

Report rows come as values by the path of their dataset, so that a stopped run can keep them as they are.
"""

from dataclasses import replace
from typing import TYPE_CHECKING, cast

from ...model.laws import is_angle
from ...model.tree import ELASTIC, ROTATION, Body, Tree
from .applied_loads import with_applied_loads, with_load_values
from .layout import (
    BODY_MOTION,
    DRIVER,
    EULER_PARAMETER,
    FORCE,
    JOINT_VECTOR,
    PATH,
    POINT_MOTION,
    TORQUE,
    XYZ,
    Axis,
    Layout,
    Series,
    Values,
    effort_series,
    element_values,
    numbered_axis,
    with_elements,
    with_shapes,
    with_units,
)
from .result_geometry import SIDE, tree_geometry

if TYPE_CHECKING:
    from ...solvers.constrained.tree_element_rows import TreeElementRows
    from ...solvers.tree.points import PointMotion
    from ...solvers.tree.rows import TreeRows


COORDINATE = ("coordinate/coordinate",)
HINGE_VECTOR = ("hinge/hinge", "xyz")
# Fields of `TreeRows` in results of all trees besides the motion of bodies.
SERIES = {
    "q": Series("coordinate/q", COORDINATE, "rad or m", "generalized coordinate"),
    "y": Series("coordinate/u", COORDINATE, "rad/s or m/s", "generalized speed"),
    "y_rate": Series("coordinate/u_rate", COORDINATE, "rad/s2 or m/s2", "rate of the generalized speed"),
    "kinetic": Series("energy/kinetic", (), "J", "kinetic energy"),
    "potential": Series("energy/potential", (), "J", "potential energy of gravity and hinge springs"),
    "strain": Series("energy/strain", (), "J", "strain energy of elastic bodies"),
    "applied_work": Series("energy/applied_work", (), "J", "work of all other loads since the start"),
    "total": Series(
        "energy/total", (), "J", "kinetic + potential + strain - applied work: constant but for errors"
    ),
}
# In those of trees with closures.
OF_CLOSURES = {
    "constraint_residual": Series("audit/constraint_residual", (), "m", "largest gap of a closure"),
    "velocity_residual": Series("audit/velocity_residual", (), "m/s", "largest rate of a gap of a closure"),
    "reaction_force": Series(
        "reaction/force",
        JOINT_VECTOR,
        "N",
        "force of the closure on its second body (KB), opposite on the first, global axes",
    ),
}


# Of its own formulation only.
OF_HINGES = {
    "hinge_force": Series("hinge/force", HINGE_VECTOR, "N", "force through hinge K on body K, global axes"),
    "hinge_torque": Series(
        "hinge/torque", HINGE_VECTOR, "N m", "moment about O_K through hinge K on body K, global axes"
    ),
}


def tree_layout(tree: Tree, points: list[str], reactions: bool) -> Layout:
    """Axes and series of a tree; `points`: names of its points, `reactions`: whether hinges have them."""
    axes = [
        XYZ,
        EULER_PARAMETER,
        numbered_axis("body", [body.name for body in tree.bodies]),
        numbered_axis("point", points),
        _coordinate_axis(tree),
    ]
    series = [*BODY_MOTION.values(), *POINT_MOTION.values(), *SERIES.values()]
    if reactions:
        axes.append(numbered_axis("hinge", [body.name for body in tree.bodies]))
        series += OF_HINGES.values()
    for k, body in _flexible(tree):
        axes.append(_node_axis(body))
        long_name = f"elastic displacement of the nodes of {body.name}, axes of the body"
        series.append(Series(_displacement(tree, k), (_node_axis(body).path, "xyz"), "m", long_name))
    if tree.closures:
        axes.append(SIDE)
        axes.append(numbered_axis("joint", [f"closure {i}" for i in range(1, len(tree.closures) + 1)]))
        series += OF_CLOSURES.values()
    layout = Layout("dynamic", tree.time.rows, tuple(axes), tuple(series), tree_geometry(tree))
    if tree.elements:
        layout = with_elements(_with_drivers(layout, tree), tree.elements)
    return with_shapes(with_applied_loads(layout, tree), tree.shapes)


def _with_drivers(layout: Layout, tree: Tree) -> Layout:
    """The layout with the efforts of prescribed coordinates."""
    coordinates = [(p.body, f"{p.motion} {p.axis}") for p in tree.prescribed]
    names = [f"{tree.bodies[body].name} {coordinate}" for body, coordinate in coordinates]
    names += [item.name for item in tree.elements.drivers]
    coordinates += [(item.joint, item.coordinate) for item in tree.elements.drivers]
    if not names:
        return layout
    units = [TORQUE if is_angle(coordinate) else FORCE for _, coordinate in coordinates]
    axis = with_units(numbered_axis("driver", names), "driver", units)
    series = effort_series(
        Series(PATH, (DRIVER,), "N or N m", "effort along the prescribed coordinate"), units
    )
    return replace(layout, axes=(*layout.axes, axis), series=(*layout.series, series))


def tree_values(tree: Tree, rows: "TreeRows", points: "PointMotion") -> Values:
    """Report rows (`TreeRows`) and the motion of points, three arrays, by path."""
    named = BODY_MOTION | SERIES | (OF_CLOSURES if tree.closures else {})
    named |= OF_HINGES if rows.hinge_force.size else {}
    values = {"time": rows.time} | {series.path: getattr(rows, name) for name, series in named.items()}
    for series, motion in zip(POINT_MOTION.values(), points, strict=True):
        values[series.path] = motion
    for (k, _), displacement in zip(_flexible(tree), rows.displacement, strict=True):
        values[_displacement(tree, k)] = displacement
    if tree.elements:
        values |= element_values(rows)
        if tree.prescribed or tree.elements.drivers:
            values[PATH] = cast("TreeElementRows", rows).driver_effort
    return with_load_values(values, tree)


def _flexible(tree: Tree) -> list[tuple[int, Body]]:
    return [(k, body) for k, body in enumerate(tree.bodies) if body.elastic is not None]


def _displacement(tree: Tree, k: int) -> str:
    return f"elastic/{tree.bodies[k].name}/displacement"


def _node_axis(body: Body) -> Axis:
    assert body.elastic is not None, "only flexible bodies have nodes"
    numbers = tuple(range(1, len(body.elastic.masses) + 1))
    return Axis(f"elastic/{body.name}/node", numbers, f"node of {body.name}")


def _coordinate_axis(tree: Tree) -> Axis:
    axis = numbered_axis("coordinate", [c.name for c in tree.coordinates])
    units = tuple("rad" if c.motion == ROTATION else "m" for c in tree.coordinates)
    kinds = tuple("elastic" if c.motion == ELASTIC else c.motion for c in tree.coordinates)
    more = (
        ("coordinate/unit", units, "unit of the coordinate"),
        ("coordinate/kind", kinds, "kind of motion"),
    )
    return Axis(axis.path, axis.values, "number of the coordinate", (*axis.labels, *more))
