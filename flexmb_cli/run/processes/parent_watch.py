"""Worker processes end with the process that started them, however it ends; it does not end with them."""

import os
import signal
from multiprocessing import parent_process
from threading import Thread
from typing import Any


def end_with_parent() -> None:
    """Have this worker killed when its parent is gone.

    It would otherwise wait for work for ever, or go on writing files that the next call of the same
    command writes, too.
    """
    parent = parent_process()
    if parent is not None:
        Thread(target=_kill_after, args=(parent,), daemon=True).start()


def outlive_workers() -> None:
    """Have a worker, or a scheduler, that dies raise an error here.

    The system would end this process as well, silently, for writing into a pipe that nobody reads.
    """
    if hasattr(signal, "SIGPIPE"):
        signal.signal(signal.SIGPIPE, signal.SIG_IGN)


def _kill_after(parent: Any) -> None:
    parent.join()
    os.kill(os.getpid(), signal.SIGTERM if os.name == "nt" else signal.SIGKILL)
