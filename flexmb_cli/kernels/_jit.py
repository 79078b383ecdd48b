"""One home for numba's options and for the place where compiled kernels are cached.

`check` and other commands that only look at a deck call `interpret()` first: the same kernels then
run as plain Python on numpy arrays, and numba is never imported.
"""

import contextlib
import functools
import hashlib
import os
import pickle
import stat
import tempfile
import zlib
from pathlib import Path

from ..memory import TO_COMPILE, TO_LOAD, require_memory

OPTIONS = {"error_model": "numpy", "no_cfunc_wrapper": True}

_interpreted = os.environ.get("NUMBA_DISABLE_JIT", "0") not in ("", "0")


def interpret() -> None:
    """Leave the kernels that are imported from now on uncompiled."""
    global _interpreted
    _interpreted = True


def interpreted() -> bool:
    """Whether kernels run as plain Python."""
    return _interpreted


def _kernel_digest() -> str:
    """Name of the text and place of every kernel file.

    numba notices an edit in the file it compiled, but neither in the files that file calls
    (numba#1833) nor in imported constants: one changed kernel selects a new directory for all.  The
    same kernels elsewhere are others to numba.
    """
    here = Path(__file__).parent
    digest = hashlib.sha256(os.fsencode(here))
    for path in sorted(here.rglob("*.py")):
        digest.update(path.name.encode())
        digest.update(path.read_bytes())
    # Bounds-checked code is other code under the same signature.
    digest.update(os.environ.get("NUMBA_BOUNDSCHECK", "").encode())
    return digest.hexdigest()[:12]


def _cache_bases():
    for name, below in (
        ("NUMBA_CACHE_DIR", ""),
        ("XDG_CACHE_HOME", ""),
        ("LOCALAPPDATA", ""),
        ("HOME", ".cache"),
    ):
        base = os.environ.get(name)
        if base:
            yield Path(base) / below

    private = _private_folder()
    if private is not None:
        yield private


def _private_folder() -> Path | None:
    """A folder of this user's own among the temporary files, for systems without a home.

    Compiled kernels are code: a folder that others may write to is not used.
    """
    if not hasattr(os, "getuid"):
        return None
    folder = Path(tempfile.gettempdir()) / f"flexmb-{os.getuid()}"
    try:
        folder.mkdir(mode=0o700, exist_ok=True)
        found = folder.lstat()
    except OSError:
        return None
    mine = stat.S_ISDIR(found.st_mode) and found.st_uid == os.getuid() and not found.st_mode & 0o022
    return folder if mine else None


def _cache_folder() -> tuple[Path, bool]:
    """A writable folder for compiled kernels, and whether it will be there next time.

    numba itself fails at import when it finds no writable place (numba#5566).
    """
    for base in _cache_bases():
        folder = base / "flexmb" / f"kernels-{_kernel_digest()}"
        try:
            folder.mkdir(parents=True, exist_ok=True)
            tempfile.TemporaryFile(dir=folder).close()
        except OSError:
            continue
        return folder, True
    return Path(tempfile.mkdtemp(prefix="flexmb-")), False


class Cache:
    """Where compiled kernels lie; filled when the first kernel is decorated."""

    folder: Path | None = None
    lasting = True

    @classmethod
    def must_compile(cls, name: str) -> bool:
        """Whether the kernel `name` ("module.function") has to be compiled before its first call."""
        return cls.folder is not None and not any(cls.folder.glob(f"**/{name}-*.nbi"))


def _compiling_alone(dispatcher):
    """Have `dispatcher` compiled by one of several first runs; the others wait and find it in the cache."""
    function, compile_now = dispatcher.py_func, dispatcher.compile
    name = f"{function.__module__.rpartition('.')[2]}.{function.__name__}"

    def compile_once(signature):
        if not Cache.must_compile(name):
            require_memory(TO_LOAD)
            return compile_now(signature)
        require_memory(TO_COMPILE)
        with _lock(Cache.folder / f"{name}.lock"):
            return compile_now(signature)

    dispatcher.compile = compile_once
    return dispatcher


@contextlib.contextmanager
def _lock(path: Path):
    try:
        import fcntl
    except ImportError:  # no such locks here: everyone compiles
        yield
        return
    with contextlib.ExitStack() as opened:
        # Where the folder has vanished or became unwritable, everyone compiles, too.
        with contextlib.suppress(OSError):
            fcntl.flock(opened.enter_context(open(path, "w")), fcntl.LOCK_EX)
        yield


@functools.cache
def _kept_kernel():
    """numba's cache of one kernel, which neither damage nor the loss of its folder can stop.

    numba itself would raise what unpickling raises, and run whatever machine code still unpickles.
    """
    from numba.core.caching import FunctionCache, IndexDataCacheFile

    class CheckedFiles(IndexDataCacheFile):
        def _dump(self, obj):
            data = super()._dump(obj)
            return _checksum(data) + data

        def _load_index(self):
            # Damaged bytes can raise anything when they are unpickled.
            with contextlib.suppress(Exception), open(self._index_path, "rb") as file:
                if pickle.load(file) == self._version:
                    stamp, overloads = pickle.loads(_intact(file.read()))
                    return overloads if stamp == self._source_stamp else {}
            return {}

        def _load_data(self, name):
            with open(self._data_path(name), "rb") as file:
                return pickle.loads(_intact(file.read()))

    class KeptKernel(FunctionCache):
        def __init__(self, function):
            super().__init__(function)
            stamp = self._impl.locator.get_source_stamp()
            self._cache_file = CheckedFiles(self._cache_path, self._impl.filename_base, stamp)

        def _guard_against_spurious_io_errors(self):
            # A kernel that cannot be kept, or is gone, is compiled: the cache only saves time.
            return contextlib.suppress(OSError)

    return KeptKernel


def _checksum(data):
    return zlib.crc32(data).to_bytes(4, "little")


def _intact(content):
    """What stands behind its checksum; numba takes the OSError of a damaged file for a missing one."""
    if _checksum(content[4:]) != content[:4]:
        raise OSError("damaged")
    return content[4:]


@functools.cache
def _compiled():
    """What makes a compiled kernel of a function; numba is imported here, and told where to keep kernels."""
    Cache.folder, Cache.lasting = _cache_folder()
    before = os.environ.get("NUMBA_CACHE_DIR")
    os.environ["NUMBA_CACHE_DIR"] = str(Cache.folder)  # read when numba is imported
    import numba

    numba.config.CACHE_DIR = str(Cache.folder)  # if something imported numba before us
    # Loops over three or four numbers gain nothing from vectors, and compilation takes a fifth longer.
    numba.config.LOOP_VECTORIZE = 0
    if before is None:
        del os.environ["NUMBA_CACHE_DIR"]
    else:
        os.environ["NUMBA_CACHE_DIR"] = before
    from ._linking import Kernel

    return Kernel


def kernel(function, **options):
    """Compile `function` with numba, or leave it alone when kernels are interpreted."""
    if _interpreted:
        return function
    compiled = _compiled()(function, targetoptions=OPTIONS | options)
    # numba raises RuntimeError where it finds no folder that can be written: then nothing is kept.
    with contextlib.suppress(RuntimeError):
        compiled._cache = _kept_kernel()(function)
    return _compiling_alone(compiled)


def part(function):
    """A kernel that is forced into its callers: for inner loops, where handing over arrays counts.

    LLVM would leave some apart, and Kane's recursion a third slower; elsewhere that is as quick.
    """
    return kernel(function, forceinline=True)
