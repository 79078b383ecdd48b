"""A missing extra is reported before any work, with the command that installs it here, and leaves no file."""

import os
import shlex
import shutil
import subprocess
import sys
import tomllib
import venv
from importlib import metadata
from pathlib import Path

import pytest

from flexmb_cli import installation
from flexmb_cli.kernels import _jit

TOP = Path(__file__).resolve().parents[2]
# A module that is None cannot be imported; the program starts as `python -m flexmb_cli` does.
WITHOUT = "import sys; sys.modules[{module!r}] = None; from flexmb_cli.__main__ import main; main()"
STUDY = """
deck = "IN4-BAR.dat"
[parameters]
"driver.1.B" = { from = 3.0, to = 3.2, count = 3 }
[results]
top = "max body.3.z"
"""


@pytest.fixture
def folder(tmp_path):
    """A folder with a deck, a study and a result that is enough to be found."""
    shutil.copy(TOP / "decks/young/IN4-BAR.dat", tmp_path)
    (tmp_path / "study.toml").write_text(STUDY)
    (tmp_path / "r.h5").write_bytes(b"")
    return tmp_path


@pytest.mark.processes
@pytest.mark.parametrize(
    ("module", "arguments", "extra"),
    [
        ("matplotlib", ["plot", "r.h5", "-o", "p.png"], "plot"),
        ("pyarrow", ["sweep", "study.toml", "-o", "t.parquet"], "parquet"),
        ("distributed", ["sweep", "study.toml", "--scheduler", "tcp://127.0.0.1:1"], "cluster"),
    ],
)
def test_a_missing_extra_is_reported_before_any_work(module, arguments, extra, folder):
    before = sorted(folder.iterdir())
    code = WITHOUT.format(module=module)
    done = subprocess.run(
        [sys.executable, "-c", code, *arguments], capture_output=True, text=True, cwd=folder, timeout=60
    )
    assert (done.returncode, done.stdout) == (2, "")
    (line,) = done.stderr.splitlines()  # and no "Usage:" above it
    assert line.startswith("flexmb: error: ")
    assert f"needs {module}, which" in line
    assert "install it with: " in line and "install" in shlex.split(line.partition("install it with: ")[2])
    assert sorted(folder.iterdir()) == before


@pytest.mark.processes
@pytest.mark.skipif(_jit.interpreted(), reason="nothing is compiled")
def test_without_numba_a_kernel_that_no_object_has_is_refused(folder):
    """A wheel with objects works without numba, until a damaged object has to be compiled again."""
    (folder / "none").mkdir()  # without a TMPDIR that is there, /tmp may hold this machine's kernels
    nowhere = dict.fromkeys(("NUMBA_CACHE_DIR", "XDG_CACHE_HOME", "HOME", "TMPDIR"), str(folder / "none"))
    done = subprocess.run(
        [sys.executable, "-c", WITHOUT.format(module="numba"), "run", "IN4-BAR.dat"],
        capture_output=True, text=True, cwd=folder, timeout=60, env=os.environ | nowhere,
    )  # fmt: skip
    assert done.returncode == 2
    (line,) = done.stderr.splitlines()
    assert "compiling kernels needs numba, which is not installed; install it with: " in line
    assert sorted(path.name for path in folder.iterdir()) == ["IN4-BAR.dat", "none", "r.h5", "study.toml"]


def test_in_a_checkout_the_command_names_its_own_pip_and_folder(monkeypatch):
    checkout = installation._checkout()
    if checkout is None:
        pytest.skip("flexmb is installed from a wheel")
    monkeypatch.chdir(checkout)
    _pip, *rest = shlex.split(installation.install_command("plot"))
    assert rest[-2:] == ["-e", ".[plot]"]
    monkeypatch.chdir("/")
    assert shlex.split(installation.install_command("plot"))[-1] == f"{checkout}[plot]"


def test_a_wheel_is_not_looked_for_on_an_index(monkeypatch):
    monkeypatch.setattr(installation, "_checkout", lambda: None)
    command = shlex.split(installation.install_command("plot"))
    assert command[-2] == "install"
    assert command[-1].startswith("matplotlib>=")
    assert "flexmb" not in " ".join(command[1:])


def test_the_command_for_films_installs_what_they_draw_with(monkeypatch):
    """`movie` names `flexmb[plot]`: the command named matplotlib as missing and did not install it."""
    monkeypatch.setattr(installation, "_checkout", lambda: None)
    command = shlex.split(installation.install_command("movie"))
    required = tomllib.loads((TOP / "pyproject.toml").read_text())["project"]["optional-dependencies"]
    wanted = {name for name in required["movie"] if not name.startswith("flexmb[")} | set(required["plot"])
    assert set(command[command.index("install") + 1 :]) == wanted


def test_every_extra_of_users_has_libraries_to_name():
    for extra in ("plot", "report", "parquet", "cluster"):
        assert extra in metadata.metadata("flexmb").get_all("Provides-Extra")
        assert installation._libraries(extra) != [extra]


@pytest.mark.processes
def test_the_command_in_a_fresh_environment_names_a_pip_that_is_there(tmp_path, monkeypatch):
    """In `.venv` of the current folder the command is `.venv/bin/pip install …`, as one types it there."""
    venv.create(tmp_path / ".venv", with_pip=False, symlinks=True)
    pip = tmp_path / ".venv/bin/pip"
    pip.touch()
    code = f"import sys; sys.path[:0] = [{str(TOP)!r}]"
    code += "\nfrom flexmb_cli.installation import _installer as told\nprint(told())"
    ask = [str(tmp_path / ".venv/bin/python"), "-c", code]
    reported = subprocess.run(ask, capture_output=True, text=True, cwd=tmp_path, timeout=60)
    assert reported.stdout == ".venv/bin/pip install\n"
    pip.unlink()
    reported = subprocess.run(ask, capture_output=True, text=True, cwd=tmp_path, timeout=60)
    assert reported.stdout == "uv pip install --python .venv/bin/python\n"
