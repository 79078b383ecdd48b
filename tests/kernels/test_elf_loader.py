"""Objects of x86-64 Linux, placed in memory without LLVM.

Expected values are what Python computes of the same functions; kinds of sections and relocations are those of
the System V ABI, AMD64 supplement, figure 4.9 and table 4.9 (R_X86_64_GOTPCREL is 9, R_X86_64_PC32 2).
"""

import math
import struct
import sys

import numpy as np
import pytest

from flexmb_cli.kernels import _entry, _jit, _objects
from flexmb_cli.kernels._jit import allocating

pytestmark = [
    pytest.mark.skipif(_jit.interpreted(), reason="nothing is compiled"),
    pytest.mark.skipif(
        _objects.target() != "x86_64-linux", reason="objects of this system are loaded by LLVM"
    ),
]

WEIGHTS = (0.5, -1.25, 3.0, 7.5, -2.0)


def mixed(angles, place):
    """Call the C library, read a table of constants, and keep numbers in memory of its own."""
    turned = np.zeros(len(angles))
    for k in range(len(angles)):
        turned[k] = math.sin(angles[k]) * math.cos(angles[k]) + math.atan2(angles[k], 2.0)
    return float(turned.sum()) + WEIGHTS[place] * angles[0] ** 1.7


@pytest.fixture(scope="module")
def code():
    parameters = [["a", 1, "<f8"], "i"]
    made = _entry.emit("mixed", [(allocating(mixed), "mixed", parameters)], "0" * 16, ["x86_64-linux"])
    return made["x86_64-linux"]


def loaded_by(name, content, monkeypatch):
    """The function `mixed` as one of the loaders gives it."""
    refused = {"elf": "_llvm_engine", "llvm": "_elf_engine"}[name]
    monkeypatch.setattr(_objects, refused, lambda _: None)
    return _objects.load(content, "mixed", "0" * 16)["mixed"][0]


@pytest.mark.parametrize("loader", ["elf", "llvm"])
@pytest.mark.parametrize("place", range(len(WEIGHTS)))
def test_loaded_code_computes_what_python_does(code, monkeypatch, loader, place):
    angles = np.array([0.3, -1.1, 2.7])
    taken, found = loaded_by(loader, code, monkeypatch).call((angles, place))
    assert taken and found == pytest.approx(mixed(angles, place), rel=1e-14)


def relocations(code):
    """Places of all entries of the tables of relocations (section header: kind at 4, offset 24, size 32)."""
    first, (size, count) = struct.unpack_from("<Q", code, 40)[0], struct.unpack_from("<HH", code, 58)
    for place in range(first, first + size * count, size):
        if struct.unpack_from("<I", code, place + 4)[0] == 4:
            begin, length = struct.unpack_from("<QQ", code, place + 24)
            yield from range(begin, begin + length, 24)


def test_an_object_with_unknown_relocations_is_left_to_llvm(code):
    """As newer LLVM may make them."""
    from flexmb_cli.kernels._elf_loader import LoadedObject, NotLoadedError

    changed = bytearray(_objects.read(code)[1])
    place = next(place for place in relocations(changed) if changed[place + 8] == 2)
    changed[place + 8] = 9
    with pytest.raises(NotLoadedError, match="another type"):
        LoadedObject(bytes(changed))
    assert _objects._elf_engine(bytes(changed)) is None


def test_loaded_code_cannot_be_overwritten(code):
    from flexmb_cli.kernels._elf_loader import LoadedObject

    loaded = LoadedObject(_objects.read(code)[1])
    with open("/proc/self/maps", encoding="ascii") as maps:
        rights = {line.split("-")[0]: line.split()[1] for line in maps}
    assert rights[f"{loaded._base:x}"] == "r-xp"


def test_no_function_needs_llvmlite(code, monkeypatch):
    """llvmlite is imported where this loader gives up, nowhere else."""
    monkeypatch.setitem(sys.modules, "llvmlite.binding", None)
    assert _objects.load(code, "mixed", "0" * 16)
