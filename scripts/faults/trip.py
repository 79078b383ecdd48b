"""Moments at which a run can be hit: its deeds to the files of a folder are counted, and one goes wrong.

Counted are opening for writing, every write to a file, renaming, removing, making and cutting.  `install`
must come before the first import of flexmb: files are then opened through a class that counts its writes.
"""

import builtins
import errno
import io
import mmap
import os
import signal
import sys
from dataclasses import dataclass, field

KILL, TORN, FULL, BROKEN, STOP, VANISH = "kill", "torn", "full", "broken", "stop", "vanish"

_WRITING = os.O_WRONLY | os.O_RDWR | os.O_CREAT | os.O_TRUNC
_DEEDS = {"os.rename": 1, "os.remove": 0, "os.mkdir": 0, "os.rmdir": 0, "os.truncate": 0, "os.chmod": 0}
_TAKES_ROOM = ("open", "write", "os.mkdir")


@dataclass
class Trip:
    """What goes wrong in `folder` at the deed number `at` (from 1; 0: never); `sent`: the signal of STOP."""

    folder: str
    at: int = 0
    action: str = KILL
    sent: int = signal.SIGTERM
    seen: mmap.mmap = field(default_factory=lambda: mmap.mmap(-1, 8))

    @property
    def count(self) -> int:
        """Deeds so far, also when they were done by a forked child."""
        return int.from_bytes(self.seen[:8], "little")

    def note(self, deed: str, path) -> bool:
        """Count a deed at `path`; whether a write is to be torn."""
        if not self._concerns(path):
            return False
        count = self.count + 1
        self.seen[:8] = count.to_bytes(8, "little")
        if self.at == 0 or count < self.at:
            return False
        return self._act(deed, count)

    def _concerns(self, path):
        if isinstance(path, int):
            path = os.readlink(f"/proc/self/fd/{path}")
        if not isinstance(path, str | bytes):
            return False
        path = os.path.abspath(os.fsdecode(path))
        return path.startswith((f"{self.folder}/", f"{self.folder}.gone/"))

    def _act(self, deed, count):
        if self.action == FULL and deed in _TAKES_ROOM:
            raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))
        if count > self.at:
            return False
        if self.action == BROKEN:
            raise OSError(errno.EIO, os.strerror(errno.EIO))
        if self.action == TORN and deed == "write":
            return True
        if self.action in (KILL, TORN):
            os.kill(os.getpid(), signal.SIGKILL)
        elif self.action == STOP:
            os.kill(os.getpid(), self.sent)
        elif self.action == VANISH:
            _take_away(self.folder)
        return False


class _Armed:
    trip: Trip | None = None


def arm(trip: Trip | None) -> None:
    """Let `trip` happen in this process."""
    _Armed.trip = trip


def _take_away(folder):
    trip, _Armed.trip = _Armed.trip, None
    os.rename(folder, f"{folder}.gone")
    _Armed.trip = trip


class _CountingFile(io.FileIO):
    """A file whose writes are deeds."""

    def write(self, data):
        torn = _Armed.trip is not None and _Armed.trip.note("write", self.name)
        if not torn:
            return super().write(data)
        view = memoryview(data).cast("B")
        super().write(view[: len(view) // 2])
        os.kill(os.getpid(), signal.SIGKILL)
        return 0


_open = io.open


def _counting_open(
    file, mode="r", buffering=-1, encoding=None, errors=None, newline=None, closefd=True, opener=None
):
    if _Armed.trip is None or not set("wax+") & set(mode):
        return _open(file, mode, buffering, encoding, errors, newline, closefd, opener)
    raw = _CountingFile(file, mode.replace("b", "").replace("t", ""), closefd, opener)
    if buffering == 0:
        return raw
    buffered = io.BufferedRandom(raw) if "+" in mode else io.BufferedWriter(raw)
    return buffered if "b" in mode else io.TextIOWrapper(buffered, encoding, errors, newline)


def _heard(event, arguments):
    if _Armed.trip is None:
        return
    if event == "open" and isinstance(arguments[2], int) and arguments[2] & _WRITING:
        _Armed.trip.note("open", arguments[0])
    elif event in _DEEDS:
        _Armed.trip.note(event, arguments[_DEEDS[event]])


def install() -> None:
    """Have deeds counted in this process and its forks."""
    io.FileIO = _CountingFile
    io.open = builtins.open = _counting_open
    sys.addaudithook(_heard)
