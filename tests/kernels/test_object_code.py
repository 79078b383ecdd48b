"""Compiled objects: the same for the same text, of every system's format, and without fused instructions."""

import os
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

from flexmb_cli.kernels import _entry, _jit, _objects, signatures
from flexmb_cli.kernels._jit import kernel
from flexmb_cli.kernels.constrained import speeds
from tests.kernels.test_compiled_objects import compiled


def product_and_sum(a, b, c):
    """What a processor with fused multiply-add can do at once, rounding once."""
    return a * b + c


@pytest.fixture(scope="module")
def for_all_machines():
    """The objects of two small kernels, for every target."""
    if _jit.interpreted():
        pytest.skip("nothing is compiled")
    entries = [
        (speeds.normalise, "constrained.speeds.normalise", ["i", ["a", 1, "<f8"]]),
        (kernel(product_and_sum), "product_and_sum", ["f", "f", "f"]),
    ]
    return _entry.emit("small", entries, "0" * 16, list(signatures.PROCESSORS))


def instructions(code):
    """The 32-bit words of the sections of an arm64 object that hold instructions."""
    import llvmlite.binding as llvm

    for section in llvm.ObjectFileRef.from_data(code).sections():
        if section.is_text():
            yield from np.frombuffer(section.data(), "<u4").tolist()


def is_fused(word):
    """Whether an arm64 instruction is FMADD, FMSUB, FNMADD, FNMSUB, FMLA or FMLS (Arm ARM, C4.1)."""
    return word >> 24 == 0x1F or word & 0xBF20FC00 == 0x0E20CC00


def test_fused_instructions_are_recognised():
    """fmadd and fmsub d0, d1, d2, d3, fmla v0.2d, v1.2d, v2.2d; fmul d0, d1, d2 and fadd d0, d0, d2."""
    assert all(map(is_fused, (0x1F420C20, 0x1F428C20, 0x4E62CC20)))
    assert not any(map(is_fused, (0x1E620820, 0x1E612800)))


@pytest.mark.parametrize("target", [name for name in signatures.PROCESSORS if name.startswith("arm64")])
def test_nothing_is_multiplied_and_added_at_once(for_all_machines, target):
    """Fused operations round once and give other digits than x86-64."""
    _, code = _objects.read(for_all_machines[target])
    found = list(instructions(code))
    multiplied = [word for word in found if word & 0xFFE0FC00 == 0x1E600800]  # fmul of doubles
    assert len(found) > 30 and multiplied
    assert not any(map(is_fused, found))


# First bytes of object files by system: ELF, Mach-O, COFF with the number of the machine.
FORMATS = {"linux": b"\x7fELF", "macos": b"\xcf\xfa\xed\xfe"}
MACHINES = {"x86_64-windows": b"\x64\x86", "arm64-windows": b"\x64\xaa"}


def test_every_system_gets_objects_of_its_format(for_all_machines):
    assert set(for_all_machines) == set(signatures.PROCESSORS)
    for target, content in for_all_machines.items():
        head, code = _objects.read(content)
        assert head["target"] == target
        assert code.startswith(MACHINES.get(target) or FORMATS[target.partition("-")[2]]), target


@compiled
def test_an_object_of_another_version_or_machine_is_not_loaded(for_all_machines):
    content = for_all_machines[_objects.target()]
    assert set(_objects.load(content, "small", "0" * 16)) == {
        "constrained.speeds.normalise",
        "product_and_sum",
    }
    other = next(target for target in for_all_machines if target != _objects.target())
    for foreign, digest in ((content, "1" * 16), (for_all_machines[other], "0" * 16)):
        with pytest.raises(_objects.OtherKernelsError):
            _objects.load(foreign, "small", digest)


@compiled
@pytest.mark.parametrize(
    "change",
    [
        lambda head, code: (head | {"unit": "constrained"}, code),
        lambda head, code: (head, b""),
        lambda head, code: (head, code[: len(code) // 2]),
        lambda head, code: (head, bytes(len(code))),
    ],
    ids=["of another unit", "without code", "with half of its code", "zeroed"],
)
def test_a_whole_file_with_other_code_is_compiled_again(for_all_machines, monkeypatch, change):
    """Its checksum is right: whoever copied, or wrote, it made that, too."""
    monkeypatch.setattr(_entry, "damaged", [])
    content = _objects.write(*change(*_objects.read(for_all_machines[_objects.target()])))
    assert not _entry._take("small", (Path("small.object"), content), "0" * 16, "it is compiled again")
    assert _entry.damaged == ["small.object is damaged: it is compiled again"]


@compiled
def test_an_object_without_the_kernel_wanted_is_a_miss(monkeypatch):
    monkeypatch.setattr(_entry, "_functions", {})
    monkeypatch.setattr(_entry, "_loaded", {"constrained"})
    assert not _entry.is_ready("constrained.accelerations.accelerations")


@compiled
def test_the_same_text_gives_the_same_object(for_all_machines):
    """No address of the compiling process, and nothing of its surroundings, gets into it."""
    code = (
        "from flexmb_cli.kernels import _entry, _objects\n"
        "from flexmb_cli.kernels.constrained import speeds\n"
        "entries = [(speeds.normalise, 'speeds.normalise', ['i', ['a', 1, '<f8']])]\n"
        "import hashlib\n"
        "made = _entry.emit('one', entries, '', [_objects.target()])\n"
        "print(hashlib.sha256(_objects.read(made[_objects.target()])[1]).hexdigest())\n"
    )
    said = {
        subprocess.run(
            [sys.executable, "-c", code], capture_output=True, text=True, check=True, timeout=300,
            env=os.environ | {"PYTHONHASHSEED": seed},
        ).stdout
        for seed in "12"
    }  # fmt: skip
    assert len(said) == 1
