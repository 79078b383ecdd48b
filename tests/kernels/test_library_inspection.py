"""What the inspection of a wheel's libraries finds in them."""

import importlib.machinery
import importlib.util
import runpy
import shutil
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

from flexmb_cli.kernels import _entry, _jit
from flexmb_cli.kernels._library import library_name
from flexmb_cli.kernels.signatures import PROCESSORS, UNITS

TOP = Path(__file__).resolve().parents[2]
HERE = "x86_64-linux"


@pytest.fixture(scope="module")
def script():
    loader = importlib.machinery.SourceFileLoader("inspect_libraries", str(TOP / "scripts/inspect_libraries"))
    module = importlib.util.module_from_spec(importlib.util.spec_from_loader(loader.name, loader))
    loader.exec_module(module)
    return module


@pytest.fixture(scope="module")
def library(tmp_path_factory):
    """A library of this machine, linked by its own compiler: a function that calls two of C's."""
    if not shutil.which("cc") or not sys.platform.startswith("linux"):
        pytest.skip("no C compiler")
    folder = tmp_path_factory.mktemp("library")
    (folder / "x.c").write_text(
        "#include <math.h>\ndouble one(double a, double b) { return atan2(a, b) + tan(a); }\n"
    )
    subprocess.run(
        ["cc", "-shared", "-fPIC", "-nostartfiles", "-o", "x.so", "x.c", "-lm"], cwd=folder, check=True
    )
    return folder / "x.so"


def test_names_of_a_library_are_those_that_nm_finds(script, library):
    own, foreign = script.names(library.read_bytes())
    assert (own, foreign) == ({"one"}, {"atan2", "tan"})
    said = subprocess.run(["nm", "-D", library], capture_output=True, text=True, check=True).stdout
    assert {line.split()[-1].partition("@")[0] for line in said.splitlines()} == own | foreign


def test_what_multiplies_and_adds_at_once_is_recognised(script):
    """fmadd, fmsub d0; fmla v0.2d by vector and by element, fmls and fmla d0 by element (Arm ARM, C7.2)."""
    at_once = [0x1F420C20, 0x1F428C20, 0x4E62CC20, 0x4FC21020, 0x4FC25020, 0x5FC21020]
    assert script.is_fused(np.array(at_once, np.uint32)).all()
    # fmul and fadd d0; fmul v0.2d by vector and by element; ret
    apart = [0x1E620820, 0x1E612800, 0x6E62DC20, 0x4FC29020, 0xD65F03C0]
    assert not script.is_fused(np.array(apart, np.uint32)).any()


def test_a_library_without_kernels_is_refused(script, library, monkeypatch, capsys):
    shutil.copy(library, library.with_name(library_name(HERE)))
    monkeypatch.setattr("sys.argv", ["inspect_libraries", str(library.parent)])
    assert script.main() == 1
    said = capsys.readouterr().out
    assert "lacks: flexmb_constrained_accelerations_accelerations " in said and "not of" not in said


@pytest.mark.campaign
@pytest.mark.skipif(_jit.interpreted(), reason="nothing is compiled")
def test_libraries_of_all_systems_have_all_kernels_and_call_c_alone(script, tmp_path, monkeypatch, capsys):
    """One unit stands for all, which take minutes; Zig links for each system."""
    pytest.importorskip("ziglang")
    setup = runpy.run_path(str(TOP / "setup.py"), run_name="setup")
    made = _entry.Unit("equations").emit(list(PROCESSORS))
    for target, name in setup["ZIG"].items():
        zig = [sys.executable, "-m", "ziglang", "cc", "-target", name]
        setup["link"](zig, {"equations": made[target]}, tmp_path / library_name(target))
    monkeypatch.setattr(script, "UNITS", {"equations": UNITS["equations"]})
    monkeypatch.setattr("sys.argv", ["inspect_libraries", str(tmp_path)])
    assert script.main() == 0
    said = capsys.readouterr().out
    assert said.count(" names; it calls ") == len(PROCESSORS)
    assert said.count("  0 instructions multiply and add at once") == 3
