"""Compiled kernels as Python calls them: functions of a shared library, or of an object in memory.

A wheel has one library for each processor and system, with all entries of `signatures.py`; the system loads
it as any other, and no memory is made executable.  Elsewhere LLVM, which has compiled them, loads objects.
"""

import ctypes
import functools
import os
import sys
import threading
from collections.abc import Callable
from pathlib import Path

from ..memory import TO_LOAD, require_executable_memory, require_memory
from ._arguments import Results, Words

# Their owner and mode are not checked: whoever can write there can change the Python files beside them, too.
PACKAGED = Path(__file__).parent / "libraries"
# Checks of bounds are other code under the same name, which no wheel has.
CHECKED = os.environ.get("NUMBA_BOUNDSCHECK", "0") not in ("", "0")
_PROCESSORS = {"AMD64": "x86_64", "aarch64": "arm64", "ARM64": "arm64"}
_SYSTEMS = {"darwin": "macos", "win32": "windows"}
_ENDINGS = {"linux": "so", "macos": "dylib", "windows": "dll"}
AddressOf = Callable[[str], int]  # of a symbol; ValueError where there is none

unusable: list[str] = []  # why libraries and objects were not used, and what becomes of it


def note_once(sentences: list[str], sentence: str) -> None:
    """Add a sentence to those that are shown."""
    if sentence not in sentences:
        sentences.append(sentence)


def target() -> str:
    """Return processor and system of this process."""
    machine = os.environ.get("PROCESSOR_ARCHITECTURE", "") if sys.platform == "win32" else os.uname().machine
    return f"{_PROCESSORS.get(machine, machine)}-{_SYSTEMS.get(sys.platform, sys.platform)}"


def library_name(target: str) -> str:
    """Return the name of the library of a wheel for processor and system."""
    return f"{target}.{_ENDINGS.get(target.partition('-')[2], 'so')}"


@functools.cache
def packaged() -> AddressOf | None:
    """Return what finds the functions of the package's library; None without one that can be used."""
    if CHECKED or not PACKAGED.is_dir():
        return None
    path = PACKAGED / library_name(target())
    if not path.exists():
        note_once(unusable, f"the package has no kernels for {target()}: they are compiled, once per version")
        return None
    try:
        # The interpreter stays locked, as in a call of numba's.
        library = ctypes.PyDLL(str(path))
    except OSError as fault:
        note_once(unusable, f"{path} cannot be loaded ({fault}): kernels are compiled; reinstall flexmb")
        return None
    return lambda symbol: ctypes.addressof(ctypes.c_char.in_dll(library, symbol))


def in_memory(code: bytes) -> AddressOf:
    """Return what finds the functions of an object, loaded by LLVM; raises RuntimeError where it is none."""
    require_executable_memory()
    require_memory(TO_LOAD)
    import llvmlite.binding as llvm

    try:
        llvm.initialize_native_target()
        llvm.initialize_native_asmprinter()
    except RuntimeError:  # llvmlite has already
        pass
    if sys.platform == "win32":
        for library in ("ucrtbase", "ntdll"):
            llvm.load_library_permanently(library)
        llvm.add_symbol("_fltused", id(unusable))  # a mark that nothing reads
    machine = llvm.Target.from_default_triple().create_target_machine(opt=0, jit=True)
    engine = llvm.create_mcjit_compiler(llvm.parse_assembly(""), machine)
    engine.add_object_file(llvm.ObjectFileRef.from_data(code))
    engine.finalize_object()
    return engine.get_global_value_address


class Compiled:
    """One compiled function."""

    def __init__(self, address_of: AddressOf, symbol: str, parameters: list):
        self._code = address_of  # machine code lives as long as its engine does, which this holds
        self._words = Words(parameters)
        self._results = Results(ctypes.string_at(address_of(f"{symbol}_result")).decode())
        self._call = ctypes.PYFUNCTYPE(ctypes.c_int, ctypes.c_void_p, ctypes.c_void_p)(address_of(symbol))
        self._lock = threading.Lock()

    def call(self, values: tuple) -> tuple[bool, object]:
        """Return whether it takes such values, and what it returns."""
        with self._lock:
            if not self._words.pack(values):
                return False, None
            if self._call(self._words.address, self._results.address):
                # Kernels raise nothing themselves.
                raise IndexError("an index is out of bounds") if CHECKED else MemoryError
            return True, self._results.value()
