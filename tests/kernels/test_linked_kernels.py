"""What kernels call is linked into them."""

import os
import subprocess
import sys

import pytest

from flexmb_cli.kernels import _jit

pytestmark = pytest.mark.skipif(_jit.interpreted(), reason="nothing is compiled")


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
    """Offered to LLVM after the part that only names it, it was left out, and the process ended."""
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


OVERLAPPING = """
import numpy as np
from flexmb_cli.kernels._jit import allocating

@allocating
def assign(a, b):
    a[:, 0] = b[:, 1]

assign(np.zeros((3, 3)), np.ones((3, 3)))
"""


@pytest.mark.processes
def test_a_kernel_that_assigns_an_array_to_an_array_is_refused(tmp_path):
    """numba takes memory of its own in case they overlap; loaded from the cache it ended the process."""
    done = ran(tmp_path, OVERLAPPING)
    assert done.returncode == 1 and "assign an array to an array" in done.stderr


BEYOND = """
import numpy as np
from flexmb_cli.kernels._jit import kernel, part

@%s
def at(a, place):
    return a[place]

@kernel
def beyond(a, place):
    return at(a, place)

try:
    beyond(np.zeros(2), %d)
except IndexError:
    print("checked")
"""


@pytest.mark.parametrize(("how", "place"), [("kernel", 2), ("part", -1)])
def test_bounds_are_checked_in_what_a_kernel_calls_too(tmp_path, how, place):
    """What the fourth pass of scripts/test rests on; kernels do not count from the end."""
    for _ in ("compiled", "loaded"):
        done = ran(tmp_path, BEYOND % (how, place), NUMBA_BOUNDSCHECK="1")
        assert done.stdout.strip() == "checked", done.stderr
