"""DAFMS decks (1992): trees of rigid and flexible bodies."""

from ...model.integrators import TREE_METHODS
from ..dialect import Dialect

DIALECT = Dialect(
    name="dafms",
    package=__name__,
    begins="two integers, then a card DFMB, STAR or STOP",
    recogniser="recognition:begins_dafms",
    reader="reader:read_dafms",
    builder="build:build_dafms",
    writer="listing:Tables",
    listing_readers=("listing_reader:parse_echo",),
    series_readers=("listing_reader:parse_series",),
    listing_begins=("==n==ndm==",),
    # FORMAT(2F12.7,5E15.6), and the lines that a stopped integration writes below.
    series_row=r" *(-?\d*\.\d{7}|\*+)( *(-?\d*\.\d{7}|\*+|(?i:nan)|-?Inf\w*))?"
    r"( *(-?\d?\.\d{6}([EDe][+-]\d+|[+-]\d+)|\*+|(?i:nan)|-?Inf\w*)){0,5} *|  (TOL,XEND|\*\*Y\*\*).*",
    listing_signs="no echo of a DAFMS deck (==N==NDM==) and no time series of one",
    series=(".T2", ".T3"),
    options=("rtol", "atol", "method", "formulation"),
    methods=TREE_METHODS,
    curves=("coordinate/q",),
    form="form:DafmsForm",
    new_name="NEW.DAT",
    rigid_model="exchange.rigid_model:rigid_model",
    programs=("mjcf",),
    rigid_deck="exchange.rigid_deck:rigid_deck",
    by_columns=True,
)
