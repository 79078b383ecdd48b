"""Blocks of report rows are kept one by one; between two of them a run can be stopped."""

from collections.abc import Callable, Iterable
from contextlib import ExitStack

from .outcome import Listener, Outcome, Stop


def keep_blocks(
    blocks: Iterable, keep: Callable, wanted: int, outcome: Outcome, listener: Listener, complete: ExitStack
) -> None:
    """Hand every block to `keep`, which writes it and returns its number of rows.

    Once all rows that are `wanted` are kept a stop comes too late, and waits until `complete` is closed.
    Raises what `blocks` and `keep` raise, and KeyboardInterrupt or Terminated.
    """
    Stop.heed()
    listener.begin(wanted)
    for block in blocks:
        with Stop.later():
            rows = keep(block)
            outcome.rows += rows
            if outcome.rows >= wanted:
                complete.enter_context(Stop.later())
        listener.advance(rows)
        Stop.heed()
