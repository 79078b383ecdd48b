"""Last lines of a command on many decks: how many passed, and the first error of each that failed."""

import os
import time
from collections.abc import Sequence

import click

from ...errors import DONE, Fault, visible
from ...run.outcome import Outcome


class ClosingLines:
    """Outcomes of `count` decks; `passed` is the word for one that did what the command asks."""

    def __init__(self, count: int, passed: str):
        self.count, self.passed = count, passed
        self.begin = time.perf_counter()
        self.failures: list[str] = []
        self.done = 0

    def add(self, outcome: Outcome) -> None:
        """Count the outcome of a deck."""
        if outcome.exit_code == DONE:
            self.done += 1
            return
        error = next((fault.message for fault in outcome.faults if fault.severity == "error"), "interrupted")
        self.failures.append(f"  {visible(outcome.deck)}: {visible(error)}")

    def show(self) -> None:
        """Print the lines on standard error; none for a single deck."""
        if self.count < 2:
            return
        seconds = time.perf_counter() - self.begin
        head = f"{self.count} decks: {self.done} {self.passed}, {len(self.failures)} failed; {seconds:.1f} s"
        click.echo("\n".join([head, *self.failures]), err=True)


def annotations(deck: str, faults: Sequence[Fault]) -> str:
    """Return the lines that mark faults in the files of a pull request; "" outside jobs of GitHub."""
    if os.environ.get("GITHUB_ACTIONS") != "true":
        return ""
    return "".join(f"{_annotation(deck, fault)}\n" for fault in faults)


def _annotation(deck: str, fault: Fault) -> str:
    severity = fault.severity if fault.severity in ("error", "warning") else "notice"
    properties: dict[str, str] = {"file": deck, "title": fault.id or "flexmb"}
    if fault.place is not None:
        properties |= {"line": str(fault.place.line), "col": str(fault.place.column)}
    named = ",".join(f"{key}={_escaped(value, ':,')}" for key, value in properties.items())
    return f"::{severity} {named}::{_escaped(fault.sentence)}"


def _escaped(text: str, more: str = "") -> str:
    """Return `text` as a workflow command takes it: percent signs, ends of lines and `more` as numbers."""
    special: dict[str, str | int | None] = {letter: f"%{ord(letter):02X}" for letter in "%\r\n" + more}
    return text.translate(str.maketrans(special))
