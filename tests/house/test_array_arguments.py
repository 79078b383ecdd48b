"""Each array that a public kernel takes has its shape in the docstring of the kernel, its file or its folder.

Records and named tuples are described where they are defined (`test_documented_fields`).
"""

import ast
import re
from pathlib import Path

KERNELS = Path(__file__).resolve().parents[2] / "flexmb_cli" / "kernels"
# Named tuples and integrations of several classes, described there.
TUPLES = {"geometry", "integration", "system", "tree"}
FOLDERS = ("constrained", "integrators", "kinematics", "linalg", "tree")


def names_shape(docstring, argument):
    """Return whether "argument (n, 3)" or "argument (), …" stands in the docstring."""
    return re.search(rf"(?<![\w.]){re.escape(argument)}`? \((?=\)|[^)]*[\d,])", docstring) is not None


def without_shape(text, folder_docstring=""):
    """Yield "kernel.argument" of public functions whose array has no shape in any docstring."""
    module = ast.parse(text)
    above = [ast.get_docstring(module) or "", folder_docstring]
    for function in module.body:
        if isinstance(function, ast.FunctionDef) and not function.name.startswith("_"):
            docstrings = [ast.get_docstring(function) or "", *above]
            for one in function.args.args:
                annotation = ast.unparse(one.annotation) if one.annotation else "Any"
                is_array = "np.ndarray" in annotation or annotation.strip("'") == "Any"
                described = any(names_shape(docstring, one.arg) for docstring in docstrings)
                if is_array and one.arg not in TUPLES and not described:
                    yield f"{function.name}.{one.arg}"


def test_every_array_has_a_shape():
    found, files = [], [path for folder in FOLDERS for path in sorted((KERNELS / folder).rglob("*.py"))]
    for path in files:
        above = ast.get_docstring(ast.parse((path.parent / "__init__.py").read_text(encoding="utf-8"))) or ""
        name = path.relative_to(KERNELS).as_posix()
        found += [f"{name}: {one}" for one in without_shape(path.read_text(encoding="utf-8"), above)]
    assert len(files) > 80 and not found


def test_an_array_without_shape_is_found():
    text = 'def f(a: "np.ndarray", b: np.ndarray, c: float, q):\n    """Fill b (n, 3) from a(t)."""\n'
    assert list(without_shape(text)) == ["f.a", "f.q"]
    assert list(without_shape(text, "- q (n,): coordinates")) == ["f.a"]
