"""Files of compiled kernels: an object for the linker, behind lines with its checksum and what it holds.

Objects are the same wherever they lie, in the package or in the user's cache, and whichever numba made them.
On x86-64 Linux `_elf_loader` loads them, elsewhere llvmlite; numba is not imported for it.
"""

import contextlib
import ctypes
import functools
import hashlib
import json
import os
import struct
import sys
import threading
from pathlib import Path
from typing import TYPE_CHECKING, Any

from ..memory import TO_LOAD, require_executable_memory, require_memory
from ._arguments import Results, Words, key_of
from .signatures import RECORDS, TUPLES

if TYPE_CHECKING:
    from collections.abc import Iterator


MAGIC = b"flexmb object 1\n"
ENDING = ".object"
# Those of a wheel, a folder for each target.  Their owner and mode are not checked, only their checksum:
# whoever can write there can change the Python files beside them, too.
PACKAGED = Path(__file__).parent / "objects"
_PROCESSORS = {"x86_64": "x86_64", "AMD64": "x86_64", "aarch64": "arm64", "arm64": "arm64", "ARM64": "arm64"}
_SYSTEMS = {"linux": "linux", "darwin": "macos", "win32": "windows"}
# What objects may call; LLVM replaces some of it, as sin and cos together by sincos.
OF_C = frozenset(
    ("malloc", "free", "memset", "memcpy", "memmove", "sin", "cos", "tan", "asin", "acos", "atan", "atan2")
    + ("sinh", "cosh", "tanh", "exp", "log", "log10", "pow", "sqrt", "fmod", "floor", "ceil", "rint")
    + ("hypot",)
)
_LOADING = ("_cache.py", "_elf_loader.py", "_entry.py", "_objects.py")
# Checks of bounds are other code under the same name.
CHECKED = os.environ.get("NUMBA_BOUNDSCHECK", "0") not in ("", "0")


class DamagedError(Exception):
    """A file that is no whole object."""


class OtherKernelsError(Exception):
    """A whole object of another version of the kernels, or for another target."""


def target() -> str | None:
    """Return processor and system of this process, None where words are shorter than addresses are here."""
    machine = os.environ.get("PROCESSOR_ARCHITECTURE", "") if sys.platform == "win32" else os.uname().machine
    if sys.maxsize < 2**32:
        return None
    return f"{_PROCESSORS.get(machine, machine)}-{_SYSTEMS.get(sys.platform, sys.platform)}"


@functools.cache
def kernel_digest() -> str:
    """Return a name for the text of all kernels.

    A kernel depends on what it calls and on constants of other files: one changed text makes all others.  It
    also depends on the order of fields in the records and tuples that it is given, some of which the model
    defines.  What only finds and loads objects has no part in them.
    """
    return digest_of(os.path.dirname(os.path.dirname(__file__)))


def digest_of(package: str) -> str:
    """Return the name for the kernels' text in the folder `package`, a flexmb_cli."""
    digest = hashlib.sha256(b"checked" if CHECKED else b"")
    kernels = os.path.join(package, "kernels")
    for path in sorted(_texts(kernels), key=lambda path: path.split(os.sep)):
        digest.update(path[len(kernels) + 1 :].replace(os.sep, "/").encode())
        digest.update(_bytes_of(path))
    places = [*RECORDS.values(), *(place for place, _ in TUPLES.values())]
    for definition in _model_definitions(package, places):
        digest.update(definition)
    return digest.hexdigest()[:16]


def _model_definitions(package: str, places: list[str]) -> "Iterator[bytes]":
    """Yield the texts that define those of the records and tuples at `places` that are the model's.

    Importing them would cost a run modules of other analyses, and hashing their files would compile all
    kernels anew for each edit of what fills them.
    """
    texts: dict[str, bytes] = {}
    for module, _, name in (place.partition(":") for place in places):
        if not module.startswith("kernels."):
            if module not in texts:
                texts[module] = _bytes_of(os.path.join(package, *module.split(".")) + ".py")
            yield _definition(texts[module], name.encode())


def _definition(text: bytes, name: bytes) -> bytes:
    """Return the text of a record, up to its closing bracket, or of a class, up to two blank lines."""
    for start, end in ((b"\n%s = " % name, b"\n)\n"), (b"\nclass %s(" % name, b"\n\n\n")):
        if start in text:
            return start + text.partition(start)[2].partition(end)[0]
    raise KeyError(name)


def _bytes_of(path: str) -> bytes:
    with open(path, "rb") as file:
        return file.read()


def _texts(folder: str) -> "Iterator[Any]":
    """Paths of the files of Python that the kernels consist of."""
    for found in os.scandir(folder):
        if found.is_dir():
            yield from _texts(found.path)
        elif found.name.endswith(".py") and found.name not in _LOADING:
            yield found.path


def write(header: dict, code: bytes) -> bytes:
    """Return the content of a file that holds the object `code`."""
    content = json.dumps(header, separators=(",", ":")).encode() + b"\n" + code
    return MAGIC + hashlib.sha256(content).hexdigest().encode() + b"\n" + content


def read(content: bytes) -> tuple[dict, bytes]:
    """Return header and object of a file's content; raises DamagedError."""
    checksum, _, rest = content.removeprefix(MAGIC).partition(b"\n")
    if not content.startswith(MAGIC) or hashlib.sha256(rest).hexdigest().encode() != checksum:
        raise DamagedError
    header, _, code = rest.partition(b"\n")
    return json.loads(header), code


def is_current(path: Path, digest: str, target: str) -> bool:
    """Return whether a whole object of these kernels for this target lies at `path`."""
    try:
        header, _ = read(path.read_bytes())
    except (OSError, ValueError, DamagedError):
        return False
    unit = path.name.removesuffix(ENDING)
    return (header.get("unit"), header.get("digest"), header.get("target")) == (unit, digest, target)


class Compiled:
    """One function of an object, as Python calls it."""

    def __init__(self, address: int, parameters: list, result: "str | list"):
        self.key = key_of(parameters)
        self._kinds = parameters, result
        # The interpreter stays locked, as in a call of numba's.
        self._call = ctypes.PYFUNCTYPE(ctypes.c_int, ctypes.c_void_p, ctypes.c_void_p)(address)
        self._lock = threading.Lock()

    @functools.cached_property
    def _words(self):
        return Words(self._kinds[0])

    @functools.cached_property
    def _results(self):
        return Results(self._kinds[1])

    def takes(self, values: tuple) -> bool:
        """Return whether the values are of the types that it was compiled for."""
        with self._lock:
            return self._words.pack(values)

    def call(self, values: tuple) -> tuple[bool, object]:
        """Return whether it takes such values, and what it returns."""
        with self._lock:
            if not self._words.pack(values):
                return False, None
            if self._call(self._words.address, self._results.address):
                # Kernels raise nothing themselves.
                raise IndexError("an index is out of bounds") if CHECKED else MemoryError
            return True, self._results.value()


_engines: list[Any] = []  # machine code lives as long as they do


def load(content: bytes, unit: str, digest: str) -> dict[str, list[Compiled]]:
    """Return the functions of the object of a unit by name; raises DamagedError and OtherKernelsError."""
    header, code = read(content)
    if header["unit"] != unit:
        raise DamagedError
    if header["digest"] != digest or header["target"] != target():
        raise OtherKernelsError
    require_executable_memory()
    engine = _elf_engine(code) or _llvm_engine(code)
    _engines.append(engine)
    found: dict[str, list[Compiled]] = {}
    for entry in header["entries"]:
        address = engine.get_function_address(entry["symbol"])
        found.setdefault(entry["name"], []).append(Compiled(address, entry["parameters"], entry["result"]))
    return found


def _elf_engine(code: bytes):
    """Return an object of x86-64 Linux in memory, None where only LLVM can load it."""
    if target() != "x86_64-linux":
        return None
    from ._elf_loader import LoadedObject, NotLoadedError

    try:
        return LoadedObject(code)
    except NotLoadedError:
        return None
    except (struct.error, ValueError, IndexError, StopIteration, OverflowError) as fault:
        raise DamagedError from fault


def _llvm_engine(code: bytes):
    require_memory(TO_LOAD)
    import llvmlite.binding as llvm

    with contextlib.suppress(RuntimeError):  # llvmlite may know already
        llvm.initialize_native_target()
        llvm.initialize_native_asmprinter()
    if sys.platform == "win32":
        _name_symbols(llvm)
    machine = llvm.Target.from_default_triple().create_target_machine(opt=0, jit=True)
    engine = llvm.create_mcjit_compiler(llvm.parse_assembly(""), machine)
    try:
        engine.add_object_file(llvm.ObjectFileRef.from_data(code))
    except RuntimeError as fault:
        raise DamagedError from fault
    engine.finalize_object()
    return engine


def _name_symbols(llvm: Any) -> None:
    """Give LLVM the addresses of the C library's functions: on Windows it does not find them by itself."""
    library = ctypes.WinDLL("ucrtbase")  # type: ignore[attr-defined]
    for name in OF_C:
        llvm.add_symbol(name, ctypes.cast(getattr(library, name), ctypes.c_void_p).value)
    checked_stack = ctypes.WinDLL("ntdll").__chkstk  # type: ignore[attr-defined]  # what LLVM calls for large frames
    llvm.add_symbol("__chkstk", ctypes.cast(checked_stack, ctypes.c_void_p).value)
    llvm.add_symbol("_fltused", id(_engines))  # a mark that nothing reads
