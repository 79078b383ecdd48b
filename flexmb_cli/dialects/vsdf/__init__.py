"""VSDF decks: finite-element bodies in floating frames (VSDFlex, 2008)."""

from ...model.integrators import METHOD_OPTIONS
from ..dialect import Dialect

DIALECT = Dialect(
    name="vsdf",
    package=__name__,
    begins="the word VSDF",
    recogniser="recognition:begins_vsdf",
    reader="reader:read_vsdf",
    builder="build:build_model",
    writer="listing:VsdfTable",
    listing_readers=("listing_reader:parse_vsdf",),
    listing_begins=("*" * 78 + "vsdf",),
    listing_signs="no listing of a VSDF deck",
    options=("method", "rtol", "atol"),
    methods=METHOD_OPTIONS,
    joints={
        "SPHE": "spherical",
        "UNIV": "universal",
        "REVO": "revolute",
        "CYLI": "cylindrical",
        "TRAN": "translational",
        "SCRW": "screw",
        "FIXD": "fixed",
        "RSPH": "revolute-spherical",
        "DIST": "spherical-spherical",
    },
    curves=("point/position", "body/position"),
    form="form:VsdfForm",
    new_name="NEW.vsdf",
    second_model="exchanged_frames:exchanged_model",
    rigid_model="exchange.rigid_model:rigid_model",
    rigid_deck="exchange.rigid_deck:rigid_deck",
    by_columns=True,
)
