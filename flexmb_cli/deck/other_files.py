"""Recognition of files that are no decks, by their first bytes."""

import os
from collections.abc import Iterable
from contextlib import suppress
from pathlib import Path
from typing import BinaryIO

MOST_NAMES = 2000  # of a folder that are looked at
_TABLES = "open it in its program and save the deck as plain text"
# What a file begins with, what it is, and what to do.
_BEGINNINGS = (
    (b"\x89HDF\r\n\x1a\n", "an HDF5 file, as results are; flexmb table, plot and report read those"),
    (b"PK\x03\x04", f"a zip archive or an office document; {_TABLES}"),
    (b"\xd0\xcf\x11\xe0", f"an office document; {_TABLES}"),
    (b"%PDF", "a PDF document; copy the deck's text into a file of its own"),
    (b"\x1f\x8b", "compressed by gzip; unpack it: gunzip -c FILE | flexmb run -"),
    (b"\x89PNG", "a picture"),
)


def kind_of_file(raw: bytes) -> str:
    """Return what the file is that begins with `raw`, and what to do; empty where nothing is known."""
    return next((kind for beginning, kind in _BEGINNINGS if raw.startswith(beginning)), "")


def similar_name(path: Path) -> str:
    """Return the file of the same folder whose name is like that of `path`, or an empty text."""
    try:
        names = [entry.name for entry, _ in zip(path.parent.iterdir(), range(MOST_NAMES), strict=False)]
    except OSError:
        return ""
    return _same_stem(path.name, names) or _nearest(path.name, names)


def _same_stem(name: str, names: Iterable[str]) -> str:
    stems = {other.rpartition(".")[0].lower(): other for other in sorted(names, reverse=True)}
    return stems.get(name.lower(), "")


def _nearest(name: str, names: Iterable[str]) -> str:
    from difflib import get_close_matches

    by_letters = {other.lower(): other for other in names}
    found = get_close_matches(name.lower(), by_letters, n=1, cutoff=0.8)
    return by_letters[found[0]] if found else ""


_PIECE = 2**20  # bytes


def first_bytes(stream: BinaryIO, most: int) -> bytes:
    """Return the first `most` bytes of a stream, or all of them.

    A plain `stream.read(most)` would reserve `most` bytes even for a short stream.
    """
    expected = size_of(stream)
    pieces = [stream.read(min(expected + 1, most))]
    found = len(pieces[0])
    # A pipe or a device has no size, and a file may have grown.
    while expected < found < most and (piece := stream.read(min(_PIECE, most - found))):
        pieces.append(piece)
        found += len(piece)
    return b"".join(pieces)


def size_of(stream: BinaryIO) -> int:
    """Return the bytes of a file; 0 of a pipe, a device and a stream in memory."""
    with suppress(OSError, ValueError):  # a stream in memory has no descriptor
        return os.fstat(stream.fileno()).st_size
    return 0
