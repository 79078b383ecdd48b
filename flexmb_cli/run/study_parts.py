"""What a study has got so far: a folder of part files, one for every block of cases.

A case is kept the moment it is solved, with its length and checksum: a kill tears at most the case being
written, which then does not count.  Whoever works on a block holds a lock on its file, so that no case is
kept twice.  The folder may be on a disk that many machines share.
"""

import contextlib
import json
import os
import shutil
import struct
import zlib
from collections.abc import Iterator

import numpy as np

from ..errors import Fault, ModelError, OutputError
from ..write.atomic import located, make_folder
from .study_solver import CaseResult

_HEAD = struct.Struct("<II")
_FIXED = struct.Struct("<qiiiii")
_IDENTITY = "study.json"
_UNFINISHED_IDENTITY = f".{_IDENTITY}"


class Parts:
    """The part files in `folder`; `identity` is all that the cases depend on, in JSON's types."""

    def __init__(self, folder: str, identity: dict):
        self.folder = folder
        self.identity = identity

    def begin(self, fresh: bool) -> bool:
        """Make the folder, or go on with the one of a stopped study; whether there was one.

        Raises ModelError when the folder belongs to another study, OutputError when it cannot be made.
        """
        if fresh or os.path.isdir(self._leaving):
            self._clear(fresh)
        found = self._stored_identity()
        if found is not None:
            self._refuse_other(found)
            return True
        # A kill may have left the identity half written.
        if os.path.isdir(self.folder) and set(os.listdir(self.folder)) - {_UNFINISHED_IDENTITY}:
            message = f"{self.folder}: the folder is not empty and holds no study; remove it or give --parts"
            raise ModelError([Fault("error", message)])
        make_folder(self.folder)
        with located(self.folder):
            temporary = os.path.join(self.folder, _UNFINISHED_IDENTITY)
            with open(temporary, "w", encoding="utf-8") as file:
                json.dump(self.identity, file)
            os.replace(temporary, os.path.join(self.folder, _IDENTITY))
        return False

    def _clear(self, fresh):
        """Finish a removal that was stopped; with `fresh` remove the stopped study as well."""
        if os.path.isdir(self._leaving):
            shutil.rmtree(self._leaving)
        if fresh:
            self.remove()

    def check_shared(self) -> None:
        """Raises OutputError where this process does not see the study's folder."""
        if self._stored_identity() != self.identity:
            raise OutputError(f"{self.folder}: not seen by a worker; give --parts a folder that all share")

    def block(self, number: int) -> "Part":
        """The part file of a block, locked until it is closed."""
        return Part(self._path(number))

    def stored(self, number: int) -> Iterator[CaseResult]:
        """The cases of a block that are there, without waiting for whoever works on it."""
        with contextlib.suppress(FileNotFoundError), open(self._path(number), "rb") as file:
            yield from _records(file)

    def remove(self) -> None:
        """Remove the folder of this or another study."""
        with located(self.folder):
            # A kill half-way must not leave a folder that looks like a study with cases missing.
            if self._stored_identity() is not None:
                os.replace(self.folder, self._leaving)
            if os.path.isdir(self._leaving):
                shutil.rmtree(self._leaving)

    @property
    def _leaving(self):
        return f"{self.folder}.done"

    def _path(self, number):
        return os.path.join(self.folder, f"block-{number:08d}.part")

    def _stored_identity(self):
        try:
            with open(os.path.join(self.folder, _IDENTITY), encoding="utf-8") as file:
                found = json.load(file)
        except (OSError, ValueError):
            return None
        return found if isinstance(found, dict) else None

    def _refuse_other(self, found):
        other = [name for name in self.identity if found.get(name) != self.identity[name]]
        if other:
            message = (
                f"{self.folder} holds a stopped study that differs in {', '.join(other)}; "
                "--fresh throws it away, --parts names another folder"
            )
            raise ModelError([Fault("error", message)])


class Part:
    """One part file, open for appending by the only process that works on its block."""

    def __init__(self, path: str):
        self.path = path
        with located(path):
            # Unbuffered: what a full disk refused must not be tried again when the file is closed.
            self._file = os.fdopen(os.open(path, os.O_RDWR | os.O_CREAT, 0o666), "r+b", buffering=0)
            _lock(self._file)
            self.failed = self.count = end = 0
            for record in _records(self._file):
                self.count += 1
                self.failed += record.exit_code != 0
                end = self._file.tell()
            self._file.truncate(end)
            self._file.seek(end)

    def append(self, result: CaseResult) -> None:
        """Keep a case."""
        payload = _packed(result)
        view = memoryview(_HEAD.pack(len(payload), zlib.crc32(payload)) + payload)
        with located(self.path):
            while view:
                view = view[self._file.write(view) :]
        self.count += 1
        self.failed += result.exit_code != 0

    def __enter__(self) -> "Part":
        return self

    def __exit__(self, *failure) -> None:
        self._file.close()


def _lock(file):
    try:
        import fcntl
    except ImportError:  # no such locks here: blocks are given out one by one anyway
        return
    fcntl.flock(file, fcntl.LOCK_EX)


def _packed(result):
    message = result.message.encode()
    counts = result.parameters.size, result.values.size, result.series.shape[0]
    fixed = _FIXED.pack(result.case, result.exit_code, result.rows, *counts)
    numbers = np.concatenate([result.parameters, result.values, result.series.ravel()])
    return fixed + struct.pack("<I", len(message)) + message + numbers.astype("<f8").tobytes()


def _records(file):
    """Whole records up to the end or the first torn one."""
    size = os.fstat(file.fileno()).st_size
    while len(head := file.read(_HEAD.size)) == _HEAD.size:
        length, checksum = _HEAD.unpack(head)
        # A damaged length may be larger than any memory.
        if length > size - file.tell():
            return
        payload = file.read(length)
        if len(payload) < length or zlib.crc32(payload) != checksum:
            return
        yield _unpacked(payload)


def _unpacked(payload):
    case, code, rows, parameters, values, series = _FIXED.unpack_from(payload)
    at = _FIXED.size
    (length,) = struct.unpack_from("<I", payload, at)
    at += 4
    message = payload[at : at + length].decode()
    numbers = np.frombuffer(payload, "<f8", offset=at + length)
    rest = numbers[parameters + values :]
    return CaseResult(
        case,
        code,
        rows,
        numbers[:parameters],
        numbers[parameters : parameters + values],
        rest.reshape(series, -1) if series else rest.reshape(0, 0),
        message,
    )
