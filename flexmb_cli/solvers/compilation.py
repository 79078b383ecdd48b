"""Compiling kernels: saying before it happens that a run waits for it, and doing it ahead of all runs."""

from collections.abc import Iterator
from contextlib import AbstractContextManager
from pathlib import Path
from typing import Protocol, cast

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


def interpreting(wanted: bool = True) -> AbstractContextManager[None]:
    """Return a block within which a system is built and evaluated by uncompiled kernels, if that is `wanted`.

    A small system that is only looked at is ready before its kernels were compiled.
    """
    from ..kernels import _jit

    return _jit.interpreting(wanted)


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
    from ..kernels import _entry

    for sentence in _entry.damaged:
        if sentence not in _shown:
            _shown.add(sentence)
            listener.notice(Fault("warning", sentence, id="SOLVE-045"))


def units_to_compile() -> list[str]:
    """Return the units of kernels that neither the package nor the user's cache has."""
    from ..kernels import _entry
    from ..kernels.signatures import UNITS

    return [unit for unit, entries in UNITS.items() if not all(map(_entry.is_ready, entries))]


def copy_units() -> tuple[int, Path | None]:
    """Copy units to the folder that new ones go to where it lacks them; return how many, and the folder.

    NUMBA_CACHE_DIR may name a folder for others, who do not see what lies in this user's home.
    """
    from ..kernels import _cache, _entry
    from ..kernels.signatures import UNITS

    ready = (unit for unit, entries in UNITS.items() if all(map(_entry.is_ready, entries)))
    behind = [unit for unit in ready if not _entry.is_packaged(unit) and _cache.is_kept_behind(unit)]
    folder = _cache.folder_to_write() if behind else None
    for unit in behind:
        found = _cache.content(unit)
        assert found is not None
        _cache.keep(folder, unit, found[1])
        if _cache.is_kept_behind(unit):
            raise _unwritten(folder)
    return len(behind), folder


def compile_unit(unit: str) -> None:
    """Compile a unit of kernels into the user's cache; raises OutputError where it cannot be kept."""
    from ..kernels import _cache, _entry, _objects
    from ..kernels.signatures import UNITS

    folder = _cache.folder_to_write()
    if folder is None:
        raise OutputError(NO_FOLDER, id="SOLVE-001")
    # None, a processor without a name, is one more target.
    target, digest = cast("str", _objects.target()), _objects.kernel_digest()
    with _cache.alone(folder, unit):
        if not all(map(_entry.is_ready, UNITS[unit])):  # another process was not quicker
            made = _entry.emit(unit, _entry.unit_entries(unit), digest, [target])
            _cache.keep(folder, unit, made[target])
    if _cache.content(unit) is None:
        raise _unwritten(folder)


def _unwritten(folder: Path | None) -> OutputError:
    return OutputError(f"{folder}: compiled kernels cannot be written", id="SOLVE-002")


def list_compiled() -> Iterator[tuple[str, int, str]]:
    """Yield path, bytes and compiler of what the user's cache keeps; what is not used says so."""
    from ..kernels import _cache

    for path, size in _cache.kept():
        yield str(path), size, _compiler_of(path)


def _compiler_of(path: Path) -> str:
    """Return what compiled a kept object, or why it is not used."""
    from ..kernels import _cache, _objects

    try:
        content = _cache.read_own(path)
        if content is None:
            return "not used: others may have written it"
        header, _ = _objects.read(content)
        if header["unit"] != path.name.removesuffix(_cache.ENDING):
            return f"not used: it is the unit {header['unit']}"
        compiler: str = header["compiler"]
    except OSError as fault:
        return f"not used: {fault.strerror or 'it is no regular file'}"
    except (ValueError, KeyError, _objects.DamagedError):
        return "not used: it is damaged"
    return compiler


def clear_compiled() -> tuple[int, list[str]]:
    """Delete what the user's cache keeps, of all versions; return how many files, and those that stay."""
    from ..kernels import _cache

    count, stay = _cache.clear()
    return count, [str(path) for path in stay]


def refused_places() -> list[str]:
    """Return why folders and files were not used, a sentence each."""
    from ..kernels import _cache, _entry

    return [*_cache.refused, *_entry.damaged]
