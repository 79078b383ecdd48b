"""Each field of a record or a named tuple says beside it what it means, with shape, unit and frame."""

import ast
import re
from collections.abc import Iterator
from pathlib import Path

PACKAGE = Path(__file__).resolve().parents[2] / "flexmb_cli"
# `namedtuple` has no place beside its fields.
BARE = ("namedtuple", "collections.namedtuple")
SHAPE = re.compile(r"\([^()]*,[^()]*\)|\brecords?\b|\bflat\b")
# Of numbers that are counts, or have none: what they are.
UNIT = re.compile(
    r"(?<![\w.])(?:m|s|rad|kg|N|J|W|Hz|1|m²|s²|no unit|units?|scaled|numbers?|places?|records?|bool|flat"
    r"|as a share|share of|ratio|tolerances?|factors?|(?:unit )?vector|axes)(?![\w.(])|/s|/m"
)


def comment_of(lines: list[str], node: ast.AST) -> str:
    """Return the comments on the lines of the node, and those that stand alone before it."""
    start = node.lineno - 1
    while lines[start - 1].lstrip().startswith("#"):
        start -= 1
    return " ".join(line.partition("# ")[2] for line in lines[start : node.end_lineno])


def has_shape_and_unit(lines: list[str], node: ast.AST) -> bool:
    """Return whether the comment of a field of floats has a unit, and that of an array its shape too."""
    comment, text = comment_of(lines, node), ast.unparse(node)
    if isinstance(node, ast.AnnAssign) and "np.ndarray" in text:
        return bool(SHAPE.search(comment) and UNIT.search(re.sub(r"\([^()]*,[^()]*\)", "", comment)))
    return "float" not in text or "Callable" in text or bool(UNIT.search(comment))


def fields_of(node: ast.AST) -> Iterator[tuple[str, ast.AST]]:
    """Yield names and nodes of the fields that a class of a named tuple, or the list of a record, defines."""
    if isinstance(node, ast.ClassDef) and any("NamedTuple" in ast.unparse(base) for base in node.bases):
        yield from ((ast.unparse(one.target), one) for one in node.body if isinstance(one, ast.AnnAssign))
    elif isinstance(node, ast.Call) and ast.unparse(node.func) in ("np.dtype", "numpy.dtype"):
        described = node.args[0].elts if isinstance(node.args[0], ast.List) else []
        yield from ((ast.unparse(one.elts[0]), one) for one in described if isinstance(one, ast.Tuple))


def has_comment(lines: list[str], node: ast.AST) -> bool:
    """Return whether a comment stands on a line of the node, or alone on the line before it."""
    own = lines[node.lineno - 1 : node.end_lineno]
    return lines[node.lineno - 2].lstrip().startswith("#") or any("# " in line for line in own)


def undocumented(name: str, text: str) -> list[str]:
    """Return the fields without a comment, and the tuples that can have none."""
    lines, found = text.splitlines(), []
    for node in ast.walk(ast.parse(text)):
        if isinstance(node, ast.Call) and ast.unparse(node.func) in BARE:
            found.append(f"{name}:{node.lineno} is no class with a comment for each field")
        found += [
            f"{name}:{one.lineno} {field}" for field, one in fields_of(node) if not has_comment(lines, one)
        ]
    return found


def test_every_field_says_what_it_means():
    found = [
        fault
        for path in sorted(PACKAGE.rglob("*.py"))
        for fault in undocumented(path.relative_to(PACKAGE).as_posix(), path.read_text(encoding="utf-8"))
    ]
    assert not found


def test_every_number_has_a_unit_and_every_array_a_shape():
    found, counted = [], 0
    for path in sorted(PACKAGE.rglob("*.py")):
        text = path.read_text(encoding="utf-8")
        lines, name = text.splitlines(), path.relative_to(PACKAGE).as_posix()
        for _, one in (field for node in ast.walk(ast.parse(text)) for field in fields_of(node)):
            counted += 1
            if not has_shape_and_unit(lines, one):
                found.append(f"{name}:{one.lineno}")
    assert counted > 500 and not found


def test_a_field_without_unit_or_shape_is_found():
    text = (
        "class Point(NamedTuple):\n    # (3,) global axes\n    # and so on, m\n    r: np.ndarray\n"
        "    v: np.ndarray  # of the point, m/s\n    a: np.ndarray  # (3,) of the point\n"
        "    mass: float  # of the point\n    count: int  # of points\n"
    )
    fields = list(fields_of(ast.parse(text).body[0]))
    missing = [name for name, one in fields if not has_shape_and_unit(text.splitlines(), one)]
    assert missing == ["v", "a", "mass"]


def test_a_field_without_comment_is_found():
    text = (
        "class Point(NamedTuple):\n    # (3,) global axes, m\n    r: tuple\n    v: tuple\n"
        'RECORD = np.dtype(\n    [\n        ("t", float),  # s\n        ("h", float),\n    ]\n)\n'
        'Pair = namedtuple("Pair", "a b")\n'
    )
    assert [fault.partition(":")[2] for fault in undocumented("x", text)] == [
        "4 v",
        "8 'h'",
        "11 is no class with a comment for each field",
    ]
