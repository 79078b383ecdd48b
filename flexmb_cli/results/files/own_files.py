"""Files that flexmb may replace unasked: those that it made itself, of any age, whole or cut, and empty ones.

A deck, or a text of the user, in the place of a result stays: `--force` alone replaces it.
"""

import os
import re
from collections.abc import Iterable

from ...dialects.recognise import every_dialect
from ...errors import OutputError

_READ = 2**16  # bytes that are looked at
HDF5_SIGNATURE = b"\x89HDF\r\n\x1a\n"
# Beginnings of files that are no tables, and what else stands in so many bytes from there on.
_MARKS = (
    (HDF5_SIGNATURE, b"flexmb-", 2**10),  # of `Conventions`, the first attribute
    (HDF5_SIGNATURE + b"\x02", b"VTKHDF", 2**7),  # superblock 2: VTK and h5py by themselves write others
    (b"MATLAB 5.0 MAT-file, written by flexmb", b"", 0),
    (b"\x89PNG\r\n", b"Software\0flexmb", 2**8),
    (b'<!DOCTYPE html>\n<html lang="en">\n<head>\n<meta charset="utf-8">', b"script-src 'sha256-", 2**8),
    (b'<!doctype html>\n<html lang="en"><head><meta charset="utf-8">', b"script-src 'sha256-", 2**8),
)
# What HDF5 needs to find anything: a file cut before holds nothing.
_SHORTEST_HDF5 = 2**8


def refuse_foreign(paths: Iterable[str], force: bool = False, alike: bytes = b"") -> None:
    """Raise OutputError where a file that flexmb did not make stands at one of `paths`.

    `alike`: with what a file of this command begins, if it has no mark of its own.
    """
    for path in paths:
        if not force and os.path.isfile(path) and not is_own(path, alike):
            raise OutputError(
                f"{path}: a file stands there that flexmb did not make; --force replaces it, or rename it",
                id="RESULT-082",
            )


def is_own(path: str, alike: bytes = b"") -> bool:
    """Return whether the file at `path` is empty, or one that flexmb made."""
    try:
        with open(path, "rb") as file:
            content = file.read(_READ)
    except OSError:
        return False
    if not content.strip(b"\0"):  # zeros are what a loss of power leaves
        return True
    if content.startswith(HDF5_SIGNATURE[: len(content)]) and len(content) < _SHORTEST_HDF5:
        return True
    if any(content.startswith(begin) and mark in content[:within] for begin, mark, within in _MARKS):
        return True
    return _is_table(content.decode("latin-1"), path) or (bool(alike) and content.startswith(alike))


def _is_table(text: str, path: str) -> bool:
    """Return whether it is a printed table, or a part of one from its beginning."""
    begin, whole = "".join(text[:400].lower().split()), len(text) <= 400
    for dialect in every_dialect():
        for head in dialect.listing_begins:
            if begin.startswith(head) or (whole and head.startswith(begin)):
                return True
        if dialect.series_row and path.endswith(dialect.series) and _is_series(text, dialect.series_row):
            return True
    return False


def _is_series(text: str, row: str) -> bool:
    *lines, cut = text.replace("\r", "").split("\n")
    return all(re.fullmatch(row, line) for line in lines) and (bool(lines) or not cut.strip(" .-*0123456789E+"))
