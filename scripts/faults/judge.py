"""The rules: an output is the old one, the new one whole, or marked partial, and a message says which."""

import re
import shutil
from pathlib import Path

import h5py
import numpy as np

from .child import HANGS, Ended
from .stage import Command

OURS = re.compile(r"(^|/)\.flexmb-[\w-]+\.tmp$")
SAYS_STOPPED = re.compile("interrupted|stopped|terminated", re.IGNORECASE)
KILLED = -9
STOPPED = {130, 143}


def faults_of_end(ended: Ended, allowed) -> list[str]:
    """What is wrong with how a command ended; `allowed` are exit codes."""
    found = []
    if ended.code == HANGS:
        return ["it hangs"]
    if ended.code not in allowed:
        found.append(f"exit {ended.code}, allowed {sorted(allowed)}: {ended.stderr[-300:]!r}")
    for word in ("Traceback", "a fault of flexmb itself", "Exception ignored"):
        if word in ended.stderr:
            found.append(f"{word}: {ended.stderr[-1500:]}")
    if ended.code in (1, 2) and not ended.stderr.strip():
        found.append(f"exit {ended.code} without a word")
    if ended.code in STOPPED and not SAYS_STOPPED.search(ended.stderr):
        found.append(f"exit {ended.code} without a word on what was kept: {ended.stderr[-300:]!r}")
    return found


def faults_of_files(command: Command, folder: Path, before: dict, ended: Ended) -> list[str]:
    """What is wrong with the files in `folder`, where `before` was before the command."""
    found = []
    states = {}
    for output in command.outputs:
        states[output] = state = _state(command, folder, before, output)
        if state is None:
            found.append(f"{output} is neither the old one, nor the new one, nor marked partial")
            _keep_evidence(folder, output)
        elif state == "partial" and ended.code not in (1, *STOPPED):
            found.append(f"{output} is partial after exit {ended.code}")
        elif state == "old" and ended.code == 0:
            found.append(f"{output} was not written in spite of exit 0")
        elif state == "partial" and output not in ended.stderr and "several" not in command.name:
            found.append(f"{output} is partial and no message says so: {ended.stderr[-300:]!r}")
    if ended.code == 2 and set(states.values()) - {"old"} and "several" not in command.name:
        found.append(f"exit 2 left {states}")
    return found + _strangers(command, folder, before, ended)


def _keep_evidence(folder, output):
    """The command that is given again would write over it."""
    if (folder / output).is_file():
        shutil.copy(folder / output, folder.parent / f"seen-{Path(output).name}")


def _state(command, folder, before, output):
    path = folder / output
    now = path.read_bytes() if path.is_file() else None
    whole = command.whole[output]
    if now == whole:
        return "new"
    stale = path.with_name(f"{path.name}.stale")
    if now is None and stale.is_file():
        now = stale.read_bytes()  # a run without a result has set it aside
    if now == before.get(output):
        return "old"
    if now is not None and _is_partial(path, now, whole, folder):
        return "partial"
    return None


def _is_partial(path, now, whole, folder):
    if path.suffix == ".h5":
        reference = folder.parent / "reference.h5"
        reference.write_bytes(whole)
        return _is_marked(path, reference)
    # A table of text is cut after a row; the message and the HDF5 file have the mark.
    return whole.startswith(now)


def _is_marked(path, reference):
    try:
        with h5py.File(path) as file, h5py.File(reference) as complete:
            rows = len(file["time"])
            marked = file.attrs["status"] == "failed" and file.attrs["message"] != ""
            same = []
            complete.visititems(lambda name, item: same.append(_begins(file, name, item, rows)))
            return marked and all(same)
    except (OSError, KeyError):
        return False


def _begins(file, name, item, rows):
    """Whether a dataset of the complete result begins with the partial one's."""
    if not isinstance(item, h5py.Dataset):
        return True
    part, value = np.asarray(file[name][()]), np.asarray(item[()])
    if part.shape != value.shape:
        if len(part) != rows:
            return False
        value = value[:rows]
    # Texts are objects, whose bytes are their addresses.
    return part.tolist() == value.tolist() if part.dtype == object else part.tobytes() == value.tobytes()


def _strangers(command, folder, before, ended):
    found = []
    for path in sorted(folder.rglob("*")):
        name = str(path.relative_to(folder))
        if path.is_dir() or name.removesuffix(".stale") in command.outputs:
            continue
        if name in before:
            if path.read_bytes() != before[name]:
                found.append(f"{name} was changed")
        elif not _belongs(name, command, ended):
            found.append(f"{name} was left behind after exit {ended.code}: {ended.stderr[-300:]!r}")
    missing = [name for name in before if name not in command.outputs and not (folder / name).exists()]
    return found + [f"{name} is gone" for name in missing]


def _belongs(name, command, ended):
    kept = name.endswith((".resume", ".draft")) or ".parts/" in name
    if command.resumable and ended.code != 0 and kept:
        return True
    # Of these the next command that writes the same output clears up.
    return ended.code in (KILLED, *STOPPED) and bool(OURS.search(name))


def faults_of_finish(command: Command, folder: Path, before: dict, ended: Ended) -> list[str]:
    """What is wrong after the command was given again: it must give the bytes of the undisturbed one."""
    found = [f"given again: {fault}" for fault in faults_of_end(ended, {0})]
    for output in command.outputs:
        path = folder / output
        if not path.is_file() or path.read_bytes() != command.whole[output]:
            found.append(f"given again: {output} has not the bytes of the undisturbed command")
    for path in sorted(folder.rglob("*")):
        name = str(path.relative_to(folder))
        left = not path.is_dir() and name not in before and name.removesuffix(".stale") not in command.outputs
        if left:
            found.append(f"given again: {name} is left behind")
    return found


def said_the_same(command: Command, ended: Ended) -> list[str]:
    """A command that was not hit says what it says undisturbed."""
    same = ended.code != 0 or ended.stdout == command.said
    return [] if same else ["exit 0 with another standard output"]
