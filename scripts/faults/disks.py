"""Disks that fill up or break: failing deeds, a small file system, a limit of the file size."""

import contextlib
import os
import resource
import signal
import subprocess
from pathlib import Path

from . import trip as trips
from .child import Hit
from .judge import faults_of_end, faults_of_files, faults_of_finish
from .stops import Verdict, _go_on
from .trip import Trip


def full_from_a_deed_on(stage, chance, number, folder) -> Verdict:
    """From the n-th deed on nothing has room any more."""
    return _failing_deed(stage, chance, number, folder, trips.FULL)


def broken_deed(stage, chance, number, folder) -> Verdict:
    """The n-th deed fails with an error of the disk, those behind it do not."""
    return _failing_deed(stage, chance, number, folder, trips.BROKEN)


def vanishing_folder(stage, chance, number, folder) -> Verdict:
    """The folder is taken away before the n-th deed, and comes back when the command has ended."""
    command = stage.spread(stage.writers, number)
    before = command.prepare(folder, chance.random() < 0.5)
    trip = Trip(str(folder), chance.randint(1, command.deeds), trips.VANISH)
    ended = command.run(folder, Hit(trip=trip))
    gone = Path(f"{folder}.gone")
    if gone.exists():
        _put_back(gone, folder)
    found = faults_of_end(ended, {0, 1, 2})
    # What was being written cannot be removed any more where it went to.
    for path in folder.rglob(".flexmb-*.tmp"):
        path.unlink()
    if ended.code == 0:
        found += (
            [] if all((folder / output).exists() for output in command.outputs) else ["exit 0, no output"]
        )
    found += faults_of_finish(command, folder, before, _go_on(command, folder, Hit()))
    return Verdict(command.name, found)


def _put_back(gone, folder):
    """The folder as it was taken away; what was made in its place meanwhile goes."""
    subprocess.run(["rm", "-rf", folder], check=True)
    gone.rename(folder)


def _failing_deed(stage, chance, number, folder, action):
    command = stage.spread(stage.writers, number)
    before = command.prepare(folder, chance.random() < 0.5)
    trip = Trip(str(folder), chance.randint(1, command.deeds), action)
    ended = command.run(folder, Hit(trip=trip))
    return _refused(command, folder, before, ended)


def _refused(command, folder, before, ended):
    found = faults_of_end(ended, {0, 1, 2}) + faults_of_files(command, folder, before, ended)
    finished = _go_on(command, folder, Hit())
    found += faults_of_finish(command, folder, before, finished)
    return Verdict(command.name, found, not found and ended.code != 0 and command.resumable)


def small_disk(stage, chance, number, folder) -> Verdict:
    """A file system of random size, from nothing to what the outputs need; then with room enough."""
    command = stage.spread(stage.writers, number)
    needed = sum(map(len, command.whole.values())) + sum(map(len, command.inputs.values()))
    room = (
        int(chance.uniform(0, 1.3) * needed) // 4096 * 4096 + 4096 + sum(map(_pages, command.inputs.values()))
    )
    with _mounted(folder, room) as mounted:
        if not mounted:
            return Verdict(command.name, skipped="no file system can be mounted here: needs root")
        with contextlib.suppress(OSError):
            before = command.prepare(folder, with_old=False)
            ended = command.run(folder, Hit())
            found = faults_of_end(ended, {0, 1}) + faults_of_files(command, folder, before, ended)
            subprocess.run(["mount", "-o", "remount,size=1g", folder], check=True)
            finished = _go_on(command, folder, Hit())
            found += faults_of_finish(command, folder, before, finished)
            return Verdict(command.name, found, not found and ended.code != 0 and command.resumable)
    return Verdict(command.name, skipped="no room for the inputs")


def _pages(content):
    return len(content) // 4096 * 4096 + 8192


@contextlib.contextmanager
def _mounted(folder, size):
    options = ["mount", "-t", "tmpfs", "-o", f"size={size}", "none", str(folder)]
    mounted = os.geteuid() == 0 and subprocess.run(options, capture_output=True).returncode == 0
    try:
        yield mounted
    finally:
        if mounted:
            subprocess.run(["umount", str(folder)], check=True)


def limited_size(stage, chance, number, folder) -> Verdict:
    """A limit of the size of files, from nothing to the largest output."""
    command = stage.spread(stage.writers, number)
    before = command.prepare(folder, chance.random() < 0.5)
    size = int(chance.uniform(0, max(map(len, command.whole.values()))))
    ended = command.run(folder, Hit(begin=lambda: _limit(size)))
    return _refused(command, folder, before, ended)


def _limit(size):
    signal.signal(signal.SIGXFSZ, signal.SIG_IGN)  # as Python has it, but a fork need not
    resource.setrlimit(resource.RLIMIT_FSIZE, (size, size))
