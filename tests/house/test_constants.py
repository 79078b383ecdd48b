"""A constant's name has one meaning: numbers of the same name stand in one file, or are listed here."""

import ast
from collections import defaultdict
from collections.abc import Iterator
from functools import cache
from pathlib import Path

PACKAGE = Path(__file__).resolve().parents[2] / "flexmb_cli"
# What each method, each kind of system or each analysis has for itself, in the same sense.
OF_EACH = {
    "CORRECTION": "row of the work's vectors: a correction of the coordinates",
    "EQUATIONS": "how many equations a joint has",
    "FASTEST": "largest factor from a step's length to the next",
    "FLOOR": "of the speeds: round-off, below which an iteration ends",
    "LARGEST_BLOCK": "rows of an analysis that are solved at a time",
    "LEAST": "contraction of an iteration that is trusted",
    "MOST_CORRECTIONS": "corrections of a projection",
    "MOST_ITERATIONS": "iterations of Newton's method",
    "MOST_STEPS": "corrections of an assembly",
    "NEW": "row of the end of a step",
    "PHI": "row of the work: residuals of the equations",
    "SAFETY": "factor on the length that the error of a step suggests",
    "SCALED": "row of the work: residuals in units of the equations",
    "SHARE": "of a step in front of a singular position",
    "SINGULAR": "code of what has no solution",
    "SOLVED": "code of what has one",
    "STAGES": "stages of a method of Runge and Kutta",
    "UNKNOWN": "row of the work's vectors: the solution of a linear system",
}
# Kernels import nothing: their codes repeat those of the model (`tests/kernels/constrained/test_load_codes`).
REPEATED_IN = {
    "model/arrays/contacts.py": ("kernels/contact.py", "kernels/contact_shapes.py", "kernels/laws.py"),
    "model/arrays/records.py": ("kernels/constrained/elements.py", "kernels/constrained/forces.py"),
    "model/time_functions.py": ("kernels/constrained/time_functions.py",),
    "model/laws.py": ("kernels/laws.py",),
    "model/signals.py": ("kernels/signals.py",),
    "model/arrays/tree_elements.py": ("kernels/tree/elements.py", "kernels/tree/loop_closures.py"),
    # It imports nothing before it can be interrupted.
    "run/outcome.py": ("__main__.py",),
}
ARITHMETIC = (ast.Constant, ast.UnaryOp, ast.BinOp, ast.operator, ast.unaryop)


def assigned(tree: ast.Module) -> Iterator[tuple[str, ast.expr]]:
    """Yield the names of a module, and what they are set to."""
    for node in tree.body:
        if isinstance(node, ast.Assign):
            for target in node.targets:
                pair = isinstance(target, ast.Tuple) and isinstance(node.value, ast.Tuple)
                parts = zip(target.elts, node.value.elts, strict=True) if pair else [(target, node.value)]
                yield from ((ast.unparse(name), value) for name, value in parts)


def number_of(value: ast.expr) -> float | None:
    """Return the number that an expression of numbers is."""
    if not all(isinstance(node, ARITHMETIC) for node in ast.walk(value)):
        return None
    found = eval(compile(ast.Expression(value), "", "eval"), {"__builtins__": {}})
    return found if isinstance(found, int | float) else None


@cache
def constants() -> dict[str, dict[str, float]]:
    """Return the value of every constant, by name and file."""
    found: dict[str, dict[str, float]] = defaultdict(dict)
    for path in sorted(PACKAGE.rglob("*.py")):
        file = path.relative_to(PACKAGE).as_posix()
        for name, value in assigned(ast.parse(path.read_text(encoding="utf-8"))):
            if name.isupper() and (number := number_of(value)) is not None:
                found[name][file] = number
    return found


def test_numbers_of_the_same_name_have_the_same_meaning():
    several = {}
    for name, values in constants().items():
        copies = {
            copy for origin, copies in REPEATED_IN.items() if origin in values for copy in copies
            if values.get(copy) == values[origin]
        }  # fmt: skip
        if name not in OF_EACH and len(values) - len(copies & set(values)) > 1:
            several[name] = values
    assert not several, "import the constant from one place, or list its name in OF_EACH here, and why"


def test_no_name_is_listed_that_stands_in_one_file():
    found = constants()
    assert [name for name in OF_EACH if len(found[name]) < 2] == []


def test_a_tuple_text_or_record_is_written_once():
    """Of the same name and value: two copies would part one day."""
    places: dict[tuple[str, str], list[str]] = defaultdict(list)
    for path in sorted(PACKAGE.rglob("*.py")):
        for name, value in assigned(ast.parse(path.read_text(encoding="utf-8"))):
            long = len(text := ast.unparse(value)) > 12
            if name.isupper() and long and number_of(value) is None and "__package__" not in text:
                places[name, text].append(path.relative_to(PACKAGE).as_posix())
    assert {key[0]: files for key, files in places.items() if len(files) > 1} == {}
