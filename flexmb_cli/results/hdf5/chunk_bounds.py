"""Memory that libhdf5 takes for the chunks of a dataset, found before it reads them.

It keeps a record of every chunk that it reads from, written or not.  And its filter inflates a chunk to
whatever the packed bytes make, a thousand times their number, before it compares that with the chunk.

The global heaps of an HDF5 file, where its texts and references lie, looked at before HDF5 follows them.

HDF5 File Format Specification 3.0, section III.E.  libhdf5 (1.14) goes round for ever, beyond the reach of
signals, where a part of a heap has no size; so an untrusted file could stop `table` and `diff`.

A text of variable length is stored as a reference of 16 bytes: its length (4), then the place of the text.
Thousands of them may lead to the same megabyte, so the lengths are summed up (sections III.E, global heap,
and VIII, variable-length datatypes).
"""

import mmap
import struct
import zlib
from collections.abc import Iterator

import h5py
import numpy as np

# Packing of netCDF-4.  Others of the library take sizes from the file, or have it load a plugin.
FILTERS: tuple[int, ...] = (h5py.h5z.FILTER_DEFLATE, h5py.h5z.FILTER_SHUFFLE, h5py.h5z.FILTER_FLETCHER32)
RECORD = 1024  # bytes for a chunk (libhdf5 1.14 takes about 800)
INFLATED = 1032  # bytes, at most, of a byte that was deflated (zlib's technical details)
_INFLATED_AT_ONCE = 2**20  # bytes
_CHECKSUM = 4  # bytes of Fletcher's, packed with the chunk


def bytes_of_records(dataset: h5py.Dataset) -> int:
    """Return the bytes of memory for the records of all chunks."""
    count = 1 if dataset.chunks else 0
    for length, chunk in zip(dataset.shape, dataset.chunks or (), strict=False):
        count *= -(-int(length) // int(chunk))
    return count * RECORD


def fault_of_filters(dataset: h5py.Dataset) -> str:
    """Return what is wrong with how a dataset is packed, "" for nothing."""
    plan = dataset.id.get_create_plist()
    filters = [plan.get_filter(k)[0] for k in range(plan.get_nfilters())]
    if any(number not in FILTERS for number in filters):
        return "is packed by a filter other than deflate, shuffle and Fletcher-32"
    return "is packed several times" if len(set(filters)) < len(filters) else ""


def fault_of_packed(dataset: h5py.Dataset, most: int) -> str:
    """Return what is wrong with chunks that may inflate to more than `most` bytes, "" for nothing.

    Raises what h5py raises of a damaged file.
    """
    plan = dataset.id.get_create_plist()
    filters = [plan.get_filter(k)[0] for k in range(plan.get_nfilters())]
    if h5py.h5z.FILTER_DEFLATE not in filters or dataset.id.get_storage_size() * INFLATED <= most:
        return ""
    bit = 1 << filters.index(h5py.h5z.FILTER_DEFLATE)
    room = dataset.dtype.itemsize + _CHECKSUM
    for length in dataset.chunks:
        room *= int(length)
    for chunk in chunks_of(dataset):
        if chunk.size * INFLATED > most and not chunk.filter_mask & bit:
            raw = dataset.id.read_direct_chunk(chunk.chunk_offset)[1]
            if not _fits(raw, room):
                return "has a chunk that unpacks to more than it holds"
    return ""


def chunks_of(dataset: h5py.Dataset) -> list[h5py.h5d.StoreInfo]:
    """Return place and size of all stored chunks: to ask for one by its number looks through those before."""
    chunks: list[h5py.h5d.StoreInfo] = []
    dataset.id.chunk_iter(chunks.append)
    return chunks


def _fits(raw: bytes, room: int) -> bool:
    """Return whether a chunk inflates to `room` bytes at most; the pieces are thrown away."""
    stream, total = zlib.decompressobj(), 0
    try:
        while not stream.eof and raw:
            total += len(stream.decompress(raw, _INFLATED_AT_ONCE))
            raw = stream.unconsumed_tail
            if total > room:
                return False
    except zlib.error:
        return False
    return True


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


REFERENCE = 16
# Bytes of memory that Python takes for a text besides its characters.
TEXT_COST = 64
_LENGTH = np.dtype({"names": ["length"], "formats": ["<u4"], "offsets": [0], "itemsize": REFERENCE})


class UnknownSize(Exception):
    """The references are stored in a way that no text of flexmb or of netCDF is."""


def bytes_of_texts(dataset: h5py.Dataset, most: int) -> int:
    """Return the bytes of memory that all texts of a dataset take, or some number above `most`.

    Raises UnknownSize, and what h5py raises of a damaged file.
    """
    count = _product(dataset.shape)
    total = count * TEXT_COST
    if total > most or not count:
        return total
    if dataset.chunks is None:
        return total + _contiguous(dataset, count)
    unwritten = count * _fill_length(dataset)
    for chunk in chunks_of(dataset):
        if total + unwritten > most:
            break
        total += _chunk(dataset, chunk.chunk_offset)
    return total + unwritten


def _contiguous(dataset: h5py.Dataset, count: int) -> int:
    place = dataset.id.get_offset()
    if place is None and not dataset.id.get_storage_size():
        return count * _fill_length(dataset)
    if place is None:
        # In the heading of the dataset, which has room for 4,000 of them.
        return sum(len(dataset[index]) for index in np.ndindex(dataset.shape))
    with open(dataset.file.filename, "rb") as stream:
        stream.seek(place)
        return _lengths(stream.read(count * REFERENCE))


def _chunk(dataset: h5py.Dataset, offset: tuple[int, ...]) -> int:
    mask, raw = dataset.id.read_direct_chunk(offset)
    size = _product(dataset.chunks) * REFERENCE
    plan = dataset.id.get_create_plist()
    for k in reversed(range(plan.get_nfilters())):
        if not mask >> k & 1:
            raw = _unpacked(plan.get_filter(k)[0], raw, size)
    return _lengths(raw)


def _unpacked(number: int, raw: bytes, size: int) -> bytes:
    # HDF5 passes over the other filters where references are packed, and says so in the chunk's mask.
    if number != h5py.h5z.FILTER_DEFLATE:
        raise UnknownSize("they are packed by a filter for numbers")
    return zlib.decompressobj().decompress(raw, size)


def _lengths(raw: bytes) -> int:
    whole = len(raw) // REFERENCE * REFERENCE
    return int(np.frombuffer(raw[:whole], _LENGTH)["length"].sum(dtype=np.int64))


def _fill_length(dataset: h5py.Dataset) -> int:
    """Length of the text that stands where nothing was written."""
    plan = dataset.id.get_create_plist()
    if plan.fill_value_defined() != h5py.h5d.FILL_VALUE_USER_DEFINED:
        return 0
    return len(dataset.fillvalue or b"")


def _product(lengths: tuple[int, ...]) -> int:
    product = 1
    for length in lengths:
        product *= int(length)
    return product
