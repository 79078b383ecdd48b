"""A kernel as Python calls it: by compiled code, which is loaded or made when it is needed."""

import functools
import hashlib
import importlib
from collections.abc import Callable
from pathlib import Path
from typing import Any

from ..memory import TO_COMPILE, require_executable_memory, require_memory
from . import _cache
from ._arguments import Words, describe, key_of
from ._interpreted import is_interpreting, twin
from ._library import AddressOf, Compiled, in_memory, packaged, target
from .signatures import unit_of, unit_parameters

_PACKAGE = __package__ + "."
_loaded: dict[str, AddressOf] = {}  # by the name of the unit, or of the object of a kernel alone


class Unit:
    """Kernels that are compiled and loaded together: those of a unit of `signatures.py`, or one alone."""

    def __init__(self, unit: str, parameters: dict[str, list] | None = None, kernel: "Entry | None" = None):
        self._unit, self._kernel = unit, kernel
        self._parameters = parameters or unit_parameters(unit)

    @property
    def _mark(self) -> str:
        return self.name if self._kernel else self._unit

    @functools.cached_property
    def name(self) -> str:
        """Name of the object: another one for other parameters, or another text of a kernel elsewhere."""
        key = "".join(f"{name} {list(map(key_of, kinds))}" for name, kinds in self._parameters.items())
        key += self._kernel.own_text if self._kernel else ""
        return f"{self._unit}-{hashlib.sha256(key.encode()).hexdigest()[:12]}"

    def load(self) -> AddressOf | None:
        """Return what finds the functions, in the package's library or an object that was kept."""
        if self._mark not in _loaded:
            library = None if self._kernel else packaged()
            if library is None and (code := _cache.content(self.name)) is not None:
                library = in_memory(code)
            if library is None:
                return None
            _loaded[self._mark] = library
        return _loaded[self._mark]

    def compile(self) -> AddressOf:
        """Compile, keep the object in the user's cache, and return what finds the functions."""
        require_memory(TO_COMPILE)
        folder = _cache.folder_to_write()
        with _cache.alone(folder, self.name):
            library = self.load()  # another process was quicker
            if library is None:
                code = self.emit([target()])[target()]
                library = _loaded[self._mark] = in_memory(code)
                _cache.keep(folder, self.name, code)
        return library

    def emit(self, targets: list[str]) -> dict[str, bytes]:
        """Return the object for each target."""
        _compiler()
        from ._object_code import emit_objects

        entries = {}
        for name, kinds in self._parameters.items():
            module, _, function = name.rpartition(".")
            kernel = self._kernel or getattr(importlib.import_module(_PACKAGE + module), function)
            entries[symbol_of(name)] = kernel.part, kinds
        return emit_objects(self._unit, entries, targets)


def is_ready(name: str) -> bool:
    """Return whether the kernel `name` can be called without compiling it."""
    unit = unit_of(name)
    return unit is not None and Unit(unit).load() is not None


def symbol_of(name: str) -> str:
    """Return the name in the library of an entry."""
    return f"flexmb_{name.replace('.', '_')}"


class Entry:
    """A kernel; `py_func` is the function it was made of."""

    def __init__(self, function: Callable, options: dict):
        self.py_func, self._options = function, options
        self.__name__, self.__doc__ = function.__name__, function.__doc__
        # The module as seen from the kernels.
        self._compiled: list[Compiled] = []
        self._name = f"{function.__module__.removeprefix(_PACKAGE)}.{function.__name__}"

    def __call__(self, *values: Any):
        """Call compiled code; the first call of an entry without any compiles it."""
        if is_interpreting():
            return self.interpreted(*values)
        for compiled in self._compiled:
            fits, result = compiled.call(values)
            if fits:
                return result
        code = self._made_for(values)
        # No compiled code takes, for instance, every other number of a row.
        return code.call(values)[1] if code else self.interpreted(*values)

    def _made_for(self, values: tuple[Any, ...]) -> Compiled | None:
        """Load or compile what takes such values; None where nothing can."""
        unit = unit_of(self._name)
        if unit is not None and Words(unit_parameters(unit)[self._name]).pack(values):
            parameters, unit_of_types = unit_parameters(unit)[self._name], Unit(unit)
        else:
            try:
                parameters = [describe(value) for value in values]
            except TypeError:
                return None
            unit_of_types = Unit(self._name, {self._name: parameters}, self)
        compiled = Compiled(
            unit_of_types.load() or unit_of_types.compile(), symbol_of(self._name), parameters
        )
        self._compiled.insert(0, compiled)
        return compiled

    @property
    def own_text(self) -> str:
        """The text of a kernel that is none of the package's; theirs is in the name of the cache's folder."""
        if self.py_func.__module__.startswith(_PACKAGE):
            return ""
        code = self.py_func.__code__
        path = Path(code.co_filename)  # not there where it was typed at a prompt
        return path.read_text(encoding="utf-8") if path.exists() else f"{code.co_code!r}{code.co_consts!r}"

    @functools.cached_property
    def interpreted(self) -> Callable:
        """Return the function as plain Python, which calls other kernels as such."""
        return twin(self.py_func)

    @functools.cached_property
    def part(self):
        """Return what numba, which is imported only here, compiles into kernels that call this one."""
        require_memory(TO_COMPILE)
        return _compiler().Part(self.py_func, self._options)

    @property
    def _numba_type_(self):
        return self.part._numba_type_


class PlainEntry(Entry):
    """A kernel that Python runs as it is."""

    def __call__(self, *values: Any):
        """Call the function itself."""
        if is_interpreting():
            return self.interpreted(*values)
        return self.py_func(*values)


class BuiltIn(PlainEntry):
    """A function that is compiled to what `_values` says."""

    @property
    def _numba_type_(self):
        _compiler()
        from ._values import built_in_type

        return built_in_type(self.__name__)


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
