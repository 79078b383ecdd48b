"""`flexmb compile`: what it compiles, lists and clears, and where it cannot."""

import os
import subprocess
import sys

import pytest

from flexmb_cli.kernels import _jit, _objects

pytestmark = [
    pytest.mark.processes,
    pytest.mark.skipif(_jit.interpreted(), reason="nothing is compiled"),
]
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


def flexmb(cache, *arguments):
    """What a command prints, on both streams, and its exit code."""
    done = subprocess.run(
        [sys.executable, "-c", CODE, *arguments], capture_output=True, text=True, timeout=300,
        env=os.environ
        | {"NUMBA_CACHE_DIR": str(cache), "XDG_CACHE_HOME": "", "HOME": "", "TMPDIR": str(cache.parent)},
    )  # fmt: skip
    return done.stdout + done.stderr, done.returncode


def test_it_compiles_once_lists_and_clears(tmp_path):
    cache = tmp_path / "cache"
    assert flexmb(cache, "compile") == ("flexmb: compiling small\n", 0)
    assert flexmb(cache, "compile") == ("flexmb: all kernels are compiled\n", 0)
    listed, code = flexmb(cache, "compile", "--list")
    path, total = listed.splitlines()
    assert code == 0 and f"objects-{_objects.kernel_digest()}/small.object" in path and "numba" in path
    assert total.endswith("in all")
    assert flexmb(cache, "compile", "--clear") == ("flexmb: 1 file of compiled kernels deleted\n", 0)
    assert not list(cache.rglob("*.object"))


def test_a_place_that_cannot_be_written_is_said(tmp_path):
    """Every folder there is belongs to another, or is a file."""
    nowhere = "from flexmb_cli.kernels import _cache; _cache._bases = lambda: iter(())\n"
    done = subprocess.run(
        [sys.executable, "-c", nowhere + CODE, "compile"], capture_output=True, text=True, timeout=300
    )
    assert done.returncode == 2
    assert "no folder to keep compiled kernels in; set NUMBA_CACHE_DIR" in done.stderr


def test_list_and_clear_exclude_each_other(tmp_path):
    said, code = flexmb(tmp_path / "cache", "compile", "--list", "--clear")
    assert code == 2 and "exclude each other" in said
