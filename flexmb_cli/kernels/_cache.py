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

from ..managed_files import UnsafePlace, is_own, make_own_folder, open_managed
from ._library import CHECKED, note_once, unusable

ENDING = ".object"
_VARIABLES = (("NUMBA_CACHE_DIR", ""), ("XDG_CACHE_HOME", ""), ("LOCALAPPDATA", ""), ("HOME", ".cache"))
KEPT_VERSIONS = 3  # of the kernels' text; older folders are deleted
_PREFIX = "objects-"
_LOADING = ("_cache.py", "_entry.py", "_library.py")  # which have no part in what is compiled

refused: list[str] = []  # why folders and files were not used, a sentence each


class DamagedError(ValueError):
    """A kept file that is no whole object."""


def _bases() -> Iterator[Path]:
    for name, below in _VARIABLES:
        base = os.environ.get(name)
        if base:
            yield Path(base) / below
    if hasattr(os, "getuid"):
        import tempfile

        yield Path(tempfile.gettempdir()) / f"flexmb-{os.getuid()}"


def _refuse(path: Path, status: os.stat_result) -> None:
    """Note why a folder or file is not used, and the remedy."""
    reason = f"others may write to it; chmod go-w {path}"
    if stat.S_ISLNK(status.st_mode):
        reason = "it is a link; remove it"
    elif status.st_uid not in (0, os.getuid()):
        reason = "it belongs to another user; let NUMBA_CACHE_DIR name another folder"
    note_once(refused, f"{path} is not used for compiled kernels: {reason}")


def _is_safe(base: Path, folder: Path) -> bool:
    """Return whether all folders from the base down to `folder` that exist can be trusted."""
    with contextlib.suppress(FileNotFoundError, NotADirectoryError):
        status = base.stat()
        # A folder for all, such as /tmp, will do where nobody can take away what is another's.
        if not is_own(status) and (status.st_uid or not status.st_mode & stat.S_ISVTX):
            _refuse(base, status)
            return False
        for below in (folder.parent, folder):
            status = below.lstat()
            if not stat.S_ISDIR(status.st_mode) or not is_own(status):
                _refuse(below, status)
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
            note_once(unusable, f"{path} is damaged: it is compiled again")
        except (OSError, ValueError, UnsafePlace):
            pass
        if folder == last:
            break
    return None


def read_object(path: Path) -> bytes:
    """Return a kept object; raises ValueError, UnsafePlace or OSError where it is not used."""
    with open(open_managed(str(path), os.O_RDONLY), "rb") as file:
        status = os.fstat(file.fileno())
        if not is_own(status):
            _refuse(path, status)
            raise ValueError("others may have written it")
        checksum, _, code = file.read().partition(b"\n")
    if _checksum(path.name, code) != checksum:
        raise DamagedError("it is damaged")
    return code


def _checksum(name: str, code: bytes) -> bytes:
    """Return what an object begins with; who may copy it does not make it another kernel."""
    return hashlib.sha256(name.encode() + code).hexdigest().encode()


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


def _prune(folder: Path) -> None:
    """Delete the folders of old versions."""
    import shutil

    others = [path for path in folder.parent.glob(f"{_PREFIX}*") if path != folder and not path.is_symlink()]
    for path in sorted(others, key=lambda path: path.stat().st_mtime)[: 1 - KEPT_VERSIONS]:
        shutil.rmtree(path, ignore_errors=True)


def kept() -> list[Path]:
    """Return the files of all versions, each once: several variables may name the same folder."""
    of_name: dict[Path, Path] = {}
    for folder in folders():
        for path in sorted(folder.parent.glob(f"{_PREFIX}*/*{ENDING}")):
            if not path.parent.is_symlink():
                of_name.setdefault(path.parent.resolve() / path.name, path)
    return list(of_name.values())


def clear() -> tuple[int, list[Path]]:
    """Delete the kept objects of all versions; return how many there were, and those that stay."""
    import shutil

    before = kept()
    for version in {path.parent for path in before}:
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
