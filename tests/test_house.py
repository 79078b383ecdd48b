"""The rules of the house: who may import whom, who may print, what starts without numba."""

import ast
import os
import subprocess
import sys
from pathlib import Path

import pytest

sys.path.insert(0, str(Path(__file__).parent / "write"))
from results import write_result

PACKAGE = Path(__file__).resolve().parents[1] / "flexmb_cli"
DECKS = PACKAGE.parent / "decks"
# Stations in the direction of the data; each may import from itself and from those listed.
MAY_IMPORT = {
    "read": {"read"},
    "model": {"read", "model"},
    "fe": {"read", "model", "fe"},
    "kernels": {"kernels"},
    "solve": {"read", "model", "fe", "kernels", "solve"},
    "write": {"read", "model", "solve", "write"},
    "run": {"read", "model", "fe", "kernels", "solve", "write", "run"},
}
# `write` may know the records that an analysis yields, but none of its machinery.
RECORDS_OF_SOLVE = {"rows", "tree_rows"}
MODULES = sorted(PACKAGE.rglob("*.py"))


def imports_of(path):
    """(station or top-level package, module below it) of every import of a file."""
    package = ["flexmb_cli", *path.relative_to(PACKAGE).parts[:-1]]
    for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
        if isinstance(node, ast.ImportFrom):
            base = package[: len(package) - node.level + 1] if node.level else []
            full = base + (node.module.split(".") if node.module else [])
            for name in node.names:
                yield (*full, name.name)
        elif isinstance(node, ast.Import):
            for name in node.names:
                yield tuple(name.name.split("."))


@pytest.mark.parametrize("path", MODULES, ids=lambda p: str(p.relative_to(PACKAGE)))
def test_imports_run_one_way(path):
    station = path.relative_to(PACKAGE).parts[0]
    if station not in MAY_IMPORT:
        return
    for full in imports_of(path):
        if full[0] == "flexmb_cli" and len(full) > 2 and full[1] in MAY_IMPORT:
            assert full[1] in MAY_IMPORT[station], f"{path}: imports {'.'.join(full)}"
            if station == "write" and full[1] == "solve":
                assert full[2] in RECORDS_OF_SOLVE, f"{path}: imports {'.'.join(full)}"
        if station in ("read", "model", "write"):
            assert full[0] not in ("numba", "scipy"), f"{path}: imports {full[0]}"


@pytest.mark.parametrize("path", MODULES, ids=lambda p: str(p.relative_to(PACKAGE)))
def test_only_the_command_line_prints_and_exits(path):
    if path.relative_to(PACKAGE).parts[0] in ("cli", "__main__.py"):
        return
    for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
        if isinstance(node, ast.Call):
            name = ast.unparse(node.func)
            assert name not in ("print", "exit", "quit", "sys.exit", "os._exit", "input"), (
                f"{path}:{node.lineno}"
            )


@pytest.mark.parametrize("path", MODULES, ids=lambda p: str(p.relative_to(PACKAGE)))
def test_no_file_has_a_name_that_says_nothing(path):
    assert path.stem not in ("utils", "helpers", "common", "base", "manager", "misc")


@pytest.mark.processes
@pytest.mark.parametrize(
    "arguments",
    [
        ["--help"],
        ["--version"],
        ["run", "--help"],
        ["new", "--help"],
        ["check", "decks/young/IN4-BAR.dat"],
        ["check", "decks/dafms/fourbar_flex.DAT"],
        *(["check", f"decks/vsdf/{deck.name}"] for deck in sorted((DECKS / "vsdf").glob("*.vsdf"))),
        ["beam", "--length", "1", "--nodes", "2", "--ei", "1", "--rho", "1"],
        ["diff", "README.md", "README.md"],
        ["diff", "{result}", "{result}"],
        ["table", "{result}", "body.*.z"],
        ["table", "{result}", "--list"],
    ],
    ids=lambda a: " ".join(a[:2]),
)
def test_what_needs_no_solver_starts_without_numba_and_scipy(arguments, tmp_path):
    if "{result}" in arguments:
        result = write_result(tmp_path / "r.h5", 3)
        arguments = [argument.format(result=result) for argument in arguments]
    code = (
        "import sys\n"
        "from flexmb_cli.cli import main\n"
        f"sys.argv = ['flexmb', *{arguments!r}]\n"
        "try:\n    main()\nexcept SystemExit:\n    pass\n"
        "print(sorted({'numba', 'scipy'} & set(sys.modules)), file=sys.stderr)\n"
    )
    environment = {name: value for name, value in os.environ.items() if not name.startswith("NUMBA")}
    # A flexible body that is kept from an earlier run would need no scipy in any case.
    environment["FLEXMB_CACHE_DIR"] = str(tmp_path)
    done = subprocess.run(
        [sys.executable, "-c", code],
        capture_output=True, text=True, cwd=PACKAGE.parent, env=environment, timeout=60,
    )  # fmt: skip
    assert done.stderr.splitlines()[-1] == "[]"
    assert "a fault of flexmb itself" not in done.stderr
