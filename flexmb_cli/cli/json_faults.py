"""What `--json` prints of a command that ended in a fault."""

import json
from contextlib import contextmanager

import click

from ..errors import BAD_INPUT, FlexmbError


@contextmanager
def faults_in_json(wanted: bool, about: dict, file: str):
    """Failures in here are printed as one JSON object if `wanted`, and go on.

    `about` begins the record; `file` is named to blame where a failure names none.
    """
    try:
        yield
    except FlexmbError as failure:
        if wanted:
            click.echo(json.dumps(about | _record(failure, file)))
        raise


def _record(failure, file):
    file = getattr(failure, "name", None) or getattr(failure, "path", None) or file
    return {
        "status": "bad input" if failure.exit_code == BAD_INPUT else "failed",
        "exit_code": failure.exit_code,
        "faults": [{"file": file} | fault.as_dict() for fault in failure.faults],
    }
