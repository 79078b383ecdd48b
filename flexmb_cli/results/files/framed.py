"""Payloads one behind the other in a growing file, each with its length and checksum before it.

A kill tears at most the last one, which then does not count.
"""

import os
import struct
import sys
import zlib
from collections.abc import Iterator
from typing import BinaryIO


class LargePayload(ValueError):
    """A payload takes more memory than its reader has for it; `length` in bytes."""

    def __init__(self, length: int):
        super().__init__(length)
        self.length = length


def framed(payload: bytes, head: struct.Struct) -> bytes:
    """Return the payload behind its head of two whole numbers: length, CRC-32."""
    return head.pack(len(payload), zlib.crc32(payload)) + payload


def whole_payloads(file: BinaryIO, head: struct.Struct, most: int = sys.maxsize) -> Iterator[bytes]:
    """Yield the payloads from here on, up to the end or the first that is torn or damaged.

    Raises LargePayload before it reads one of more than `most` bytes.
    Zeros, as a loss of power may leave, look like an empty payload with its checksum: the caller must check.
    """
    size = os.fstat(file.fileno()).st_size
    while len(start := file.read(head.size)) == head.size:
        length, checksum = head.unpack(start)
        # A damaged length may be larger than any memory.
        if length > size - file.tell():
            return
        if length > most:
            raise LargePayload(length)
        payload = file.read(length)
        if len(payload) < length or zlib.crc32(payload) != checksum:
            return
        yield payload
