"""A result as a MATLAB file (version 5), which MATLAB, Octave and scipy read."""

import io
import re
from collections.abc import Iterator
from typing import Any

import h5py
import numpy as np

from ...deck.listing import read_bytes
from ..hdf5.stored_result import attribute
from ..quantities.quantities import ResultError
from .matlab_reader import read_variable

# Bytes of the header's text, of a variable, and of a name.
HEADER, LARGEST_VARIABLE, LONGEST_NAME = 116, 2**31 - 1, 63


def matlab_bytes(result: h5py.File) -> bytes:
    """The file's bytes: one struct `flexmb`, a field for every group and dataset, `info` for the attributes.

    Names are those of the result, with _ for what MATLAB does not take: body 1 is body_1.  Raises
    `ResultError` for a result that is too large for the format.
    """
    content = _content(result)
    if _size(content) > LARGEST_VARIABLE:
        limit = "larger than the 2 GB of a MATLAB 5 file; MATLAB reads the result itself (h5read)"
        raise ResultError(result.filename, limit, id="RESULT-012")
    return variable_bytes("flexmb", content)


def matlab_fields(result: h5py.File) -> dict[str, np.ndarray]:
    """Return what the file of `result` would hold, by the paths of the fields: `body/position`."""
    return dict(_flat(_content(result)))


def read_matlab(path: str) -> dict[str, np.ndarray]:
    """Return the fields of a file that `flexmb export --to mat` wrote, by their paths.

    Raises TableError when it cannot be read, ValueError when it is another file.
    """
    return dict(_flat(read_variable(read_bytes(path), "flexmb")))


def _flat(content: dict[Any, Any], prefix: str = "") -> Iterator[Any]:
    for name, value in content.items():
        if isinstance(value, dict):
            yield from _flat(value, f"{prefix}{name}/")
        else:
            yield f"{prefix}{name}", np.asarray(value)


def _content(result: h5py.File) -> dict[Any, Any]:
    return _struct(result) | {
        "info": {name: attribute(result, name) for name in result.attrs if name[:1] != "_"}
    }


def variable_bytes(name: str, content: dict[Any, Any]) -> bytes:
    """Return the bytes of a file with one variable; a dictionary is a struct."""
    from scipy.io import savemat

    stream = io.BytesIO()
    savemat(stream, {name: content}, long_field_names=True, oned_as="column")
    # scipy writes the time of the day here; the same result shall give the same bytes.
    text = b"MATLAB 5.0 MAT-file, written by flexmb"
    return text.ljust(HEADER) + stream.getvalue()[HEADER:]


def _struct(group: h5py.File | h5py.Group) -> dict[Any, Any]:
    fields: dict[Any, Any] = {}
    for name, item in group.items():
        fields[_field(name, fields)] = _struct(item) if isinstance(item, h5py.Group) else _values(item)
    return fields


def _field(name: str, taken: dict[Any, Any]) -> str:
    field = re.sub(r"\W", "_", name, flags=re.ASCII)
    field = (field if field[:1].isalpha() else f"x{field}")[:LONGEST_NAME]
    count = 1
    while field in taken:
        count += 1
        field = f"{field[: LONGEST_NAME - 4]}_{count}"
    return field


def _values(dataset: h5py.Dataset) -> np.ndarray | str:
    if h5py.check_string_dtype(dataset.dtype) is None:
        found: np.ndarray | str = dataset[()]
        return found
    texts = dataset.asstr(errors="replace")[()]
    return texts if isinstance(texts, str) else np.array(texts, dtype=object)


def _size(content: dict[Any, Any]) -> int:
    return sum(
        _size(item) if isinstance(item, dict) else getattr(item, "nbytes", 0) for item in content.values()
    )
