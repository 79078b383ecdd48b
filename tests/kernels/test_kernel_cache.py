"""The cache of compiled kernels, damaged or lost: kernels are compiled anew, and never run as they are."""

import os
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

from flexmb_cli.kernels import _jit

pytestmark = pytest.mark.skipif(_jit.interpreted(), reason="nothing is compiled")

KERNEL = """
import shutil, sys
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
print(twice(7.0), sum(twice.stats.cache_hits.values()))
"""


def twice(folder, *arguments):
    """What the kernel gives in a process of its own, and how often it came from the cache."""
    (folder / "kernel.py").write_text(KERNEL)
    done = subprocess.run(
        [sys.executable, folder / "kernel.py", *arguments], capture_output=True, text=True, timeout=120,
        env=os.environ | {"NUMBA_CACHE_DIR": str(folder / "cache")},
    )  # fmt: skip
    return done.stdout.strip() or done.stderr[-500:]


def garbled(content):
    """One bit in the midst of the machine code."""
    changed = bytearray(content)
    changed[len(content) // 2] ^= 1
    return bytes(changed)


DAMAGES = {
    "cut": lambda content: content[:40],
    "empty": lambda content: b"",
    "zeroed": lambda content: bytes(len(content)),
    "garbled": garbled,
}


@pytest.mark.parametrize("ending", ["nbi", "nbc"])
@pytest.mark.parametrize("damage", DAMAGES)
def test_a_damaged_kernel_is_compiled_anew_and_kept(tmp_path, damage, ending):
    assert twice(tmp_path) == "42.0 0"
    assert twice(tmp_path) == "42.0 1"
    for path in (tmp_path / "cache").rglob(f"*.{ending}"):
        path.write_bytes(DAMAGES[damage](path.read_bytes()))
    assert twice(tmp_path) == "42.0 0"
    assert twice(tmp_path) == "42.0 1"


def test_a_cache_that_is_lost_on_the_way_stops_nothing(tmp_path):
    assert twice(tmp_path, str(tmp_path / "cache")) == "42.0 0"


def test_a_checkout_elsewhere_has_a_folder_of_its_own(tmp_path):
    """numba would not find its kernels in the other's, and the notice of compiling would be left out."""
    package = Path(_jit.__file__).parents[1]
    found = set()
    for name in ("here", "there"):
        shutil.copytree(package, tmp_path / name / package.name, ignore=shutil.ignore_patterns("__pycache__"))
        command = "from flexmb_cli.kernels import _jit; print(_jit.__file__, _jit._cache_folder()[0])"
        done = subprocess.run(
            [sys.executable, "-c", command], cwd=tmp_path / name, capture_output=True, text=True, check=True,
            env=os.environ | {"NUMBA_CACHE_DIR": str(tmp_path), "PYTHONPATH": str(tmp_path / name)},
        )  # fmt: skip
        source, folder = done.stdout.split()
        assert source.startswith(str(tmp_path / name))
        found.add(folder)
    assert len(found) == 2
