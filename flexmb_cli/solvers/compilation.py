"""Compiling kernels: saying before it happens that a run waits for it, and doing it ahead of all runs."""

from collections.abc import Iterator
from contextlib import AbstractContextManager
from typing import Protocol

from ..errors import Fault, OutputError

_reported: set[str] = set()  # entries this process need not look for again: a study asks for every case
_shown: set[str] = set()  # sentences about damaged files
COMPILING = "compiling kernels (once per version, 5 to 20 s)"
NO_FOLDER = "no folder to keep compiled kernels in; set NUMBA_CACHE_DIR to one that can be written"


class Notices(Protocol):
    """Receiver of what is reported during a run."""

    def notice(self, fault: Fault) -> None:
        """Show a warning or a note."""

    def status(self, doing: str) -> None:
        """Show what is being done until the next call."""


def interpreting(interpreted: bool = True) -> AbstractContextManager[None]:
    """Return a block within which a system is built and evaluated by uncompiled kernels, if `interpreted`.

    A small system that is only looked at is ready before its kernels were compiled.
    """
    from ..kernels import _jit

    return _jit.interpreting(interpreted)


def nothing_to_compile() -> bool:
    """Return whether numba is switched off, so that all kernels are interpreted."""
    from ..kernels import _jit

    return _jit.interpreted()


def announce_compiling(listener: Notices, entry: str) -> None:
    """Notices for the user when the kernel `entry` ("module.function") has to be compiled."""
    if entry in _reported:
        return
    _reported.add(entry)
    from ..kernels import _jit

    must_compile = _jit.must_compile(entry)
    report_damage(listener)
    if not must_compile:
        return
    from ..kernels import _cache

    if _cache.folder_to_write() is None:
        listener.notice(Fault("note", NO_FOLDER, id="SOLVE-043"))
    for sentence in _cache.refused:
        listener.notice(Fault("warning", sentence, id="SOLVE-044"))
    listener.status(COMPILING)


def report_damage(listener: Notices) -> None:
    """Notices for the user, one a file, when compiled kernels were damaged or could not be read."""
    from ..kernels import _library

    for sentence in _library.unusable:
        if sentence not in _shown:
            _shown.add(sentence)
            listener.notice(Fault("warning", sentence, id="SOLVE-045"))


def has_library() -> bool:
    """Return whether the package has compiled kernels for this system, as wheels have."""
    from ..kernels import _library

    return _library.packaged() is not None


def missing_units() -> Iterator[tuple[str, bool]]:
    """Yield the units that the folder for new ones, and those before it, lack; and whether another has them.

    NUMBA_CACHE_DIR may name a folder for others, who do not see what lies in this user's home.
    """
    from ..kernels import _cache
    from ..kernels._entry import Unit
    from ..kernels.signatures import UNITS

    folder = _cache.folder_to_write()
    for unit in UNITS:
        if _cache.content(Unit(unit).name, folder) is None:
            yield unit, _cache.content(Unit(unit).name) is not None


def provide_unit(unit: str) -> None:
    """Compile a unit into the user's cache, or copy it; raises OutputError where it cannot be kept."""
    from ..kernels import _cache
    from ..kernels._entry import Unit
    from ..kernels._library import target

    folder, kernels = _cache.folder_to_write(), Unit(unit)
    if folder is None:
        raise OutputError(NO_FOLDER, id="SOLVE-001")
    with _cache.alone(folder, kernels.name):
        if _cache.content(kernels.name, folder) is None:  # another process was not quicker
            _cache.keep(
                folder, kernels.name, _cache.content(kernels.name) or kernels.emit([target()])[target()]
            )
    if _cache.content(kernels.name, folder) is None:
        raise OutputError(f"{folder}: compiled kernels cannot be written", id="SOLVE-002")


def list_compiled() -> Iterator[tuple[str, int, str]]:
    """Yield path, bytes, and why it is not used, of what the user's cache keeps."""
    from ..kernels import _cache

    for path in _cache.kept():
        why = ""
        try:
            _cache.read_object(path)
        except (OSError, ValueError, OutputError) as fault:
            why = f"not used: {str(fault).removeprefix(f'{path}: ')}"
        yield str(path), path.lstat().st_size, why


def clear_compiled() -> tuple[int, list[str]]:
    """Delete what the user's cache keeps, of all versions; return how many files, and those that stay."""
    from ..kernels import _cache

    count, stay = _cache.clear()
    return count, [str(path) for path in stay]


def refused_places() -> list[str]:
    """Return why folders and files were not used, a sentence each."""
    from ..kernels import _cache, _library

    return [*_cache.refused, *_library.unusable]
