"""A copy of the checkout, and which tests run which lines of its kernels."""

import ast
import hashlib
import json
import os
import shutil
import subprocess
import sys
from pathlib import Path

CHECKOUT = Path(__file__).resolve().parents[2]
PACKAGE = "flexmb_cli"
MADE = shutil.ignore_patterns("__pycache__", ".*", "_build", "build", "dist")  # not of the checkout itself
LEFT_OUT = ["--ignore=tests/house"]  # tests that read sources and run no kernel
# `made`: an argument of the function that makes the kernel, which compiles it or leaves it to Python.
DECORATORS = {"kernel", "part", "allocating", "made"}
ONLY = "not long_motion and not processes"
ENVIRONMENT = {"NUMBA_DISABLE_JIT": "1", "OPENBLAS_NUM_THREADS": "1"}


def copy_checkout(folder: Path) -> Path:
    """Copy what tests need into `folder`/tree, changed files only; return it."""
    tree = folder / "tree"
    tree.mkdir(parents=True, exist_ok=True)
    names = [path.name for path in CHECKOUT.iterdir()]
    for name in sorted(set(names) - MADE(CHECKOUT, names)):
        source, target = CHECKOUT / name, tree / name
        if source.is_file():
            shutil.copy2(source, target)
            continue
        # Old bytecode beside the tests saves compiling them for every mutant.
        if target.exists():
            _drop_vanished(source, target)
        shutil.copytree(source, target, dirs_exist_ok=True, ignore=MADE)
    return tree


def _drop_vanished(source, target):
    for path in target.rglob("*.py"):
        if not (source / path.relative_to(target)).exists():
            path.unlink()


def digest(path: Path) -> str:
    """Return a short name of the contents of a file."""
    return hashlib.sha256(path.read_bytes()).hexdigest()[:12]


def is_kernel(node: ast.AST) -> bool:
    """Whether a function is compiled by numba."""
    return isinstance(node, ast.FunctionDef) and any(
        isinstance(d, ast.Name) and d.id in DECORATORS for d in node.decorator_list
    )


def kernel_files(tree: Path) -> list[Path]:
    """Return the files of the package that hold compiled functions."""
    return [path for path in sorted((tree / PACKAGE).rglob("*.py")) if _holds_kernels(path)]


def _holds_kernels(path):
    return any(map(is_kernel, ast.walk(ast.parse(path.read_bytes()))))


def read_map(folder: Path) -> list[dict]:
    """Return the records of `Mapper`, of each test the last."""
    path = folder / "map.jsonl"
    records = path.read_text(encoding="utf-8").splitlines() if path.exists() else []
    return list({r["test"]: r for r in map(json.loads, records)}.values())


def renew_map(folder: Path, tree: Path, arguments: list[str]) -> None:
    """Run the tests that are not in the map yet, or whose file has changed, in a process of its own."""
    kernels = {str(path): digest(path) for path in kernel_files(tree)}
    stamp = folder / "kernels.json"
    if stamp.exists() and json.loads(stamp.read_text()) != kernels:
        (folder / "map.jsonl").unlink(missing_ok=True)
    stamp.write_text(json.dumps(kernels))
    command = [sys.executable, __file__, str(folder), *arguments]
    environment = (
        os.environ | ENVIRONMENT | {"PYTHONPATH": str(tree), "FLEXMB_CACHE_DIR": str(folder / "cache")}
    )
    with open(folder / "map.log", "w") as log:
        subprocess.run(command, cwd=tree, env=environment, stdout=log, stderr=log, check=True)


def _run_mapper(folder, arguments):
    import pytest
    from plugin import Mapper

    tree = folder / "tree"
    digests = {str(p.relative_to(tree)): digest(p) for p in (tree / "tests").rglob("*.py")}
    known = {(r["test"], r["digest"]) for r in read_map(folder)}
    mapper = Mapper(folder / "map.jsonl", [str(p) for p in kernel_files(tree)], known, digests)
    options = ["-p", "no:cacheprovider", "-p", "no:xdist", "--hypothesis-seed=0", "-m", ONLY]
    code = pytest.main([*options, *LEFT_OUT, "--rootdir", str(tree), *arguments], plugins=[mapper])
    if code not in (pytest.ExitCode.OK, pytest.ExitCode.TESTS_FAILED, pytest.ExitCode.NO_TESTS_COLLECTED):
        sys.exit(int(code))


if __name__ == "__main__":
    _run_mapper(Path(sys.argv[1]), sys.argv[2:])
