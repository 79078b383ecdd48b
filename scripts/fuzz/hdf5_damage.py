"""Damage to the structure of an HDF5 result: what is missing, of another kind, elsewhere or too large."""

import random
from contextlib import suppress
from pathlib import Path

import h5py
import numpy as np

NAMES = (
    *(
        "",
        "body 1",
        "complete",
        "failed",
        "\x1b[2J",
        "<script>alert(1)</script>",
        "a" * 4000,
        "e0",
        "rad or m",
    ),
    *("\u2028", "body.1", "nan", "-1", "[", "*", "é", "\x07"),
)
TYPES = (
    "i1",
    "i4",
    "u8",
    "f4",
    "f8",
    "c16",
    "?",
    "S4",
    "V8",
    h5py.string_dtype(),
    h5py.string_dtype("ascii", 3),
)
TYPES += (np.dtype([("a", "f8"), ("b", "i4")]), h5py.vlen_dtype("f8"), h5py.ref_dtype)
SHAPES = ((), (0,), (1,), (3,), (2, 3), (0, 3), (5, 4, 3), (2, 2, 2, 2), None)
HUGE = ((10**12,), (2**40, 3, 3), (2**62,), (3, 2**50), (2**31,))
VALUES = (np.nan, np.inf, -np.inf, 0.0, -1.0, 1e308, 5e-324)


def damage_structure(chance: random.Random, path: Path) -> None:
    """One to three changes to the file at `path`."""
    for _ in range(chance.choice((1, 1, 1, 2, 3))):
        # What h5py will not write, and files that it cannot close, cannot be read either.
        with suppress(KeyError, ValueError, RuntimeError, TypeError, OSError), h5py.File(path, "r+") as file:
            chance.choice(CHANGES)(chance, file)


def _paths(file, kind=h5py.Dataset):
    found = []
    file.visititems(lambda name, item: found.append(name) if isinstance(item, kind) else None)
    return sorted(found)


def _chosen(chance, file):
    return chance.choice(_paths(file))


def _remove(chance, file):
    del file[chance.choice(_paths(file, (h5py.Dataset, h5py.Group)))]


def _rename(chance, file):
    name = _chosen(chance, file)
    file.move(name, f"{name}{chance.choice(('2', ' ', '.x', '/x'))}")


def _exchange(chance, file):
    a, b = _chosen(chance, file), _chosen(chance, file)
    if a != b:
        file.move(a, "swap")
        file.move(b, a)
        file.move("swap", b)


def _replace(chance, file, **making):
    name = _chosen(chance, file)
    attributes = dict(file[name].attrs)
    del file[name]
    made = file.create_dataset(name, **making)
    for key, value in attributes.items():
        if key not in ("DIMENSION_LIST", "REFERENCE_LIST"):
            made.attrs[key] = value


def _retype(chance, file):
    shape, kind = chance.choice(SHAPES), chance.choice(TYPES)
    if shape is None:
        _replace(chance, file, data=h5py.Empty("f8"))
    else:
        _replace(chance, file, shape=shape, dtype=kind)


def _convert(chance, file):
    """The same shape and scales, another type."""
    name = _chosen(chance, file)
    old = file[name]
    scales = [[scale.name for scale in axis.values()] for axis in old.dims]
    shape, kind = old.shape, chance.choice(TYPES)
    del file[name]
    made = file.create_dataset(name, shape=shape, dtype=kind)
    for axis, names in enumerate(scales):
        for scale in names:
            if scale in file:
                made.dims[axis].attach_scale(file[scale])


def _inflate(chance, file):
    shape = chance.choice(HUGE)
    chunks = tuple(min(length, chance.choice((1, 16, 4096))) for length in shape)
    options = {"compression": "gzip"} if chance.random() < 0.5 else {}
    _replace(chance, file, shape=shape, chunks=chunks, dtype="f8", **options)


def _large_chunk(chance, file):
    size = chance.choice((2**20, 2**26, 2**28))
    _replace(chance, file, shape=(5,), maxshape=(None,), chunks=(size,), dtype="f8", compression="gzip")


def _resize(chance, file):
    name = _chosen(chance, file)
    dataset = file[name]
    if dataset.chunks:
        rows = chance.choice((0, 1, dataset.shape[0] + 1, dataset.shape[0] // 2, 10**6, 10**12, 2**62))
        dataset.resize(rows, axis=0)


def _spoil_values(chance, file):
    dataset = file[_chosen(chance, file)]
    if dataset.size and np.issubdtype(dataset.dtype, np.number) and _is_small(dataset):
        value = chance.choice(VALUES if dataset.dtype.kind == "f" else (-1, 0, 1, 2**31 - 1))
        values = dataset[()].reshape(-1)
        values[chance.randrange(len(values)) :: chance.choice((1, 1000))] = value
        dataset[...] = values.reshape(dataset.shape)


def _is_small(dataset):
    """Whether a value can be written without the memory of a chunk of half a gigabyte."""
    return np.prod(dataset.chunks or (1,), dtype=float) < 2**22


def _spoil_text(chance, file):
    dataset = file[_chosen(chance, file)]
    if h5py.check_string_dtype(dataset.dtype):
        text = chance.choice((chance.choice(NAMES), b"\xff\xfe"))
        dataset[...] = text if dataset.shape == () else [text] * dataset.shape[0]


def _spoil_attribute(chance, file):
    owner = chance.choice((file, file, file[_chosen(chance, file)]))
    names = sorted(owner.attrs) or ["status"]
    name = chance.choice(names)
    if chance.random() < 0.3:
        del owner.attrs[name]
        return
    values = (
        *NAMES,
        1,
        1.5,
        np.nan,
        np.arange(3.0),
        b"\xff\xfe",
        h5py.Empty("f8"),
        np.array(["a", "b"], "S1"),
    )
    owner.attrs[name] = chance.choice(values)


def _detach(chance, file):
    dataset = file[_chosen(chance, file)]
    name = chance.choice(("DIMENSION_LIST", "REFERENCE_LIST", "CLASS", "NAME"))
    if name in dataset.attrs:
        del dataset.attrs[name]


def _attach(chance, file):
    """A scale of another length, or one that is no scale."""
    dataset, scale = file[_chosen(chance, file)], file[_chosen(chance, file)]
    if not scale.is_scale:
        scale.make_scale("extra")
    if dataset.ndim:
        dataset.dims[chance.randrange(dataset.ndim)].attach_scale(scale)


def _link(chance, file):
    name = _chosen(chance, file)
    group = name.rpartition("/")[0] or "/"
    links = (
        h5py.SoftLink("/nowhere"),
        h5py.SoftLink(f"/{name}"),
        h5py.SoftLink("/body/position"),
        h5py.ExternalLink("other.h5", "/time"),
        h5py.ExternalLink("/dev/zero", "/time"),
        file[group],
    )
    del file[name]
    file[name] = chance.choice(links)


def _outside(chance, file):
    """A dataset whose numbers are in other files."""
    name = _chosen(chance, file)
    shape = file[name].shape or (1,)
    del file[name]
    if chance.random() < 0.5:
        file.create_dataset(name, shape=shape, dtype="f8", external=[("/dev/zero", 0, h5py.h5f.UNLIMITED)])
    else:
        layout = h5py.VirtualLayout(shape=shape, dtype="f8")
        layout[...] = h5py.VirtualSource("other.h5", "time", shape=shape)
        file.create_virtual_dataset(name, layout)


def _other_object(chance, file):
    name = _chosen(chance, file)
    del file[name]
    if chance.random() < 0.5:
        file.create_group(name)
    else:
        file[name] = np.dtype("f8")


def _deepen(chance, file):
    """Groups in groups, and many of them."""
    name = "/".join(["elastic"] + ["body 1"] * chance.choice((2, 50, 500)))
    file.require_group(name).create_dataset("displacement", data=np.zeros((3, 3)))


CHANGES = (
    *(_remove, _rename, _exchange, _retype, _convert, _convert, _inflate, _large_chunk, _resize),
    *(_spoil_values, _spoil_values, _spoil_text, _spoil_attribute, _spoil_attribute, _detach, _attach),
    *(_link, _outside, _other_object, _deepen),
)
