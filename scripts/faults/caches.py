"""Caches of kernels and of flexible bodies: damaged, gone, without a place; and many first runs at once."""

import os
import shutil
import subprocess
import sys
import tempfile
import textwrap
from dataclasses import replace
from pathlib import Path

from .child import Ended, Hit, run_forked, run_process
from .judge import faults_of_end, faults_of_files
from .places import NOBODY
from .stops import Verdict

# A kernel of its own, so that compiling anew takes a second and not a minute.
KERNEL = """
from flexmb_cli.kernels._jit import kernel

@kernel
def below(x):
    return 3.0 * x

@kernel
def twice(x):
    return 2.0 * below(x)

print(twice(7.0))
"""


def damaged_kernels(stage, chance, number, folder) -> Verdict:
    """Files of the kernels' cache cut, emptied, zeroed, garbled or removed: they are compiled anew."""
    cache = folder / "cache"
    first = _twice(folder, cache)
    found = [] if first == "42.0" else [f"without damage: {first}"]
    files = sorted(path for path in cache.rglob("*.object"))
    for path in chance.sample(files, chance.randint(1, len(files))):
        _damage(chance, path, number)
    for _ in range(2):
        said = _twice(folder, cache)
        found += [] if said == "42.0" else [f"after damage: {said}"]
    return Verdict("a kernel", found)


def _damage(chance, path, number):
    content = path.read_bytes()
    way = number % 6
    if way == 0:
        path.write_bytes(content[: chance.randrange(len(content))])
    elif way == 1:
        path.write_bytes(b"")
    elif way == 2:
        path.write_bytes(bytes(len(content)))
    elif way == 3:
        path.write_bytes(chance.randbytes(len(content)))
    elif way == 4:
        flipped = bytearray(content)
        flipped[chance.randrange(len(content))] ^= chance.randrange(1, 256)
        path.write_bytes(flipped)
    else:
        path.unlink()


def _twice(folder, cache):
    """What the kernel says, in a process of its own."""
    (folder / "kernel.py").write_text(KERNEL)
    environment = os.environ | {"NUMBA_CACHE_DIR": str(cache)}
    done = subprocess.run(
        [sys.executable, folder / "kernel.py"], env=environment, capture_output=True, text=True, timeout=120
    )
    return done.stdout.strip() or f"exit {done.returncode}: {done.stderr[-500:]}"


def lost_kernel_folder(stage, chance, number, folder) -> Verdict:
    """The folder of the kernels' cache vanishes, or becomes a file, between import and first call."""
    cache = folder / "cache"
    _twice(folder, cache)
    put = f"open({str(cache)!r}, 'w').close()" if number % 2 else "pass"
    loss = f"import shutil; shutil.rmtree({str(cache)!r}); {put}\nprint(twice(7.0))"
    (folder / "lost.py").write_text(KERNEL.replace("print(twice(7.0))", textwrap.dedent(loss)))
    done = subprocess.run(
        [sys.executable, folder / "lost.py"], env=os.environ | {"NUMBA_CACHE_DIR": str(cache)},
        capture_output=True, text=True, timeout=120,
    )  # fmt: skip
    return Verdict("a kernel", [] if done.stdout.strip() == "42.0" else [done.stderr[-500:]])


def damaged_bodies(stage, chance, number, folder) -> Verdict:
    """Flexible bodies in the cache cut or garbled, or a cache that is a file: they are reduced anew."""
    command = stage.commands["run vsdf"]
    before = command.prepare(folder, with_old=False)
    cache = folder.parent / f"{folder.name}-cache"
    cache.mkdir()
    where = {"FLEXMB_CACHE_DIR": str(cache)}
    found = faults_of_end(command.run(folder, Hit(environment=where)), {0})
    command = replace(command, whole={name: (folder / name).read_bytes() for name in command.outputs})
    bodies = [path for path in cache.rglob("*") if path.is_file()]
    if number % 8 == 7:
        where["FLEXMB_CACHE_DIR"] = str(bodies[0])
    elif number % 8 == 6:
        (cache / "flexmb").rename(cache / "other")
        (cache / "flexmb").write_bytes(b"")
    else:
        for path in bodies:
            _damage(chance, path, number)
    ended = command.run(folder, Hit(environment=where))
    found += faults_of_end(ended, {0}) + faults_of_files(command, folder, before, ended)
    return Verdict(command.name, found)


def homeless(stage, chance, number, folder) -> Verdict:
    """No HOME, one that is not there, no TMPDIR, a cache that cannot be written; each in a process."""
    command = stage.commands["run young"]
    before = command.prepare(folder, with_old=False)
    warm = _kernels()
    private = folder.parent / f"{folder.name}-tmp"
    lasting = private / f"flexmb-{os.getuid()}/flexmb"
    lasting.mkdir(parents=True)
    (private / f"flexmb-{os.getuid()}").chmod(0o700)
    lasting.chmod(0o700)
    shutil.copytree(warm, lasting / warm.name)
    no = dict.fromkeys(("HOME", "XDG_CACHE_HOME", "NUMBA_CACHE_DIR", "LOCALAPPDATA"))
    somewhere = {"TMPDIR": str(private)}
    ways = [
        no | somewhere,
        no | somewhere | {"HOME": "/proc/none"},
        no | somewhere | {"HOME": ""},
        no | somewhere | {"HOME": "/dev/null", "XDG_CACHE_HOME": "/dev/full"},
        no | {"NUMBA_CACHE_DIR": str(lasting.parent), "TMPDIR": None},
        no | {"NUMBA_CACHE_DIR": str(lasting.parent), "TMPDIR": "/proc/none"},
    ]
    ended = command.run(folder, Hit(environment=ways[number % len(ways)]), run_process)
    found = faults_of_end(ended, {0}) + faults_of_files(command, folder, before, ended)
    return Verdict(command.name, found)


def _kernels() -> Path:
    from flexmb_cli.kernels import _cache

    return _cache.folder_to_write()


def unwritable_bodies(stage, chance, number, folder) -> Verdict:
    """A cache of bodies that only others may write."""
    command = stage.commands["run vsdf"]
    if os.geteuid() != 0:
        return Verdict(command.name, skipped="becoming another user needs root")
    before = command.prepare(folder, with_old=False)
    folder.chmod(0o777)
    cache = folder.parent / f"{folder.name}-cache"
    cache.mkdir(mode=0o755)

    def nobody():
        os.setgroups([]), os.setresgid(NOBODY, NOBODY, NOBODY), os.setresuid(NOBODY, NOBODY, NOBODY)

    hit = Hit(
        begin=nobody, environment={"FLEXMB_CACHE_DIR": str(cache), "HOME": None, "XDG_CACHE_HOME": None}
    )
    ended = command.run(folder, hit)
    found = faults_of_end(ended, {0}) + faults_of_files(command, folder, before, ended)
    return Verdict(command.name, found)


def first_runs_at_once(stage, chance, number, folder) -> Verdict:
    """Eight first runs of a version at once: one compiles, all give the same bytes (a minute)."""
    command = stage.commands["run young"]
    cache = tempfile.mkdtemp(dir=folder.parent, prefix="cold-")
    places, found = [], []
    for k in range(8):
        (folder / str(k)).mkdir()
        command.prepare(folder / str(k), with_old=False)
        places.append(_started(command, folder / str(k), cache))
    for k, process in enumerate(places):
        stderr = process.communicate(timeout=900)[1]
        ended = Ended(process.returncode, b"", stderr, 0.0, 0)
        found += faults_of_end(ended, {0}) + faults_of_files(command, folder / str(k), {}, ended)
    return Verdict(command.name, found)


def _started(command, folder, cache):
    arguments = [sys.executable, "-m", "flexmb_cli", *map(str, command.arguments)]
    return subprocess.Popen(
        arguments, cwd=folder, env=os.environ | {"NUMBA_CACHE_DIR": cache}, stderr=subprocess.PIPE, text=True
    )


def changed_matrix(stage, chance, number, folder) -> Verdict:
    """A finite-element file changed behind the cache's back: the new one counts."""
    from .stage import DECKS

    cache = folder.parent / f"{folder.name}-cache"
    cache.mkdir()
    fe = folder / "fe"
    subprocess.run(["cp", "-r", DECKS / "vsdf/fe", fe], check=True)
    deck = folder / "d.vsdf"
    deck.write_bytes((DECKS / "vsdf/pendulum.vsdf").read_bytes())
    hit = Hit(environment={"FLEXMB_CACHE_DIR": str(cache)})
    first = run_forked(("modes", "d.vsdf"), folder, hit)
    matrix = fe / chance.choice(("pendulum_M.mtx", "pendulum_K.mtx"))
    lines = matrix.read_text().split("\n")
    head = next(k for k, line in enumerate(lines) if line and not line.startswith("%"))
    at = next(k for k in range(head + 1, len(lines)) if len(set(lines[k].split()[:2])) == 1)
    row, column, value = lines[at].split()
    lines[at] = f"{row} {column} {float(value) * 2!r}"
    matrix.write_text("\n".join(lines))
    second = run_forked(("modes", "d.vsdf"), folder, hit)
    found = faults_of_end(first, {0}) + faults_of_end(second, {0, 2})
    if first.stdout == second.stdout:
        found.append(f"{matrix.name} was changed and the answer is the old one")
    return Verdict("modes of a changed matrix", found)
