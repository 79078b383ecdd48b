"""What a command imports: its own dialect and analysis, and no module that it could do without.

numpy, h5py and click take half of the time of a run; each heavy module more shows in every run.
"""

import os
import subprocess
import sys
from pathlib import Path

import pytest

from flexmb_cli.kernels import _jit
from tests.results.results import write_result

pytestmark = pytest.mark.processes

DECKS = Path(__file__).resolve().parents[2] / "decks"
CHILD = """
import sys
{before}
before = set(sys.modules)
from flexmb_cli.__main__ import main
sys.argv = ["flexmb", *{arguments!r}]
try:
    main()
except SystemExit as ending:
    assert not ending.code, ending.code
print(*sorted(set(sys.modules) - before), file=sys.stderr)
"""
# Modules of the standard library that cost a millisecond or more, and that Python and click do without.
HEAVY = {
    "asyncio", "bz2", "concurrent", "csv", "ctypes", "datetime", "difflib", "email",
    "hashlib", "http", "json", "logging", "lzma", "multiprocessing", "pickle", "platform",
    "random", "secrets", "shutil", "socket", "ssl", "statistics", "subprocess", "tempfile",
    "tokenize", "tomllib", "unittest", "urllib", "xml", "zipfile",
}  # fmt: skip
# Beyond those that numpy and h5py import.  llvmlite, which wheels do without, needs the second line.
OF_RUNS = {"difflib", "hashlib", "json"}
OF_LLVM = {"bz2", "lzma", "platform", "random", "shutil", "tempfile", "zipfile"}


def imported(tmp_path, *arguments, before="", **environment):
    """Names of the modules that a command imports, in a process of its own."""
    code = CHILD.format(before=before, arguments=tuple(map(str, arguments)))
    given = {name: value for name, value in os.environ.items() if name != "NUMBA_DISABLE_JIT"}
    done = subprocess.run(
        [sys.executable, "-c", code], capture_output=True, text=True, cwd=tmp_path, timeout=600,
        env=given | {"FLEXMB_CACHE_DIR": str(tmp_path), "OPENBLAS_NUM_THREADS": "1"} | environment,
    )  # fmt: skip
    assert done.returncode == 0, done.stderr
    return set(done.stderr.splitlines()[-1].split())


def strangers(modules):
    """What is neither flexmb's nor of the standard library."""
    tops = {name.partition(".")[0] for name in modules} - set(sys.stdlib_module_names) - {"flexmb_cli"}
    return {name for name in tops if not name.startswith(("_", "cython_runtime"))}


def heavy(modules):
    """The heavy ones of the standard library."""
    return HEAVY & {name.partition(".")[0] for name in modules}


def own(modules):
    """flexmb's, without its name, and without those that only name commands."""
    return {name.removeprefix("flexmb_cli.") for name in modules if name.startswith("flexmb_cli.")}


TREES = {"tree", "kane", "dafms", "implicit"}
CONSTRAINED = {"constrained", "mass_matrix", "multipliers"}
# Trees share kernels of time functions and friction.
OF_MECHANISMS = {"solvers.constrained", "mass_matrix", "multipliers"}
FLEXIBLE = {"vsdf", "fe_files", "fe.", "flexible_dynamics", "build_mechanism"}
INTEGRATIONS = {"generalised_alpha", "radau5"}
OF_SOLVING = {"kernels", "model", "run.check", "run.solution", "solvers.kinematics", "solvers.constrained"}
# A deck of each dialect and analysis, what is changed in it, and words that no module of its run may have.
RUNS = {
    "young": ("young/IN1-1-1.dat", (), TREES | CONSTRAINED | FLEXIBLE),
    "young forward": ("young/dynamics/IN-ANDREWS.dat", ("time.end=0.0001",), TREES | FLEXIBLE | INTEGRATIONS),
    "dafms": (
        "dafms/pendulum.DAT",
        ("time.IT=2",),
        OF_MECHANISMS
        | FLEXIBLE
        | {"implicit", "newton", "young", "flexible_", "element_table", "elements.build"},
    ),
    "vsdf": ("vsdf/pendulum.vsdf", ("time.end=0.0001",), TREES | {"radau5", "young"}),
}


@pytest.mark.parametrize("how", RUNS)
def test_a_run_imports_its_own_dialect_and_analysis(tmp_path, how):
    deck, changes, foreign = RUNS[how]
    options = [word for change in changes for word in ("--set", change)]
    found = imported(
        tmp_path, "run", "-q", *options, DECKS / deck, before="import numpy, h5py, click",
        NUMBA_DISABLE_JIT="1",
    )  # fmt: skip
    assert not [name for name in own(found) for word in foreign if word in name]
    assert strangers(found) <= {"h5py", "numpy"}
    # A flexible body is kept by way of a temporary file.
    keeping = {"random", "shutil", "tempfile", "bz2", "lzma"} if how == "vsdf" else set()
    assert heavy(found) <= OF_RUNS | keeping
    assert "numpy.ma" not in found  # 15 ms, for which numpy's functions on sets ask


@pytest.mark.skipif(_jit.interpreted(), reason="nothing is compiled")
@pytest.mark.parametrize("how", RUNS)
def test_a_later_run_needs_neither_numba_nor_scipy(tmp_path, how):
    deck, changes, _ = RUNS[how]
    options = [word for change in changes for word in ("--set", change)]
    for _ in ("compiled, perhaps", "loaded"):
        found = imported(tmp_path, "run", "-q", *options, DECKS / deck, before="import numpy, h5py, click")
    assert strangers(found) - {"h5py", "numpy"} == {"llvmlite"}
    assert heavy(found) <= OF_RUNS | OF_LLVM
    assert "flexmb_cli.fe.reduction" not in found
    # The body is kept: no element, and no reader but that of the nodes.
    readers = {"file_text", "formats", "matrix_file", "node_table"}
    files = {name.partition("fe.formats.")[2] for name in found} - {""}
    assert files == (readers if how == "vsdf" else set())
    assert not [name for name in found if name.startswith("flexmb_cli.fe.elements")]


# The words for `--method`, which are part of what describes a dialect: half a millisecond.
METHODS = {"model", "model.integrators"}
OF_CHECK = {"difflib", "hashlib", "json"}
LISTINGS, RESULTS = 2 * ["LISTING"], 2 * ["RESULT"]
# Arguments, heavy modules, packages, and words that no module of flexmb's has.
COMMANDS = {
    "--help": (["--help"], {"bz2", "lzma", "shutil"}, {"click"}, {"kernels", "dialects", "results"}),
    "check young": (
        ["check", "-q", DECKS / "young/IN4-BAR.dat"],
        OF_CHECK | {"random", "secrets"},  # of numpy: its estimates are far off, and other starts random
        {"click", "numpy"},
        TREES | CONSTRAINED | FLEXIBLE | {"results"},
    ),
    "check dafms": (
        ["check", "-q", DECKS / "dafms/pendulum.DAT"],
        OF_CHECK,
        {"click", "numpy"},
        OF_MECHANISMS | FLEXIBLE | {"implicit", "newton", "young", "flexible_", "results"},
    ),
    # A flexible body is reduced, and kept by way of a temporary file.
    "check vsdf": (
        ["check", "-q", DECKS / "vsdf/pendulum.vsdf"],
        OF_CHECK | {"bz2", "lzma", "random", "shutil", "tempfile"},
        {"click", "numpy"},
        TREES | {"radau5", "dop853", "young", "results"},
    ),
    "diff of listings": (["diff", *LISTINGS], {"hashlib", "json"}, {"click", "numpy"}, OF_SOLVING),
    "diff of results": (
        ["diff", *RESULTS],
        {"difflib", "hashlib", "json"},
        {"click", "numpy", "h5py"},
        OF_SOLVING | {"listing_reader"},
    ),
    "table": (
        ["table", "RESULT", "body.*.z"],
        {"csv", "difflib", "json"},
        {"click", "numpy", "h5py"},
        OF_SOLVING | {"dialects", "diff"},
    ),
    "table --list": (
        ["table", "RESULT", "--list"],
        {"csv", "difflib", "json"},
        {"click", "numpy", "h5py"},
        OF_SOLVING | {"dialects", "diff"},
    ),
}


def test_check_of_a_tree_with_elements_needs_no_integrator(tmp_path):
    """scipy's took 45 MB beside what a large deck may take, and `check` makes no step."""
    text = (DECKS / "dafms/pendulum.DAT").read_text()
    spring = "ELEMENTS\n  SPRING s at=1.r1 stiffness=1\n"
    deck = tmp_path / "spring.DAT"
    deck.write_text(f"{1:5d}{2:5d}\n" + text.split("\n", 1)[1].replace("END \n", f"{spring}END \n"))
    found = imported(tmp_path, "check", "-q", deck)
    assert "flexmb_cli.solvers.tree.attached_elements" in found
    assert "scipy" not in found


@pytest.mark.parametrize("command", COMMANDS)
def test_what_commands_import(tmp_path, command):
    arguments, heavy_ones, packages, foreign = COMMANDS[command]
    files = {"RESULT": write_result(tmp_path / "r.h5", 3), "LISTING": tmp_path / "table.OUT"}
    files["LISTING"].write_text("TIME= 0.000\n  1.0 2.0\n")
    # The packages first: what they import themselves, and h5py asks `uname` for, is none of flexmb's.
    before = f"import {', '.join(sorted(packages))}" if command != "--help" else ""
    found = imported(tmp_path, *(files.get(word, word) for word in arguments), before=before)
    assert strangers(found) <= packages
    assert heavy(found - imported_with(tmp_path, packages)) <= heavy_ones
    described = METHODS if command == "diff of listings" else set()
    assert not [name for name in own(found) - described for word in foreign if word in name]
    if command == "--help":
        assert {name for name in own(found) if name.startswith("cli.")} <= {
            "cli.options",
            "cli.terminal",
            "cli.terminal.screen",
        }


def imported_with(tmp_path, packages):
    """What Python, and those packages, import by themselves."""
    code = f"import sys, {', '.join(sorted(packages))}; print(*sys.modules)"
    done = subprocess.run(
        [sys.executable, "-c", code], capture_output=True, text=True, check=True, timeout=60
    )
    return set(done.stdout.split())


def test_the_help_of_the_commands_is_their_own():
    """`--help` shows it without importing them."""
    from flexmb_cli.cli import COMMANDS as shown
    from flexmb_cli.cli import cli

    assert {name: one.get_short_help_str(65) for name, one in cli.commands.items()} == shown
    assert [one.name for one in cli.commands.values()] == list(shown)
