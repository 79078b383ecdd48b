"""Blocks of report rows are kept one by one; between two of them a run can be stopped."""

from collections.abc import Callable, Iterable

from .outcome import Listener, Outcome, Stop


def keep_blocks(blocks: Iterable, keep: Callable, wanted: int, outcome: Outcome, listener: Listener) -> None:
    """Hand every block to `keep`, which writes it and returns its number of rows.

    Raises what `blocks` and `keep` raise, and KeyboardInterrupt or Terminated before all rows that are
    `wanted` are kept.
    """
    with Stop.released():
        listener.begin(wanted)
        for block in blocks:
            with Stop.later():
                rows = keep(block)
                outcome.rows += rows
                if outcome.rows >= wanted:
                    Stop.too_late()
            listener.advance(rows)
            Stop.heed()
