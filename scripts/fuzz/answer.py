"""One command on one damaged input: its exit code, and what a user must never see."""

import contextlib
import io
import os
import re
import sys
import traceback
import warnings
from dataclasses import dataclass

import click

from flexmb_cli.cli import cli
from flexmb_cli.errors import BAD_INPUT, DONE, FlexmbError, visible

# What a terminal would obey: C0 without tab and line end, DEL, C1.
CONTROL = re.compile(r"[\x00-\x08\x0b-\x1f\x7f-\x9f\u2028\u2029\u202a-\u202e\u2066-\u2069]")
NO_CONSTANTS = ("None:", "<class ", "object at 0x", "Traceback")


@dataclass(frozen=True)
class Answer:
    """Exit code (None: a traceback), what was printed, and the fault of flexmb, "" for none."""

    code: int | None
    output: str
    errors: str
    fault: str = ""


def answered(arguments: list[str], typed: bytes = b"") -> Answer:
    """Run `flexmb ARGUMENTS` in this process, as `flexmb_cli.cli.main` does, with `typed` as input."""
    streams = _Streams(typed)
    fault = ""
    with streams, warnings.catch_warnings():
        warnings.simplefilter("error")
        try:
            code = _code_of(arguments)
        except Exception:
            code, fault = None, traceback.format_exc()
    output, errors = streams.texts
    return Answer(code, output, errors, fault or _unfit(code, output, errors))


def _code_of(arguments):
    """The exit code; whatever `main` calls a fault of flexmb itself is raised."""
    try:
        cli.main(arguments, standalone_mode=False, prog_name="flexmb")
    except SystemExit as ending:
        return ending.code
    except click.exceptions.Exit as ending:
        return ending.exit_code
    except click.Abort:
        return 130
    except click.ClickException as refusal:
        refusal.message = visible(refusal.message)
        refusal.show()
        return BAD_INPUT
    except FlexmbError as failure:
        for fault in failure.faults:
            click.echo(f"flexmb: {fault.severity}: {visible(fault.sentence)}", err=True)
        return failure.exit_code
    return DONE


def _unfit(code, output, errors):
    """What is wrong with an answer that came in time, in a sentence."""
    if code not in (0, 1, 2):
        return f"exit code {code}"
    if code == 2 and not errors.strip():
        return "exit code 2 without a message"
    found = CONTROL.search(errors.replace("\r\n", "\n"))
    if found:
        return f"control character {found.group()!r} in a message"
    word = next((word for word in NO_CONSTANTS if word in errors), "")
    return f"{word!r} in a message" if word else ""


class _Streams(contextlib.ExitStack):
    """Standard streams of one command, in memory."""

    def __init__(self, typed):
        super().__init__()
        self._in = io.TextIOWrapper(io.BytesIO(typed), encoding="utf-8")
        self._out = io.TextIOWrapper(io.BytesIO(), encoding="utf-8", errors="backslashreplace")
        self._err = io.TextIOWrapper(io.BytesIO(), encoding="utf-8", errors="backslashreplace")

    def __enter__(self):
        before = sys.stdin, sys.stdout, sys.stderr
        self.callback(lambda: setattr(sys, "stdin", before[0]))
        self.callback(lambda: setattr(sys, "stdout", before[1]))
        self.callback(lambda: setattr(sys, "stderr", before[2]))
        sys.stdin, sys.stdout, sys.stderr = self._in, self._out, self._err
        return super().__enter__()

    @property
    def texts(self) -> tuple[str, str]:
        """What came out, and what was said."""
        for stream in (self._out, self._err):
            stream.flush()
        return tuple(s.buffer.getvalue().decode("utf-8", "replace") for s in (self._out, self._err))


def without_surroundings() -> None:
    """Forget where caches of bodies could be, so that each answer is made anew; keep compiled code."""
    caches = os.environ.get("XDG_CACHE_HOME") or os.path.join(os.environ.get("HOME", ""), ".cache")
    os.environ.setdefault("NUMBA_CACHE_DIR", caches)
    for name in ("FLEXMB_CACHE_DIR", "XDG_CACHE_HOME", "LOCALAPPDATA", "HOME"):
        os.environ.pop(name, None)
