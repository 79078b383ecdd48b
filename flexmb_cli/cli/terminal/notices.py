"""Notes of a command on the one file that it reads: words on standard error, and an object of `--json`."""

import json
from collections.abc import Iterable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from typing import Any

import click

from ...errors import BAD_INPUT, DONE, INTERNAL_FAULT, Fault, FlexmbError, compiler_style
from ...run.outcome import INTERRUPTED, TERMINATED
from .screen import WrongCall, notify, say

STATUS = {BAD_INPUT: "bad input", INTERNAL_FAULT: "internal fault"}
STATUS |= dict.fromkeys((INTERRUPTED, TERMINATED), "interrupted")


@contextmanager
def faults_in_json(as_json: bool, about: dict[str, Any], file: str) -> Iterator[None]:
    """Failures in here are printed as one JSON object if `as_json`, and go on.

    `about` begins the record; `file` is named to blame where a failure names none.
    """
    try:
        yield
    except FlexmbError as failure:
        if as_json:
            blamed = None if failure.of_the_call else failure.file or file
            print_record(failure.exit_code, failure.faults, blamed, about)
            failure.printed = True
        raise


def wants_json(commands: Mapping[str, Any], arguments: list[str]) -> bool:
    """Return whether the command line asks for JSON of a command that has it; it may be wrong otherwise."""
    options = arguments[: arguments.index("--")] if "--" in arguments else arguments
    command = commands.get(next((word for word in options if word in commands), ""))
    return "--json" in options and any("--json" in option.opts for option in getattr(command, "params", ()))


def print_record(
    exit_code: int,
    faults: tuple[Fault, ...],
    file: str | None = None,
    about: dict[Any, Any] | tuple[Any, ...] = (),
) -> None:
    """One JSON object on standard output: `about`, the status in a word, and the faults of `file`."""
    record = {
        "status": STATUS.get(exit_code, "failed"),
        "exit_code": exit_code,
        "faults": [{"file": file} | fault.as_dict() for fault in faults],
    }
    click.echo(json.dumps(dict(about) | record))


class Notices:
    """Collected notes on a file, in words unless `quiet`; with `as_json` one object at the end.

    `role` is the key of the file in the object: "deck" or "result".
    """

    def __init__(self, role: str, file: str, quiet: bool, as_json: bool):
        self.about = {role: file}
        self.file, self.quiet, self.as_json = file, quiet, as_json
        self.faults: list[tuple[str, Fault]] = []  # with the file that each is about
        self.lines: Sequence[str] = ()  # of the deck

    @contextmanager
    def failures(self) -> Iterator[None]:
        """Failures in here are printed as JSON if wanted, and go on."""
        with faults_in_json(self.as_json, self.about, self.file):
            yield

    def refuse_standard_output(self, output: str) -> None:
        """Raise UsageError where the object and what is written would both go to standard output."""
        if self.as_json and output == "-":
            raise WrongCall("-o - and --json both take standard output; give -o a file", id="CLI-060")

    def add(self, faults: Iterable[Fault], file: str = "") -> None:
        """Print notes, of the file that is read if no other is named, and keep them for the object."""
        about = file or self.file
        for fault in faults:
            self.faults.append((about, fault))
            self.say(f"{about}: {fault.severity}: {fault.message}")

    def add_of_deck(self, faults: Sequence[Fault], lines: Sequence[str], file: str = "") -> None:
        """Print notes on a deck with their places in its `lines`, and keep them for the object."""
        about = file or self.file
        self.faults += [(about, fault) for fault in faults]
        self.lines = lines
        if faults and not self.quiet:
            say(compiler_style(about, faults, lines))

    def say(self, sentence: str) -> None:
        """Print a sentence that the object has no need of."""
        if not self.quiet:
            notify(sentence)

    def end(self, status: str = "complete", exit_code: int = DONE, **more: Any) -> None:
        """Print the object of a command that has ended; `more`: what it has besides the faults."""
        if self.as_json:
            faults = [{"file": file} | fault.as_dict(self.lines) for file, fault in self.faults]
            record = self.about | {"status": status, "exit_code": exit_code, "faults": faults} | more
            click.echo(json.dumps(record))
