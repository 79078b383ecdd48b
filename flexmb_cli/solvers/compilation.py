"""Compiling kernels: saying before it happens that a run waits for it, and doing it ahead of all runs."""

from collections.abc import Iterator
from contextlib import AbstractContextManager
from typing import Protocol

from ..errors import OutputError

_reported: set[str] = set()  # entries this process need not look for again: a study asks for every case
COMPILING = "compiling kernels (once per version, 5 to 20 s)"
NO_FOLDER = "no folder to keep compiled kernels in; set NUMBA_CACHE_DIR to one that can be written"


class Notices(Protocol):
    """Receiver of sentences for the user."""

    def notice(self, sentence: str) -> None:
        """Show the sentence."""

    def status(self, doing: str) -> None:
        """Show what goes on, until something else does."""


def interpreting(wanted: bool = True) -> AbstractContextManager[None]:
    """Return a block within which a system is built and evaluated by uncompiled kernels, if that is `wanted`.

    A small system that is only looked at is ready before its kernels were compiled.
    """
    from ..kernels import _jit

    return _jit.interpreting(wanted)


def tell_of_compiling(listener: Notices, entry: str) -> None:
    """Notices for the user when the kernel `entry` ("module.function") has to be compiled."""
    if entry in _reported:
        return
    _reported.add(entry)
    from ..kernels import _jit

    if not _jit.must_compile(entry):
        return
    from ..kernels import _cache

    listener.status(COMPILING)
    if _cache.folder_to_write() is None:
        listener.notice(NO_FOLDER)
    for sentence in _cache.refused:
        listener.notice(sentence)


def units_to_compile() -> list[str]:
    """Return the units of kernels that neither the package nor the user's cache has."""
    from ..kernels import _entry
    from ..kernels.signatures import UNITS

    return [unit for unit, entries in UNITS.items() if not all(map(_entry.is_ready, entries))]


def compile_unit(unit: str) -> None:
    """Compile a unit of kernels into the user's cache; raises OutputError where it cannot be kept."""
    from ..kernels import _cache, _entry, _objects
    from ..kernels.signatures import UNITS

    folder = _cache.folder_to_write()
    if folder is None:
        raise OutputError(NO_FOLDER, id="SOLVE-001")
    target, digest = _objects.target(), _objects.kernel_digest()
    with _cache.alone(folder, unit):
        if not all(map(_entry.is_ready, UNITS[unit])):  # another process was not quicker
            made = _entry.emit(unit, _entry.unit_entries(unit), digest, [target])  # type: ignore[list-item]
            _cache.keep(folder, unit, made[target])  # type: ignore[index]
    if _cache.content(unit) is None:
        raise OutputError(f"{folder}: compiled kernels cannot be written", id="SOLVE-002")


def list_compiled() -> Iterator[tuple[str, int, str]]:
    """Yield path, bytes and compiler of what the user's cache keeps."""
    from ..kernels import _cache, _objects

    for path, size in _cache.kept():
        try:
            compiler = _objects.read(path.read_bytes())[0]["compiler"]
        except (OSError, ValueError, KeyError, _objects.DamagedError):
            compiler = "damaged"
        yield str(path), size, compiler


def clear_compiled() -> int:
    """Delete what the user's cache keeps, of all versions; return how many files."""
    from ..kernels import _cache

    return _cache.clear()


def refused_places() -> list[str]:
    """Return why folders and files were not used, a sentence each."""
    from ..kernels import _cache

    return list(_cache.refused)
