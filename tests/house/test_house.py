"""The rules of the house: who may import whom, who may print, what starts without numba."""

import ast
import os
import re
import subprocess
import sys
from functools import cache
from pathlib import Path

import pytest

from flexmb_cli.dialects import DIALECTS
from flexmb_cli.dialects.recognise import every_dialect
from tests.results.results import write_result

PACKAGE = Path(__file__).resolve().parents[2] / "flexmb_cli"
DECKS = PACKAGE.parent / "decks"
# From bottom to top: a module imports only from its own layer and from lower ones.
LAYERS = (
    "errors", "deck", "model", "fe", "kernels", "solvers", "dialects", "results", "result",
    "run", "study", "interface", "cli",
)  # fmt: skip
# Beside the layers, for all of them: modules of the top that import each other and errors only.
FOR_ALL = ("extras", "installation", "managed_files", "memory", "version")
# What starts at once never imports these; the MATLAB file is SciPy's.
LIGHT, HEAVY = ("deck", "model", "dialects", "results"), ("numba", "scipy")
FOREIGN_FORMATS = "results/files/matlab.py"
MODULES = sorted(PACKAGE.rglob("*.py"))
# Decks whose bodies have more coordinates than `fe.linear_algebra.DENSE`: their matrices are sparse, SciPy's.
OF_SPARSE_MATRICES = ("strap_medium", "strap_fine")
MOST_FILES = 25  # in a folder
MOST_LINES = 500  # of a file
LONGEST_FUNCTION = 40  # lines


def of_annotations(tree):
    """Nodes that are there for type checkers only."""
    for node in ast.walk(tree):
        if isinstance(node, ast.If) and ast.unparse(node.test) == "TYPE_CHECKING":
            yield from ast.walk(node)


@cache
def imports_of(path, running=False):
    """Names of every import of a file, as tuples: ("flexmb_cli", "model", "tree", "Tree").

    `running`: without those for annotations.
    """
    package = ["flexmb_cli", *path.relative_to(PACKAGE).parts[:-1]]
    tree, found = ast.parse(path.read_text(encoding="utf-8")), []
    for node in set(ast.walk(tree)) - (set(of_annotations(tree)) if running else set()):
        if isinstance(node, ast.ImportFrom):
            base = package[: len(package) - node.level + 1] if node.level else []
            full = base + (node.module.split(".") if node.module else [])
            found += [(*full, name.name) for name in node.names]
        elif isinstance(node, ast.Import):
            found += [tuple(name.name.split(".")) for name in node.names]
    return found


def may_import(layer):
    """Names of the layers that a layer may import."""
    if layer == "kernels":
        return {"kernels"}
    lower = set(LAYERS[: LAYERS.index(layer) + 1])
    return lower if layer == "solvers" else lower - {"kernels"}


def test_every_folder_is_a_layer():
    folders = {path.relative_to(PACKAGE).parts[0] for path in MODULES if path.parent != PACKAGE}
    assert folders == {layer for layer in LAYERS if not (PACKAGE / f"{layer}.py").exists()}


def test_imports_run_one_way():
    upward = [
        f"{path.relative_to(PACKAGE)} imports {'.'.join(full)}"
        for path in MODULES
        if (layer := path.relative_to(PACKAGE).parts[0].removesuffix(".py")) in LAYERS
        # Kernels name the named tuples of arrays that they are handed.
        for full in imports_of(path, running=layer == "kernels")
        if full[0] == "flexmb_cli"
        and len(full) > 1
        and full[1] in LAYERS
        and full[1] not in may_import(layer)
    ]
    assert not upward


def test_every_module_at_the_top_is_a_layer_or_for_all_layers():
    """The package itself names the interface, which it imports late, and `__main__` starts the commands."""
    top = {path.stem for path in MODULES if path.parent == PACKAGE} - {"__init__", "__main__"}
    assert top - set(LAYERS) == set(FOR_ALL)
    upward = [
        f"{name}.py imports {'.'.join(full)}"
        for name in (*FOR_ALL, "errors")
        for full in imports_of(PACKAGE / f"{name}.py")
        if full[0] == "flexmb_cli" and full[1] not in (*FOR_ALL, "errors")
    ]
    assert not upward


def test_what_starts_at_once_imports_neither_numba_nor_scipy():
    heavy = [
        f"{path.relative_to(PACKAGE)} imports {full[0]}"
        for path in MODULES
        if path.relative_to(PACKAGE).parts[0] in LIGHT
        and path.relative_to(PACKAGE).as_posix() != FOREIGN_FORMATS
        for full in imports_of(path)
        if full[0] in HEAVY
    ]
    assert not heavy


def literals_of(path):
    """Strings of a file that are no docstrings, with their lines."""
    tree = ast.parse(path.read_text(encoding="utf-8"))
    homes = (ast.Module, ast.ClassDef, ast.FunctionDef)
    heads = [node.body[0] for node in ast.walk(tree) if isinstance(node, homes) and node.body]
    documented = {id(head.value) for head in heads if isinstance(head, ast.Expr)}
    for node in ast.walk(tree):
        if isinstance(node, ast.Constant) and isinstance(node.value, str) and id(node) not in documented:
            yield node.lineno, node.value


def test_nothing_outside_its_folder_names_a_dialect():
    """What is to be known of a dialect stands in its DIALECT; sentences may call it YOUNG, DAFMS, VSDF."""
    named = re.compile(rf"\b({'|'.join(DIALECTS)})\b")
    found = [
        f"{path.relative_to(PACKAGE)}:{line}"
        for path in MODULES
        if not path.relative_to(PACKAGE).as_posix().startswith("dialects/")
        for line, text in literals_of(path)
        if named.search(text)
    ]
    assert not found


def test_kinds_of_motions_are_told_apart_in_one_file():
    """Whether a motion is of a joint, and a length, are properties of `Motion`."""
    found = {
        path.relative_to(PACKAGE).as_posix()
        for path in MODULES
        if not path.relative_to(PACKAGE).as_posix().startswith("dialects/")
        for _, text in literals_of(path)
        if text in ("TRAX", "TRAY", "TRAZ", "ROTX", "ROTY", "ROTZ", "ANGL", "STRK")
    }
    assert found == {"model/time_functions.py"}


def test_nothing_outside_its_folder_imports_a_dialect():
    """`flexmb beam` writes cards of one dialect."""
    found = [
        f"{path.relative_to(PACKAGE)} imports {'.'.join(full)}"
        for path in MODULES
        if path.relative_to(PACKAGE).as_posix() != "cli/beam.py"
        for full in imports_of(path)
        if full[1:2] == ("dialects",) and full[2:3] and full[2] in DIALECTS
        and path.relative_to(PACKAGE).parts[:2] != ("dialects", full[2])
    ]  # fmt: skip
    assert not found


def test_every_part_that_a_dialect_names_is_there():
    for dialect in every_dialect():
        single = (dialect.recogniser, dialect.reader, dialect.builder, dialect.writer, dialect.form)
        more = (dialect.relabel, dialect.second_model)
        for reference in (*single, *more, *dialect.listing_readers, *dialect.series_readers):
            assert not reference or callable(dialect.part(reference))


def test_only_the_command_line_prints_and_exits():
    forbidden = ("print", "exit", "quit", "sys.exit", "os._exit", "input")
    found = [
        f"{path.relative_to(PACKAGE)}:{node.lineno}"
        for path in MODULES
        if path.relative_to(PACKAGE).parts[0] not in ("cli", "__main__.py")
        for node in ast.walk(ast.parse(path.read_text(encoding="utf-8")))
        if isinstance(node, ast.Call) and ast.unparse(node.func) in forbidden
    ]
    assert not found


def test_docstrings_say_what_things_do_or_are_and_no_riddles():
    """Functions: "Return whether …", not "Whether …"; files and classes: "Result of …", not "What …"."""
    riddles = ("What ", "How ", "Whether ", "Where ", "Who ", "Why ", "When ", "Which ", "Of ")
    documented = (ast.FunctionDef, ast.ClassDef, ast.Module)
    found = [
        f"{path.relative_to(PACKAGE)}: {getattr(node, 'name', 'the file')}"
        for path in MODULES
        for node in ast.walk(ast.parse(path.read_text(encoding="utf-8")))
        if isinstance(node, documented) and (ast.get_docstring(node) or "").startswith(riddles)
    ]
    assert not found


def test_parts_that_subclasses_give_are_abstract():
    """`raise NotImplementedError` is found by the run that needs the part, an abstract method at once."""
    found = [
        f"{path.relative_to(PACKAGE)}:{node.lineno}"
        for path in MODULES
        for node in ast.walk(ast.parse(path.read_text(encoding="utf-8")))
        if isinstance(node, ast.Raise) and node.exc and "NotImplementedError" in ast.unparse(node.exc)
    ]
    assert not found


def test_no_file_has_a_name_that_says_nothing():
    nothing = ("utils", "helpers", "common", "base", "manager", "misc")
    assert not [path for path in MODULES if path.stem in nothing]


def test_no_folder_is_crowded():
    """Folders of a build, of caches and of editors are none of the project's."""
    made = ("_build", "__pycache__", "gallery")
    crowded = [
        f"{path.relative_to(PACKAGE.parent)} has {len(files)} files"
        for top in ("flexmb_cli", "tests", "scripts", "docs", "decks")
        for path in (PACKAGE.parent / top, *(PACKAGE.parent / top).rglob("*/"))
        if not any(part.startswith(".") or part in made for part in path.parts[len(PACKAGE.parent.parts) :])
        and len(files := [file for file in path.iterdir() if file.is_file()]) > MOST_FILES
    ]
    assert not crowded, "put the files of one subject into a folder of their own"


def test_no_file_is_long():
    """Files of one subject; a long one wants to be two."""
    long = [
        f"{path.relative_to(PACKAGE)}: {lines} lines"
        for path in MODULES
        if (lines := len(path.read_text(encoding="utf-8").splitlines())) > MOST_LINES
    ]
    assert not long


def lines_of(function):
    """Lines of the body of a function, without its docstring."""
    head = function.body[0]
    first = head.end_lineno + 1 if ast.get_docstring(function) else head.lineno
    return function.end_lineno - first + 1


def test_no_function_is_long():
    long = [
        f"{path.relative_to(PACKAGE)}: {node.name}"
        for path in MODULES
        for node in ast.walk(ast.parse(path.read_text(encoding="utf-8")))
        if isinstance(node, ast.FunctionDef) and lines_of(node) > LONGEST_FUNCTION
    ]
    assert not long


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
        *(
            ["check", f"decks/vsdf/{deck.name}"]
            for deck in sorted((DECKS / "vsdf").glob("*.vsdf"))
            if deck.stem not in OF_SPARSE_MATRICES
        ),
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
