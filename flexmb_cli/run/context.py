"""Context of one run from beginning to end: its options, its outcome, and the listener to its progress."""

from typing import NamedTuple, Protocol

from ..errors import Fault
from .outcome import Listener, Outcome, RunOptions, refuse_warnings


class TextStream(Protocol):
    """Destination of a listing that is not kept in a file."""

    def write(self, text: str, /) -> int:
        """Write `text`."""

    def flush(self) -> None:
        """Hand what is buffered to the reader."""


class Run(NamedTuple):
    """The context of one deck."""

    outcome: Outcome  # fills while the deck is run
    options: RunOptions  # those of the command
    listener: Listener = Listener()  # receives its progress
    stdout: TextStream | None = None  # receives the listing of `--out -`

    def warn(self, faults: "list[Fault] | tuple[Fault, ...]") -> None:
        """Record doubts; under `--strict` they end the run as errors.  Raises ModelError."""
        self.outcome.faults += faults
        refuse_warnings(self.outcome, self.options)

    @property
    def unheard(self) -> "Run":
        """The same run once more, with an outcome of its own."""
        return self._replace(outcome=Outcome(self.outcome.deck))
