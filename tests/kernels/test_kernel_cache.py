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


@pytest.fixture(scope="module")
def script(tmp_path_factory):
    """The kernel as a program, and a cache in which it is kept."""
    path = tmp_path_factory.mktemp("kernel") / "kernel.py"
    path.write_text(KERNEL)
    assert twice(path, path.parent / "cache") == "42.0 0"
    assert twice(path, path.parent / "cache") == "42.0 1"
    return path


def twice(script, cache, *arguments):
    """What the kernel gives in a process of its own, and how often it came from the cache."""
    done = subprocess.run(
        [sys.executable, script, *arguments], capture_output=True, text=True, timeout=120,
        env=os.environ | {"NUMBA_CACHE_DIR": str(cache)},
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


@pytest.mark.processes
@pytest.mark.parametrize("ending", ["nbi", "nbc"])
@pytest.mark.parametrize("damage", DAMAGES)
def test_a_damaged_kernel_is_compiled_anew_and_kept(tmp_path, script, damage, ending):
    cache = shutil.copytree(script.parent / "cache", tmp_path / "cache")
    (kept,) = cache.rglob(f"*.{ending}")
    kept.write_bytes(DAMAGES[damage](kept.read_bytes()))
    assert twice(script, cache) == "42.0 0"
    assert twice(script, cache) == "42.0 1"


@pytest.mark.processes
def test_what_kernels_call_is_compiled_with_them_and_by_itself_only_when_python_calls_it(tmp_path, script):
    cache = shutil.copytree(script.parent / "cache", tmp_path / "cache")
    assert [path.name.partition("-")[0] for path in cache.rglob("*.nbc")] == ["kernel.twice"]
    command = "import kernel; print(kernel.below(7.0), kernel.below.part.overloads)"
    done = subprocess.run(
        [sys.executable, "-c", command], cwd=script.parent, capture_output=True, text=True, timeout=120,
        env=os.environ | {"NUMBA_CACHE_DIR": str(cache)},
    )  # fmt: skip
    assert done.stdout.split()[-2:] == ["21.0", "OrderedDict()"], done.stderr


def ran(folder, text, **environment):
    """A script in a process of its own, with a cache of its own."""
    (folder / "script.py").write_text(text)
    return subprocess.run(
        [sys.executable, folder / "script.py"], capture_output=True, text=True, timeout=120,
        env=os.environ | environment | {"NUMBA_CACHE_DIR": str(folder / "cache")},
    )  # fmt: skip


UNCALLED = """
from flexmb_cli.kernels._jit import kernel

THREE = 3

@kernel
def shared(x):
    return 2.0 * x

@kernel
def never(x):
    twice_three = 2 * THREE
    if twice_three < THREE:
        return shared(x)
    return x

@kernel
def always(x):
    return shared(x) + 1.0

@kernel
def both(x):
    return always(x) + never(x)

print(both(2.0))
"""


@pytest.mark.processes
def test_a_function_that_one_part_names_and_another_calls_is_linked(tmp_path):
    """Offered to LLVM behind the part that only names it, it was left out, and the process ended."""
    done = ran(tmp_path, UNCALLED)
    assert (done.stdout.strip(), done.returncode) == ("7.0", 0)


CIRCLE = """
from flexmb_cli.kernels._jit import kernel

@kernel
def even(n):
    if n == 0:
        return True
    return odd(n - 1)

@kernel
def odd(n):
    if n == 0:
        return False
    return even(n - 1)

@kernel
def both(n):
    return even(n) and odd(n + 1)

print(both(4))
"""


@pytest.mark.processes
def test_kernels_that_call_one_another_in_a_circle_are_refused(tmp_path):
    done = ran(tmp_path, CIRCLE)
    assert done.returncode == 1 and "in a circle?" in done.stderr


BEYOND = """
import numpy as np
from flexmb_cli.kernels._jit import kernel, part

@%s
def third(a):
    return a[2]

@kernel
def beyond(a):
    return third(a)

try:
    beyond(np.zeros(2))
except IndexError:
    print("checked")
"""


@pytest.mark.parametrize("how", ["kernel", "part"])
def test_bounds_are_checked_in_what_a_kernel_calls_too(tmp_path, how):
    """What the third pass of scripts/test rests on."""
    done = ran(tmp_path, BEYOND % how, NUMBA_BOUNDSCHECK="1")
    assert done.stdout.strip() == "checked", done.stderr


@pytest.mark.processes
def test_a_cache_that_is_lost_on_the_way_stops_nothing(tmp_path, script):
    assert twice(script, tmp_path / "cache", tmp_path / "cache") == "42.0 0"


@pytest.mark.processes
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
