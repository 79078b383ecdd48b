"""Commands in forks of this process, which has imported flexmb and loaded its kernels."""

import os
import signal
import sys
import tempfile
import time
import traceback
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from pathlib import Path

from . import trip as trips

PATIENCE = 120  # s, after which a command counts as hanging
HANGS = 999


@dataclass(frozen=True)
class Ended:
    """How a command ended: exit code (negative: by that signal), what it said, its group of processes."""

    code: int
    stdout: bytes
    stderr: str
    seconds: float
    group: int


@dataclass(frozen=True)
class Hit:
    """What happens to a command from outside: a signal after `delay` s, a trip, another start.

    `of_child` sends the signal to a process that the command has started, if there is one.
    `begin` is called in the child before the command; `closed` are standard streams without a file.
    """

    sent: int = 0
    delay: float = 0.0
    of_child: bool = False
    trip: trips.Trip | None = None
    begin: Callable[[], None] = lambda: None
    stdin: bytes = b""
    closed: tuple[int, ...] = ()
    stdout: str | None = None
    environment: dict = field(default_factory=dict)


UNHIT = Hit()


def run_forked(arguments: Sequence, folder: Path, hit: Hit = UNHIT) -> Ended:
    """Run `flexmb ARGUMENTS` in `folder` by a fork of this process."""
    said = _streams(hit)
    sys.stdout.flush(), sys.stderr.flush()
    start = time.monotonic()
    number = os.fork()
    if number == 0:
        _become(list(arguments), folder, hit, said)
    return _awaited(number, start, hit, said)


def run_process(arguments: Sequence, folder: Path, hit: Hit = UNHIT) -> Ended:
    """The same by a Python of its own, from its first import; without `trip` and `begin`."""
    said = _streams(hit)
    environment = {name: value for name, value in (os.environ | hit.environment).items() if value is not None}
    command = [sys.executable, "-m", "flexmb_cli", *map(os.fsencode, map(str, arguments))]
    start = time.monotonic()
    number = os.fork()
    if number == 0:
        try:
            _plug(hit, said)
            os.setsid()
            os.chdir(folder)
            signal.signal(signal.SIGINT, signal.SIG_DFL)
            os.execve(sys.executable, command, environment)
        finally:
            os._exit(99)
    return _awaited(number, start, hit, said)


def _streams(hit):
    """Files for the three standard streams."""
    said = [tempfile.TemporaryFile() for _ in range(3)]  # noqa: SIM115 - closed when they have been read
    said[0].write(hit.stdin)
    said[0].seek(0)
    return said


def _become(arguments, folder, hit, said):
    """The child: never returns."""
    code = 98
    try:
        os.setsid()
        os.chdir(folder)
        _plug(hit, said)
        signal.signal(signal.SIGINT, signal.SIG_DFL)
        signal.signal(signal.SIGTERM, signal.SIG_DFL)
        _environment(hit.environment)
        hit.begin()
        code = _main(["flexmb", *map(str, arguments)], hit.trip)
    finally:
        os._exit(code)


def _main(arguments, trip):
    from flexmb_cli.cli import main

    sys.argv = arguments
    trips.arm(trip)
    code = 0
    try:
        signal.signal(signal.SIGINT, signal.default_int_handler)
        main()
    except SystemExit as ending:
        code = ending.code if isinstance(ending.code, int) else int(ending.code is not None)
    except BaseException:
        traceback.print_exc()
        code = 1
    trips.arm(None)
    for stream in (sys.stdout, sys.stderr):
        try:
            stream.flush()
        except OSError:
            code = code or 120  # as Python itself
    return code


def _plug(hit, said):
    for stream in range(3):
        if stream in hit.closed:
            os.close(stream)
            setattr(sys, ("stdin", "stdout", "stderr")[stream], None)
        elif stream == 1 and hit.stdout:
            os.dup2(os.open(hit.stdout, os.O_WRONLY), 1)
        else:
            os.dup2(said[stream].fileno(), stream)


def _environment(changes):
    for name, value in changes.items():
        if value is None:
            os.environ.pop(name, None)
        else:
            os.environ[name] = value


def _awaited(number, start, hit, said):
    status = None
    if hit.sent:
        status = _waited(number, start + hit.delay)
        if status is None:
            _send(_child_of(number) if hit.of_child else number, hit.sent)
    if status is None:
        status = _waited(number, start + hit.delay + PATIENCE)
    seconds = time.monotonic() - start
    if status is None:
        os.killpg(number, signal.SIGKILL)
        os.waitpid(number, 0)
        code = HANGS
    else:
        code = os.waitstatus_to_exitcode(status)
    texts = [_whole(file) for file in said[1:]]
    return Ended(code, texts[0], texts[1].decode("utf-8", "surrogateescape"), seconds, number)


def _child_of(number):
    """The youngest process that the process `number` has started; the first is Python's resource tracker."""
    started = Path(f"/proc/{number}/task/{number}/children").read_text().split()
    return int(started[-1]) if len(started) > 1 else 0


def _send(number, sent):
    if number == 0:
        return
    try:
        os.kill(number, sent)
    except ProcessLookupError:
        return


def _waited(number, until):
    """Status of the child once it has ended, None when it runs on at `until`."""
    pause = 0.0005
    while True:
        found, status = os.waitpid(number, os.WNOHANG)
        if found:
            return status
        left = until - time.monotonic()
        if left <= 0:
            return None
        time.sleep(min(pause, left))
        pause = min(1.5 * pause, 0.01)


def _whole(file):
    with file:
        file.seek(0)
        return file.read()
