"""The global heaps of an HDF5 file, where its texts and references lie, looked at before HDF5 follows them.

HDF5 File Format Specification 3.0, section III.E.  libhdf5 (1.14) goes round for ever, beyond the reach of
signals, where a part of a heap has no size; so an untrusted file could stop `table` and `diff`.
"""

import mmap
import struct
from collections.abc import Iterator

import h5py

# Of larger files only the first part is searched, which takes a tenth of a second.
SEARCHED = 2**28
SIGNATURE = b"GCOL\x01"
_HEADING, _PART = 16, 16
_WIDTHS = (8, 8)  # bytes of an address and of a length


def fault_of_heaps(file: h5py.File) -> str:
    """Return what is wrong with a heap of the file, "" when they are as HDF5 leaves them."""
    if file.id.get_create_plist().get_sizes() != _WIDTHS:
        return "its addresses and lengths are not of eight bytes"
    with open(file.filename, "rb") as stream:
        length = min(stream.seek(0, 2), SEARCHED)
        if not length:
            return "it is empty"
        with mmap.mmap(stream.fileno(), length, access=mmap.ACCESS_READ) as raw:
            return next((fault for fault in _faults(raw) if fault), "")


def _faults(raw: mmap.mmap) -> Iterator[str]:
    start = raw.find(SIGNATURE)
    while start >= 0:
        end = start + _number(raw, start + 8)
        yield _fault_of_heap(raw, start, end)
        # A text within a heap may well hold the signature.
        start = raw.find(SIGNATURE, end)


def _fault_of_heap(raw: mmap.mmap, start: int, end: int) -> str:
    """A heap is its heading and its parts, each behind the other up to its end; part 0 is free space."""
    if end < start + _HEADING or (end > len(raw) and len(raw) < SEARCHED):
        return f"the heap at byte {start} is longer than the file, or has no length"
    at = start + _HEADING
    while at + _PART <= min(end, len(raw)):
        length = _number(raw, at + 8)
        step = _PART + -(-length // 8) * 8 if raw[at : at + 2] != b"\0\0" else length
        if step < _PART or at + step > end:
            return f"the heap at byte {start} has a part of {length} bytes"
        at += step
    return ""


def _number(raw: mmap.mmap, at: int) -> int:
    return int(struct.unpack_from("<Q", raw, at)[0]) if at + 8 <= len(raw) else 0
