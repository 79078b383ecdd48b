"""Files in the making beside their target: reserved, held by their process, removed when it was killed."""

import errno
import os
import zlib
from contextlib import suppress
from typing import Any

from ...managed_files import UnsafePlace, open_managed

_PREFIX, _SUFFIX = ".flexmb-", ".tmp"


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
