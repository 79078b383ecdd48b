"""The forms of files that `diff` compares, recognised by their first bytes."""

import re
from typing import Any

from ..files.own_files import HDF5_SIGNATURE

HDF5, CSV, MATLAB, LISTING = "an HDF5 file", "a CSV table", "a MATLAB file", "a table for print"
UNREADABLE = "a file that cannot be opened"
MATLAB_SIGNATURE = b"MATLAB 5.0 MAT-file"
# The heading of the first column that `flexmb export --to csv` and `flexmb table` write, and what follows.
CSV_HEAD = re.compile(rb"\A(?:\xef\xbb\xbf)?\"?time \[s\]\"?([,\t\r\n]|\Z)")
_SIGNATURE_BYTES = 64


def form_of(path: Any) -> str:
    """Return the form of the file at `path`; what is unknown counts as a table for print."""
    if str(path) == "-":
        return LISTING
    try:
        with open(path, "rb") as file:
            begins = file.read(_SIGNATURE_BYTES)
    except OSError:
        # The reader that opens it again words the fault.
        return UNREADABLE
    if begins.startswith(HDF5_SIGNATURE):
        return HDF5
    if begins.startswith(MATLAB_SIGNATURE):
        return MATLAB
    return CSV if CSV_HEAD.match(begins) else LISTING
