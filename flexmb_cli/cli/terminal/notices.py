"""Notes of a command on the one file that it reads: words on standard error, and an object of `--json`."""

import json
from contextlib import contextmanager
from typing import TYPE_CHECKING, Any

import click

from ...errors import DONE, Fault, compiler_style
from .json_faults import faults_in_json
from .screen import notify
from .wrong_call import WrongCall

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator, Sequence


class Notices:
    """Collected notes on a file, in words unless `quiet`; with `as_json` one object at the end.

    `role` is the key of the file in the object: "deck" or "result".
    """

    def __init__(self, role: str, file: str, quiet: bool, as_json: bool):
        self.about = {role: file}
        self.file, self.quiet, self.as_json = file, quiet, as_json
        self.faults: list[tuple[str, Fault]] = []  # with the file that each is about

    @contextmanager
    def failures(self) -> "Iterator[None]":
        """Failures in here are printed as JSON if wanted, and go on."""
        with faults_in_json(self.as_json, self.about, self.file):
            yield

    def refuse_standard_output(self, output: str) -> None:
        """Raise UsageError where the object and what is written would both go to standard output."""
        if self.as_json and output == "-":
            raise WrongCall("-o - and --json both take standard output; give -o a file", id="CLI-060")

    def add(self, faults: "Iterable[Fault]", file: str = "") -> None:
        """Print notes, of the file that is read if no other is named, and keep them for the object."""
        about = file or self.file
        for fault in faults:
            self.faults.append((about, fault))
            self.say(f"{about}: {fault.severity}: {fault.message}")

    def add_of_deck(self, faults: "Sequence[Fault]", lines: "Sequence[str]") -> None:
        """Print notes on a deck with their places in its `lines`, and keep them for the object."""
        self.faults += [(self.file, fault) for fault in faults]
        if faults and not self.quiet:
            click.echo(compiler_style(self.file, faults, lines), err=True)

    def say(self, sentence: str) -> None:
        """Print a sentence that the object has no need of."""
        if not self.quiet:
            notify(sentence)

    def end(self, **more: Any) -> None:
        """Print the object of a command that is done; `more`: what it has besides the faults."""
        if self.as_json:
            faults = [{"file": file} | fault.as_dict() for file, fault in self.faults]
            record = self.about | {"status": "complete", "exit_code": DONE, "faults": faults} | more
            click.echo(json.dumps(record))
