"""Results appear whole or not at all: written beside their place, synced, and moved there at the end.

A file is synced before it is moved, its folder after that: a loss of power leaves the old or the new file.

What is no regular file (a pipe, /dev/null, /dev/stdout) is written to directly: moving a file over it
would destroy it.
"""

import errno
import os
import stat
import zlib
from contextlib import contextmanager, suppress
from typing import TYPE_CHECKING, Any

from ...errors import ANALYSIS_FAILED, OutputError
from ...managed_files import UnsafePlace, open_managed
from .disk_failures import located
from .durable import sync, sync_folder

if TYPE_CHECKING:
    from collections.abc import Iterator
    from pathlib import Path


_PREFIX, _SUFFIX = ".flexmb-", ".tmp"


class Replacement:
    """A file that will stand at `path`; until `commit` it is written at `temporary`.

    `direct`: `path` is no regular file, and `temporary` is the thing itself.
    Raises `OutputError` when the folder is missing or cannot be written.
    """

    def __init__(self, path: "Path | str"):
        self.path = os.fspath(path)
        # A link stays a link: the file it points to is replaced.
        self._target = os.path.realpath(self.path)
        self.direct = _is_special(self._target)
        self._hold = None
        self.temporary = self._target
        if not self.direct:
            with located(self.path):
                _refuse_place(self.path, self._target)
                _remove_leftovers(self._target)
                self.temporary, self._hold = _reserve(self._target)

    def open(self, mode: str, **how: Any) -> Any:
        """Open the temporary file, once, as the built-in `open` does."""
        return open(self.duplicate(), mode, **how)

    def duplicate(self) -> int | str:
        """Return a descriptor of the temporary file, which the caller closes; where `direct`, its path.

        Others may write in the folder, too, and put a link where the temporary file stood: it must not be
        opened by its name again.
        """
        return self.temporary if self.direct else os.dup(self._hold)  # type: ignore[arg-type]

    def finish(self) -> None:
        """Wait until all that was written is on the disk; without that the moved file could be empty."""
        if not self.direct:
            with self._discarding():
                sync(self._hold)  # type: ignore[arg-type]

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
        self.finish()
        self.move()
        sync_folders([self])

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
    def _discarding(self) -> "Iterator[None]":
        try:
            with located(self.path):
                yield
        except BaseException:
            self.discard()
            raise

    def _let_go(self) -> None:
        if self._hold is not None:
            os.close(self._hold)
            self._hold = None


class ReplacedText:
    """A text stream (UTF-8, LF line ends) to a `Replacement`; failures of the disk are `OutputError`s."""

    def __init__(self, path: "Path | str"):
        self._replacement = Replacement(path)
        self.path = self._replacement.path
        with self._discarding():
            self._stream = self._replacement.open("w", encoding="utf-8", newline="\n")

    def write(self, text: str) -> int:
        """Write `text`."""
        with self._discarding():
            return self._stream.write(text)

    @property
    def temporary(self) -> str:
        """Return where the text is until `commit`."""
        return self._replacement.temporary

    def flush(self) -> None:
        """Hand what is buffered to the system."""
        with self._discarding():
            self._stream.flush()

    def finish(self) -> None:
        """Hand everything to the disk, which may refuse it; nothing can be written any more."""
        with self._discarding():
            self._stream.close()
        self._replacement.finish()

    def move(self) -> None:
        """Put the finished file in its place."""
        self._replacement.move()

    def commit(self) -> None:
        """Close the stream and put the file in its place."""
        self.finish()
        self.move()
        sync_folders([self])

    @property
    def folder(self) -> str:
        """The folder whose names `move` changes."""
        return self._replacement.folder

    def discard(self) -> None:
        """Close the stream and leave the old file as it was."""
        _close_quietly(self._stream)
        self._replacement.discard()

    @contextmanager
    def _discarding(self) -> "Iterator[None]":
        try:
            with located(self.path):
                yield
        except (OutputError, MemoryError):
            self._replacement.discard()
            raise


def refuse_unwritable(path: str) -> None:
    """Raise the `OutputError` that would come once the result for `path` is made; nothing is left there."""
    Replacement(path).discard()


def write_whole(path: str, data: bytes) -> None:
    """Put `data` at `path`, whole or not at all.  Raises `OutputError`."""
    place = Replacement(path)
    try:
        with located(place.path), place.open("wb") as stream:
            stream.write(data)
    except BaseException:
        place.discard()
        raise
    place.commit()


def put_in_place(files: "list[Any]") -> None:
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


def _move(files: Any) -> None:
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


def sync_folders(files: "list[Any]") -> None:
    """Wait until the names of the moved `files` are on the disk, each folder once.  Raises `OutputError`."""
    for folder, path in {file.folder: file.path for file in files if file.folder}.items():
        try:
            sync_folder(folder)
        except OSError as error:
            message = f"{path}: written, but the disk does not confirm that it is there: {error.strerror}"
            raise OutputError(message, ANALYSIS_FAILED, id="RESULT-013") from error


def is_unfinished(path: str) -> bool:
    """Return whether a file has the name of a result in the making, such as a killed run leaves behind."""
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


def make_folder(folder: "Path | str") -> None:
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


def _refuse_place(path: str, target: str) -> None:
    # `realpath` drops the stroke with which a user says that a folder is meant.
    if os.path.isdir(target) or path.endswith("/"):
        raise IsADirectoryError(errno.EISDIR, os.strerror(errno.EISDIR))
    if os.path.islink(target):  # followed to its end it is a link still: one that leads back to itself
        raise OSError(errno.ELOOP, os.strerror(errno.ELOOP))
    if len(os.fsencode(os.path.basename(target))) > 255:
        raise OSError(errno.ENAMETOOLONG, os.strerror(errno.ENAMETOOLONG))


def _reserve(target: str) -> tuple[str, int]:
    """A fresh empty file in the folder of `target`, and the descriptor that holds it as long as it lasts.

    Its short name fits wherever the result's does.
    """
    while True:
        name = f"{_of_target(target)}{os.urandom(4).hex()}{_SUFFIX}"
        path = os.path.join(os.path.dirname(target), name)
        with suppress(FileExistsError):
            held = os.open(path, os.O_CREAT | os.O_EXCL | os.O_RDWR, 0o666)
            try:
                # Another run may have taken it for an orphan before it was held.
                kept = hold(held) is not False and _stands(path)
            except BaseException:
                _give_up(path, held)
                raise
            if kept:
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


def _remove_leftovers(target: str) -> None:
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


def _keep_mode(target: str, held: Any, temporary: str) -> None:
    if os.path.exists(target):
        place = held if os.chmod in os.supports_fd else temporary
        os.chmod(place, stat.S_IMODE(os.stat(target).st_mode))


def _close_quietly(stream: Any) -> None:
    try:
        stream.close()
    except OSError:
        # The text is thrown away: that its last buffer does not fit on the disk no longer matters.
        return
