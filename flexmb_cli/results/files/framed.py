"""Payloads one behind the other in a growing file, each with its length and checksum before it.

A kill tears at most the last one, which then does not count.
"""

import os
import struct
import zlib
from collections.abc import Iterator
from typing import BinaryIO


def framed(payload: bytes, head: struct.Struct) -> bytes:
    """Return the payload behind its head of two whole numbers: length, CRC-32."""
    return head.pack(len(payload), zlib.crc32(payload)) + payload


def whole_payloads(file: BinaryIO, head: struct.Struct) -> Iterator[bytes]:
    """Yield the payloads from here on, up to the end or the first that is torn or damaged.

    Zeros, as a loss of power may leave, look like an empty payload with its checksum: the caller must check.
    """
    size = os.fstat(file.fileno()).st_size
    while len(start := file.read(head.size)) == head.size:
        length, checksum = head.unpack(start)
        # A damaged length may be larger than any memory.
        if length > size - file.tell():
            return
        payload = file.read(length)
        if len(payload) < length or zlib.crc32(payload) != checksum:
            return
        yield payload
