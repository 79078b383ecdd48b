"""`scripts/release`: one version in all files; wheels of platforms are parts of the whole one."""

import runpy
import subprocess
import sys
import zipfile
from pathlib import Path

import pytest

TOP = Path(__file__).resolve().parents[2]
release = runpy.run_path(str(TOP / "scripts" / "release"))
INFO = "flexmb-0.1.0.dist-info"
LIBRARIES = [f"flexmb_cli/kernels/libraries/{target}.lib" for target in release["TAGS"]]


@pytest.fixture
def whole(tmp_path):
    """A wheel as setuptools writes it, with a library for each platform."""
    path = tmp_path / "flexmb-0.1.0-py3-none-any.whl"
    with zipfile.ZipFile(path, "w") as wheel:
        for name in ("flexmb_cli/__init__.py", *LIBRARIES, f"{INFO}/RECORD"):
            wheel.writestr(name, name)
        wheel.writestr(f"{INFO}/METADATA", "Metadata-Version: 2.1\nName: flexmb\nVersion: 0.1.0\n")
        said = "Wheel-Version: 1.0\nGenerator: test\nRoot-Is-Purelib: true\nTag: py3-none-any\n"
        wheel.writestr(f"{INFO}/WHEEL", said)
    return path


def test_all_files_name_one_version():
    from flexmb_cli import __version__

    assert release["version"]() == __version__


def test_files_of_two_versions_are_refused(tmp_path, monkeypatch):
    for file in release["VERSIONS"]:
        (tmp_path / file).parent.mkdir(parents=True, exist_ok=True)
        text = (TOP / file).read_text(encoding="utf-8")
        (tmp_path / file).write_text(text.replace("version: 0.1.0", "version: 0.2.0"), encoding="utf-8")
    monkeypatch.setitem(release["version"].__globals__, "TOP", tmp_path)
    with pytest.raises(SystemExit, match=r"CITATION\.cff': '0\.2\.0"):
        release["version"]()


@pytest.mark.parametrize("target", release["TAGS"])
def test_a_wheel_of_a_platform_has_its_library_alone_and_its_tag(whole, tmp_path, target):
    path = release["part"](whole, target, tmp_path)
    assert path.name == f"flexmb-0.1.0-py3-none-{release['TAGS'][target]}.whl"
    with zipfile.ZipFile(path) as wheel:
        libraries = [name for name in wheel.namelist() if "/libraries/" in name]
        said = wheel.read(f"{INFO}/WHEEL").decode()
    assert libraries == [f"flexmb_cli/kernels/libraries/{target}.lib"]
    assert f"Tag: py3-none-{release['TAGS'][target]}\n" in said and "Purelib: false" in said


def test_pip_installs_a_wheel_of_this_platform_by_its_record(whole, tmp_path):
    """pip checks name and tag, and takes any platform with --target."""
    path = release["part"](whole, "arm64-windows", tmp_path)
    command = [sys.executable, "-m", "pip", "install", "-q", "--no-deps", "--no-index", "--target"]
    command += [tmp_path / "site", "--platform", "win_arm64", "--only-binary=:all:", path]
    subprocess.run(command, check=True, timeout=120)
    assert (tmp_path / "site/flexmb_cli/kernels/libraries/arm64-windows.lib").exists()


def test_a_wheel_whose_file_is_not_that_of_its_record_is_refused(whole, tmp_path):
    path = release["part"](whole, "x86_64-linux", tmp_path)
    changed = tmp_path / "changed.whl"
    with zipfile.ZipFile(path) as old, zipfile.ZipFile(changed, "w") as new:
        for one in old.infolist():
            new.writestr(one, old.read(one) + b"#" * one.filename.endswith("__init__.py"))
    with pytest.raises(SystemExit, match="__init__"):
        release["inspect"](changed, "x86_64-linux")
