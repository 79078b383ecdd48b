"""The first bytes of a stream of any length, without reserving memory for the largest length allowed."""

import os
from contextlib import suppress
from typing import BinaryIO

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
