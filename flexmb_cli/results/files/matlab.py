"""A result as a MATLAB file (version 5), which MATLAB, Octave and scipy read."""

import io
import re

import h5py
import numpy as np

from ..hdf5.stored_result import attribute
from ..quantities.quantities import ResultError

# Bytes of the header's text, of a variable, and of a name.
HEADER, LARGEST, LONGEST_NAME = 116, 2**31 - 1, 63


def matlab_bytes(result: h5py.File) -> bytes:
    """The file's bytes: one struct `flexmb`, a field for every group and dataset, `info` for the attributes.

    Names are those of the result, with _ for what MATLAB does not take: body 1 is body_1.  Raises
    `ResultError` for a result that is too large for the format.
    """
    content = _struct(result)
    content["info"] = {name: attribute(result, name) for name in result.attrs if name[:1] != "_"}
    if _size(content) > LARGEST:
        limit = "larger than the 2 GB of a MATLAB 5 file; MATLAB reads the result itself (h5read)"
        raise ResultError(result.filename, limit, id="RESULT-012")
    return variable_bytes("flexmb", content)


def variable_bytes(name: str, content) -> bytes:
    """Return the bytes of a file with one variable; a dictionary is a struct."""
    from scipy.io import savemat

    stream = io.BytesIO()
    savemat(stream, {name: content}, long_field_names=True, oned_as="column")
    # scipy writes the time of the day here; the same result shall give the same bytes.
    text = b"MATLAB 5.0 MAT-file, written by flexmb"
    return text.ljust(HEADER) + stream.getvalue()[HEADER:]


def _struct(group):
    fields = {}
    for name, item in group.items():
        fields[_field(name, fields)] = _struct(item) if isinstance(item, h5py.Group) else _values(item)
    return fields


def _field(name, taken):
    field = re.sub(r"\W", "_", name, flags=re.ASCII)
    field = (field if field[:1].isalpha() else f"x{field}")[:LONGEST_NAME]
    count = 1
    while field in taken:
        count += 1
        field = f"{field[: LONGEST_NAME - 4]}_{count}"
    return field


def _values(dataset):
    if h5py.check_string_dtype(dataset.dtype) is None:
        return dataset[()]
    texts = dataset.asstr(errors="replace")[()]
    return texts if isinstance(texts, str) else np.array(texts, dtype=object)


def _size(content):
    return sum(
        _size(item) if isinstance(item, dict) else getattr(item, "nbytes", 0) for item in content.values()
    )
