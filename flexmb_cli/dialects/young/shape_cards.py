"""Cards of shapes, behind GEOMETRY or DYNAMICS: what bodies look like in pictures."""

from .card import Card, vector, whole
from .sections import Column

_BODY = whole("body", "number of the body, 0: the ground")
_PLACED = (
    *vector("offset", "the middle of the shape, body axes", "m"),
    Column("alpha", "angle by which it is turned about x, then", "rad"),
    Column("beta", "about y, then", "rad"),
    Column("gamma", "about z, axes of the body", "rad"),
)
SHAPE_CARDS = (
    Card(
        "GEOM",
        "shape",
        (
            _BODY,
            whole("shape", "1 box, 2 cylinder, 3 tube, 4 cone, 5 sphere"),
            Column("a", "length along x; of all but a box the radius", "m"),
            Column("b", "length along y; of all but a box the length along z", "m"),
            Column("c", "length along z; inner radius of a tube, upper one of a cone", "m"),
            *_PLACED,
        ),
        optional=8,
    ),
    Card(
        "STL",
        "shape_file",
        (
            Column("file", "STL file", is_text=True),
            _BODY,
            Column("unit", "metres in a unit of the file", "m"),
            *_PLACED,
        ),
        optional=6,
    ),
)
