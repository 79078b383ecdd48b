"""JSON output of a command that ended in a fault."""

import json
from collections.abc import Mapping
from contextlib import contextmanager
from typing import TYPE_CHECKING, Any

import click

from ...errors import BAD_INPUT, INTERNAL_FAULT, Fault, FlexmbError
from ...run.outcome import INTERRUPTED, TERMINATED

if TYPE_CHECKING:
    from collections.abc import Iterator


STATUS = {BAD_INPUT: "bad input", INTERNAL_FAULT: "internal fault"}
STATUS |= dict.fromkeys((INTERRUPTED, TERMINATED), "interrupted")


@contextmanager
def faults_in_json(wanted: bool, about: dict[str, Any], file: str) -> "Iterator[None]":
    """Failures in here are printed as one JSON object if `wanted`, and go on.

    `about` begins the record; `file` is named to blame where a failure names none.
    """
    try:
        yield
    except FlexmbError as failure:
        if wanted:
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
    about: "dict[Any, Any] | tuple[Any, ...]" = (),
) -> None:
    """One JSON object on standard output: `about`, the status in a word, and the faults of `file`."""
    record = {
        "status": STATUS.get(exit_code, "failed"),
        "exit_code": exit_code,
        "faults": [{"file": file} | fault.as_dict() for fault in faults],
    }
    click.echo(json.dumps(dict(about) | record))
