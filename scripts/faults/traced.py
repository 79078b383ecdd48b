"""The system calls of a command, by strace: recorded with all their bytes, or one of them made to fail."""

import ctypes
import os
import re
import shutil
import signal
import subprocess
import time
from dataclasses import dataclass
from pathlib import Path

PATIENCE = 20.0  # s, until strace has taken hold, or has written its last line
PR_SET_PTRACER, ANYBODY = 0x59616D61, -1
ANY_FILE = "%file,%desc"
LINE = re.compile(r"(\w+)\((.*)\)\s+= (-?\w+)(?:<(.*?)>)?( .*)?$", re.DOTALL)
QUOTED = re.compile(r'"((?:\\x[0-9a-f]{2})*)"')
RELATIVE = re.compile(r'(?:-?\d+|AT_FDCWD)<(.*?)>, "((?:\\x[0-9a-f]{2})*)"')
OPENED = re.compile(r"(-?\d+|AT_FDCWD)<(.*?)>")


@dataclass(frozen=True)
class Call:
    """A system call that did something: its name, arguments as strace shows them, result; its place among
    the calls of that name, from 1.
    """

    name: str
    arguments: str
    result: str
    at: int

    @property
    def texts(self) -> list[bytes]:
        """Its strings: paths and what was written."""
        return [_bytes(text) for text in QUOTED.findall(self.arguments)]

    @property
    def places(self) -> list[str]:
        """Its paths, those relative to an open folder with that folder before them."""
        if "at" not in self.name:
            return [os.fsdecode(text) for text in self.texts if text]
        pairs = RELATIVE.findall(self.arguments)
        return [os.path.join(*(os.fsdecode(_bytes(part)) for part in pair)) for pair in pairs]

    @property
    def paths(self) -> list[str]:
        """All the paths that it is about."""
        named = [os.fsdecode(text) for text in self.texts[:2] if text] if self.name in NAMING else []
        opened = [
            os.fsdecode(_bytes(path)) for number, path in OPENED.findall(self.arguments) if number.isdigit()
        ]
        return named + opened


NAMING = {
    *("open", "openat", "rename", "renameat", "renameat2", "unlink", "unlinkat", "mkdir", "mkdirat", "rmdir"),
    *("stat", "lstat", "newfstatat", "access", "faccessat2", "chmod", "fchmodat", "readlink", "truncate"),
}


def is_here() -> bool:
    """Whether strace is installed and may trace here."""
    if shutil.which("strace") is None:
        return False
    return subprocess.run(["strace", "-o", os.devnull, "true"], capture_output=True).returncode == 0


def tracer(log: Path, *options: str):
    """What a child calls before its command, so that strace follows it and writes `log`."""

    def begin():
        ctypes.CDLL(None).prctl(PR_SET_PTRACER, ctypes.c_ulong(ANYBODY), 0, 0, 0)
        words = ["strace", "-y", "-xx", "-s", "1000000000", "-o", str(log), *options, "-p", str(os.getpid())]
        traced = os.getpid()
        first = os.fork()
        if first == 0:
            # Once more, so that the command has no child that it did not start.
            if os.fork() == 0:
                _take_hold(words, traced)
            os._exit(0)
        os.waitpid(first, 0)
        # While it waits it must not make calls that would be counted.
        os.kill(traced, signal.SIGSTOP)

    return begin


def _take_hold(words, traced):
    """Start strace once the process `traced` has stopped, and let that go on; never returns."""
    try:
        status = Path(f"/proc/{traced}/status")
        until = time.monotonic() + PATIENCE
        while "State:\tT" not in status.read_text() and time.monotonic() < until:
            time.sleep(0.001)
        quiet = {"stdin": subprocess.DEVNULL, "stdout": subprocess.DEVNULL, "stderr": subprocess.PIPE}
        strace = subprocess.Popen(words, start_new_session=True, **quiet)
        strace.stderr.readline()  # "attached"
    finally:
        os.kill(traced, signal.SIGCONT)
        os._exit(0)


def recorded(log: Path) -> list[Call]:
    """The calls in `log`, once strace has written its last line."""
    until = time.monotonic() + PATIENCE
    while not (log.exists() and b"+++ " in log.read_bytes()[-200:]):
        if time.monotonic() > until:
            raise TimeoutError(f"{log} does not end")
        time.sleep(0.005)
    calls, counts = [], {}
    for line in log.read_text(encoding="utf-8", errors="surrogateescape").splitlines():
        found = LINE.match(line)
        if found:
            name = found[1]
            counts[name] = counts.get(name, 0) + 1
            calls.append(Call(name, found[2], found[3], counts[name]))
    return calls


def concerned(calls: list[Call], folder: Path) -> list[Call]:
    """Those of `calls` that are about files in `folder`, and the folder."""
    inside = f"{folder}/"
    return [
        call
        for call in calls
        if any(f"{os.path.join(folder, path)}/".startswith(inside) for path in call.paths)
    ]


def _bytes(text):
    if isinstance(text, str) and "\\x" in text:
        return bytes.fromhex(text.replace("\\x", ""))
    return os.fsencode(text)
