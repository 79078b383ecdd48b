"""Memory that libhdf5 takes for the chunks of a dataset, found before it reads them.

It keeps a record of every chunk that it reads from, written or not.  And its filter inflates a chunk to
whatever the packed bytes make, a thousand times their number, before it compares that with the chunk.
"""

import zlib

import h5py

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
    for found in chunks_of(dataset):
        if found.size * INFLATED > most and not found.filter_mask & bit:
            raw = dataset.id.read_direct_chunk(found.chunk_offset)[1]
            if not _fits(raw, room):
                return "has a chunk that unpacks to more than it holds"
    return ""


def chunks_of(dataset: h5py.Dataset) -> list[h5py.h5d.StoreInfo]:
    """Return place and size of all stored chunks: to ask for one by its number looks through those before."""
    found: list[h5py.h5d.StoreInfo] = []
    dataset.id.chunk_iter(found.append)
    return found


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
