"""Write docs/reference/messages.md: the stable identifier of every fault, with its words of today.

python docs/_ext/fault_messages.py
"""

import ast
from collections import Counter
from collections.abc import Iterator
from functools import cache
from pathlib import Path

TOP = Path(__file__).resolve().parents[2]
PACKAGE = TOP / "flexmb_cli"
PAGE = TOP / "docs" / "reference" / "messages.md"
# What makes a fault, and which of its arguments is the message.
MAKERS = {
    "Fault": 1, "error": 1, "warn": 1, "note": 1, "OutputError": 0, "UnsafePlace": 0, "ResultError": 1,
    "ToleranceError": 0, "ClusterError": 0, "WorkersError": 0, "MissingExtra": 0, "FEFileFault": 0,
}  # fmt: skip
# Identifiers of faults that are no longer reported, and what took their place; none is given again.
RETIRED = {
    "DECK-015": "", "DECK-017": "", "RUN-006": "RESULT-007", "RUN-011": "", "RUN-029": "", "RUN-032": "",
    "RUN-033": "", "YOUNG-062": "", "YOUNG-105": "ELEMENTS-012", "YOUNG-106": "ELEMENTS-014",
    "YOUNG-107": "ELEMENTS-015",
    "YOUNG-108": "ELEMENTS-016", "YOUNG-109": "ELEMENTS-017", "YOUNG-110": "ELEMENTS-018",
    "YOUNG-111": "ELEMENTS-019", "YOUNG-112": "ELEMENTS-020", "YOUNG-113": "ELEMENTS-021",
    "YOUNG-114": "ELEMENTS-022", "YOUNG-115": "ELEMENTS-023", "YOUNG-116": "ELEMENTS-001",
    "YOUNG-117": "ELEMENTS-003", "YOUNG-118": "ELEMENTS-004", "YOUNG-119": "ELEMENTS-005",
    "YOUNG-120": "ELEMENTS-002", "YOUNG-124": "ELEMENTS-007", "YOUNG-125": "ELEMENTS-008",
    "YOUNG-126": "ELEMENTS-009", "YOUNG-127": "ELEMENTS-010", "YOUNG-128": "ELEMENTS-006",
    "YOUNG-129": "ELEMENTS-011", "YOUNG-153": "", "YOUNG-154": "",
}  # fmt: skip
HEAD = """# Messages

Every message has an identifier that stays the same when its words change: with `--json` it is the key `id`
of a fault. An identifier that is no longer used is not given to another message. `…` stands for what depends
on the input. Where it is all that stands there, and the file is named, several messages of that file share
the identifier, such as all faults of a study's keys (STUDY-013) or of the fields of a DAFMS card (DECK-005).
An error may end with the numbers changed by `--set`. `python docs/_ext/fault_messages.py` makes this page; a
test compares it with the program.

| identifier | message |
|---|---|
"""
TAIL = """
## Identifiers that are no longer used

| identifier | replaced by |
|---|---|
"""


@cache
def makers() -> tuple[tuple[Path, ast.Call, ast.AST], ...]:
    """Return every call that makes a fault: its file, the call, the function around it."""
    return tuple(each for path in sorted(PACKAGE.rglob("*.py")) for each in _makers_of(path))


def _makers_of(path: Path) -> Iterator[tuple[Path, ast.Call, ast.AST]]:
    tree = ast.parse(path.read_text(encoding="utf-8"))
    nodes = list(ast.walk(tree))
    functions = [node for node in nodes if isinstance(node, ast.FunctionDef)]
    for node in nodes:
        if isinstance(node, ast.Call) and _maker(node):
            around = [f for f in functions if f.lineno <= node.lineno <= f.end_lineno]
            yield path, node, max(around, key=lambda f: f.lineno, default=tree)


def _maker(call):
    if isinstance(call.func, ast.Name):
        name = call.func.id
        return name if name in MAKERS and name not in ("error", "warn", "note") else None
    if isinstance(call.func, ast.Attribute) and call.func.attr in ("error", "warn", "note"):
        return call.func.attr if ast.unparse(call.func.value).endswith("findings") else None
    return None


def identifier(call: ast.Call) -> str | None:
    """Return the identifier that a call gives, None without one; what another fault carries is ""."""
    given = next((word.value for word in call.keywords if word.arg == "id"), None)
    return given.value if isinstance(given, ast.Constant) else None if given is None else ""


def proposal(path: Path) -> str:
    """Return the next free identifier for a fault in a file, of the area of the faults nearest to it."""
    given = [(file, name) for file, call, _ in makers() if (name := identifier(call))]
    for place in (path, *path.parents):
        areas = Counter(name.partition("-")[0] for file, name in given if file.is_relative_to(place))
        if areas:
            area = areas.most_common(1)[0][0]
            taken = {name for _, name in given} | set(RETIRED)
            return next(name for n in range(1, 1000) if (name := f"{area}-{n:03d}") not in taken)
    raise ValueError(f"{path} is in no folder with faults")


def words(call: ast.Call, around: ast.AST) -> str:
    """Return the message of a call, with … for what depends on the input."""
    place = MAKERS[_maker(call)]
    node = call.args[place] if len(call.args) > place else None
    if isinstance(node, ast.Name):
        before = [
            each
            for each in ast.walk(around)
            if isinstance(each, ast.Assign)
            and each.lineno <= call.lineno
            and any(isinstance(target, ast.Name) and target.id == node.id for target in each.targets)
        ]
        node = max(before, key=lambda each: each.lineno).value if before else node
    return " ".join(_text(node).split()) or "…"


def _text(node):
    if isinstance(node, ast.Constant):
        return str(node.value)
    if isinstance(node, ast.JoinedStr):
        return "".join(_text(part) for part in node.values)
    if isinstance(node, ast.BinOp):
        return _text(node.left) + _text(node.right)
    if isinstance(node, ast.Call) and ast.unparse(node.func) == "no_such":
        return f"{_text(node.args[0])} number … is outside … / is not there: the deck has none"
    if isinstance(node, ast.IfExp):
        return f"{_text(node.body)} / {_text(node.orelse)}"
    return "…"


def _row(path: Path, call: ast.Call, around: ast.AST) -> str:
    """Return the words, and the file where none of them is known."""
    text = words(call, around)
    known = any(letter.isalpha() for letter in text)
    return text if known else f"{text} (from `{path.relative_to(PACKAGE).as_posix()}`)"


def page() -> str:
    """Return the text of the page."""
    found = {identifier(call): _row(*each) for each in makers() if identifier(call := each[1])}
    rows = (f"| {name} | {text.replace('|', chr(92) + '|')} |\n" for name, text in sorted(found.items()))
    gone = (f"| {name} | {successor} |\n" for name, successor in sorted(RETIRED.items()))
    return HEAD + "".join(rows) + TAIL + "".join(gone)


if __name__ == "__main__":
    PAGE.write_text(page(), encoding="utf-8")
