"""Checkpoints of a study: a folder of part files, one for every block of cases.

Cases are kept the moment they are solved, each with its length and checksum: a kill tears at most the case
being written, which then does not count.  Whoever works on a block holds a lock on its file, so that no case
is kept twice.  The folder may be on a disk that many machines share.  One sweep at a time works in it: the
lock is the system's, on a file in the folder, and free again however its process ends.
"""

import contextlib
import json
import os
import struct
from collections.abc import Iterator
from contextlib import suppress
from typing import Any, BinaryIO, NamedTuple

import numpy as np

from ..errors import Fault, ModelError, OutputError
from ..managed_files import ManagedFolder, belongs_here, unbuffered
from ..results.files.disk_failures import located
from ..results.files.durable import GROWING, LargePayload, framed, sync, sync_folder, whole_payloads
from ..results.files.replaced_file import hold, make_folder
from .solver import MESSAGE_LENGTH, CaseResult
from .study import SERIES, Study

LOCK = "lock"


class StudyLock:
    """The right to write in `folder`, which is made if it is missing; `study` is named to who comes second.

    Raises OutputError while another process has it, or when the folder cannot be made.
    """

    def __init__(self, folder: str, study: str):
        self.folder, self.path = folder, os.path.join(folder, LOCK)
        while not self._taken(study):
            # A sweep that has just ended took folder and lock away.
            continue

    def leave(self) -> None:
        """Give the folder up, and remove it when nothing else is in it."""
        with suppress(OSError):
            # While it is held: who opens it from now on sees that it is gone, and makes another.
            os.unlink(self.path)
        self._file.close()
        with suppress(OSError):
            os.rmdir(self.folder)

    def _taken(self, study: str) -> bool:
        make_folder(self.folder)
        with located(self.path), ManagedFolder(self.folder) as folder:
            self._file = open(folder.open(LOCK, os.O_WRONLY | os.O_CREAT), "ab")  # noqa: SIM115
        if hold(self._file) is False:
            self._file.close()
            raise OutputError(
                f"{study}: another sweep is writing this study, its cases are in {self.folder}; wait until "
                "it ends or stop it, or have it solved elsewhere (-o and --parts name other places)",
                id="STUDY-010",
            )
        stands = self._stands()
        if not stands:
            self._file.close()
        return stands

    def _stands(self) -> bool:
        try:
            return os.path.samestat(os.fstat(self._file.fileno()), os.lstat(self.path))
        except FileNotFoundError:
            return False


_HEAD = struct.Struct("<II")
_FIXED = struct.Struct("<qiiiii")
_IDENTITY = "study.json"
_UNFINISHED_IDENTITY = f".{_IDENTITY}"
_PART = ".part"
_LONGEST_IDENTITY = 2**20  # bytes


class RecordForm(NamedTuple):
    """Counts of the numbers in the record of a case; a record of other counts is taken for a torn one."""

    parameters: int  # that the study varies
    values: int  # results that are one number
    series: int  # results that are series
    rows: int  # numbers of a series: report rows, 0 where there is no series

    @classmethod
    def of(cls, study: Study, rows: int) -> "RecordForm":
        """Return the form of the cases of a study whose deck has so many report rows."""
        series = sum(result.take == SERIES for result in study.results)
        return cls(len(study.parameters), len(study.results) - series, series, rows if series else 0)

    @property
    def most_bytes(self) -> int:
        """Return how long a record is, with the longest message."""
        numbers = self.parameters + self.values + self.series * self.rows
        return _FIXED.size + 4 + 4 * MESSAGE_LENGTH + 8 * numbers

    def fits(self, result: CaseResult) -> bool:
        """Return whether a record has this form."""
        sizes = (result.parameters.size, result.values.size, *result.series.shape)
        return sizes == tuple(self)


class Parts:
    """The part files in `folder`; `identity` is all that the cases depend on, in JSON's types."""

    def __init__(self, folder: str, identity: dict[str, Any], form: RecordForm):
        self.folder = folder
        self.identity = identity
        self.form = form

    def lock(self, study: str) -> StudyLock:
        """The right to write in the folder, which is made if it is missing.

        Raises ModelError where the folder holds what is no study, OutputError as StudyLock does.
        """
        if os.path.isdir(self.folder) and self._stored_identity() is None:
            with located(self.folder), ManagedFolder(self.folder) as folder:
                names = set(folder.names()) - {LOCK}
            # A kill may have left a folder that was being begun or removed.
            if names and _UNFINISHED_IDENTITY not in names:
                message = (
                    f"{self.folder}: the folder is not empty and holds no study; remove it or give --parts"
                )
                raise ModelError([Fault("error", message, id="STUDY-001")])
        return StudyLock(self.folder, study)

    def begin(self, fresh: bool) -> bool:
        """Begin the folder, which is locked, or continue with that of a stopped study; whether there was one.

        Raises ModelError when the folder belongs to another study, OutputError when it cannot be written.
        """
        stored = self._stored_identity()
        if stored is not None and not fresh:
            self._refuse_other(stored)
            return True
        self.remove()
        with located(self.folder), ManagedFolder(self.folder) as folder:
            with unbuffered(folder.open(_UNFINISHED_IDENTITY, os.O_RDWR | os.O_CREAT)) as file:
                file.truncate()
                file.write(json.dumps(self.identity).encode())
                sync(file.fileno())
            folder.replace(_IDENTITY, _UNFINISHED_IDENTITY)
            sync_folder(self.folder)
            sync_folder(os.path.dirname(self.folder))  # which has the name of a folder just made
        return False

    def check_shared(self) -> None:
        """Raises OutputError where this process does not see the study's folder."""
        if self._stored_identity() != self.identity:
            message = "not seen by a worker: removed, or not on a disk that all share (--parts names one)"
            raise OutputError(f"{self.folder}: {message}", id="STUDY-002")

    def block(self, number: int, cases: range) -> "Part":
        """The part file of a block of `cases`, locked until it is closed."""
        path = os.path.join(self.folder, _name(number))
        with located(path), ManagedFolder(self.folder) as folder:
            return Part(path, folder.open(_name(number), os.O_RDWR | os.O_CREAT), cases, self.form)

    def stored(self, number: int, cases: range) -> Iterator[CaseResult]:
        """The first of the `cases` of a block that are there, without waiting for whoever works on it."""
        try:
            with ManagedFolder(self.folder) as folder:
                file = open(folder.open(_name(number), os.O_RDONLY), "rb")  # noqa: SIM115
        except FileNotFoundError:
            return
        with file:
            yield from _records(file, cases, self.form)

    def sync_all(self) -> None:
        """Hand to the disk what all processes have kept so far.  Raises OutputError."""
        with located(self.folder):
            for name in os.listdir(self.folder):
                if name.endswith(_PART):
                    GROWING.note(os.path.join(self.folder, name))
            GROWING.sync_all()

    def is_of_another_user(self) -> bool:
        """Return whether the folder, or a file in it, belongs neither to this user nor to root."""
        with located(self.folder), ManagedFolder(self.folder) as folder:
            paths = [self.folder, *(os.path.join(self.folder, name) for name in folder.names())]
            return any(not belongs_here(os.lstat(path)) for path in paths)

    def remove(self) -> None:
        """Remove all of this or another study but the lock of its folder."""
        with located(self.folder), ManagedFolder(self.folder) as folder:
            # A kill half-way must not leave a folder that looks like a study with cases missing.
            with contextlib.suppress(FileNotFoundError):
                folder.replace(_UNFINISHED_IDENTITY, _IDENTITY)
            for name in folder.names():
                if name.endswith(_PART):
                    folder.unlink(name)
            with contextlib.suppress(FileNotFoundError):
                folder.unlink(_UNFINISHED_IDENTITY)

    def _stored_identity(self) -> dict[str, str] | None:
        """The identity that the folder holds, None where it holds none.  Raises UnsafePlace."""
        try:
            with (
                ManagedFolder(self.folder) as folder,
                open(folder.open(_IDENTITY, os.O_RDONLY), encoding="utf-8") as file,
            ):
                stored = json.loads(file.read(_LONGEST_IDENTITY))
        except (OSError, ValueError, RecursionError):
            return None
        return stored if isinstance(stored, dict) else None

    def _refuse_other(self, stored: dict[str, str]) -> None:
        other = [name for name in self.identity if stored.get(name) != self.identity[name]]
        if other:
            message = (
                f"{self.folder} holds a stopped study that differs in {', '.join(other)}; "
                "--fresh throws it away, --parts names another folder"
            )
            raise ModelError([Fault("error", message, id="STUDY-003")])


class Part:
    """One part file, open for appending by the only process that works on its block."""

    def __init__(self, path: str, number: int, cases: range, form: RecordForm):
        """`number` is the descriptor of the file at `path`, open for reading and writing."""
        self.path = path
        self._file = unbuffered(number)
        _lock(self._file)
        self.failed = self.count = end = 0
        for record in _records(self._file, cases, form):
            self.count += 1
            self.failed += record.exit_code != 0
            end = self._file.tell()
        self._file.truncate(end)
        self._file.seek(end)

    def append(self, results: list[CaseResult]) -> None:
        """Keep the next cases."""
        view = memoryview(b"".join(framed(_packed(result), _HEAD) for result in results))
        with located(self.path):
            while view:
                view = view[self._file.write(view) :]
            GROWING.grown(self.path)
        self.count += len(results)
        self.failed += sum(result.exit_code != 0 for result in results)

    def __enter__(self) -> "Part":
        return self

    def __exit__(self, *failure: Any) -> None:
        self._file.close()


def _name(block: int) -> str:
    return f"block-{block:08d}{_PART}"


def _lock(file: BinaryIO) -> None:
    try:
        import fcntl
    except ImportError:  # no such locks here: blocks are given out one by one anyway
        return
    fcntl.flock(file, fcntl.LOCK_EX)


def _packed(result: CaseResult) -> bytes:
    message = result.message.encode()
    counts = result.parameters.size, result.values.size, result.series.shape[0]
    fixed = _FIXED.pack(result.case, result.exit_code, result.rows, *counts)
    numbers = np.concatenate([result.parameters, result.values, result.series.ravel()])
    return fixed + struct.pack("<I", len(message)) + message + numbers.astype("<f8").tobytes()


def _records(file: BinaryIO, cases: range, form: RecordForm) -> Iterator[CaseResult]:
    """Whole records of `cases`, up to the end or the first that is torn, or of another case or form."""
    with contextlib.suppress(LargePayload):
        payloads = whole_payloads(file, _HEAD, form.most_bytes)
        yield from _records_of(zip(cases, payloads, strict=False), form)


def _records_of(payloads: Iterator[tuple[int, bytes]], form: RecordForm) -> Iterator[CaseResult]:
    for case, payload in payloads:
        # Zeros, as behind a loss of power, are a record of no length and its checksum.
        try:
            result = _unpacked(payload)
        except (struct.error, ValueError):
            return
        if result.case != case or not form.fits(result):
            return
        yield result


def _unpacked(payload: bytes) -> CaseResult:
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
