"""The rows of an analysis, for comparison with those of a second formulation."""

from typing import TYPE_CHECKING, Any

from ...errors import Fault, ModelError
from ..outcome import Stop

if TYPE_CHECKING:
    from collections.abc import Iterator


NEARLY_CLOSED = ("SOLVE-080", "SOLVE-082")  # notes on loops that close within their tolerance only


def compared_rows(analysis: Any) -> "Iterator[Any]":
    """Yield the blocks of rows; raises ModelError where an overconstrained loop closes only nearly.

    Each formulation leaves such a gap in other equations, and their motions differ by as much.
    """
    for block in analysis.rows():
        for note in analysis.warnings:
            if note.id in NEARLY_CLOSED:
                message = (
                    f"{note.message}: each formulation leaves it elsewhere, so their motions cannot be "
                    "compared; align the axes of the loop, or replace a joint by one with more freedom"
                )
                raise ModelError([Fault("error", message, note.place, note.subject)])
        yield block
        Stop.raise_if_asked()
