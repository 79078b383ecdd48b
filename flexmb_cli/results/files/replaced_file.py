"""Results appear whole or not at all: written beside their place, synced, and moved there at the end.

A file is synced before it is moved, its folder after that: a loss of power leaves the old or the new file.

What is not a regular file (a pipe, /dev/null, /dev/stdout) is written to directly: moving a file over it
would destroy it.  Opening a pipe without a reader would block for ever, signals included.
"""

import errno
import os
import stat
import zlib
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager, suppress
from pathlib import Path
from time import monotonic, sleep
from typing import Any

from ...errors import ANALYSIS_FAILED, OutputError
from ...managed_files import UnsafePlace, open_managed
from .disk_failures import located
from .durable import sync, sync_folder

_PREFIX, _SUFFIX = ".flexmb-", ".tmp"


def is_unfinished(path: str) -> bool:
    """Return whether a file has the name of a result in the making, such as a killed run leaves."""
    name = os.path.basename(path)
    return name.startswith(_PREFIX) and name.endswith(_SUFFIX)


def hold(file: Any) -> bool | None:
    """Lock the open file for this process until it ends; return whether it is locked, None without locks."""
    try:
        import fcntl
    except ImportError:
        return None
    try:
        fcntl.flock(file, fcntl.LOCK_EX | fcntl.LOCK_NB)
    except OSError as error:
        return False if error.errno in (errno.EWOULDBLOCK, errno.EACCES) else None
    return True


def refuse_place(path: str, target: str) -> None:
    """Raise OSError for a place where no file can stand."""
    # `realpath` drops the stroke with which a user says that a folder is meant.
    if os.path.isdir(target) or path.endswith("/"):
        raise IsADirectoryError(errno.EISDIR, os.strerror(errno.EISDIR))
    if os.path.islink(target):  # followed to its end it is a link still: one that leads back to itself
        raise OSError(errno.ELOOP, os.strerror(errno.ELOOP))
    if len(os.fsencode(os.path.basename(target))) > 255:
        raise OSError(errno.ENAMETOOLONG, os.strerror(errno.ENAMETOOLONG))


def reserve(target: str) -> tuple[str, int]:
    """A fresh empty file in the folder of `target`, and the descriptor that holds it as long as it lasts.

    Its short name fits wherever the result's does.
    """
    while True:
        name = f"{_of_target(target)}{os.urandom(4).hex()}{_SUFFIX}"
        path = os.path.join(os.path.dirname(target), name)
        with suppress(FileExistsError):
            held = os.open(path, os.O_CREAT | os.O_EXCL | os.O_RDWR, 0o666)
            try:
                # Another run may have taken it for a leftover before it was held.
                stays = hold(held) is not False and _stands(path)
            except BaseException:
                _give_up(path, held)
                raise
            if stays:
                return path, held
            _give_up(path, held)


def _give_up(path: str, held: int) -> None:
    with suppress(OSError):
        os.unlink(path)
    os.close(held)


def _stands(path: str) -> bool:
    """Return whether there is a file; anything but its absence is a failure of the disk, and reported."""
    with suppress(FileNotFoundError):
        os.lstat(path)
        return True
    return False


def remove_leftovers(target: str) -> None:
    """Remove what killed runs left in the place of `target`: files that nobody holds any more."""
    folder = os.path.dirname(target)
    names = []
    with suppress(OSError):
        names = os.listdir(folder)
    for name in names:
        if name.startswith(_of_target(target)) and name.endswith(_SUFFIX):
            with suppress(OSError, UnsafePlace):
                _remove_unheld(os.path.join(folder, name))


def _remove_unheld(path: str) -> None:
    file = open_managed(path, os.O_WRONLY)
    try:
        if hold(file):
            os.unlink(path)
    finally:
        os.close(file)


def _of_target(target: str) -> str:
    return f"{_PREFIX}{zlib.crc32(os.fsencode(os.path.basename(target))):08x}-"


LONGEST_WAIT = 10.0  # s, in which a program that reads the pipe starts
_PAUSE = 0.02  # s, between two tries


def open_special(path: str) -> int:
    """Return a descriptor that writes to the pipe or device at `path`.

    A plain opening of a pipe waits for its reader and continues waiting when a signal asks for the end.
    Raises OutputError where no program reads the pipe, OSError as `os.open`.
    """
    last = monotonic() + LONGEST_WAIT
    while True:
        try:
            number = os.open(path, os.O_WRONLY | getattr(os, "O_NONBLOCK", 0) | getattr(os, "O_NOCTTY", 0))
        except OSError as error:
            if error.errno != errno.ENXIO or not stat.S_ISFIFO(os.stat(path).st_mode):
                raise
        else:
            break
        if monotonic() > last:
            raise OutputError(
                f"{path}: cannot be written: it is a pipe that nothing reads; start its reader or remove it",
                id="RESULT-052",
            )
        sleep(_PAUSE)
    if hasattr(os, "set_blocking"):
        os.set_blocking(number, True)
    return number


class Replacement:
    """A file that will stand at `path`; until `commit` it is written at `temporary`.

    `direct`: `path` is not a regular file, and `temporary` is the thing itself; only if `special` allows it.
    Raises `OutputError` when the folder is missing or cannot be written.
    """

    def __init__(self, path: Path | str, special: bool = True):
        self.path = os.fspath(path)
        # A link stays a link: the file it points to is replaced.
        self._target = os.path.realpath(self.path)
        self.direct = _is_special(self._target)
        if self.direct and not special:
            raise OutputError(
                f"{self.path}: cannot be written: it is not a regular file, but a pipe or a device; "
                "remove it",
                id="RESULT-051",
            )
        self._hold: int | None = None
        self.temporary = self._target
        if not self.direct:
            with located(self.path):
                refuse_place(self.path, self._target)
                remove_leftovers(self._target)
                self.temporary, self._hold = reserve(self._target)

    def open(self, mode: str, **how: Any) -> Any:
        """Open the temporary file, once, as the built-in `open` does."""
        return open(open_special(self.temporary) if self.direct else self.duplicate(), mode, **how)

    def duplicate(self) -> int | str:
        """Return a descriptor of the temporary file, which the caller closes; where `direct`, its path.

        Others may write in the folder, too, and put a link where the temporary file stood: it must not be
        opened by its name again.
        """
        if self.direct:
            return self.temporary
        assert self._hold is not None, "the temporary file is there until `move`"
        return os.dup(self._hold)

    def finish(self) -> None:
        """Wait until all that was written is on the disk; without that the moved file could be empty."""
        if not self.direct and self._hold is not None:
            with self._discarding():
                sync(self._hold)

    def move(self) -> None:
        """Put the finished file in its place; it is discarded when it cannot be put there."""
        if self.direct:
            return
        with self._discarding():
            _keep_mode(self._target, self._hold, self.temporary)
            os.replace(self.temporary, self._target)
        self._let_go()

    def commit(self) -> None:
        """Finish the file, put it in its place, and wait until its name is on the disk."""
        put_in_place([self])

    @property
    def folder(self) -> str:
        """The folder whose names `move` changes; "" for a file that is written directly."""
        return "" if self.direct else os.path.dirname(self._target)

    def discard(self) -> None:
        """Remove what was written; the file that stood at `path` before stays."""
        if not self.direct:
            # In a folder that has vanished, or may no longer be written, it cannot be helped.
            with suppress(OSError):
                os.unlink(self.temporary)
        self._let_go()

    @contextmanager
    def _discarding(self) -> Iterator[None]:
        try:
            with located(self.path):
                yield
        except (OutputError, MemoryError):
            self.discard()
            raise

    def _let_go(self) -> None:
        if self._hold is not None:
            os.close(self._hold)
            self._hold = None


class ReplacedText(Replacement):
    """A text stream (UTF-8, LF line ends) to a place; failures of the disk are `OutputError`s."""

    def __init__(self, path: Path | str, special: bool = True):
        self._stream: Any = None
        super().__init__(path, special)
        with self._discarding():
            self._stream = self.open("w", encoding="utf-8", newline="\n")

    def write(self, text: str) -> int:
        """Write `text`."""
        with self._discarding():
            return int(self._stream.write(text))

    def flush(self) -> None:
        """Hand what is buffered to the system."""
        with self._discarding():
            self._stream.flush()

    def finish(self) -> None:
        """Hand everything to the disk, which may refuse it; nothing can be written any more."""
        with self._discarding():
            self._stream.close()
        super().finish()

    def discard(self) -> None:
        """Close the stream and leave the old file as it was."""
        # It may never have been opened, and that its last buffer does not fit on the disk no longer matters.
        with suppress(OSError, AttributeError):
            self._stream.close()
        super().discard()


def refuse_unwritable(path: str, special: bool = True) -> None:
    """Raise the `OutputError` that would come once the result for `path` is made; nothing is left there."""
    Replacement(path, special).discard()


@contextmanager
def replaced(path: Path | str) -> Iterator[Any]:
    """Give a stream of bytes that stand at `path` once the block has ended, if nothing fails in it."""
    place = Replacement(path)
    try:
        with located(place.path), place.open("wb") as stream:
            yield stream
    except BaseException:
        place.discard()
        raise
    place.commit()


def write_whole(path: str, data: bytes) -> None:
    """Put `data` at `path`, whole or not at all.  Raises `OutputError`."""
    write_together({path: data}, special=True)


def write_together(contents: Mapping[Any, bytes], special: bool = False) -> None:
    """Put the contents at their paths, all or none, into what is not a regular file only where `special`."""
    places: list[Replacement] = []
    try:
        for path, data in contents.items():
            places.append(place := Replacement(path, special))
            with located(place.path), place.open("wb") as stream:
                stream.write(data)
    except BaseException:
        for place in places:
            place.discard()
        raise
    put_in_place(places)


def put_in_place(files: list[Any]) -> None:
    """Commit `files` that have `finish`, `move`, `folder` and `discard`: none before all are on the disk."""
    try:
        for file in files:
            file.finish()
        _move(files)
        sync_folders(files)
    except BaseException:
        for file in files:
            file.discard()
        raise


def _move(files: Sequence[Any]) -> None:
    """Move all; once one is in its place, another that cannot be moved is no wrong command: exit 1."""
    moved: list[Any] = []
    for file in files:
        try:
            file.move()
        except OutputError as error:
            if not moved:
                raise
            raise OutputError(
                f"{error}; already replaced: {', '.join(moved)}", ANALYSIS_FAILED, id="RESULT-024"
            ) from error
        moved.append(file.path)


def sync_folders(files: list[Any]) -> None:
    """Wait until the names of the moved `files` are on the disk, each folder once.  Raises `OutputError`."""
    for folder, path in {file.folder: file.path for file in files if file.folder}.items():
        try:
            sync_folder(folder)
        except OSError as error:
            message = f"{path}: written, but the disk does not confirm that it is there: {error.strerror}"
            raise OutputError(message, ANALYSIS_FAILED, id="RESULT-013") from error


def make_folder(folder: Path | str) -> None:
    """Make the output folder and its parents if missing."""
    folder = os.fspath(folder)
    with located(folder):
        os.makedirs(folder, exist_ok=True)


def _is_special(target: str) -> bool:
    try:
        mode = os.stat(target).st_mode
    except OSError:
        return False
    return not (stat.S_ISREG(mode) or stat.S_ISDIR(mode))


def _keep_mode(target: str, held: Any, temporary: str) -> None:
    if os.path.exists(target):
        place = held if os.chmod in os.supports_fd else temporary
        os.chmod(place, stat.S_IMODE(os.stat(target).st_mode))
