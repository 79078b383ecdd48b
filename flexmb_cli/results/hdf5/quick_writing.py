"""Attributes, scales and rows written by HDF5's own calls: h5py's objects take three times as long."""

import h5py
import numpy as np
from h5py import h5a, h5d, h5ds, h5p, h5s, h5t

TEXT = h5py.string_dtype()
_OF_FILES, _OF_MEMORY = h5t.py_create(TEXT, logical=True), h5t.py_create(TEXT)


def set_texts(item: h5py.HLObject, **texts: str) -> None:
    """Give a new dataset or file its attributes."""
    for name, text in texts.items():
        attribute = h5a.create(item.id, name.encode(), _OF_FILES, h5s.create_simple(()))
        attribute.write(np.array(text, TEXT), mtype=_OF_MEMORY)


def attach_scales(dataset: h5py.Dataset, scales: list[h5py.Dataset]) -> None:
    """Make the scales those of the dataset's axes."""
    for number, scale in enumerate(scales):
        h5ds.attach_scale(dataset.id, scale.id, number)


def growing_dataset(file: h5py.File, path: str, item: tuple[int, ...], chunk: int) -> h5py.Dataset:
    """Make a dataset of floats, without rows; a row has the shape `item`."""
    folder, _, name = path.rpartition("/")
    group = file.require_group(folder) if folder else file
    properties = h5p.create(h5p.DATASET_CREATE)
    properties.set_chunk((chunk, *item))
    properties.set_obj_track_times(False)
    space = h5s.create_simple((0, *item), (h5s.UNLIMITED, *item))
    return h5py.Dataset(h5d.create(group.id, name.encode(), h5t.IEEE_F64LE, space, properties))


def append_rows(dataset: h5py.Dataset, begin: int, values: np.ndarray) -> None:
    """Write rows behind the first `begin` rows, which are all that the dataset has."""
    identifier, values = dataset.id, np.ascontiguousarray(values)
    identifier.set_extent((begin + len(values), *values.shape[1:]))
    if values.size:
        space = identifier.get_space()
        space.select_hyperslab((begin, *(0 for _ in values.shape[1:])), values.shape)
        identifier.write(h5s.create_simple(values.shape), space, values)
