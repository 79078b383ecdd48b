"""Where the system forbids executable memory, a run says so; it died by SIGSEGV without a word."""

import hashlib
import os
import runpy
import shutil
import signal
import subprocess
import sys
from pathlib import Path

import h5py
import pytest

from flexmb_cli.kernels import _entry, _jit, _library

TOP = Path(__file__).resolve().parents[2]
DECK = TOP / "decks/young/IN1-1-1.dat"
NO_FILTERS = 77

pytestmark = [
    pytest.mark.processes,
    pytest.mark.skipif(_jit.interpreted(), reason="nothing is compiled"),
    pytest.mark.skipif(_library.target() != "x86_64-linux", reason="the filter is made of x86-64's numbers"),
]


def flexmb(folder, *words, **environment):
    filtered = [sys.executable, str(Path(__file__).with_name("seccomp.py")), sys.executable]
    done = subprocess.run(
        [*filtered, "-m", "flexmb_cli", *words], cwd=folder, capture_output=True, text=True, timeout=300,
        env=os.environ | environment,
    )  # fmt: skip
    if done.returncode == NO_FILTERS:
        pytest.skip("this system takes no filters of system calls")
    return done


@pytest.mark.parametrize("cache", ["kept", "empty"])
def test_a_run_names_the_memory_that_is_forbidden(tmp_path, cache):
    """Kept kernels are loaded, others are compiled: LLVM does not look whether its memory is executable."""
    kept = {} if cache == "kept" else {"NUMBA_CACHE_DIR": str(tmp_path), "HOME": "", "XDG_CACHE_HOME": ""}
    done = flexmb(tmp_path, "run", str(DECK), **kept)
    assert done.returncode not in (-signal.SIGSEGV, 139)
    first = done.stderr.splitlines()[0]
    assert first.startswith(f"{DECK}: error: the system forbids executable memory")
    assert "Operation not permitted" in first and "MemoryDenyWriteExecute" in first
    assert (done.returncode, [path.name for path in tmp_path.glob("OUT*")]) == (1, [])


def test_the_remedy_of_the_message_helps(tmp_path):
    done = flexmb(tmp_path, "run", "-q", str(DECK), NUMBA_DISABLE_JIT="1")
    assert (done.returncode, done.stderr) == (0, "")
    with h5py.File(tmp_path / "OUT1-1-1.h5") as result:
        assert result.attrs["status"] == "complete"


WHEEL = """
import pathlib, sys
from flexmb_cli.kernels import _library
_library.PACKAGED = pathlib.Path({folder!r})
sys.modules["numba"] = sys.modules["llvmlite"] = None
from flexmb_cli.__main__ import main
main()
"""


@pytest.mark.skipif(not shutil.which("cc"), reason="no C compiler")
def test_a_library_needs_no_such_memory(tmp_path):
    """As in a wheel, linked by the machine's own compiler: the system itself makes its code executable."""
    units = {unit: _entry.Unit(unit) for unit in ("equations", "kinematics")}
    objects = {unit: _entry._cache.content(made.name) for unit, made in units.items()}
    for unit in objects:
        objects[unit] = objects[unit] or units[unit].emit([_library.target()])[_library.target()]
    link = runpy.run_path(str(TOP / "setup.py"), run_name="setup")["link"]
    library = tmp_path / "wheel" / _library.library_name(_library.target())
    link(["cc"], objects, library)
    (tmp_path / "run.py").write_text(WHEEL.format(folder=str(library.parent)))
    filtered = [sys.executable, str(Path(__file__).with_name("seccomp.py")), sys.executable]
    done = subprocess.run(
        [*filtered, tmp_path / "run.py", "run", "-q", DECK], cwd=tmp_path, capture_output=True, text=True,
        env=os.environ | {"PYTHONPATH": str(TOP)}, timeout=300,
    )  # fmt: skip
    if done.returncode == NO_FILTERS:
        pytest.skip("this system takes no filters of system calls")
    assert (done.returncode, done.stderr) == (0, "")
    pinned = dict(line.split()[::-1] for line in (TOP / "tests/run/digests.txt").read_text().splitlines())
    table = hashlib.sha256((tmp_path / "OUT1-1-1.dat").read_bytes()).hexdigest()
    assert table == pinned["young/OUT1-1-1.dat"]


@pytest.mark.campaign
def test_every_command_that_needs_compiled_kernels_names_it(tmp_path):
    other = DECK.with_name("IN4-BAR.dat")
    for words in (["run", "-j", "2", DECK, other], ["verify", other], ["compile"]):
        done = flexmb(tmp_path, *map(str, words), HOME=str(tmp_path))
        assert done.returncode == 1 and "forbids executable memory" in done.stderr
    assert flexmb(tmp_path, "check", str(DECK)).returncode == 0
