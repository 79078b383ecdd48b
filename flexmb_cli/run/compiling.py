"""Saying before it happens that kernels will be compiled: the first run of a version waits for them."""

from .outcome import Listener

_ready: set[str] = set()  # entries this process need not look for again: a study asks for every case


def tell_of_compiling(listener: Listener, entry: str) -> None:
    """Notices for the user when the kernel `entry` ("module.function") is not in the cache, or none lasts."""
    if entry in _ready:
        return
    from ..kernels import _jit

    if _jit.Cache.must_compile(entry):
        listener.notice("compiling kernels (once per version, 20 s to two minutes)")
    else:
        _ready.add(entry)
    if not _jit.Cache.lasting:
        listener.notice(
            "no folder to keep compiled kernels in; set NUMBA_CACHE_DIR to one that can be written"
        )
