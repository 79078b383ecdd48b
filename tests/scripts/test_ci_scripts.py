"""What CI prints last, and that it waits for the package manager; what the scripts start is stood in for."""

import os
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

pytestmark = [pytest.mark.processes, pytest.mark.skipif(sys.platform == "win32", reason="shell scripts")]

TOP = Path(__file__).resolve().parents[2]
TOOLS = (
    "bash",
    "sh",
    "env",
    "dirname",
    "seq",
    "sleep",
    "timeout",
    "grep",
    "tail",
    "sed",
    "sort",
    "date",
    "awk",
)
MORE = ("tee", "mktemp", "rm", "cat", "printf")
PACKAGES = ("calculix-ccx", "chromium chromium-driver", "netcdf-bin", "strace")
PACKAGES += ("git", "binutils", "groff", "zsh", "fish")
CLOSING = "2 passed, 1 skipped in 3.21s"
SKIPPED = (
    "SKIPPED [1] tests/fe/test_calculix.py:9: CalculiX (ccx, Debian package calculix-ccx) is not installed"
)


def program(path, text):
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_text(f"#!/bin/sh\n{text}\n")
    path.chmod(0o755)


@pytest.fixture
def checkout(tmp_path):
    """A folder with CI's scripts, and `bin` with what a bare machine has."""
    for name in (".ci/run", "scripts/test"):
        (tmp_path / name).parent.mkdir(exist_ok=True)
        shutil.copy(TOP / name, tmp_path / name)
    for tool in (*TOOLS, *MORE):
        (tmp_path / "bin").mkdir(exist_ok=True)
        (tmp_path / "bin" / tool).symlink_to(shutil.which(tool))
    program(tmp_path / "bin" / "id", "echo 0")
    program(tmp_path / "scripts" / "venv", "exit 0")
    program(tmp_path / ".venv" / "bin" / "ruff", "exit 0")
    program(tmp_path / ".venv" / "bin" / "mypy", "exit 0")
    program(tmp_path / ".venv" / "bin" / "coverage", '[ "$1" != run ] || exec .venv/bin/python "$@"')
    program(tmp_path / ".venv" / "bin" / "python", f'echo "{SKIPPED}"; echo "{CLOSING}"; exit "${{ENDS:-0}}"')
    return tmp_path


def run(checkout, script, *arguments, **environment):
    done = subprocess.run(
        [checkout / script, *arguments], capture_output=True, text=True, timeout=60,
        env={"PATH": str(checkout / "bin"), "FLEXMB_CI_PAUSE": "0", **environment},
    )  # fmt: skip
    return done.returncode, done.stdout.splitlines(), done.stderr


def with_packages(checkout, refused):
    """An apt-get that refuses the first calls, as one whose lock is held, and then installs."""
    calls = checkout / "calls"
    installs = "".join(
        f"[ $word = {package} ] && : >bin/{name} && chmod 755 bin/{name}\n"
        for package, name in (
            ("calculix-ccx", "ccx"),
            ("chromium-driver", "chromedriver"),
            ("netcdf-bin", "ncdump"),
            ("strace", "strace"),
            ("git", "git"),
            ("binutils", "nm"),
            ("groff", "groff"),
            ("zsh", "zsh"),
            ("fish", "fish"),
        )
    )
    os.symlink(shutil.which("chmod"), checkout / "bin" / "chmod")
    held = 'echo "E: Could not get lock"; exit 100'
    text = f'echo "$@" >>{calls}\nif [ $(grep -c . {calls}) -le {refused} ]; then {held}; fi'
    program(checkout / "bin" / "apt-get", f"{text}\nfor word in $@; do\n{installs}done\nexit 0")
    return calls


def test_ci_waits_for_the_package_manager_and_tries_again(checkout):
    calls = with_packages(checkout, refused=2)
    code, reported, errors = run(checkout, ".ci/run")
    assert (code, errors) == (0, "")
    assert (checkout / "bin" / "ccx").exists() and (checkout / "bin" / "chromedriver").exists()
    lines = calls.read_text().splitlines()
    assert all("DPkg::Lock::Timeout=300" in line for line in lines)
    assert sum("update" in line for line in lines) == 2 + 1
    assert sum("install" in line for line in lines) == len(PACKAGES)
    assert not any("not installed, tried" in line for line in reported)


def test_the_last_lines_of_ci_tell_what_was_skipped_and_why(checkout):
    with_packages(checkout, refused=99)
    code, reported, _ = run(checkout, ".ci/run", FLEXMB_CI_ATTEMPTS="2")
    assert code == 0
    why = "not installed, tried 2 times: E: Could not get lock"
    last = reported[-8 - len(PACKAGES) :]
    notes, last = last[: len(PACKAGES)], last[len(PACKAGES) :]
    assert notes == [f"scripts/test: {packages} {why}" for packages in PACKAGES]
    assert last[:2] == ["scripts/test: skipped tests and why:", SKIPPED]
    assert last[2].startswith("scripts/test: ") and last[2].endswith("min on two quiet cores")
    assert last[3:] == ["scripts/test: pytest closed its passes with", *[CLOSING] * 4]


def test_without_root_ci_installs_nothing_and_the_last_lines_name_what_is_missing(checkout):
    calls = with_packages(checkout, refused=0)
    program(checkout / "bin" / "id", "echo 1000")
    code, reported, errors = run(checkout, ".ci/run")
    notes = [f"{packages} not installed: that needs root" for packages in PACKAGES]
    assert code == 0 and not calls.exists()
    assert errors.splitlines() == [f"warning: {note}" for note in notes]
    assert reported[-8 - len(PACKAGES) : -6] == [
        *(f"scripts/test: {note}" for note in notes),
        "scripts/test: skipped tests and why:",
        SKIPPED,
    ]


def test_a_failing_pass_is_told_last_and_fails_ci(checkout):
    code, reported, _ = run(checkout, "scripts/test", ENDS="1")
    assert code == 1
    assert "scripts/test: failed: 1. physics, compiled" in reported[-10:]
    assert reported[-4:] == [CLOSING] * 4


def test_all_campaigns_run_and_one_that_finds_something_fails_the_script(checkout):
    for name in ("inject_faults", "fuzz/run", "determinism/run", "dependencies"):
        program(checkout / "scripts" / name, f'echo "{name} $@" >>{checkout}/campaigns')
    finds = f'echo "fuzz $1" >>{checkout}/campaigns; [ "$1" != megabytes ]'
    program(checkout / "scripts" / "fuzz" / "run", finds)
    code, reported, _ = run(checkout, "scripts/test", "--all")
    ran = (checkout / "campaigns").read_text()
    assert code == 1
    assert reported[-5:] == ["scripts/test: pytest closed its passes with", *[CLOSING] * 4]
    assert "scripts/test: failed: files of a megabyte" in reported
    wanted = (
        "inject_faults --seed",
        "inject_faults power",
        "inject_faults calls",
        "fuzz --count",
        "fuzz solved",
        "dependencies lowest",
        "dependencies highest",
    )
    assert all(word in ran for word in (*wanted, "fuzz bytes", "determinism/run rounds"))
