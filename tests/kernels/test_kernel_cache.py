"""The cache of compiled kernels, damaged, lost or another user's: kernels are compiled anew."""

import os
import shutil
import subprocess
import sys
import tempfile
import threading
from pathlib import Path

import pytest

from flexmb_cli.fe import flexible_bodies as bodies
from flexmb_cli.kernels import _cache, _jit

pytestmark = pytest.mark.skipif(_jit.interpreted(), reason="nothing is compiled")

NOBODY = 65534
KERNEL = """
import os, shutil, sys
from flexmb_cli.fe import flexible_bodies as bodies
from flexmb_cli.kernels import _cache, _library
from flexmb_cli.kernels._jit import kernel

@kernel
def below(x):
    return 3.0 * x

@kernel
def twice(x):
    return 2.0 * below(x)

if sys.argv[1:]:
    shutil.rmtree(sys.argv[1])
    open(sys.argv[1], "w").close()
print(twice(7.0), "compiled" if "numba" in sys.modules else "loaded", *_cache.refused, *_library.unusable)
"""


@pytest.fixture(scope="module")
def script(tmp_path_factory):
    """The kernel as a program, and a cache in which it is kept."""
    path = tmp_path_factory.mktemp("kernel") / "kernel.py"
    path.write_text(KERNEL)
    assert twice(path, path.parent / "cache") == "42.0 compiled"
    assert twice(path, path.parent / "cache") == "42.0 loaded"
    return path


def twice(script, cache, *arguments, **environment):
    """What the kernel gives in a process of its own, and whether it was compiled for it."""
    places = {"NUMBA_CACHE_DIR": str(cache), "HOME": "", "XDG_CACHE_HOME": "", "TMPDIR": str(cache.parent)}
    done = subprocess.run(
        [sys.executable, script, *arguments], capture_output=True, text=True, timeout=120,
        env=os.environ | places | environment,
    )  # fmt: skip
    return done.stdout.strip() or done.stderr[-500:]


@pytest.fixture
def cache(tmp_path, script):
    """A copy of the cache, for one test."""
    return shutil.copytree(script.parent / "cache", tmp_path / "cache")


def kept_file(cache):
    """The one object in a cache."""
    (path,) = cache.rglob("*.object")
    return path


def garbled(content):
    """One bit in the midst of the machine code."""
    changed = bytearray(content)
    changed[len(content) // 2] ^= 1
    return bytes(changed)


def of_another_kernel(content):
    """A whole object under the name of another one."""
    code = content.partition(b"\n")[2]
    return _cache._checksum("other.object", code) + b"\n" + code


DAMAGES = {
    "cut": lambda content: content[:40],
    "empty": lambda content: b"",
    "zeroed": lambda content: bytes(len(content)),
    "garbled": garbled,
    "that of another kernel": lambda content: of_another_kernel(content),
}


@pytest.mark.processes
@pytest.mark.parametrize("damage", DAMAGES)
def test_a_damaged_kernel_is_compiled_anew_and_kept(cache, script, damage):
    kept = kept_file(cache)
    kept.write_bytes(DAMAGES[damage](kept.read_bytes()))
    assert twice(script, cache) == f"42.0 compiled {kept} is damaged: it is compiled again"
    assert twice(script, cache) == "42.0 loaded"


@pytest.mark.processes
def test_an_edited_text_is_compiled_anew(tmp_path, cache, script):
    edited = tmp_path / script.name
    edited.write_text(KERNEL.replace("3.0", "4.0"))
    assert twice(edited, cache) == "56.0 compiled"


@pytest.mark.processes
def test_everything_compiled_lies_in_one_place_that_only_the_user_can_write(tmp_path, script):
    home, copy = tmp_path / "home", tmp_path / "copy"
    shutil.copytree(
        Path(_jit.__file__).parents[1], copy / "flexmb_cli", ignore=shutil.ignore_patterns("*.pyc")
    )
    shutil.copy(script, copy)
    before = set(copy.rglob("*.nb?"))
    for expected in ("compiled", "loaded"):
        done = subprocess.run(
            [sys.executable, copy / script.name], capture_output=True, text=True, timeout=120, cwd=copy,
            env={"HOME": str(home), "PYTHONPATH": str(copy), "TMPDIR": str(tmp_path)},
        )  # fmt: skip
        assert done.stdout.split() == ["42.0", expected], done.stderr
    assert set(copy.rglob("*.nb?")) == before
    assert kept_file(home).stat().st_mode & 0o777 == 0o600
    folders = [path for path in home.rglob("*") if path.is_dir()]
    assert folders and {path.stat().st_mode & 0o777 for path in folders} == {0o700}


def of_another_user(path):
    """Give a file or folder away."""
    if os.geteuid() != 0:
        pytest.skip("giving a file away needs root")
    os.chown(path, NOBODY, NOBODY)


CLAIMS = {"another user's": of_another_user, "writable by others": lambda path: path.chmod(0o777)}


@pytest.mark.processes
@pytest.mark.parametrize("place", ["cache", "cache/flexmb", "version", "object"])
@pytest.mark.parametrize("claim", CLAIMS)
def test_what_others_may_have_written_is_not_loaded(tmp_path, cache, script, place, claim):
    """Whoever owned such a folder could have had code of theirs run; the bytes are those of a good object."""
    kept = kept_file(cache)
    path = {"version": kept.parent, "object": kept}.get(place, tmp_path / place)
    CLAIMS[claim](path)
    said = twice(script, cache, HOME=str(tmp_path / "home"))
    assert said.startswith(f"42.0 compiled {path} is not used for compiled kernels")
    assert said.count("is not used") == 1
    remedy = "let NUMBA_CACHE_DIR name another folder" if claim == "another user's" else f"chmod go-w {path}"
    assert remedy in said


@pytest.mark.processes
@pytest.mark.parametrize("place", ["version", "object"])
def test_links_are_not_followed(tmp_path, cache, script, place):
    kept = kept_file(cache)
    path = {"version": kept.parent, "object": kept}[place]
    path.rename(tmp_path / "elsewhere")
    path.symlink_to(tmp_path / "elsewhere")
    assert twice(script, cache, HOME=str(tmp_path / "home")).startswith("42.0 compiled")


@pytest.mark.processes
def test_a_pipe_in_place_of_an_object_stops_nothing(cache, script):
    kept = kept_file(cache)
    kept.unlink()
    os.mkfifo(kept)
    assert twice(script, cache) == "42.0 compiled"
    assert twice(script, cache) == "42.0 loaded"


@pytest.mark.skipif(not hasattr(os, "mkfifo"), reason="pipes with names")
def test_a_pipe_in_place_of_a_lock_is_not_waited_for(tmp_path):
    pipe = tmp_path / "unit.lock"
    os.mkfifo(pipe)
    ends_the_wait = threading.Timer(60.0, lambda: os.open(pipe, os.O_RDWR))
    ends_the_wait.daemon = True
    ends_the_wait.start()
    with _cache.alone(tmp_path, "unit"):
        assert ends_the_wait.is_alive(), "it waited"
    ends_the_wait.cancel()


@pytest.mark.processes
def test_a_pickle_is_not_looked_at(cache, script, tmp_path):
    """numba's index was unpickled before any check; an object has no pickle in it."""
    kept = kept_file(cache)
    code = f"import os\nos.mkdir({str(tmp_path / 'attacked')!r})"
    import pickle

    class Attack:
        def __reduce__(self):
            return exec, (code,)

    for name in ("kernel.twice-9.py311.nbi", "kernel.twice-9.py311.1.nbc", kept.name):
        (kept.parent / name).write_bytes(pickle.dumps(Attack()))
    assert twice(script, cache) == f"42.0 compiled {kept} is damaged: it is compiled again"
    assert not (tmp_path / "attacked").exists()
    assert b"pickle" not in kept.read_bytes()


@pytest.mark.processes
def test_what_kernels_call_is_compiled_with_them_and_by_itself_only_when_python_calls_it(cache, script):
    assert [path.name.partition("-")[0] for path in cache.rglob("*.object")] == ["__main__.twice"]
    command = "import kernel; print(kernel.below(7.0))"
    done = subprocess.run(
        [sys.executable, "-c", command], cwd=script.parent, capture_output=True, text=True, timeout=120,
        env=os.environ | {"NUMBA_CACHE_DIR": str(cache)},
    )  # fmt: skip
    assert done.stdout.split()[-1] == "21.0", done.stderr


@pytest.mark.processes
def test_a_cache_that_is_lost_on_the_way_stops_nothing(cache, script):
    assert twice(script, cache, cache) == "42.0 compiled"


@pytest.mark.processes
def test_old_versions_are_deleted(cache, script):
    """The latest three are kept."""
    place = cache / "flexmb"
    for name in (f"objects-{k}" for k in range(5)):
        (place / name).mkdir()
        (place / name / "old.object").write_text("old")
        os.utime(place / name, (0, 0))
    kept_file(cache / "flexmb" / kept_version(cache)).unlink()
    assert twice(script, cache) == "42.0 compiled"
    names = sorted(path.name for path in place.iterdir())
    assert len(names) == 3 and kept_version(cache) in names


def kept_version(cache):
    """Name of the folder of this version."""
    (path,) = cache.rglob("__main__.twice*.lock")
    return path.parent.name


def test_nothing_is_made_in_the_home_of_another_user(tmp_path, monkeypatch):
    """`sudo` may keep HOME: a `~/.cache` of root with mode 0700 locks its user out of all caches."""
    home = tmp_path / "home"
    home.mkdir()
    if os.geteuid() == 0:
        os.chown(home, NOBODY, NOBODY)
    else:
        monkeypatch.setattr(os, "geteuid", lambda: NOBODY)
    for name in ("NUMBA_CACHE_DIR", "XDG_CACHE_HOME", "FLEXMB_CACHE_DIR", "LOCALAPPDATA"):
        monkeypatch.delenv(name, raising=False)
    monkeypatch.setenv("HOME", str(home))
    monkeypatch.setattr(tempfile, "tempdir", str(tmp_path))
    for folder in (_cache.folder_to_write(), bodies.cache_folder()):
        assert folder is None or home not in folder.parents
    assert list(home.iterdir()) == []
