"""Saying before it happens that kernels will be compiled: the first run of a version waits for them."""

from .outcome import Listener


def tell_of_compiling(listener: Listener, entry: str) -> None:
    """Notices for the user when the kernel `entry` ("module.function") is not in the cache, or none lasts."""
    from ..kernels import _jit

    if _jit.Cache.must_compile(entry):
        listener.notice("compiling kernels (once per version, 20 s to a minute)")
    if not _jit.Cache.lasting:
        listener.notice(
            "no folder to keep compiled kernels in; set NUMBA_CACHE_DIR to one that can be written"
        )
