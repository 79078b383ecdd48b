"""Input of the kernels of a kinematic analysis."""

import numpy as np

from ...kernels.kinematics.newton import COLUMN, RANK, System
from ...model.arrays.kinematic import KinematicArrays
from ...model.joints import DRIVER, SIMPLIFIED
from .position import KinematicSettings


def kinematic_system(arrays: KinematicArrays, settings: KinematicSettings) -> System:
    """The kernels' view of a mechanism.

    Bodies at rest come first among the columns, and held or driven coordinates first among the
    rows: elimination then finds them as pivots and leaves zeros behind.
    """
    if "places" not in arrays.of_variants:
        arrays.of_variants["places"] = _places_and_units(arrays)
    places, units = arrays.of_variants["places"]
    return System(
        arrays.constraints,
        places,
        units,
        np.array([settings.tolerance, settings.smallest_pivot, settings.most_iterations, arrays.q.size]),
    )


def _places_and_units(arrays: KinematicArrays) -> tuple[np.ndarray, np.ndarray]:
    constraints = arrays.constraints
    simple = np.isin(constraints["kind"], (SIMPLIFIED.code, DRIVER.code))
    of_row = np.searchsorted(constraints["first_row"], np.arange(len(arrays.equations)), side="right") - 1
    order = np.argsort(~simple[of_row], kind="stable")
    held = np.bincount(constraints["body_i"][simple], minlength=len(arrays.body_names))
    column = np.empty(arrays.q.size, dtype=np.int64)
    for position, body in enumerate(np.argsort(-held, kind="stable")):
        column[7 * body : 7 * body + 7] = np.arange(7 * position, 7 * position + 7)
    # Fewer equations than coordinates can be evaluated, though not solved: the table is padded.
    places, units = np.zeros((arrays.q.size, 4), dtype=np.int64), np.ones((2, arrays.q.size))
    places[: len(order), :2], places[: len(order), 2], places[:, COLUMN] = arrays.bodies_of, order, column
    units[0, : len(order)], units[1] = 1.0 / arrays.row_scale, arrays.column_scale
    return places, units


def with_dependent_columns(system: System, dependent: tuple[int, ...]) -> System:
    """The system for a position at which the coordinates `dependent` follow from the others.

    They are eliminated last, and their corrections and rates are 0.
    """
    places = system.places.copy()
    order = np.argsort(
        places[:, COLUMN] + system.places.shape[0] * np.isin(np.arange(len(places)), dependent)
    )
    places[order, COLUMN] = np.arange(len(places))
    limits = system.limits.copy()
    limits[RANK] -= len(dependent)
    return system._replace(places=places, limits=limits)
