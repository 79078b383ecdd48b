"""The rows of an analysis, for comparison with those of a second formulation."""

from typing import TYPE_CHECKING, Any

from ...errors import Fault, ModelError
from ..outcome import Stop

if TYPE_CHECKING:
    from collections.abc import Iterator


def compared_rows(analysis: Any) -> "Iterator[Any]":
    """Yield the blocks of rows; raises ModelError where an overconstrained loop closes only nearly.

    Each formulation leaves such a gap in other equations, and their motions differ by as much.
    """
    for block in analysis.rows():
        if note := getattr(analysis, "loop_note", None):
            message = (
                f"{note.message}: each formulation leaves it elsewhere, so their motions cannot be "
                "compared; align the axes of the loop, or replace a joint by one with more freedom"
            )
            raise ModelError([Fault("error", message, note.place, note.subject, id="RUN-034")])
        yield block
        Stop.raise_if_asked()
