"""YOUNG decks (1996): spatial mechanisms, kinematics and dynamics."""

from ...model.integrators import METHOD_OPTIONS
from ..dialect import Dialect

DIALECT = Dialect(
    name="young",
    package=__name__,
    begins="twelve integers",
    recogniser="recognition:begins_young",
    reader="dynamic_cards:read_young_deck",
    builder="build_model:build_model",
    writer="listing:OutTable",
    listing_readers=("listing_reader:parse_listing",),
    listing_begins=("enternumberofbody:nbody", "numberswiththeknownerrorsoftheprogramof1996"),
    listing_signs="neither a line TIME= nor an echo of a YOUNG deck",
    renamed=("IN", "OUT"),
    options=("feps", "epslu", "nrmax", "as-printed", "method", "rtol", "atol"),
    methods=METHOD_OPTIONS,
    stepping="dynamic_cards:takes_steps",
    joints={
        "NSPHER": "spherical",
        "NUNIVE": "universal",
        "NREVOL": "revolute",
        "NCYLIN": "cylindrical",
        "NTRANS": "translational",
        "NSCREW": "screw",
        "NSIMPL": "simplified",
        "NSIMP2": "distance",
        "NDRIVE": "driver",
    },
    curves=("point/position", "body/position", "driver/effort"),
    form="form:YoungForm",
    new_name="IN-NEW.dat",
    relabel="reader:relabelled",
    rigid_model="exchange.rigid_model:rigid_model",
    programs=("exudyn",),
    rigid_deck="exchange.rigid_deck:rigid_deck",
    other_units="exchange.other_units:in_other_units",
    as_given={"driver": ("C", "B", "A"), "point": ("x", "y", "z")},
    any_units=True,
)
