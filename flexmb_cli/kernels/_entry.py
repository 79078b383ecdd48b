"""A kernel as Python calls it: by compiled code, which is loaded or made when it is needed."""

import functools
import hashlib
import importlib
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

from ..collector import without_collector
from ..memory import TO_COMPILE, require_executable_memory, require_memory
from . import _cache, _objects
from ._arguments import NotDescribedError, Words, describe, key_of
from ._interpreted import is_interpreting, twin
from .signatures import PROCESSORS, UNITS, unit_of, unit_parameters

_PACKAGE = __package__ + "."
_INSTALL_ANEW = "kernels are compiled in its place; install flexmb anew"
_functions: dict[str, list] = {}  # compiled code by the name of the entry
_loaded: set[str] = set()  # units whose files were looked for
damaged: list[str] = []  # files that could not be used, and what becomes of it, a sentence each


def entry_name(function: Callable) -> str:
    """Return "module.function", the module as seen from the kernels."""
    return f"{function.__module__.removeprefix(_PACKAGE)}.{function.__name__}"


def is_ready(name: str) -> bool:
    """Return whether the kernel `name` can be called without compiling it."""
    unit = unit_of(name)
    if unit is None or not _load_unit(unit, _objects.kernel_digest()):
        return False
    wanted = key_of(unit_parameters(unit)[name])
    return any(compiled.key == wanted for compiled in _functions.get(name, ()))


def _load_unit(unit: str, digest: str) -> bool:
    """Load the code of a unit from the package or the user's cache; whether there is some."""
    return (
        unit in _loaded
        or _take(unit, _packaged(unit), digest, _INSTALL_ANEW)
        or _take(unit, _cache.content(unit), digest, "it is compiled again")
    )


def is_packaged(unit: str) -> bool:
    """Return whether the package has the unit, of this version."""
    target = _objects.target()
    path = _objects.PACKAGED / str(target) / f"{unit}{_cache.ENDING}"
    return target is not None and _objects.is_current(path, _objects.kernel_digest(), target)


def _packaged(unit: str) -> tuple[Path, bytes] | None:
    """Return file and content of a unit's object in the package, None where there is none to be read."""
    path = _objects.PACKAGED / str(_objects.target()) / f"{unit}{_cache.ENDING}"
    try:
        return (path, path.read_bytes()) if path.is_file() else None
    except OSError as fault:
        _note_damage(f"{path} cannot be read ({fault.strerror}): {_INSTALL_ANEW}")
        return None


def _take(unit: str, found: tuple[Path, bytes] | None, digest: str, remedy: str) -> bool:
    """Make the functions of an object known; whether it is there, whole and of this version."""
    if found is None:
        return False
    path, content = found
    try:
        _add(unit, content, digest)
    except _objects.OtherKernelsError:
        return False
    except (_objects.DamagedError, ValueError, KeyError, TypeError):
        _note_damage(f"{path} is damaged: {remedy}")
        return False
    return True


def _note_damage(sentence: str) -> None:
    if sentence not in damaged:
        damaged.append(sentence)


def _add(unit: str, content: bytes, digest: str) -> None:
    """Make the functions of an object known; raises as `_objects.load`."""
    for name, functions in _objects.load(content, unit, digest).items():
        _functions[name] = functions + _functions.get(name, [])
    _loaded.add(unit)


class Entry:
    """A kernel; `py_func` is the function it was made of."""

    def __init__(self, function: Callable, options: dict):
        self.py_func, self._options = function, options
        self.__name__, self.__doc__ = function.__name__, function.__doc__
        self._name, self._made = entry_name(function), None

    def __call__(self, *values: Any):
        """Call compiled code; the first call of an entry without any compiles it."""
        if is_interpreting():
            return self.interpreted(*values)
        for compiled in _functions.get(self._name, ()):
            fits, result = compiled.call(values)
            if fits:
                return result
        return self._call_new(values)

    def _call_new(self, values: tuple[Any, ...]):
        """Load or compile what takes such values, and call it."""
        if _objects.target() is None or not self._make_ready(values):
            return self.dispatcher(*values)
        return self(*values)

    def _make_ready(self, values: tuple[Any, ...]) -> bool:
        """Load or compile what takes such values; whether an object can."""
        unit = unit_of(self._name)
        if unit is not None and Words(unit_parameters(unit)[self._name]).pack(values):
            return self._find(values, unit, _objects.kernel_digest(), lambda: unit_entries(unit))
        try:
            parameters = [describe(value) for value in values]
        except NotDescribedError:
            return False
        own = f"{self._name}-{hashlib.sha256(key_of(parameters).encode()).hexdigest()[:12]}"
        return self._find(values, own, self._digest(), lambda: [(self, self._name, parameters)])

    def _find(
        self, values: tuple[Any, ...], unit: str, digest: str, entries: Callable[[], list[Any]]
    ) -> bool:
        """Load a unit, or compile its entries; whether this kernel then takes the values."""

        def found():
            return any(compiled.takes(values) for compiled in _functions.get(self._name, ()))

        if _load_unit(unit, digest) and found():
            return True
        _loaded.discard(unit)  # made for other records
        require_memory(TO_COMPILE)
        folder = _cache.folder_to_write()
        with _cache.alone(folder, unit):
            if _load_unit(unit, digest) and found():  # another process was quicker
                return True
            try:
                data = emit(unit, entries(), digest, [_objects.target()])[_objects.target()]  # type: ignore[index, list-item]
            except NotDescribedError:
                return False
            _cache.keep(folder, unit, data)
        _add(unit, data, digest)
        return found()

    def _digest(self):
        """Name of the text of all kernels, and of the file of one that lies elsewhere."""
        if self.py_func.__module__.startswith(_PACKAGE):
            return _objects.kernel_digest()
        try:
            text = Path(self.py_func.__code__.co_filename).read_bytes()
        except OSError:  # typed at a prompt
            text = self.py_func.__code__.co_code + repr(self.py_func.__code__.co_consts).encode()
        return hashlib.sha256(_objects.kernel_digest().encode() + text).hexdigest()[:16]

    @functools.cached_property
    def interpreted(self) -> Callable:
        """Return the function as plain Python, which calls other kernels as such."""
        return twin(self.py_func)

    @property
    def dispatcher(self):
        """numba's own object, which is made, and numba imported, when it is first needed."""
        if self._made is None:
            require_memory(TO_COMPILE)
            self._made = _compiler().Kernel(self.py_func, targetoptions=self._options)
        return self._made

    @property
    def part(self):
        """Return what numba compiles into kernels that call this one."""
        return self.dispatcher.part

    @property
    def _numba_type_(self):
        return self.dispatcher._numba_type_


class PlainEntry(Entry):
    """A kernel that Python runs as it is."""

    def __call__(self, *values: Any):
        """Call the function itself."""
        if is_interpreting():
            return self.interpreted(*values)
        return self.py_func(*values)


class BuiltIn(PlainEntry):
    """A function that is compiled to what `_linking` says."""

    @property
    def _numba_type_(self):
        return _compiler().built_in_type(self.__name__)


def _compiler():
    """Return what compiles kernels; numba is imported here.  Raises MissingExtra without it."""
    require_executable_memory()
    try:
        import numba
    except ModuleNotFoundError:
        from ..extras import needed

        numba = needed("numba", "numba", "", "compiling kernels")

    # Loops over three or four numbers gain nothing from vectors, and compilation takes a fifth longer.
    numba.config.LOOP_VECTORIZE = 0  # type: ignore[attr-defined]
    from . import _linking

    return _linking


def unit_entries(unit: str) -> list[tuple[Entry, str, list]]:
    """Return the entries of a unit: kernel, name, parameters."""
    found = []
    for name, parameters in unit_parameters(unit).items():
        module, _, function = name.rpartition(".")
        found.append((getattr(importlib.import_module(_PACKAGE + module), function), name, parameters))
    return found


def emit(unit: str, entries: list, digest: str, targets: list[str]) -> dict[str, bytes]:
    """Return the content of a unit's file for each target."""
    _compiler()
    import llvmlite
    import numba

    from . import _object_code

    machines = {target: PROCESSORS.get(target) or _object_code.this_machine() for target in targets}
    named = [_object_code.Entry(name, kernel, parameters) for kernel, name, parameters in entries]
    with without_collector():  # numba makes cycles by the million, and a tenth of the time went into them
        made = _object_code.emit_object(unit, named, machines)
    words = f"numba {numba.__version__}, llvmlite {llvmlite.__version__}"
    return {
        target: _objects.write(
            {"unit": unit, "digest": digest, "target": target, "compiler": words, "entries": reported}, code
        )
        for target, (reported, code) in made.items()
    }


def package_objects(folder: Path) -> Iterator[Path]:
    """Compile all units for all processors and systems into `folder`, for a wheel; yield each file.

    Those of an earlier build stay until a kernel's text changes; delete them after a change of numba.
    """
    digest = _objects.kernel_digest()
    for unit in UNITS:
        paths = {target: folder / target / f"{unit}{_cache.ENDING}" for target in PROCESSORS}
        missing = [target for target, path in paths.items() if not _objects.is_current(path, digest, target)]
        made = emit(unit, unit_entries(unit), digest, missing) if missing else {}
        for target, content in made.items():
            paths[target].parent.mkdir(parents=True, exist_ok=True)
            paths[target].write_bytes(content)
        yield from paths.values()
