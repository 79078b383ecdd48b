"""Results appear whole or not at all: written beside their place, moved there at the end.

What is no regular file (a pipe, /dev/null, /dev/stdout) is written to directly: moving a file over it
would destroy it.
"""

import errno
import os
import stat
import zlib
from contextlib import contextmanager, suppress

from ..errors import ANALYSIS_FAILED, BAD_INPUT, OutputError
from ..memory import file_lacks_memory

_PREFIX, _SUFFIX = ".flexmb-", ".tmp"

FULL = (errno.ENOSPC, errno.EDQUOT, errno.EFBIG)


class Replacement:
    """A file that will stand at `path`; until `commit` it is written at `temporary`.

    `direct`: `path` is no regular file, and `temporary` is the thing itself.
    Raises `OutputError` when the folder is missing or cannot be written.
    """

    def __init__(self, path):
        self.path = os.fspath(path)
        # A link stays a link: the file it points to is replaced.
        self._target = os.path.realpath(self.path)
        self.direct = _is_special(self._target)
        self._hold = None
        self.temporary = self._target
        if not self.direct:
            with located(self.path):
                _refuse_place(self.path, self._target)
                _remove_orphans(self._target)
                self.temporary, self._hold = _reserve(self._target)

    def commit(self) -> None:
        """Put the finished file in its place; it is discarded when it cannot be put there."""
        if self.direct:
            return
        try:
            with located(self.path):
                _keep_mode(self._target, self.temporary)
                os.replace(self.temporary, self._target)
        except BaseException:
            self.discard()
            raise
        self._let_go()

    def discard(self) -> None:
        """Remove what was written; the file that stood at `path` before stays."""
        if not self.direct:
            # In a folder that has vanished, or may no longer be written, it cannot be helped.
            with suppress(OSError):
                os.unlink(self.temporary)
        self._let_go()

    def _let_go(self):
        if self._hold is not None:
            os.close(self._hold)
            self._hold = None


class ReplacedText:
    """A text stream (UTF-8, LF line ends) to a `Replacement`; failures of the disk are `OutputError`s."""

    def __init__(self, path):
        self._replacement = Replacement(path)
        self.path = self._replacement.path
        with self._discarding():
            self._stream = open(self._replacement.temporary, "w", encoding="utf-8", newline="\n")  # noqa: SIM115

    def write(self, text: str) -> int:
        """Write `text`."""
        with self._discarding():
            return self._stream.write(text)

    @property
    def temporary(self) -> str:
        """Where the text is until `commit`."""
        return self._replacement.temporary

    def flush(self) -> None:
        """Hand what is buffered to the system."""
        with self._discarding():
            self._stream.flush()

    def finish(self) -> None:
        """Hand everything to the disk, which may refuse it; nothing can be written any more."""
        with self._discarding():
            self._stream.close()

    def commit(self) -> None:
        """Close the stream and put the file in its place."""
        self.finish()
        self._replacement.commit()

    def discard(self) -> None:
        """Close the stream and leave the old file as it was."""
        _close_quietly(self._stream)
        self._replacement.discard()

    @contextmanager
    def _discarding(self):
        try:
            with located(self.path):
                yield
        except (OutputError, MemoryError):
            self._replacement.discard()
            raise


def refuse_unwritable(path) -> None:
    """Raise the `OutputError` that would come once the result for `path` is made; nothing is left there."""
    Replacement(path).discard()


def write_whole(path, data: bytes) -> None:
    """Put `data` at `path`, whole or not at all.  Raises `OutputError`."""
    place = Replacement(path)
    try:
        with located(place.path), open(place.temporary, "wb") as stream:
            stream.write(data)
    except BaseException:
        place.discard()
        raise
    place.commit()


def put_in_place(files) -> None:
    """Commit `files` that have `finish`, `commit` and `discard`: none before all are complete on the disk."""
    try:
        for file in files:
            file.finish()
        for file in files:
            file.commit()
    except BaseException:
        for file in files:
            file.discard()
        raise


@contextmanager
def located(path: str):
    """Turn an `OSError` while writing `path` into an `OutputError` with a clear sentence, or MemoryError."""
    try:
        yield
    except BrokenPipeError:
        raise
    except OSError as error:
        if file_lacks_memory(error):
            raise MemoryError(str(error)) from error
        raise output_error(path, error) from error


def output_error(path: str, error: OSError) -> OutputError:
    """A full disk ends the run (exit 1); a place that cannot be written is a wrong command (exit 2)."""
    number = error.errno
    if number in FULL:
        return OutputError(f"{path}: no space left for the result; free some and run again", ANALYSIS_FAILED)
    if number == errno.EIO:
        return OutputError(f"{path}: the disk reports a failure while the result is written", ANALYSIS_FAILED)
    if number in (errno.EMFILE, errno.ENFILE):
        told = "too many files are open; `ulimit -n` tells how many may be"
        return OutputError(f"{path}: cannot be written: {told}", ANALYSIS_FAILED)
    reason = _reason(number, error)
    if number == errno.ENOENT and os.path.isdir(os.path.dirname(os.path.realpath(path))):
        reason = "its folder takes no new files"  # such as /proc
    return OutputError(f"{path}: cannot be written: {reason}", BAD_INPUT)


def is_unfinished(path: str) -> bool:
    """Whether a file has the name of a result in the making, such as a killed run leaves behind."""
    name = os.path.basename(path)
    return name.startswith(_PREFIX) and name.endswith(_SUFFIX)


def hold(file):
    """Whether the open file is now this process's alone, until it ends somehow; None: no locks here."""
    try:
        import fcntl
    except ImportError:
        return None
    try:
        fcntl.flock(file, fcntl.LOCK_EX | fcntl.LOCK_NB)
    except OSError as error:
        return False if error.errno in (errno.EWOULDBLOCK, errno.EACCES) else None
    return True


def make_folder(folder) -> None:
    """Make the output folder and its parents if missing."""
    folder = os.fspath(folder)
    with located(folder):
        os.makedirs(folder, exist_ok=True)


def _reason(number, error):
    return {
        errno.EACCES: "permission denied",
        errno.EPERM: "permission denied",
        errno.EROFS: "the disk is read-only",
        errno.ENOENT: "its folder does not exist",
        errno.ENOTDIR: "a part of the path is a file, not a folder",
        errno.EEXIST: "a file of that name is in the way",
        errno.EISDIR: "it is a folder",
        errno.ENAMETOOLONG: "the name is too long",
    }.get(number, error.strerror or str(error))


def _is_special(target):
    try:
        mode = os.stat(target).st_mode
    except OSError:
        return False
    return not (stat.S_ISREG(mode) or stat.S_ISDIR(mode))


def _refuse_place(path, target):
    # `realpath` drops the stroke with which a user says that a folder is meant.
    if os.path.isdir(target) or path.endswith("/"):
        raise IsADirectoryError(errno.EISDIR, os.strerror(errno.EISDIR))
    if os.path.islink(target):  # followed to its end it is a link still: one that leads back to itself
        raise OSError(errno.ELOOP, os.strerror(errno.ELOOP))
    if len(os.fsencode(os.path.basename(target))) > 255:
        raise OSError(errno.ENAMETOOLONG, os.strerror(errno.ENAMETOOLONG))


def _reserve(target):
    """A fresh empty file in the folder of `target`, and the descriptor that holds it as long as it lasts.

    Its short name fits wherever the result's does.
    """
    while True:
        name = f"{_of_target(target)}{os.urandom(4).hex()}{_SUFFIX}"
        path = os.path.join(os.path.dirname(target), name)
        with suppress(FileExistsError):
            held = os.open(path, os.O_CREAT | os.O_EXCL | os.O_WRONLY, 0o666)
            # Another run may have taken it for an orphan before it was held.
            if hold(held) is not False and os.path.exists(path):
                return path, held
            os.close(held)


def _remove_orphans(target):
    """Remove what killed runs left in the place of `target`: files that nobody holds any more."""
    folder = os.path.dirname(target)
    with suppress(OSError):
        names = os.listdir(folder)
        for name in names:
            if name.startswith(_of_target(target)) and name.endswith(_SUFFIX):
                _remove_unheld(os.path.join(folder, name))


def _remove_unheld(path):
    file = os.open(path, os.O_WRONLY)
    try:
        if hold(file):
            os.unlink(path)
    finally:
        os.close(file)


def _of_target(target):
    return f"{_PREFIX}{zlib.crc32(os.fsencode(os.path.basename(target))):08x}-"


def _keep_mode(target, temporary):
    if os.path.exists(target):
        os.chmod(temporary, stat.S_IMODE(os.stat(target).st_mode))


def _close_quietly(stream):
    try:
        stream.close()
    except OSError:
        # The text is thrown away: that its last buffer does not fit on the disk no longer matters.
        return
