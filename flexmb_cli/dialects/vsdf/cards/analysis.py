"""Cards of the analysis and its results: stiffening, times, integrator, output, materials, shapes."""

from ....model.integrators import METHODS
from ..card import BODY, MATRIX_FORMS, NODE, Column, card, vector_columns, whole_column, word_column

WITHOUT_CARD = "GALF"  # method of a deck without the card INTG, and what `flexmb new` proposes
# The first word of a column is the one that the dialogue proposes.
_METHODS = (WITHOUT_CARD, *sorted(METHODS.keys() - {WITHOUT_CARD}))

STRESS_PLACES = ("NODE", "ELEM", "MAX")
PROGRAMS = ("CCX", "ABQ")
SHAPES = ("BOX", "CYLI", "TUBE", "CONE", "SPHE")

_SHAPED = whole_column("body", "rigid body, 0: ground", None)
# Offset and angles of a shape.
_PLACED = (
    *vector_columns("offset", "middle of the shape, body axes", "m"),
    Column("alpha", "turned about x, then", "rad", default=0.0),
    Column("beta", "about y, then", "rad", default=0.0),
    Column("gamma", "about z, axes of the body", "rad", default=0.0),
)

ANALYSIS_CARDS = (
    card(
        "GEOS stiffening body",
        "stiffening of body {}",
        BODY,
        whole_column("on", "1: centrifugal stiffening"),
        Column("E", "Young's modulus of the elements; empty: by MATL or FEMG", "Pa", default=0.0),
        Column("nu", "Poisson's ratio of the elements", default=0.0),
        bodies="FLEX",
    ),
    card(
        "FEMG unit_load list",
        "geometric stiffness {}",
        BODY,
        whole_column("load", "unit load, 4 to 12: xx xy xz yx ... zz", None),
        word_column("form", "format of the file", MATRIX_FORMS),
        Column("file", "file of the geometric stiffness", letter="T", skip=1, default=None),
        bodies="FLEX",
    ),
    card(
        "TIME time single",
        "TIME",
        Column("end", "last time", "s", default=None),
        Column("output", "time between rows", "s", default=None),
        Column("step", "step of integration, 0: chosen by tolerance", "s", default=0.0),
    ),
    card(
        "INTG integrator single",
        "INTG",
        word_column("method", ", ".join(f"{word} {METHODS[word].meaning}" for word in _METHODS), _METHODS),
        Column("rho", "spectral radius at infinity, or tolerance", default=0.0),
        Column("stabilise", "constraint stabilisation", "1/s", default=0.0),
        Column("tolerance", "tolerance of a method with a spectral radius", default=0.0),
    ),
    card("OUTN output list", "output nodes {}", BODY, more=NODE),
    card(
        "MATL material body",
        "material of body {}",
        BODY,
        Column("E", "Young's modulus of the elements", "Pa", default=None),
        Column("nu", "Poisson's ratio of the elements", default=0.0),
        Column("rho", "density, to test the mass by; empty: no test", "kg/m^3", default=0.0),
        bodies="FLEX",
    ),
    card(
        "OUTS stress_output list",
        "stress output {}",
        BODY,
        word_column("what", "where stresses are reported", STRESS_PLACES),
        more=whole_column("number", "node, node set or element; none: all"),
    ),
    card(
        "PLAC placement list",
        "placement {}",
        BODY,
        NODE,
        *vector_columns("p", "point that it lies at (first), towards (second), beside (third), global", "m"),
    ),
    card(
        "GEOM shape list",
        "shape {}",
        _SHAPED,
        word_column("shape", "shape for pictures", SHAPES),
        Column("a", "length along x; of all but a box the radius", "m", default=0.0),
        Column("b", "length along y; of all but a box the length along z", "m", default=0.0),
        Column("c", "length along z; inner radius of a tube, upper one of a cone", "m", default=0.0),
        *_PLACED,
    ),
    card(
        "GSTL shape_file list",
        "shape file {}",
        _SHAPED,
        Column("unit", "metres in a unit of the file; empty: 1", "m", default=1.0),
        *_PLACED,
        second=(Column("file", "STL file", letter="T", skip=1, default=None),),
    ),
    card(
        "ELMT element_types body",
        "element types of body {}",
        BODY,
        word_column("types", "program whose types the INP file names; empty: CCX", PROGRAMS, ""),
        word_column("mass", "mass of the elements; empty: CONS, consistent", ("CONS", "LUMP"), ""),
        word_column("stress", "REDU: stresses at reduced points if K is of no known type", ("REDU",), ""),
        bodies="FLEX",
    ),
)
