"""The input languages, in the order in which they are tried: one line each.

To add one, make a folder whose `__init__.py` holds a `DIALECT` (see `dialect.Dialect`), and a line here.  The
pattern is for speed only: a dialect is imported when one of a deck's first lines, without blanks at its
ends, begins like it, and `DIALECT.fits` then decides.
"""

DIALECTS = {
    "vsdf": (f"{__name__}.vsdf", "VSDF"),
    "dafms": (f"{__name__}.dafms", "DFMB|STAR|STOP"),
    "young": (f"{__name__}.young", ""),
}

# Of names of decks in a folder, in small or capital letters.
ENDINGS = (".dat", ".pas", ".vsdf")
