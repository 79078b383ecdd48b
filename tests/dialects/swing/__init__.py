"""A dialect as somebody else would add one: lines `key = value` of a pendulum that swings in a plane."""

from flexmb_cli.dialects.dialect import Dialect

DIALECT = Dialect(
    name="swing",
    package=__name__,
    begins="the words a pendulum",
    recogniser="reader:begins",
    reader="reader:read",
    builder="builder:build",
    writer="listing:Table",
    listing_readers=("listing:parse",),
    listing_signs="no table of a pendulum",
    series=(".log",),
    curves=("point/position",),
)
