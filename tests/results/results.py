"""A small result with every kind of dataset, whose numbers tell where they stand."""

import numpy as np

from flexmb_cli.deck.record import Deck, DeckText
from flexmb_cli.results.hdf5.layout import EULER_PARAMETER, XYZ, Axis, Layout, Series, numbered_axis
from flexmb_cli.results.hdf5.result_file import ResultFile

BODIES = ("body 1", "body 2", "body 3")
COORDINATES = ("body 1 rotation 1", "body 2 rotation 1", "body 3 rotation 1", "body 3 rotation 2")
COORDINATES += ("body 2 node 1 axis 3",)
UNITS = ("rad", "rad", "rad", "rad", "m")

AXES = (
    XYZ,
    EULER_PARAMETER,
    numbered_axis("body", BODIES),
    numbered_axis("point", ["hinge 1", "body 2 node 1"]),
    numbered_axis("joint", ["spherical 1", "revolute 1", "revolute 2", "closure 1.a"]),
    numbered_axis("driver", ["driver 1"]),
    Axis(
        "coordinate/coordinate",
        (1, 2, 3, 4, 5),
        "number of the coordinate",
        (("coordinate/name", COORDINATES, "name"), ("coordinate/unit", UNITS, "unit")),
    ),
    Axis("elastic/body 2/node", (1, 3), "node of body 2"),
    Axis("modal/body 2/mode", (1, 2), "mode of body 2"),
)
SERIES = (
    Series("body/position", ("body/body", "xyz"), "m", "origin of the body frame, global axes"),
    Series("body/euler_parameters", ("body/body", "euler_parameter"), "1", "Euler parameters"),
    Series("body/velocity", ("body/body", "xyz"), "m/s", "velocity of the origin"),
    Series("body/angular_velocity", ("body/body", "xyz"), "rad/s", "angular velocity"),
    Series("point/acceleration", ("point/point", "xyz"), "m/s2", "acceleration of the point"),
    Series("coordinate/q", ("coordinate/coordinate",), "rad or m", "generalized coordinate"),
    Series("coordinate/u", ("coordinate/coordinate",), "rad/s or m/s", "generalized speed"),
    Series("reaction/force", ("joint/joint", "xyz"), "N", "force on body J"),
    Series("driver/effort", ("driver/driver",), "N or N m", "effort"),
    Series("energy/total", (), "J", "total energy"),
    Series("elastic/body 2/displacement", ("elastic/body 2/node", "xyz"), "m", "displacement"),
    Series("elastic/body 2/rate", ("elastic/body 2/node", "xyz"), "m/s", "rate of the displacement"),
    Series("modal/body 2/amplitude", ("modal/body 2/mode",), "m", "amplitude of the mode"),
    Series("audit/newton_iterations", (), "1", "Newton iterations"),
)


def value(path, row, *place):
    """The number at a place: the dataset's in the thousands, then row, item and component."""
    number = [series.path for series in SERIES].index(path) + 1
    return 1000.0 * number + row + sum(digit / 10.0 ** (k + 1) for k, digit in enumerate(place))


def write_result(path, rows, status="complete", message="", step=0.25):
    """A result of `rows` rows at t = 0, step, …"""
    length = {axis.path: len(axis.values) for axis in AXES}
    deck = Deck("dafms", DeckText("deck.DAT", "text", "0" * 64), ())
    file = ResultFile(path, deck, Layout("dynamic", rows, AXES, SERIES))
    values = {"time": step * np.arange(rows)}
    for series in SERIES:
        shape = (rows, *(length[axis] for axis in series.axes))
        places = np.indices(shape, dtype=float)
        values[series.path] = value(series.path, *places)
    file.rows(values)
    file.close(status, message)
    return path
