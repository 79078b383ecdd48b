"""Compiled objects: the same for the same text, and of every system's format."""

import os
import subprocess
import sys

import numpy as np
import pytest

from flexmb_cli.kernels import _arguments, _entry, _jit, signatures
from flexmb_cli.kernels.constrained import speeds


@pytest.fixture(scope="module")
def for_all_machines():
    """The objects of a small kernel, for every target."""
    if _jit.interpreted():
        pytest.skip("nothing is compiled")
    parameters = {"constrained.speeds.normalise": ["i", _arguments.Array(1, np.dtype(float))]}
    return _entry.Unit("small", parameters, speeds.normalise).emit(list(signatures.PROCESSORS))


# First bytes of object files by system: ELF, Mach-O, COFF with the number of the machine.
FORMATS = {"linux": b"\x7fELF", "macos": b"\xcf\xfa\xed\xfe"}
MACHINES = {"x86_64-windows": b"\x64\x86", "arm64-windows": b"\x64\xaa"}


def test_every_system_gets_objects_of_its_format(for_all_machines):
    assert set(for_all_machines) == set(signatures.PROCESSORS)
    for target, code in for_all_machines.items():
        assert code.startswith(MACHINES.get(target) or FORMATS[target.partition("-")[2]]), target


def test_the_same_text_gives_the_same_object(for_all_machines):
    """No address of the compiling process, and nothing of its surroundings, gets into it."""
    code = (
        "import numpy as np\n"
        "from flexmb_cli.kernels import _arguments, _entry\n"
        "from flexmb_cli.kernels.constrained import speeds\n"
        "parameters = {'speeds.normalise': ['i', _arguments.Array(1, np.dtype(float))]}\n"
        "import hashlib\n"
        "made = _entry.Unit('one', parameters, speeds.normalise).emit(['x86_64-linux'])\n"
        "print(hashlib.sha256(made['x86_64-linux']).hexdigest())\n"
    )
    said = {
        subprocess.run(
            [sys.executable, "-c", code], capture_output=True, text=True, check=True, timeout=300,
            env=os.environ | {"PYTHONHASHSEED": seed},
        ).stdout
        for seed in "12"
    }  # fmt: skip
    assert len(said) == 1
