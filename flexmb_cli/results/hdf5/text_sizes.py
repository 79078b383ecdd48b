"""Memory of the texts of an HDF5 file, found without reading them.

A text of variable length is stored as a reference of 16 bytes: its length (4), then the place of the text.
Thousands of them may lead to the same megabyte, so the lengths are summed up.  HDF5 File Format
Specification 3.0, sections III.E (global heap) and VIII (variable-length datatypes).
"""

import zlib

import h5py
import numpy as np

from .chunk_bounds import chunks_of

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
    for found in chunks_of(dataset):
        if total + unwritten > most:
            break
        total += _chunk(dataset, found.chunk_offset)
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
