"""What one run has from beginning to end: its options, what becomes of it, and who hears how far it is."""

from typing import NamedTuple, TextIO

from ..errors import Fault
from .outcome import Listener, Outcome, RunOptions, refuse_warnings


class Run(NamedTuple):
    """The context of one deck."""

    outcome: Outcome  # fills while the deck is run
    options: RunOptions  # what is asked of it
    listener: Listener = Listener()  # hears how far it is
    stdout: TextIO | None = None  # receives the listing of `--out -`

    def warn(self, faults: "list[Fault] | tuple[Fault, ...]") -> None:
        """Tell of doubts; under `--strict` they end the run as errors.  Raises ModelError."""
        self.outcome.faults += faults
        refuse_warnings(self.outcome, self.options)

    @property
    def unheard(self) -> "Run":
        """The same run once more, with an outcome of its own."""
        return self._replace(outcome=Outcome(self.outcome.deck))
