"""Modules and files that docstrings, comments and CONTRIBUTING.md name are there."""

import ast
import re
from functools import cache
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]
PACKAGE = ROOT / "flexmb_cli"
FORMER = {"solve"}  # folders of earlier versions
LAYERS = {path.name for path in PACKAGE.iterdir() if path.is_dir()} | FORMER
# `solvers.tree.rows.TreeRows`, and `solvers/tree/rows.py`; NAME and {braces} stand for many.
DOTTED = re.compile(r"`(?:flexmb_cli\.)?([a-z_]+(?:\.\w+)+)`")
FILES = re.compile(r"`([a-z_]+(?:/\w+)*(?:/|\.py|/\w+\.md))`")
PLACEHOLDERS = {"NAME"}


@cache
def names_in(path):
    """What a module defines or imports."""
    found = set()
    for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
        if isinstance(node, ast.FunctionDef | ast.ClassDef):
            found.add(node.name)
        elif isinstance(node, ast.Name) and isinstance(node.ctx, ast.Store):
            found.add(node.id)
        elif isinstance(node, ast.alias):
            found.add((node.asname or node.name).split(".")[0])
    return found


def is_there(dotted):
    """Whether a dotted name is a folder, a module, or a name of one and what follows it."""
    place = PACKAGE
    for part in dotted.split("."):
        if place.suffix == ".py":
            return part in names_in(place)
        place = place / part if (place / part).is_dir() else place / f"{part}.py"
        if not place.exists():
            return part in names_in(place.parent / "__init__.py") and place.parent != PACKAGE
    return True


@pytest.mark.parametrize(
    ("name", "there"),
    [
        ("solvers.tree.rows.TreeRows", True),
        ("solvers.tree", True),
        ("solve.tree_rows.TreeRows", False),
        ("model.dynamics.holders", False),
        ("solvers.tree.rows.Tree_Rows", False),
    ],
)
def test_a_name_that_is_not_there_is_found(name, there):
    assert is_there(name) == there


def test_modules_named_in_the_package_are_there():
    stale = [
        f"{path.relative_to(ROOT)}:{number}: {name}"
        for path in sorted(PACKAGE.rglob("*.py"))
        for number, line in enumerate(path.read_text(encoding="utf-8").splitlines(), 1)
        for name in DOTTED.findall(line)
        if name.split(".")[0] in LAYERS and not name.endswith((".py", ".md", ".h5")) and not is_there(name)
    ]
    assert not stale


def test_files_named_in_the_package_and_on_the_page_for_contributors_are_there():
    pages = [ROOT / "CONTRIBUTING.md", *sorted(PACKAGE.rglob("*.py"))]
    stale = [
        f"{page.relative_to(ROOT)}: {name}"
        for page in pages
        for name in FILES.findall(page.read_text(encoding="utf-8"))
        if not PLACEHOLDERS & set(re.findall(r"\w+", name))
        and name.split("/")[0] in LAYERS | {"tests", "scripts", "docs"}
        and not (PACKAGE / name).exists()
        and not (ROOT / name).exists()
    ]
    assert not stale
