"""The shipped decks, and what a fresh process writes for them."""

import hashlib
import os
import platform
import subprocess
import sys
from dataclasses import dataclass
from importlib import metadata
from pathlib import Path

import h5py
import numpy as np

DECKS = Path(__file__).resolve().parents[2] / "decks"
# pendulum.DAT and pendulum.vsdf give files of one name: every kind goes to a folder of its own.
KINDS = {
    "young": "young/*.dat",
    "young/dynamics": "young/dynamics/*.dat",
    "dafms": "dafms/*.DAT",
    "vsdf": "vsdf/*.vsdf",
}
OF_LAPACK = "vsdf"  # the kind of deck whose results hold round-off of LAPACK
# One code of OpenBLAS for every processor with AVX2, where it otherwise chooses by the processor: speeds at
# the start (docs/theory/determinism.md) and flexible bodies have its round-off.
ONE_PROCESSOR = {"OPENBLAS_CORETYPE": "Haswell"}
SENTENCES = ("notes", "message")  # attributes that may be reworded without a change of any number


@dataclass(frozen=True)
class Written:
    """A file of a run: its digest and its size in bytes."""

    sha256: str
    size: int


def linear_algebra() -> str:
    """Return what the last digits of LAPACK depend on beside ONE_PROCESSOR."""
    return f"{platform.machine()},numpy-{np.__version__},scipy-{metadata.version('scipy')}"


def shipped(kind: str, decks: Path = DECKS) -> list[Path]:
    """Paths of the decks of a kind."""
    return sorted(decks.glob(KINDS[kind]))


def flexmb(*arguments, cwd, environment=()) -> None:
    """A command in a fresh process; what it says goes to the terminal.  Raises CalledProcessError."""
    command = [sys.executable, "-m", "flexmb_cli", *map(str, arguments)]
    # The package is found beside this script, whether or not it is installed.
    path = os.pathsep.join([str(DECKS.parent), os.environ.get("PYTHONPATH", "")])
    given = {**os.environ, **dict(environment), "PYTHONPATH": path}
    subprocess.run(command, cwd=cwd, env=given, check=True)


def written(folder: Path) -> dict[str, Written]:
    """Files below `folder` by their path there."""
    found = {}
    for path in sorted(path for path in folder.rglob("*") if path.is_file()):
        content = path.read_bytes()
        name = path.relative_to(folder).as_posix()
        found[name] = Written(hashlib.sha256(content).hexdigest(), len(content))
    return found


def content_digest(path: Path) -> str:
    """Return the digest of every dataset and attribute of an HDF5 file, but its sentences."""
    digest = hashlib.sha256()
    with h5py.File(path, "r") as file:
        items = [("/", file)]
        file.visititems(lambda name, item: items.append((name, item)))
        for name, item in items:
            digest.update(f"{name}\n".encode())
            for key in sorted(set(item.attrs) - set(SENTENCES)):
                digest.update(f"@{key}\n".encode() + _bytes(_named(item.attrs[key], file)))
            if isinstance(item, h5py.Dataset):
                digest.update(_bytes(item[()]))
    return digest.hexdigest()


def _named(value, file):
    """Return an attribute with the names of datasets in the place of references to them."""
    if isinstance(value, h5py.Reference):
        return file[value].name
    if isinstance(value, np.void):
        return [_named(part, file) for part in value.tolist()]
    if isinstance(value, np.ndarray) and value.dtype.kind in "OV":
        return [_named(part, file) for part in value]
    return value


def _bytes(value) -> bytes:
    """Return type, shape and bytes of a value."""
    array = np.asarray(value)
    if array.dtype.kind in "OU":
        return f"{array.tolist()!r}\n".encode()
    return f"{array.dtype.str} {array.shape}\n".encode() + array.tobytes()
