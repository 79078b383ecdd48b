"""What the inspection of a wheel's objects finds in them."""

import importlib.machinery
import importlib.util
import math
import shutil
import subprocess
from pathlib import Path

import numpy as np
import pytest

from flexmb_cli.kernels import _entry, _jit, _objects
from flexmb_cli.kernels._jit import kernel
from flexmb_cli.kernels.signatures import PROCESSORS

SCRIPT = str(Path(__file__).resolve().parents[2] / "scripts" / "inspect_objects")


@pytest.fixture(scope="module")
def script():
    loader = importlib.machinery.SourceFileLoader("inspect_objects", SCRIPT)
    module = importlib.util.module_from_spec(importlib.util.spec_from_loader(loader.name, loader))
    loader.exec_module(module)
    return module


def calling(a, b):
    """What calls the C library."""
    return math.atan2(a, b) + math.tan(a) ** b


@pytest.fixture(scope="module")
def codes():
    if _jit.interpreted():
        pytest.skip("nothing is compiled")
    made = _entry.emit("calling", [(kernel(calling), "calling", ["f", "f"])], "0" * 16, list(PROCESSORS))
    return {target: _objects.read(content)[1] for target, content in made.items()}


@pytest.mark.parametrize("target", PROCESSORS)
def test_foreign_functions_are_found_in_the_objects_of_every_system(script, codes, target):
    marks = {"_fltused"} if target.endswith("windows") else set()
    assert script.foreign_names(codes[target]) - marks == {"atan2", "tan", "pow"}


@pytest.mark.skipif(not shutil.which("nm"), reason="no nm to compare with")
def test_foreign_functions_are_those_that_nm_finds(script, codes, tmp_path):
    (tmp_path / "x.o").write_bytes(codes["x86_64-linux"])
    reported = subprocess.run(
        ["nm", "-u", tmp_path / "x.o"], capture_output=True, text=True, check=True
    ).stdout
    assert script.foreign_names(codes["x86_64-linux"]) == {line.split()[-1] for line in reported.splitlines()}


def test_what_multiplies_and_adds_at_once_is_recognised(script):
    """fmadd, fmsub d0; fmla v0.2d by vector and by element, fmls and fmla d0 by element (Arm ARM, C7.2)."""
    at_once = [0x1F420C20, 0x1F428C20, 0x4E62CC20, 0x4FC21020, 0x4FC25020, 0x5FC21020]
    assert script.is_fused(np.array(at_once, np.uint32)).all()
    # fmul and fadd d0; fmul v0.2d by vector and by element; ret
    apart = [0x1E620820, 0x1E612800, 0x6E62DC20, 0x4FC29020, 0xD65F03C0]
    assert not script.is_fused(np.array(apart, np.uint32)).any()


def test_a_wheel_is_inspected_as_a_whole(script, codes, tmp_path, monkeypatch, capsys):
    for target, code in codes.items():
        (tmp_path / target).mkdir()
        (tmp_path / target / "x.object").write_bytes(_objects.write({"target": target}, code))
    monkeypatch.setattr("sys.argv", ["inspect_objects", str(tmp_path)])
    assert script.main() == 0
    monkeypatch.setattr(_objects, "OF_C", _objects.OF_C - {"tan"})
    assert script.main() == 1
    assert capsys.readouterr().out.count("not of the C library: tan") == len(PROCESSORS)
