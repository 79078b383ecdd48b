"""File `<stem>.resume` of a stopped run: the rows so far and the state after them.

The file is a resume file: one line that says of which run it is, then one entry for each block of rows, each
with its length and checksum.  A checkpoint stands after the rows of an entry; one that is larger than the
rows since the last is left out for a while.  A kill tears at most the last entry, which then does not count.
Result files are written anew from the entries up to the last checkpoint.
"""

import json
import math
import os
import struct
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager, suppress
from time import monotonic
from typing import Any, BinaryIO

import numpy as np
from numpy.lib.format import descr_to_dtype, dtype_to_descr

from ..errors import Fault, ModelError, OutputError
from ..managed_files import belongs_here, open_managed, unbuffered
from ..results.files.disk_failures import located
from ..results.files.durable import GROWING, LargePayload, framed, sync, sync_folder, whole_payloads
from ..results.files.replaced_file import hold, is_unfinished

# What JSON and numpy raise of a description that is none.
_UNDESCRIBED = (ValueError, TypeError, KeyError, SyntaxError, RecursionError)
# numpy refuses such shapes, of no numbers, too.
_TOO_BIG = 2**62
_LONGEST_DESCRIPTION = 2**22  # bytes, for 50,000 arrays: Python takes twenty times as many for them


def packed(arrays: dict[str, np.ndarray]) -> bytes:
    """An entry: a line that describes the arrays, and their bytes; files of numpy take ten times longer."""
    given = {name: np.asarray(array) for name, array in arrays.items()}
    reported = [[name, dtype_to_descr(array.dtype), array.shape] for name, array in given.items()]
    # Joined as they lie: a copy of each array would take a third of the time.
    parts = [np.ascontiguousarray(array).data for array in given.values()]
    return b"".join((json.dumps(reported).encode(), b"\n", *parts))


def is_whole(entry: bytes) -> Any:
    """Return whether an entry describes arrays, and holds as many bytes as they have."""
    try:
        size = sum(dtype.itemsize * math.prod(shape) for _, dtype, shape in _described(entry))
        return size == len(entry) - entry.index(b"\n") - 1
    except _UNDESCRIBED:
        return False


def _described(entry: bytes) -> Any:
    """Name, type and shape of the arrays of an entry.  Raises one of `_UNDESCRIBED`."""
    described = []
    end = entry.index(b"\n", 0, _LONGEST_DESCRIPTION)
    for name, reported, shape in json.loads(entry[:end]):
        dtype = descr_to_dtype(_with_tuples(reported))
        counted = all(type(length) is int and length >= 0 for length in shape)
        if not (isinstance(name, str) and counted and dtype.itemsize) or dtype.hasobject:
            raise ValueError(name)
        if math.prod(length or 1 for length in shape) * dtype.itemsize >= _TOO_BIG:
            raise ValueError(name)
        described.append((name, dtype, shape))
    return described


def names_of(entry: bytes) -> Any:
    """The names of the arrays of an entry."""
    return [name for name, _, _ in _described(entry)]


def arrays_of(entry: bytes, names: tuple[str, ...] | None = None) -> Any:
    """The arrays of an entry, or those of them that are called `names`."""
    arrays, start = {}, entry.index(b"\n") + 1
    for name, kind, shape in _described(entry):
        count = math.prod(shape)
        array = np.frombuffer(entry, kind, count, start) if count else np.empty(0, kind)
        array = array.reshape(shape)
        start += array.nbytes
        if names is None or name in names:
            arrays[name] = array.copy()
    return arrays


def _with_tuples(described: Sequence[Sequence[str]] | str) -> Any:
    """Return a dtype's description with tuples, as numpy needs it: JSON has lists only."""
    if isinstance(described, str):
        return described
    return [(name, _with_tuples(kind), *map(tuple, shape)) for name, kind, *shape in described]


_HEAD = struct.Struct("<QI")
_STATE = "checkpoint/"
_UNFINISHED = "unfinished"
_LONGEST_HEAD = 2**20
LARGEST_ENTRY = 2**26  # bytes of memory that any run may take for an entry
LONGEST_UNSAVED = 30.0  # s that a kill may cost where checkpoints are larger than rows
_BEGINNING = b'{"'


class ResumeFile:
    """The resume file at `path` (None keeps none); `identity` is all that the rows depend on, in JSON's
    types.

    Call `find` first where there may be the file of a stopped run; then `begin`, take the `stored`
    entries, and `append` further ones.  `warnings`: why the file found is not used, or only a part of it;
    `last_checkpoint`: the state from which the run continues.
    """

    def __init__(self, path: str | None, identity: dict[str, Any]):
        self.path = path
        self.identity = identity
        self.warnings: list[Fault] = []
        self.last_checkpoint: dict[str, np.ndarray] | None = None
        self._file: Any = None  # one stream from `find` on: the path may lead elsewhere by then
        self._begun = False
        self._first = self._end = 0
        self._unsaved = 0  # bytes of rows after the last checkpoint in the file,
        self._saved_at = monotonic()  # and when that was
        self._pending: dict[str, np.ndarray] = {}  # the checkpoint after them

    def find(self, most: int = LARGEST_ENTRY) -> None:
        """Look for the resume file of a stopped run, and remove the files that it left unfinished.

        Raises ModelError when the resume file is of another run, or has an entry of more than `most` bytes.
        """
        if self.path is None or not os.path.lexists(self.path):
            return
        self._file = self._opened(os.O_RDWR)
        with self._reading(0) as file, self._refusing_large(most):
            if not belongs_here(os.fstat(file.fileno())):
                what = "of another user, whose rows are taken; without --resume none are"
                self._warn("warning", what, id="RUN-065")
            head = file.readline(_LONGEST_HEAD)
            if _is_blank(head) or (self._head.startswith(head) and head != self._head):
                what = "cut in its first line, nothing of the stopped run can be used"
                self._warn("warning", what, id="RUN-066")
                return
            self._check_identity(head)
            self._first = self._end = file.tell()
            last, whole = b"", self._end
            for entry in _entries(file, most):
                whole, names = file.tell(), names_of(entry)
                if _UNFINISHED in names:
                    _remove_unfinished(arrays_of(entry, (_UNFINISHED,)), os.path.dirname(self.path))
                if any(name.startswith(_STATE) for name in names):
                    last, self._end = entry, whole
            if last:
                self.last_checkpoint = _split(arrays_of(last))[1]
            lost = os.fstat(file.fileno()).st_size - whole
        if lost:
            what = f"torn or damaged at byte {whole}; the {lost} bytes there are not used"
            self._warn("note", what, id="RUN-005")

    def _warn(self, severity: str, what: str, *, id: str) -> None:
        self.warnings.append(Fault(severity, f"--resume: {self.path} is {what}", id=id))

    @property
    def _head(self) -> bytes:
        return json.dumps(self.identity).encode() + b"\n"

    def begin(self, unfinished: Sequence[str]) -> None:
        """Start the resume file, or continue the one found; a kill would leave the files `unfinished`."""
        if self.path is None:
            return
        with located(self.path):
            self._open()
            self._begun = True
            # Names only: a resume file may be another's, and no file but beside it is to be touched.
            self._write({_UNFINISHED: np.array([os.path.basename(path) for path in unfinished], str)})

    def stored(self) -> Iterator[tuple[Mapping[str, np.ndarray], dict[str, np.ndarray]]]:
        """Pairs (values, checkpoint) of the resume file that was found, oldest first."""
        if self._end == self._first:
            return
        with self._reading(self._first) as file:
            for entry in _entries(file, self._end):
                values, state = _split(arrays_of(entry))
                if "time" in values:
                    yield values, state
                if file.tell() >= self._end:
                    return

    def append(self, values: Mapping[str, np.ndarray], checkpoint: Mapping[str, np.ndarray]) -> None:
        """Keep a block of rows and the state after it; the arrays of both are named by texts."""
        if self.path is None:
            return
        named = {_STATE + name: array for name, array in checkpoint.items()}
        self._unsaved += sum(np.asarray(array).nbytes for array in values.values())
        size = sum(np.asarray(array).nbytes for array in named.values())
        due = size <= self._unsaved or monotonic() - self._saved_at > LONGEST_UNSAVED
        with located(self.path):
            self._write({**values, **named} if due else values)
        # Where that failed, `close` keeps the state after the rows before.
        self._pending = {} if due else {name: np.array(array) for name, array in named.items()}
        if due:
            self._unsaved, self._saved_at = 0, monotonic()

    @property
    def begun(self) -> bool:
        """Return whether this run, or the one that it continues with, has left anything to resume."""
        return self._begun or self._end > self._first

    def close(self) -> None:
        """Leave the resume file for `--resume`."""
        if self._file and self.path is not None:
            if self._pending:
                with suppress(OSError, OutputError):
                    self._write(self._pending)
            # The run ends for another reason, which is reported; but for power cuts the file is whole anyway.
            with suppress(OSError):
                sync(self._file.fileno())
                sync_folder(os.path.dirname(self.path))
            self._file.close()

    def remove(self) -> None:
        """The run is over and leaves nothing to resume; a resume file that was not begun stays."""
        if self._begun and self.path is not None:
            stands = self._stands()
            self._file.close()
            # Where it must stay, it would only give the same results once more.
            with suppress(OSError):
                if stands:
                    os.unlink(self.path)

    def _stands(self) -> bool:
        """Return whether the open file is still the one at its path."""
        assert self.path is not None, "there is a file"
        with suppress(OSError):
            return os.path.samestat(os.lstat(self.path), os.fstat(self._file.fileno()))
        return False

    def _opened(self, flags: int) -> Any:
        """Return the file at the path, which no other run writes."""
        assert self.path is not None, "there is a file to open"
        with located(self.path):
            file = unbuffered(open_managed(self.path, flags))
        if hold(file) is False:
            file.close()
            raise OutputError(f"{self.path}: another run is writing it; wait until it ends", id="RUN-007")
        return file

    def _refuse_what_stands_there(self, existed: bool) -> None:
        """Raise OutputError unless the open file is the one that was found, or may be written."""
        fault = None
        if existed and not self._stands():
            message = f"{self.path}: it was exchanged or removed since it was read; run again"
            fault = OutputError(message, id="RUN-070")
        head = self._file.read(_LONGEST_HEAD)
        if not fault and not (_is_blank(head) or _BEGINNING.startswith(head[: len(_BEGINNING)])):
            message = "it is not the file of a stopped run, whose place it has; remove or rename it"
            fault = OutputError(f"{self.path}: {message}", id="RUN-071")
        if fault:
            self._file.close()
            self._file = None
            raise fault

    @contextmanager
    def _reading(self, start: int) -> Iterator[BinaryIO]:
        """Give a stream that reads the open file from byte `start` on; writing continues at its end."""
        with open(self._file.fileno(), "rb", closefd=False) as stream:
            stream.seek(start)
            try:
                yield stream
            finally:
                self._file.seek(0, os.SEEK_END)

    @contextmanager
    def _refusing_large(self, most: int) -> Iterator[None]:
        try:
            yield
        except LargePayload as found:
            message = (
                f"--resume: {self.path} has an entry of {found.length} bytes, but entries of this run have "
                f"at most {most}; run without --resume to start again"
            )
            raise ModelError([Fault("error", message, id="RUN-069")]) from found

    def _open(self) -> None:
        is_open, self._file = self._file is not None, self._file or self._opened(os.O_RDWR | os.O_CREAT)
        self._file.seek(0)
        self._refuse_what_stands_there(is_open)
        self._file.truncate(self._end)
        self._file.seek(self._end)
        if not self._end:
            self._put(self._head)

    def _write(self, arrays: Any) -> None:
        entry = packed(arrays)
        self._put(framed(entry, _HEAD))

    def _put(self, data: bytes) -> None:
        assert self._file is not None and self.path is not None, "`begin` has opened the file"
        start, view = self._file.tell(), memoryview(data)
        try:
            while view:
                view = view[self._file.write(view) :]
            GROWING.grown(self.path)
        except OSError:
            self._take_back(start)
            raise

    def _take_back(self, start: int) -> None:
        """Cut off what a failure left from byte `start` on: a state after it would be one of other rows."""
        assert self._file is not None, "`begin` has opened the file"
        try:
            self._file.truncate(start)
            self._file.seek(start)
        except OSError:
            self._pending = {}

    def _check_identity(self, head: bytes) -> None:
        try:
            stored = dict(json.loads(head))
        except (ValueError, TypeError, RecursionError) as fault:
            message = f"--resume: {self.path} is not the file of a stopped run; remove it"
            raise ModelError([Fault("error", message, id="RUN-008")]) from fault
        other = [name for name in self.identity if stored.get(name) != self.identity[name]]
        if other:
            raise ModelError([Fault("error", self._refusal(stored, other), id="RUN-009")])

    def _refusal(self, stored: Any, names: Any) -> Any:
        changes = "; ".join(
            f"{name} was {_shown(stored.get(name))}, is {_shown(self.identity[name])}" for name in names
        )
        return f"--resume: {self.path} is of another run: {changes}; run without --resume to start again"


def _is_blank(head: bytes) -> bool:
    """Return whether a resume file begins with nothing, or with the zeros that a loss of power may leave."""
    return not head.strip(b"\0")


def _entries(file: BinaryIO, most: int) -> Iterator[bytes]:
    """Whole entries up to the end or the first torn one.  Raises LargePayload."""
    for entry in whole_payloads(file, _HEAD, most):
        # Zeros, as after a loss of power, are an entry of no length and its checksum.
        if not is_whole(entry):
            return
        yield entry


def _split(arrays: Mapping[str, np.ndarray]) -> Any:
    state = {name.removeprefix(_STATE): array for name, array in arrays.items() if name.startswith(_STATE)}
    return {name: array for name, array in arrays.items() if not name.startswith(_STATE)}, state


def _remove_unfinished(arrays: Mapping[str, np.ndarray], folder: str) -> None:
    for names in arrays.values():
        texts = names.ravel().tolist() if names.dtype.kind == "U" else []
        for name in map(os.path.basename, texts):
            if is_unfinished(name):
                with suppress(OSError, ValueError):  # the file system has no such name
                    os.unlink(os.path.join(folder, name))


def _shown(value: Any) -> Any:
    text = "not given" if value is None else value if isinstance(value, str) else json.dumps(value)
    return text if len(text) <= 20 else f"{text[:12]}…"
