"""Files and folders that flexmb makes for itself: checkpoints of sweeps, locks, resume files, drafts, caches.

Somebody else may have prepared their folder.  A link there could lead to any file of the user, opening a
pipe could wait for ever, and opening a device could act on it; so only regular files are opened.
"""

import errno
import os
import stat
from pathlib import Path
from typing import Any

from .errors import OutputError

# The file may be exchanged between the look at it and its opening: these keep the opening harmless.
_CAREFUL = getattr(os, "O_NOFOLLOW", 0) | getattr(os, "O_NONBLOCK", 0) | getattr(os, "O_NOCTTY", 0)
_CAREFUL |= getattr(os, "O_CLOEXEC", 0) | getattr(os, "O_BINARY", 0)
_FOLDER = getattr(os, "O_DIRECTORY", 0) | getattr(os, "O_NOFOLLOW", 0) | getattr(os, "O_CLOEXEC", 0)
# Windows opens no folders.
_OPENS_FOLDERS = hasattr(os, "O_DIRECTORY") and os.open in os.supports_dir_fd


class UnsafePlace(OutputError):
    """At the place of a managed file stands a link, a pipe, a device or a folder (exit 2)."""


def open_managed(path: str, flags: int, shown: str = "", folder: int | None = None) -> int:
    """Open a regular file with `os.open` and return its descriptor; `path` is relative to the open `folder`.

    Raises UnsafePlace, with `shown` as the file's name, where anything else stands; OSError as `os.open`.
    """
    shown = shown or path
    refuse_unsafe(path, shown, folder)
    try:
        number = os.open(path, flags | _CAREFUL, 0o666, dir_fd=folder)
    except OSError:
        refuse_unsafe(path, shown, folder)
        raise
    try:
        _refuse(os.fstat(number), shown)
    except UnsafePlace:
        os.close(number)
        raise
    return number


def refuse_unsafe(path: str, shown: str = "", folder: int | None = None) -> None:
    """Raise UnsafePlace where `path` exists and is not a regular file with a single name."""
    try:
        status = os.stat(path, dir_fd=folder, follow_symlinks=False)
    except OSError:
        return
    _refuse(status, shown or path)


def _refuse(status: Any, shown: str) -> None:
    if stat.S_ISLNK(status.st_mode):
        raise UnsafePlace(f"{shown}: it is a link, which is not followed; remove it", id="FLEXMB-001")
    if not stat.S_ISREG(status.st_mode):
        raise UnsafePlace(
            f"{shown}: it is not a regular file, but a folder, a pipe or a device; remove it", id="FLEXMB-002"
        )
    if status.st_nlink > 1:
        raise UnsafePlace(
            f"{shown}: the file has another name elsewhere (a hard link); remove it here", id="FLEXMB-003"
        )


def is_own(status: os.stat_result) -> bool:
    """Return whether only this user, or root, can have written a file of this `status`."""
    return belongs_here(status) and (not hasattr(os, "geteuid") or not status.st_mode & 0o022)


def belongs_here(status: os.stat_result) -> bool:
    """Return whether a file of this `status` is of this user, or of root, who could change all anyway."""
    return not hasattr(os, "geteuid") or status.st_uid in (0, os.geteuid())


def make_own_folder(folder: Path) -> None:
    """Make the folder `flexmb/NAME` of a cache, which only this user may write to, and those above it.

    Raises PermissionError in a folder of somebody else, such as the HOME of the user whom root works for:
    he could not use what is made there.
    """
    nearest = next(each for each in (folder, *folder.parents) if each.exists())
    if not belongs_here(nearest.stat()):
        raise PermissionError(errno.EACCES, "belongs to another user", str(nearest))
    for below in (folder.parent.parent, folder.parent, folder):
        below.mkdir(mode=0o700, parents=True, exist_ok=True)


class ManagedFolder:
    """An open folder, used with `with`; names in it lead nowhere else, whatever becomes of its path.

    Raises UnsafePlace where `path` is a link, OSError where it is no folder that can be opened.
    """

    def __init__(self, path: str):
        self.path = path
        if os.path.islink(path):
            raise UnsafePlace(
                f"{path}: the folder is a link, which is not followed; remove it", id="FLEXMB-004"
            )
        self._number = os.open(path, os.O_RDONLY | _FOLDER) if _OPENS_FOLDERS else None

    def __enter__(self) -> "ManagedFolder":
        return self

    def __exit__(self, *failure: Any) -> None:
        if self._number is not None:
            os.close(self._number)

    def open(self, name: str, flags: int) -> int:
        """Open the regular file `name`, as `open_managed` does."""
        return open_managed(self._at(name), flags, os.path.join(self.path, name), self._number)

    def names(self) -> list[str]:
        """Return the names of all that is in the folder."""
        return os.listdir(self.path if self._number is None else self._number)

    def replace(self, name: str, by: str) -> None:
        """Put the file `by` in the place of `name`."""
        os.replace(self._at(by), self._at(name), src_dir_fd=self._number, dst_dir_fd=self._number)

    def unlink(self, name: str) -> None:
        """Remove the file or link `name`."""
        os.unlink(self._at(name), dir_fd=self._number)

    def _at(self, name: str) -> Any:
        return name if self._number is not None else os.path.join(self.path, name)


def unbuffered(number: int) -> Any:
    """Return an unbuffered stream for reading and writing of an open descriptor.

    What a full disk refused must not be tried again when the stream is closed.
    """
    return os.fdopen(number, "r+b", buffering=0)
