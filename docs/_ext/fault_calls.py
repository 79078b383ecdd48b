"""Find the calls that make faults in the sources.

A call that gives a constant `id=` makes a fault, whatever it is called: `Fault`, `findings.error`, or a
function that hands `id` on.  A pair ("message", "YOUNG-012") stands for one, too.
"""

import ast
import re
from collections.abc import Iterator
from dataclasses import dataclass
from functools import cache
from pathlib import Path

TOP = Path(__file__).resolve().parents[2]
PACKAGE = TOP / "flexmb_cli"
FORM = re.compile(r"(CLI|DECK|DAFMS|DIFF|ELEMENTS|FE|FLEXMB|MODEL|RESULT|RUN|SOLVE|STUDY|VSDF|YOUNG)-\d{3}")
# What makes a fault by itself, and which of its arguments is the message.
MAKERS = {
    "Fault": 1, "error": 1, "warn": 1, "note": 1, "OutputError": 0, "UnsafePlace": 0, "ResultError": 1,
    "ToleranceError": 0, "ClusterError": 0, "WorkersError": 0, "MissingExtra": 0, "FEFileFault": 0,
}  # fmt: skip


@dataclass(frozen=True)
class Site:
    """A call that makes a fault, or a pair that stands for one."""

    path: Path
    node: ast.Call | ast.Tuple
    around: ast.AST  # the function, or the module

    @property
    def line(self) -> int:
        """Where the call begins."""
        return self.node.lineno


@cache
def tree_of(path: Path) -> ast.Module:
    """Return the syntax tree of a file."""
    return ast.parse(path.read_text(encoding="utf-8"))


@cache
def nodes_of(path: Path) -> tuple[ast.AST, ...]:
    """Return all nodes of the syntax tree of a file."""
    return tuple(ast.walk(tree_of(path)))


@cache
def sites() -> tuple[Site, ...]:
    """Return everything in the package that makes a fault."""
    return tuple(site for path in sorted(PACKAGE.rglob("*.py")) for site in _sites_of(path))


@cache
def functions_of(path: Path) -> tuple[ast.FunctionDef, ...]:
    """Return the functions and methods of a file."""
    return tuple(node for node in nodes_of(path) if isinstance(node, ast.FunctionDef))


def around(path: Path, line: int) -> ast.AST:
    """Return the function that a line stands in, or the module."""
    inside = [f for f in functions_of(path) if f.lineno <= line <= (f.end_lineno or 0)]
    return max(inside, key=lambda f: f.lineno, default=tree_of(path))


def _sites_of(path: Path) -> Iterator[Site]:
    for node in nodes_of(path):
        if (isinstance(node, ast.Call) and (id_of(node) or is_maker(node))) or _is_pair(node):
            yield Site(path, node, around(path, node.lineno))


def id_of(call: ast.Call) -> ast.expr | None:
    """Return what a call gives as `id`."""
    return next((word.value for word in call.keywords if word.arg == "id"), None)


def _is_pair(node: ast.AST) -> bool:
    if not (isinstance(node, ast.Tuple) and len(node.elts) == 2):
        return False
    last = node.elts[1]
    return isinstance(last, ast.Constant) and isinstance(last.value, str) and bool(FORM.fullmatch(last.value))


def is_maker(call: ast.Call) -> bool:
    """Return whether a call makes a fault even without an identifier."""
    if isinstance(call.func, ast.Name):
        return call.func.id in MAKERS and call.func.id not in ("error", "warn", "note")
    if isinstance(call.func, ast.Attribute) and call.func.attr in ("error", "warn", "note"):
        return ast.unparse(call.func.value).endswith("findings")
    return False


def identifier(site: Site) -> str | None:
    """Return the identifier that a site gives, None without one, "" for what is handed on."""
    if isinstance(site.node, ast.Tuple):
        return str(site.node.elts[1].value)  # type: ignore[attr-defined]
    given = id_of(site.node)
    if given is None:
        return None
    node = constant(given.id, site.path) if isinstance(given, ast.Name) else given
    value = node.value if isinstance(node, ast.Constant) else ""
    return value if isinstance(value, str) else ""


def constant(name: str, path: Path) -> ast.expr | None:
    """Return the value of a module's constant, its own or one that it imports."""
    for node in tree_of(path).body:
        if isinstance(node, ast.Assign) and name in targets_of(node):
            return node.value
    origin = imported(name, path)
    return constant(name, origin) if origin else None


def targets_of(node: ast.Assign | ast.NamedExpr | ast.AugAssign) -> list[str]:
    """Return the variables that a statement gives a value."""
    targets = node.targets if isinstance(node, ast.Assign) else [node.target]
    return [target.id for target in targets if isinstance(target, ast.Name)]


def imported(name: str, path: Path) -> Path | None:
    """Return the file of the package that a name is imported from."""
    for node in nodes_of(path):
        if isinstance(node, ast.ImportFrom) and name in [each.name for each in node.names] and node.level:
            folder = path.parents[node.level - 1].joinpath(*(node.module or "").split("."))
            module = folder.with_suffix(".py")
            return module if module.exists() else folder / "__init__.py"
    return None


@cache
def definitions_of(path: Path) -> tuple[tuple[str, ast.FunctionDef], ...]:
    """Return functions by their names, and what makes an object by that of its class."""
    found = [(f.name, f) for f in functions_of(path)]
    for node in nodes_of(path):
        if isinstance(node, ast.ClassDef):
            found += [
                (node.name, f) for f in node.body if isinstance(f, ast.FunctionDef) and f.name == "__init__"
            ]
    return tuple(found)


@cache
def calls_by_name() -> dict[str, list[tuple[Path, ast.Call]]]:
    """Return all calls in the package by the last name of what is called."""
    found: dict[str, list[tuple[Path, ast.Call]]] = {}
    for path in sorted(PACKAGE.rglob("*.py")):
        for node in nodes_of(path):
            if isinstance(node, ast.Call):
                found.setdefault(name_of(node), []).append((path, node))
    return found


def name_of(call: ast.Call) -> str:
    """Return the last name of what is called."""
    return call.func.attr if isinstance(call.func, ast.Attribute) else getattr(call.func, "id", "")
