"""Modules in the working folder are not executed: Python's own names, and those of libraries.

Without the option -P, `python -c …`, with which `multiprocessing` starts processes, has the working folder
in front of `sys.path` (https://docs.python.org/3/using/cmdline.html#cmdoption-c).
"""

import re
import subprocess
import sys
from pathlib import Path

import pytest

import flexmb_cli

PACKAGE = Path(flexmb_cli.__file__).parent
DECKS = PACKAGE.parent / "decks"
LIBRARIES = (
    "numpy",
    "numba",
    "llvmlite",
    "h5py",
    "click",
    "scipy",
    "flexmb_cli",
    "sitecustomize",
    "distributed",
)
# What pip makes of the entry point, in a folder of its own.
SCRIPT = """import sys
sys.path[0:0] = [{package!r}]
from flexmb_cli.__main__ import program
if __name__ == "__main__":
    sys.exit(program())
"""
STUDY = """deck = "IN4-BAR.dat"
[parameters]
"driver.1.B" = [1.0, 1.1, 1.2]
[results]
last = "last body.2.omega.x"
"""


@pytest.fixture
def hostile(tmp_path):
    """A folder with decks, a study, and a module under every name that could be imported."""
    folder = tmp_path / "work"
    folder.mkdir()
    for name in ("IN1-1-1.dat", "IN4-BAR.dat"):
        (folder / name).write_bytes((DECKS / "young" / name).read_bytes())
    (folder / "study.toml").write_text(STUDY)
    for name in (*sys.stdlib_module_names, *LIBRARIES):
        text = f"open({str(tmp_path / 'executed')!r}, 'a').write({name!r} + ' ')\n"
        (folder / f"{name}.py").write_text(text + "raise SystemExit(66)\n")
    return folder


def flexmb(folder, *words, flags=()):
    """Run the command as its script does; return the exit code, and the modules of the folder that ran."""
    script = folder.parent / "bin" / "flexmb"
    script.parent.mkdir(exist_ok=True)
    script.write_text(SCRIPT.format(package=str(PACKAGE.parent)))
    done = subprocess.run(
        [sys.executable, *flags, str(script), *words], cwd=folder, capture_output=True, text=True, timeout=300
    )
    executed = folder.parent / "executed"
    return done.returncode, executed.read_text() if executed.exists() else ""


@pytest.mark.processes
@pytest.mark.parametrize(("words", "flags"), [
    (["run", "IN1-1-1.dat", "IN4-BAR.dat", "-j", "2", "-q"], ()),
    (["sweep", "study.toml", "-j", "2", "-q"], ("-E",)),
])  # fmt: skip
def test_processes_of_a_command_execute_nothing_of_the_folder(hostile, words, flags):
    """With -E Python passes over PYTHONSAFEPATH, which would otherwise do."""
    assert flexmb(hostile, *words, flags=flags) == (0, "")


@pytest.mark.campaign
def test_commands_of_one_process_execute_nothing_of_the_folder(hostile):
    for words in (["check"], ["verify"], ["run", "-q"]):
        assert flexmb(hostile, *words, "IN4-BAR.dat") == (0, "")
    for words in (["compile", "--list"], ["examples"], ["sweep", "study.toml", "-q"]):
        assert flexmb(hostile, *words) == (0, "")


@pytest.mark.campaign
def test_a_study_on_a_cluster_executes_nothing_of_the_folder(hostile):
    from distributed import LocalCluster

    with LocalCluster(n_workers=1, threads_per_worker=1, dashboard_address=None) as cluster:
        words = ["sweep", "study.toml", "-q", "--scheduler", cluster.scheduler_address]
        assert flexmb(hostile, *words) == (0, "")


def test_workers_are_the_only_processes_that_the_package_starts():
    """So the tests above, of the two commands that have workers, are of all processes."""
    starting = re.compile(
        r"\b(subprocess|multiprocessing|runpy|pty|webbrowser|ProcessPoolExecutor)\b(?! does)"
        r"|\bos\.(exec|spawn|posix_spawn|fork|popen|system|startfile)|\.(Process|Popen)\("
    )
    found = set()
    for path in PACKAGE.rglob("*.py"):
        code = [
            line for line in path.read_text(encoding="utf-8").splitlines() if "import " in line or "(" in line
        ]
        found |= {path.relative_to(PACKAGE).as_posix() for line in code if starting.search(line)}
    # `flexmb docs` opens a browser, which reads no deck.
    assert found == {"cli/docs.py"} | {f"run/processes/{name}.py" for name in ("signal_mask", "worker")}
