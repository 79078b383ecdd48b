"""A state space in a file of its own: NumPy archive, MATLAB file, or JSON."""

import io
import json
from typing import Any

import numpy as np

SHAPES = (("states", "states"), ("states", "inputs"), ("outputs", "states"), ("outputs", "inputs"))
FORMS = (".npz", ".mat", ".json")


def arrays_of(record: dict[str, Any]) -> dict[str, np.ndarray]:
    """Return matrices, names and units of a state space's record as arrays.

    `states`, `inputs`, `outputs`: names; `state_units` and so on: their units.
    """
    sizes = {what: len(record[what]) for what in ("states", "inputs", "outputs")}
    shapes = zip("ABCD", SHAPES, strict=True)
    found = {
        name: np.array(record[name], float).reshape([sizes[what] for what in shape]) for name, shape in shapes
    }
    for what in ("state", "input", "output"):
        for suffix, key in (("s", "name"), ("_units", "unit")):
            found[what + suffix] = np.array([signal[key] for signal in record[f"{what}s"]], dtype=str)
    found["state_relative_to"] = np.array([signal["relative_to"] for signal in record["states"]], dtype=str)
    found["constant"] = np.array([record["constant"][name] for name in "ABCD"])
    found["time"], found["axes"] = np.array(record["time"]), np.array(record["axes"])
    return found


def npz_bytes(record: dict[str, Any]) -> bytes:
    """Return a NumPy archive of the arrays of a state space."""
    stream = io.BytesIO()
    # numpy's type takes an array for its own option `allow_pickle`.
    np.savez(stream, **arrays_of(record))  # type: ignore[arg-type]
    return stream.getvalue()


def json_bytes(record: dict[str, Any]) -> bytes:
    """Return the record of a state space as JSON."""
    return (json.dumps(record) + "\n").encode()
