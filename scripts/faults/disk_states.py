"""What a journaling file system may hold after a loss of power, from the recorded calls of a command.

The model: names (made, moved, removed) reach the disk in their order, up to any one behind the last folder
that was synced; what was written to a file reaches it up to its last sync for certain, and of what came
later nothing, a part, all of it, or all of its length with zeros in it.
"""

import itertools
import os
from collections.abc import Iterator
from dataclasses import dataclass, field
from pathlib import Path

from .traced import Call

Tree = dict[str, bytes]
NONE, HALF, TORN, ALL, ZEROS = "none", "half", "torn", "all", "zeros"
SHARES = (NONE, HALF, TORN, ALL, ZEROS)
MOST_PRODUCT = 2  # files whose shares are combined in every way


@dataclass
class Inode:
    """A file: what is on the disk for certain, and the changes since, in their order."""

    synced: bytes = b""
    later: list = field(default_factory=list)  # (offset, data), or (length, None) for a cut

    def content(self, share: str) -> bytes:
        """What the disk may hold of it."""
        if share == ZEROS:
            return self._zeroed()
        count = {NONE: 0, HALF: len(self.later) // 2, TORN: len(self.later) - 1, ALL: len(self.later)}[share]
        content = bytearray(self.synced)
        for change in self.later[: max(count, 0)]:
            _apply(content, *change)
        if share == TORN and self.later and self.later[-1][1] is not None:
            offset, data = self.later[-1]
            _apply(content, offset, data[: len(data) // 2])
        return bytes(content)

    def _zeroed(self):
        content = bytearray(self.synced)
        for offset, data in self.later:
            _apply(content, offset, None if data is None else bytes(len(data)))
        return bytes(content)

    def sync(self) -> None:
        """All of it is on the disk."""
        self.synced, self.later = self.content(ALL), []


def _apply(content, offset, data):
    if data is None:
        del content[offset:]
        content.extend(bytes(offset - len(content)))
        return
    content.extend(bytes(max(0, offset - len(content))))
    content[offset : offset + len(data)] = data


@dataclass
class _Disk:
    """Names on the disk and those that wait, the open files with their positions."""

    folder: str
    names: dict[str, Inode | None]  # None: a folder
    waiting: list = field(default_factory=list)  # changes of names that are not on the disk for certain
    current: dict[str, Inode | None] = field(default_factory=dict)
    opened: dict[int, list] = field(default_factory=dict)  # descriptor: inode, position, appends


def states(calls: list[Call], folder: Path, before: Tree) -> Iterator[tuple[int, Tree]]:
    """(number of the call, files) of all the states that differ; folders have a name that ends in a stroke.

    Files in the making, which no command reads, count as one whatever is in them.
    """
    disk = _Disk(str(folder), {name: Inode(content) for name, content in before.items()})
    disk.current = dict(disk.names)
    seen = set()
    for number, call in enumerate(calls):
        if not _do(disk, call):
            continue
        for tree in _possible(disk):
            mark = hash(frozenset((name, _reported(name, content)) for name, content in tree.items()))
            if mark not in seen:
                seen.add(mark)
                yield number, tree


def _reported(name, content):
    return b"" if name.endswith(".tmp") else content


def _possible(disk):
    for count in range(len(disk.waiting) + 1):
        names = dict(disk.names)
        for change in disk.waiting[:count]:
            change(names)
        yield from _filled(names)


def _filled(names):
    """Trees of these names with every share of what was not synced."""
    files = {name: inode for name, inode in names.items() if inode is not None}
    open_ended = [name for name, inode in files.items() if inode.later]
    for shares in _choices(len(open_ended)):
        chosen = dict(zip(open_ended, shares, strict=True))
        tree = {name: inode.content(chosen.get(name, ALL)) for name, inode in files.items()}
        yield tree | {f"{name}/": b"" for name, inode in names.items() if inode is None}


def _choices(count):
    if count <= MOST_PRODUCT:
        yield from itertools.product(SHARES, repeat=count)
        return
    for share in SHARES:
        yield (share,) * count
        for odd in range(count):
            yield tuple(share if k == odd else ALL for k in range(count))


def _do(disk, call) -> bool:
    """Bring the disk to where it is behind `call`; whether anything changed."""
    if call.result.startswith("-"):
        return False
    act = _ACTS.get(call.name)
    return bool(act and act(disk, call))


def _name(disk, path):
    """A path as it is within the folder, or None."""
    path = os.path.normpath(os.path.join(disk.folder, path))
    inside = path.startswith(f"{disk.folder}/")
    return os.path.relpath(path, disk.folder) if inside else None


def _paths(disk, call):
    return [_name(disk, path) for path in call.places]


def _rename_in_both(disk, change):
    change(disk.current)
    disk.waiting.append(change)
    return True


def _open(disk, call):
    (name,) = _paths(disk, call)[:1] or (None,)
    number = int(call.result)
    disk.opened.pop(number, None)
    if name is None or (name in disk.current and disk.current[name] is None):
        return False
    made = False
    if name not in disk.current:
        if "O_CREAT" not in call.arguments:
            return False
        inode = Inode()
        made = _rename_in_both(disk, lambda names: names.__setitem__(name, inode))
    inode = disk.current[name]
    if "O_TRUNC" in call.arguments and inode.content(ALL):
        inode.later.append((0, None))
        made = True
    disk.opened[number] = [inode, 0, "O_APPEND" in call.arguments]
    return made


def _descriptor(call):
    return int(call.arguments.partition("<")[0])


def _write(disk, call):
    file = disk.opened.get(_descriptor(call))
    if file is None:
        return False
    inode, position, appends = file
    data = call.texts[0][: int(call.result)]
    at = len(inode.content(ALL)) if appends else position
    inode.later.append((at, data))
    file[1] = at + len(data)
    return True


def _read(disk, call):
    file = disk.opened.get(_descriptor(call))
    if file is not None:
        file[1] += int(call.result)
    return False


def _seek(disk, call):
    file = disk.opened.get(_descriptor(call))
    if file is not None:
        file[1] = int(call.result)
    return False


def _cut(disk, call):
    file = disk.opened.get(_descriptor(call))
    length = int(call.arguments.rpartition(",")[2])
    if file is None or len(file[0].content(ALL)) == length:
        return False
    file[0].later.append((length, None))
    return True


def _sync(disk, call):
    file = disk.opened.get(_descriptor(call))
    if file is not None:
        file[0].sync()
    else:  # a folder: its names, and with them those that came before
        disk.names, disk.waiting = dict(disk.current), []
    return True


def _duplicate(disk, call):
    """The new descriptor is the same open file, with the same position."""
    if "F_DUPFD" in call.arguments and _descriptor(call) in disk.opened:
        disk.opened[int(call.result)] = disk.opened[_descriptor(call)]
    return False


def _close(disk, call):
    disk.opened.pop(_descriptor(call), None)
    return False


def _move(disk, call):
    old, new = _paths(disk, call)
    if old is None or new is None:
        return False
    return _rename_in_both(disk, lambda names: names.__setitem__(new, names.pop(old)))


def _remove(disk, call):
    (name,) = _paths(disk, call)
    return name in disk.current and _rename_in_both(disk, lambda names: names.pop(name))


def _make(disk, call):
    (name,) = _paths(disk, call)
    return name is not None and _rename_in_both(disk, lambda names: names.__setitem__(name, None))


_ACTS = {
    "openat": _open, "write": _write, "read": _read, "lseek": _seek, "ftruncate": _cut, "fsync": _sync,
    "fdatasync": _sync, "fcntl": _duplicate, "close": _close, "rename": _move, "renameat": _move,
    "renameat2": _move, "unlink": _remove, "unlinkat": _remove, "rmdir": _remove, "mkdir": _make,
    "mkdirat": _make,
}  # fmt: skip
UNKNOWN = {
    *("pwrite64", "writev", "pwritev", "truncate", "fallocate", "copy_file_range", "sendfile"),
    *("dup", "dup2", "dup3", "link", "symlink", "linkat", "symlinkat"),
}


def not_understood(calls: list[Call]) -> set[str]:
    """Names of calls that change files and that this model does not know."""
    return {call.name for call in calls if call.name in UNKNOWN}
