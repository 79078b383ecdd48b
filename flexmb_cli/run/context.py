"""Context of one run: its options, its outcome, and the listener that receives its progress.

Every function between the command and the analysis takes this one record instead of the separate arguments.
"""

from typing import NamedTuple, Protocol

from ..errors import Fault
from .outcome import Listener, Outcome, RunOptions, refuse_warnings


class TextStream(Protocol):
    """Destination of a listing that is not written to a file."""

    def write(self, text: str, /) -> int:
        """Write `text`."""

    def flush(self) -> None:
        """Pass buffered text on."""


class Run(NamedTuple):
    """The context of one deck."""

    outcome: Outcome  # fills while the deck is run
    options: RunOptions  # those of the command
    listener: Listener = Listener()  # receives its progress
    stdout: TextStream | None = None  # receives the listing of `--out -`

    def warn(self, faults: "list[Fault] | tuple[Fault, ...]") -> None:
        """Record warnings; under `--strict` they end the run as errors.  Raises ModelError."""
        self.outcome.faults += faults
        refuse_warnings(self.outcome, self.options)

    @property
    def with_new_outcome(self) -> "Run":
        """The same run with an empty outcome, for a second solution that reports nothing to the user."""
        return self._replace(outcome=Outcome(self.outcome.deck))
