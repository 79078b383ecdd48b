"""Saying before it happens that kernels will be compiled: the first run of a version waits for them."""

from .outcome import Listener

_told: set[str] = set()  # entries this process need not look for again: a study asks for every case


def tell_of_compiling(listener: Listener, entry: str) -> None:
    """Notices for the user when the kernel `entry` ("module.function") has to be compiled."""
    if entry in _told:
        return
    _told.add(entry)
    from ..kernels import _jit

    if not _jit.must_compile(entry):
        return
    from ..kernels import _cache

    listener.notice("compiling kernels (once per version, 10 s to a minute)")
    if _cache.folder_to_write() is None:
        listener.notice(
            "no folder to keep compiled kernels in; set NUMBA_CACHE_DIR to one that can be written"
        )
    for sentence in _cache.refused:
        listener.notice(sentence)
