"""`flexmb compile`: what it compiles, lists and clears, and where it cannot."""

import os
import subprocess
import sys

import pytest
from click.testing import CliRunner

from flexmb_cli.cli.compile import compile_
from flexmb_cli.kernels import _cache, _jit

pytestmark = [pytest.mark.processes, pytest.mark.skipif(_jit.interpreted(), reason="nothing is compiled")]
# A small unit in place of all, which take two minutes.
CODE = """
from flexmb_cli.kernels import signatures
small = {"constrained.speeds.move": "int f1 f1", "linalg.rotation.rotation_matrices": "f1 f3"}
signatures.UNITS.clear()
signatures.UNITS["small"] = small
signatures._UNIT_OF = dict.fromkeys(small, "small")
from flexmb_cli.__main__ import main
main()
"""


def flexmb(cache, *arguments, home=""):
    """What a command prints, on both streams, and its exit code."""
    done = subprocess.run(
        [sys.executable, "-c", CODE, *arguments], capture_output=True, text=True, timeout=300,
        env=os.environ
        | {"NUMBA_CACHE_DIR": str(cache), "TMPDIR": str(cache.parent)}
        | {"XDG_CACHE_HOME": "", "HOME": str(home)},
    )  # fmt: skip
    return done.stdout + done.stderr, done.returncode


def test_it_compiles_once_lists_and_clears(tmp_path):
    cache = tmp_path / "cache"
    assert flexmb(cache, "compile") == ("flexmb: compiling small\n", 0)
    assert flexmb(cache, "compile") == ("flexmb: all kernels are compiled\n", 0)
    listed, code = flexmb(cache, "compile", "--list")
    path, total = listed.splitlines()
    assert code == 0 and f"objects-{_cache.kernel_digest()}/small-" in path and path.endswith(".object")
    assert total.endswith("in all")
    assert flexmb(cache, "compile", "--clear") == ("flexmb: 1 file of compiled kernels deleted\n", 0)
    assert not list(cache.rglob("*.object"))


def test_an_empty_folder_gets_what_the_home_has(tmp_path):
    """Nodes of a cluster have other homes; "all kernels are compiled" left the shared folder empty."""
    home = tmp_path / "home"
    assert flexmb(home / ".cache", "compile") == ("flexmb: compiling small\n", 0)
    shared = tmp_path / "shared"
    folder = shared / "flexmb" / f"objects-{_cache.kernel_digest()}"
    done = "flexmb: all kernels are compiled\n"
    assert flexmb(shared, "compile", home=home) == ("flexmb: copying small\n", 0)
    assert flexmb(shared, "compile", home=home) == (done, 0)
    assert flexmb(shared, "compile") == (done, 0)  # a node without that home
    (kept,) = folder.glob("small-*.object")
    assert kept.stat().st_mode & 0o777 == 0o600


def test_a_place_that_cannot_be_written_is_said(tmp_path):
    """Every folder there is belongs to another, or is a file."""
    nowhere = "from flexmb_cli.kernels import _cache; _cache._bases = lambda: iter(())\n"
    done = subprocess.run(
        [sys.executable, "-c", nowhere + CODE, "compile"], capture_output=True, text=True, timeout=300
    )
    assert done.returncode == 2
    assert "no folder to keep compiled kernels in; set NUMBA_CACHE_DIR" in done.stderr


@pytest.fixture
def version(tmp_path, monkeypatch):
    """Folder of this version in a cache that three variables name, with an object in it."""
    for variable in ("NUMBA_CACHE_DIR", "XDG_CACHE_HOME", "LOCALAPPDATA"):
        monkeypatch.setenv(variable, str(tmp_path))
    monkeypatch.setenv("HOME", str(tmp_path / "home"))
    monkeypatch.setenv("TMPDIR", str(tmp_path))
    monkeypatch.setattr("tempfile.tempdir", None)
    monkeypatch.setattr(_cache, "refused", [])
    folder = tmp_path / "flexmb" / f"objects-{_cache.kernel_digest()}"
    folder.mkdir(parents=True, mode=0o700)
    _cache.keep(folder, "good", b"code")
    return folder


def listed():
    """What `--list` shows, but for the sizes."""
    return [line.split("kB  ", 1)[1] for line in CliRunner().invoke(compile_, ["--list"]).stdout.splitlines()]


def test_a_folder_that_several_variables_name_is_counted_once(version):
    assert listed() == [f"{version}/good.object", "in all"]
    assert CliRunner().invoke(compile_, ["--clear"]).stderr == "flexmb: 1 file of compiled kernels deleted\n"
    assert CliRunner().invoke(compile_, ["--clear"]).stderr == "flexmb: 0 files of compiled kernels deleted\n"


def test_the_list_says_what_is_not_used(version):
    os.mkfifo(version / "a_pipe.object")
    (version / "b_link.object").symlink_to("good.object")
    (version / "c_damaged.object").write_bytes(b"other")
    (version / "c_damaged.object").chmod(0o600)
    _cache.keep(version, "d_public", b"code")
    (version / "d_public.object").chmod(0o666)
    *shown, last, _ = [line.removeprefix(f"{version}/") for line in listed()]
    assert shown[0].startswith("a_pipe.object  not used: it is not a regular file, but a folder, a pipe")
    assert shown[1].startswith("b_link.object  not used: ")
    assert shown[2:] == [
        "c_damaged.object  not used: it is damaged",
        "d_public.object  not used: others may have written it",
    ]
    assert last == "good.object"


def test_what_cannot_be_deleted_is_not_counted(version, monkeypatch):
    monkeypatch.setattr("shutil.rmtree", lambda folder, ignore_errors: None)
    reported = CliRunner().invoke(compile_, ["--clear"]).stderr.splitlines()
    assert reported == [
        "flexmb: 0 files of compiled kernels deleted",
        f"flexmb: warning: {version}/good.object cannot be deleted",
    ]


def test_what_a_read_only_folder_has_is_not_copied_behind_it(version, tmp_path, monkeypatch):
    """An image of a container: kernels lie in a folder of root's, and the user's home is empty."""
    home = tmp_path / "home/.cache/flexmb" / version.name
    home.mkdir(parents=True, mode=0o700)
    assert next(_cache.folders()) == version and home in _cache.folders()
    assert _cache.content("good", home) == b"code"
    _cache.keep(home, "other", b"more")
    assert _cache.content("other") == b"more" and _cache.content("other", version) is None


def test_list_and_clear_exclude_each_other(tmp_path):
    said, code = flexmb(tmp_path / "cache", "compile", "--list", "--clear")
    assert code == 2 and "exclude each other" in said


def test_where_numba_is_switched_off_there_is_nothing_to_compile(tmp_path, monkeypatch):
    """It ended with a fault of flexmb itself."""
    monkeypatch.setenv("NUMBA_DISABLE_JIT", "1")
    printed, code = flexmb(tmp_path / "cache", "compile")
    assert code == 2 and "NUMBA_DISABLE_JIT is set: kernels are interpreted" in printed
