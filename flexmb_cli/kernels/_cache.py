"""Folder of a user's compiled kernels, and the check of its owner.

Objects are code.  A folder or file counts only if it belongs to this user or to root and nobody else can
write to it; anything else is as if it were not there, and is named once (`refused`).
"""

import contextlib
import functools
import hashlib
import os
import stat
from collections.abc import Iterator
from pathlib import Path

from ..managed_files import is_own, make_own_folder
from ._library import CHECKED, note_unusable

ENDING = ".object"
KEPT_VERSIONS = 3  # of the kernels' text; older folders are deleted
_PREFIX = "objects-"
_OLD_PREFIX = "kernels-"  # of versions that kept numba's own files
_LOADING = ("_cache.py", "_entry.py", "_library.py")  # which have no part in what is compiled

refused: list[str] = []  # why folders and files were not used, a sentence each


class DamagedError(ValueError):
    """A kept file that is no whole object."""


def _bases() -> Iterator[Path]:
    for name, below in (
        ("NUMBA_CACHE_DIR", ""),
        ("XDG_CACHE_HOME", ""),
        ("LOCALAPPDATA", ""),
        ("HOME", ".cache"),
    ):
        base = os.environ.get(name)
        if base:
            yield Path(base) / below
    if hasattr(os, "getuid"):
        import tempfile

        yield Path(tempfile.gettempdir()) / f"flexmb-{os.getuid()}"


def _is_safe_base(found: os.stat_result):
    """A folder for all, such as /tmp, will do where nobody can take away what is another's."""
    return is_own(found) or (found.st_uid == 0 and bool(found.st_mode & stat.S_ISVTX))


def _refuse(path: Path, found: os.stat_result) -> None:
    sentence = f"{path} is not used for compiled kernels: {_reason(path, found)}"
    if sentence not in refused:
        refused.append(sentence)


def _reason(path: Path, found: os.stat_result) -> str:
    """Return why a folder or file is not used, and the remedy."""
    if stat.S_ISLNK(found.st_mode):
        return "it is a link; remove it"
    if found.st_uid not in (0, os.getuid()):
        return "it belongs to another user; let NUMBA_CACHE_DIR name another folder"
    return f"others may write to it; chmod go-w {path}"


def _is_safe(base: Path, folder: Path) -> bool:
    """Return whether all folders from the base down to `folder` that exist can be trusted."""
    with contextlib.suppress(FileNotFoundError, NotADirectoryError):
        found = base.stat()
        if not _is_safe_base(found):
            _refuse(base, found)
            return False
        for below in (folder.parent, folder):
            found = below.lstat()
            if not stat.S_ISDIR(found.st_mode) or not is_own(found):
                _refuse(below, found)
                return False
    return True


@functools.cache
def kernel_digest() -> str:
    """Return a name for the text of all kernels: each depends on what it calls and on others' constants."""
    digest = hashlib.sha256(b"checked" if CHECKED else b"")
    top = Path(__file__).parent
    for path in sorted(path for path in top.rglob("*.py") if path.name not in _LOADING):
        digest.update(path.relative_to(top).as_posix().encode() + path.read_bytes())
    return digest.hexdigest()[:16]


def folders() -> Iterator[Path]:
    """Yield the folders of this version that can be trusted, there or not, best first."""
    for base in _bases():
        folder = base / "flexmb" / f"{_PREFIX}{kernel_digest()}"
        with contextlib.suppress(OSError):
            if _is_safe(base, folder):
                yield folder


def content(name: str, last: Path | None = None) -> bytes | None:
    """Return the object of this name in the first of the folders, up to the `last`, that has one."""
    for folder in folders():
        path = folder / f"{name}{ENDING}"
        try:
            return read_object(path)
        except DamagedError:
            note_unusable(f"{path} is damaged: it is compiled again")
        except (OSError, ValueError):
            pass
        if folder == last:
            break
    return None


def read_object(path: Path) -> bytes:
    """Return a kept object; raises ValueError where it is not used, OSError where it is no file."""
    with open(path, "rb", opener=_open_unlinked) as file:
        found = os.fstat(file.fileno())
        if not is_own(found):
            _refuse(path, found)
            raise ValueError("others may have written it")
        checksum, _, code = file.read().partition(b"\n")
    if _checksum(path.name, code) != checksum:
        raise DamagedError("it is damaged")
    return code


def _checksum(name: str, code: bytes) -> bytes:
    """Return what an object begins with; who may copy it does not make it another kernel."""
    return hashlib.sha256(name.encode() + code).hexdigest().encode()


def _open_unlinked(path: str, flags: int) -> int:
    """Open a regular file, not what a link or a pipe of that name leads to."""
    number = os.open(path, flags | getattr(os, "O_NOFOLLOW", 0) | getattr(os, "O_NONBLOCK", 0))
    if not stat.S_ISREG(os.fstat(number).st_mode):
        os.close(number)
        raise OSError(f"{path} is no regular file")
    return number


def folder_to_write() -> Path | None:
    """Return the first folder that can be written, made where it is missing; None where there is none."""
    import tempfile

    for folder in folders():
        with contextlib.suppress(OSError):
            make_own_folder(folder)
            if folder in folders():  # another may have been quicker
                tempfile.TemporaryFile(dir=folder).close()
                return folder
    return None


def keep(folder: Path | None, name: str, code: bytes) -> None:
    """Keep an object, whole or not at all; the cache only saves time, so that no failure matters."""
    if folder is None:
        return
    import tempfile

    with contextlib.suppress(OSError):
        number, temporary = tempfile.mkstemp(prefix=f".{name[:40]}-", dir=folder)  # mode 0600
        try:
            with open(number, "wb") as file:
                file.write(_checksum(f"{name}{ENDING}", code) + b"\n" + code)
            os.replace(temporary, folder / f"{name}{ENDING}")
        except BaseException:
            Path(temporary).unlink(missing_ok=True)
            raise
        _prune(folder)


def versions(place: Path) -> list[Path]:
    """Return the folders of all versions in a folder "flexmb", the latest first."""
    found = [path for path in place.glob(f"{_PREFIX}*") if path.is_dir() and not path.is_symlink()]
    return sorted(found, key=lambda path: path.stat().st_mtime, reverse=True)


def _prune(folder: Path) -> None:
    """Delete the folders of old versions."""
    import shutil

    old = [path for path in versions(folder.parent)[KEPT_VERSIONS:] if path != folder]
    for path in [*old, *folder.parent.glob(f"{_OLD_PREFIX}*")]:
        if not path.is_symlink():
            shutil.rmtree(path, ignore_errors=True)


def _all_versions() -> list[Path]:
    """Return the folders of all versions, each once: several variables may name the same folder."""
    found: dict[tuple[int, int], Path] = {}
    for folder in folders():
        for version in versions(folder.parent) if folder.parent.is_dir() else ():
            status = version.stat()
            found.setdefault((status.st_dev, status.st_ino), version)
    return list(found.values())


def kept() -> Iterator[tuple[Path, int]]:
    """Yield what is kept as objects, of all versions, with its size in bytes."""
    for version in _all_versions():
        for path in sorted(version.glob(f"*{ENDING}")):
            yield path, path.lstat().st_size


def clear() -> tuple[int, list[Path]]:
    """Delete the kept objects of all versions; return how many there were, and those that stay."""
    import shutil

    before = [path for path, _ in kept()]
    for version in _all_versions():
        shutil.rmtree(version, ignore_errors=True)
    stay = [path for path in before if os.path.lexists(path)]
    return len(before) - len(stay), stay


@contextlib.contextmanager
def alone(folder: Path | None, name: str) -> Iterator[None]:
    """Have one of several processes compile; the others wait, and find what it kept."""
    try:
        import fcntl
    except ImportError:  # no such locks here: everyone compiles
        folder = None
    with contextlib.ExitStack() as opened:
        # Where the folder has vanished or became unwritable, everyone compiles, too.
        if folder is not None:
            with contextlib.suppress(OSError):
                flags = os.O_WRONLY | os.O_CREAT | os.O_NOFOLLOW | os.O_NONBLOCK  # a pipe is not waited for
                number = os.open(folder / f"{name}.lock", flags, 0o600)
                opened.callback(os.close, number)
                fcntl.flock(number, fcntl.LOCK_EX)
        yield
