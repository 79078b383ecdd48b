"""``python -m flexmb_cli`` is the same program as ``flexmb``."""

import atexit
import gc
import os
import sys
from typing import NoReturn

INTERRUPTED = 130
# Readers make objects by the hundred thousand and hardly a cycle: at Python's 700 the search for cycles takes
# a third of the time of a large file, and a tenth of that of imports.
OBJECTS_UNTIL_COLLECTED = 200_000


def program() -> NoReturn:
    """Run a command and end the process: the entry point of `flexmb`."""
    try:
        main()
    except SystemExit as ending:
        _leave(ending.code)
    _leave(0)


def _leave(code: str | int | None) -> NoReturn:
    """End the process without taking Python down object by object: a twentieth of a short run.

    Where someone watches (a profiler, a debugger), other threads work, or a stream is broken, Python ends as
    ever.
    """
    threading = sys.modules.get("threading")
    watched = sys.gettrace() or sys.getprofile() or (threading and threading.active_count() > 1)
    if watched or not isinstance(code, int) or not _flushed():
        sys.exit(code)
    atexit._run_exitfuncs()
    os._exit(code)


def _flushed() -> bool:
    """Write what waits in the standard streams; return whether that was possible."""
    try:
        for stream in (sys.stdout, sys.stderr):
            stream.flush()
    except (OSError, ValueError, AttributeError):
        return False
    return True


def main() -> None:
    """Run a command; Ctrl-C is heeded without a traceback while the commands are imported, too."""
    gc.set_threshold(OBJECTS_UNTIL_COLLECTED)
    try:
        from .cli import main as run
    except KeyboardInterrupt:
        print("flexmb: interrupted; nothing was begun", file=sys.stderr)
        sys.exit(INTERRUPTED)
    run()


if __name__ == "__main__":
    program()
