"""Files that flexmb may replace unasked: its own, of any age, whole or cut, and empty ones."""

import os
import re
from collections.abc import Iterable
from functools import partial

from ...dialects.recognise import every_dialect
from ...errors import OutputError

HDF5_SIGNATURE = b"\x89HDF\r\n\x1a\n"
_READ, _BEGIN_BYTES = 2**16, 400  # bytes that are looked at, and those of a heading
_SHORTEST_HDF5 = 2**8  # bytes; a file cut before holds nothing
# Files that are no tables: an HDF5 result by `Conventions`, its first attribute; VTKHDF by the superblock 2,
# where VTK and h5py by themselves write others; pages by their content security policy.
_MARKED = re.compile(
    rb"\x89HDF\r\n\x1a\n(.{,1000}flexmb-|\x02.{,100}VTKHDF)|MATLAB 5.0 MAT-file, written by flexmb"
    rb"|\x89PNG\r\n.{,200}Software\0flexmb"
    rb"|<!doctype html>\s<html lang=\"en\">\s?<head>\s?<meta charset=\"utf-8\">.{,100}script-src 'sha256-",
    re.DOTALL | re.IGNORECASE,
)


def refuse_foreign(paths: Iterable[str], force: bool = False, alike: str = "") -> None:
    """Raise OutputError where a file that flexmb did not make stands at one of `paths`.

    `alike`: with what files of this command begin, if they have no mark of their own.
    """
    for path in paths:
        if not force and os.path.isfile(path) and not is_own(path, alike):
            message = (
                f"{path}: a file stands there that flexmb did not make; --force replaces it, or rename it"
            )
            raise OutputError(message, id="RESULT-082")


def is_own(path: str, alike: str = "") -> bool:
    """Return whether the file at `path` is empty, or one that flexmb made."""
    try:
        with open(path, "rb") as file:
            content = file.read(_READ)
            if not content.strip(b"\0"):  # what a loss of power leaves
                return not any(part.strip(b"\0") for part in iter(partial(file.read, _READ), b""))
    except OSError:
        return False
    cut = HDF5_SIGNATURE.startswith(content[:8]) and len(content) < _SHORTEST_HDF5
    if cut or _MARKED.match(content):
        return True
    return _is_table(content.decode("latin-1"), path) or bool(alike and content.startswith(alike.encode()))


def _is_table(text: str, path: str) -> bool:
    """Return whether it is a printed table, or a part of one from its beginning."""
    begin, whole = "".join(text[:_BEGIN_BYTES].lower().split()), len(text) <= _BEGIN_BYTES
    *lines, _ = text.replace("\r", "").split("\n")
    for dialect in every_dialect():
        heads = dialect.listing_begins
        if begin.startswith(heads) or (whole and any(head.startswith(begin) for head in heads)):
            return True
        if dialect.series_row and path.endswith(dialect.series):
            cut = not lines and re.fullmatch(r" *|   [-+ .*\dE]*", text)
            return bool(cut or (lines and all(re.fullmatch(dialect.series_row, line) for line in lines)))
    return False
