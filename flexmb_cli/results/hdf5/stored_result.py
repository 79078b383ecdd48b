"""Untrusted HDF5 results: read only where they have the structure that flexmb writes.

A file can lead to other files by its links, declare sizes that no memory holds, and name scales that are not
there, at which the HDF5 library ends the process.  So the structure is looked at before anything is read, and
scales are found by their references here rather than by the library.
"""

import errno
import re
import zlib
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from typing import TYPE_CHECKING, Any

import h5py

from ...errors import visible
from .chunk_bounds import (
    UnknownSize,
    bytes_of_records,
    bytes_of_texts,
    fault_of_filters,
    fault_of_heaps,
    fault_of_packed,
)

if TYPE_CHECKING:
    import numpy as np


MOST_OBJECTS, DEEPEST = 100_000, 10
LONGEST_AXIS = 2**31 - 1  # MATLAB's files count no further, nor does any run
# Errors of a stream or a file that is written while the result is open.
_OF_OUTPUT = (errno.EPIPE, errno.ENOSPC, errno.EBADF, errno.EDQUOT, errno.EFBIG)
# A file may declare this, and beyond it so many times its own size: compressed results are smaller than
# declared.
FREE_BYTES, MOST_TIMES = 2**26, 100
# The last part of `Conventions`, of results and of the tables of studies.
NEWEST_LAYOUT = 2
# The beginning of `Conventions` of the tables of studies.
OF_STUDIES, OF_FLEXMB = "flexmb-study-", "flexmb-"
# Scales along one axis of a dataset: netCDF and flexmb attach one.
MOST_SCALES = 64


class Damaged(Exception):
    """The file is no result that flexmb can have written; the text says where and why."""


@contextmanager
def understood() -> Iterator[None]:
    """Turn into `Damaged` what h5py raises of a file whose parts are missing or cannot be read."""
    try:
        yield
    except (KeyError, RuntimeError, MemoryError) as error:
        raise Damaged(f"cannot be read: {visible(str(error))}") from error
    except OSError as error:
        if error.errno in _OF_OUTPUT:
            raise
        raise Damaged(f"cannot be read: {visible(str(error))}") from error


def check_structure(file: h5py.File) -> None:
    """Raise `Damaged` where the file has links, types or sizes that no result of flexmb has."""
    try:
        _look_through(file)
    except (ValueError, TypeError, SystemError) as error:
        # h5py, where a name is no text or a message of HDF5 quotes one.
        raise Damaged(f"its structure cannot be read: {visible(str(error))}") from error


def is_study(path: str) -> bool:
    """Return whether the file at `path` can be opened and is the table of a study."""
    return root_attribute(path).startswith(OF_STUDIES)


def is_run(path: str) -> bool:
    """Return whether the file at `path` can be opened and is the result of a run."""
    conventions = root_attribute(path)
    return conventions.startswith(OF_FLEXMB) and not conventions.startswith(OF_STUDIES)


def root_attribute(path: str, name: str = "Conventions") -> str:
    """Return an attribute of the file at `path`, "" where it cannot be read."""
    try:
        with h5py.File(path, "r") as file, understood():
            return "" if fault_of_heaps(file) else attribute(file, name)
    except (OSError, ValueError, TypeError, SystemError, Damaged):
        # The next reader of the file reports what is wrong with it.
        return ""


def newer_layout(file: h5py.File) -> str:
    """Return the sentence about a file whose layout is of a later flexmb, or an empty text."""
    layout = attribute(file, "Conventions")
    match = re.fullmatch(r"flexmb-(?:study-)?([0-9]{1,9})", layout)
    if match is None or int(match[1]) <= NEWEST_LAYOUT:
        return ""
    writer = attribute(file, "flexmb_version") or "a later version"
    return (
        f"written by flexmb {writer} in the layout {layout}; this flexmb reads layouts up to {NEWEST_LAYOUT}"
    )


def _look_through(file: h5py.File) -> Any:
    heaps = fault_of_heaps(file)
    if heaps:
        raise Damaged(heaps)
    names: list[bytes] = []
    most, paths = _most_bytes(file), 0

    def stop_at(name: bytes, link: Any) -> Any:
        """Return what ends the search.

        h5py cannot bear an exception in here, and its own visits of a file look links up, which may raise.
        """
        nonlocal paths
        names.append(name)
        paths += len(name)
        if link.type != h5py.h5l.TYPE_HARD:
            return f"/{_reported(name)} is a link to elsewhere, which is not followed"
        if name != name.decode("utf-8", "replace").encode():
            return f"the name /{_reported(name)} is not UTF-8"
        if name.count(b"/") > DEEPEST:
            return f"it has groups in groups, more than {DEEPEST} deep"
        if paths > most:
            return f"the paths of its datasets take {paths:.3g} bytes"
        return f"it has more than {MOST_OBJECTS} datasets" if len(names) > MOST_OBJECTS else None

    fault = file.id.links.visit(stop_at, info=True)
    if fault:
        raise Damaged(fault)
    size, declared = file.id.get_filesize(), 0
    for name in names:
        declared += _declared(name, file[name], most)
        if declared > most:
            raise Damaged(f"it declares {declared:.3g} bytes of numbers and text in a file of {size}")


def _most_bytes(file: h5py.File) -> int:
    """Bytes that a file may take when it is read."""
    return int(max(FREE_BYTES, MOST_TIMES * file.id.get_filesize()))


def _declared(name: bytes, item: h5py.Dataset | h5py.Group, most: int) -> int:
    """Bytes of memory that reading an object takes, or some number above `most`."""
    if isinstance(item, h5py.Group):
        return 0
    if not isinstance(item, h5py.Dataset) or not _has_known_type(item):
        raise Damaged(f"/{_reported(name)} holds neither numbers nor text")
    if item.shape is None:
        raise Damaged(f"/{_reported(name)} is empty")
    if max(item.shape, default=0) > LONGEST_AXIS:
        raise Damaged(f"/{_reported(name)} declares an axis of {max(item.shape)} places")
    if item.is_virtual or item.external:
        raise Damaged(f"/{_reported(name)} has its numbers in another file, which is not read")
    places = max(_product(item.shape), _product(item.chunks or (0,)))
    size = places * item.dtype.itemsize + bytes_of_records(item)
    fault = fault_of_filters(item) or (size <= most and fault_of_packed(item, most))
    if fault:
        raise Damaged(f"/{_reported(name)} {fault}")
    if size > most or not is_variable_text(item):
        return int(size)
    try:
        return int(max(size, bytes_of_texts(item, most)))
    except (UnknownSize, OSError, zlib.error) as error:
        raise Damaged(f"the texts of /{_reported(name)} cannot be read: {error}") from error


def _has_known_type(dataset: h5py.Dataset) -> bool:
    try:
        return is_text(dataset) or is_number(dataset)
    except (ValueError, TypeError):
        # A number of more digits than numpy has, for one.
        return False


def _product(lengths: tuple[int, ...]) -> int:
    # Of Python's integers: 2^40 times 2^40 must not be 0.
    product = 1
    for length in lengths:
        product *= int(length)
    return product


def is_number(dataset: h5py.Dataset) -> bool:
    """Return whether it holds integers or real numbers."""
    return dataset.dtype.kind in "iuf"


def is_text(dataset: h5py.Dataset) -> bool:
    """Return whether it holds text."""
    return h5py.check_string_dtype(dataset.dtype) is not None


def is_variable_text(dataset: h5py.Dataset) -> bool:
    """Return whether it holds texts of any length, which are stored apart."""
    return is_text(dataset) and h5py.check_string_dtype(dataset.dtype).length is None


def scale_of(dataset: h5py.Dataset, axis: int) -> h5py.Dataset | None:
    """The first dimension scale along an axis, of its length; None where there is none.

    Raises `Damaged` when the reference leads to nothing that can be one.
    """
    listed = _references(dataset, axis)
    if listed is None or not len(listed[axis]):
        return None
    where = f"the scale of axis {axis + 1} of {_reported(dataset.name or 'a dataset')}"
    try:
        scale = dataset.file[listed[axis][0]]
    except (ValueError, TypeError) as error:
        raise Damaged(f"{where} is missing") from error
    good = isinstance(scale, h5py.Dataset) and h5py.h5o.get_info(scale.id).rc > 0 and scale.ndim == 1
    # The time (axis 0) may be shorter than the dataset: `rows` are those that both have.
    if not good or (axis and len(scale) != dataset.shape[axis]):
        raise Damaged(f"{where} has another length")
    return scale


def _references(dataset: h5py.Dataset, axis: int) -> "np.ndarray | None":
    """The references to scales of all axes of a dataset, None where there are none."""
    if not h5py.h5a.exists(dataset.id, b"DIMENSION_LIST"):
        return None
    # Looked at before it is read: it may be of any length, and lead to a megabyte from each of its places.
    attribute = h5py.h5a.open(dataset.id, b"DIMENSION_LIST")
    kind = h5py.check_vlen_dtype(attribute.dtype)
    if attribute.shape != (dataset.ndim,) or kind is None or h5py.check_ref_dtype(kind) is not h5py.Reference:
        return None
    if h5py.h5ds.get_num_scales(dataset.id, axis) > MOST_SCALES:
        raise Damaged(
            f"{_reported(dataset.name or 'a dataset')} has more than {MOST_SCALES} scales for an axis"
        )
    return dataset.attrs["DIMENSION_LIST"]


def place_of(dataset: h5py.Dataset) -> int:
    """Return where in its file a dataset begins."""
    return int(h5py.h5o.get_info(dataset.id).addr)


def texts(dataset: h5py.Dataset) -> list[str]:
    """The texts of a list of names, as they can be shown."""
    if not isinstance(dataset, h5py.Dataset) or not is_text(dataset) or dataset.ndim != 1:
        raise Damaged(f"{_reported(dataset.name or 'a dataset')} is not a list of names")
    return [visible(text) for text in dataset.asstr(errors="replace")[:].tolist()]


def attribute(owner: h5py.Dataset | h5py.File, name: str, default: str = "") -> str:
    """An attribute that is text, as it can be shown; "" for what is no text."""
    return visible(_text(owner, name)) if name in owner.attrs else default


def settings_of(result: h5py.File, name: str = "settings") -> list[str]:
    """Return the changes by `--set`, "NAME=VALUE" each; with `name` "options" the options of the solution."""
    text = _text(result, name) if name in result.attrs else ""
    return [visible(line) for line in text.splitlines()]


def _text(owner: h5py.Dataset | h5py.File, name: str) -> str:
    attribute = h5py.h5a.open(owner.id, name.encode())
    # An array may lead to the same text from each of its places; flexmb writes single texts.
    if attribute.shape != () or attribute.dtype.itemsize > _most_bytes(owner.file):
        return ""
    value = owner.attrs[name]
    if isinstance(value, bytes):
        value = value.decode("utf-8", "replace")
    return value if isinstance(value, str) else ""


def check_shapes(result: h5py.File, shapes: Mapping[str, str], sizes: dict[str, int]) -> None:
    """Raise `Damaged` where a dataset has another shape than declared; what is not in the file is passed
    over.

    A digit is a length, a letter that of `sizes`, where letters that it lacks are put in as they are found.
    """
    for path, letters in shapes.items():
        if path not in result:
            continue
        dataset = result[path]
        if not isinstance(dataset, h5py.Dataset) or dataset.ndim != len(letters):
            raise Damaged(f"/{_reported(path)} is not an array of {len(letters)} axes")
        if is_text(dataset) != path.endswith(("name", "message")):
            raise Damaged(f"/{_reported(path)} has numbers in place of text, or text in place of numbers")
        for letter, length in zip(letters, dataset.shape, strict=True):
            expected = int(letter) if letter.isdigit() else sizes.setdefault(letter, length)
            if length != expected:
                raise Damaged(f"/{_reported(path)} has {length} places along an axis of {expected}")


def _reported(name: str | bytes) -> str:
    name = name.decode("utf-8", "backslashreplace") if isinstance(name, bytes) else name
    return visible(name if len(name) < 100 else f"{name[:80]}…")


class StoredDatasets(Mapping[str, h5py.Dataset]):
    """Every dataset of a file whose structure was checked; it is opened on access."""

    def __init__(self, file: h5py.File):
        self._file = file
        # A dictionary, as an ordered set.
        self._paths = dict.fromkeys(_paths_of_datasets(file))

    def __getitem__(self, path: str) -> h5py.Dataset:
        if path not in self._paths:
            raise KeyError(path)
        return self._file[path]

    def __contains__(self, path: object) -> bool:
        return path in self._paths

    def __iter__(self) -> Iterator[str]:
        return iter(self._paths)

    def __len__(self) -> int:
        return len(self._paths)

    def leave_out(self, path: str) -> None:
        """Count a path no longer among the datasets, if it is one of them."""
        self._paths.pop(path, None)


def _paths_of_datasets(file: h5py.File) -> list[str]:
    paths: list[bytes] = []

    # h5py cannot bear an exception in here.
    def note(name: bytes, described: h5py.h5o.ObjInfo) -> None:
        if described.type == h5py.h5o.TYPE_DATASET:
            paths.append(name)

    h5py.h5o.visit(file.id, note, info=True)
    return [name.decode("utf-8", "surrogateescape") for name in paths]
