"""Python's collector of cycles, kept out of where objects are made by the hundred thousand and no cycles."""

import gc
from collections.abc import Iterator
from contextlib import contextmanager


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
