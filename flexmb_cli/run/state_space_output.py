"""Output of the state space of a mechanism, in the format of the file's suffix."""

from pathlib import Path
from typing import Any

import numpy as np

from ..results.files.replaced_file import write_whole
from ..results.files.state_space import arrays_of, json_bytes, npz_bytes


def write_state_space(path: str, record: dict[str, Any]) -> None:
    """Write the record of a state space to `path`; raises OutputError."""
    forms = {".npz": npz_bytes, ".mat": _matlab_bytes, ".json": json_bytes}
    write_whole(path, forms[Path(path).suffix.lower()](record))


def _matlab_bytes(record: Any) -> Any:
    from ..results.files.matlab import variable_bytes

    # MATLAB has cells of texts where NumPy has arrays of them.
    arrays = {
        name: value.astype(object) if value.dtype.kind == "U" and value.ndim else value
        for name, value in arrays_of(record).items()
    }
    return variable_bytes("state_space", {name: np.asarray(value) for name, value in arrays.items()})
