"""Want of memory: foreseen before libraries fail of it, and distinguished from other faults afterwards."""

import errno
import functools
import gc
import math
import mmap
import os
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from typing import TYPE_CHECKING, Any

from .errors import ANALYSIS_FAILED, FlexmbError

if TYPE_CHECKING:
    import numpy as np

try:
    # Here, because where memory is short it could not be loaded any more.
    import resource
except ImportError:  # no such limits on this system
    resource = None  # type: ignore[assignment]

LACK_OF_MEMORY = "not enough memory (`ulimit -v` shows a limit)"
# Bytes of addresses that kernels may need: libraries and their buffers, and LLVM at work.
TO_LOAD, TO_COMPILE = 2**27, 2**29
SMALLEST_PAGED = 2**22  # bytes: those of which numpy asks for huge pages
# HDF5's own word, in an OSError without a number.
_OF_HDF5 = "memory allocation failed"


def paged_zeros(shape: tuple[int, ...], dtype: "type[Any]" = float) -> "np.ndarray":
    """Return zeros of which only the pages that are written take memory.

    numpy asks the system for huge pages, of which a matrix of a few entries a row touches all.
    """
    import numpy as np

    size = math.prod(shape) * np.dtype(dtype).itemsize
    if size < SMALLEST_PAGED or not hasattr(mmap, "MAP_PRIVATE"):
        return np.zeros(shape, dtype)
    pages = mmap.mmap(-1, size, flags=mmap.MAP_PRIVATE | mmap.MAP_ANONYMOUS)
    return np.frombuffer(pages, dtype).reshape(shape)


def require_memory(size: int) -> None:
    """Raise MemoryError where a limit of the process leaves less than `size` bytes of addresses.

    Short of memory OpenBLAS asks for its buffers without end, and LLVM ends the process.
    """
    if resource and resource.getrlimit(resource.RLIMIT_AS)[0] != resource.RLIM_INFINITY:
        try:
            mmap.mmap(-1, size).close()
        except OSError as fault:
            raise MemoryError(f"{size // 2**20} MB of addresses are needed") from fault


class ForbiddenMemory(FlexmbError):
    """The system lets no program make code (exit 1)."""

    exit_code = ANALYSIS_FAILED


@functools.cache
def require_executable_memory() -> None:
    """Raise ForbiddenMemory where the system lets no memory become executable: LLVM would crash there."""
    if sys.platform != "linux":
        return
    import ctypes

    page = mmap.mmap(-1, mmap.PAGESIZE, mmap.MAP_PRIVATE | mmap.MAP_ANONYMOUS)
    page[0] = 1  # SELinux distinguishes pages that were written
    place = ctypes.c_void_p(ctypes.addressof(ctypes.c_char.from_buffer(page)))
    rights = mmap.PROT_READ | mmap.PROT_EXEC
    if ctypes.CDLL(None, use_errno=True).mprotect(place, ctypes.c_size_t(mmap.PAGESIZE), rights):
        message = (
            "the system forbids executable memory, which compiled kernels need (mprotect: "
            f"{os.strerror(ctypes.get_errno())}); allow it (systemd: MemoryDenyWriteExecute=no, SELinux: "
            "execmem), or set NUMBA_DISABLE_JIT=1, which is many times slower"
        )
        raise ForbiddenMemory(message, id="FLEXMB-008")


def lacks_memory(fault: BaseException) -> bool:
    """Return whether it is what numpy, HDF5, imports and llvmlite raise where memory is short."""
    if isinstance(fault, OSError):
        return fault.errno is None or file_lacks_memory(fault)
    if isinstance(fault, SystemError):
        # Libraries in C end so, too, where they ask for memory and do not look whether they got it.
        return not _is_there(TO_COMPILE)
    return isinstance(fault, (MemoryError, ImportError)) and not isinstance(fault, ModuleNotFoundError)


def file_lacks_memory(fault: OSError) -> bool:
    """Return whether it is what the system, or HDF5, raises of a file where memory is short."""
    return fault.errno == errno.ENOMEM or _OF_HDF5 in str(fault)


def lack_of_memory_text(fault: BaseException) -> str:
    """The sentence for a `fault` that `lacks_memory`: what a library says may be another thing after all."""
    if isinstance(fault, ImportError) or (isinstance(fault, OSError) and fault.errno is None):
        return f"a library cannot be loaded, for want of memory or a broken installation: {fault}"
    return LACK_OF_MEMORY


def _is_there(size: int) -> bool:
    try:
        require_memory(size)
    except MemoryError:
        return False
    return True


@contextmanager
def without_collector() -> Iterator[None]:
    """Have cycles left alone for a while: looking for them among many objects doubles some times."""
    enabled = gc.isenabled()
    gc.disable()
    try:
        yield
    finally:
        if enabled:
            gc.enable()


@contextmanager
def with_present_objects_frozen() -> Iterator[None]:
    """Have the collector look through new objects only, for a while; what a program froze itself stays so.

    Freezing sets the collector's counts back, so that what is new is looked through at the end: many short
    blocks, one after the other, would otherwise never have their cycles collected.
    """
    frozen = gc.get_freeze_count()
    gc.freeze()
    try:
        yield
    finally:
        gc.collect()
        if not frozen:
            gc.unfreeze()
