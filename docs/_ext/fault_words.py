"""The words of the messages of faults, with … for what depends on the input."""

import ast
import os
import re
from dataclasses import dataclass, field, replace
from functools import cache
from pathlib import Path

from fault_calls import (
    MAKERS,
    PACKAGE,
    Site,
    around,
    calls_by_name,
    constant,
    definitions_of,
    functions_of,
    id_of,
    imported,
    is_maker,
    name_of,
    targets_of,
    tree_of,
)

MESSAGE_NAMES = ("message", "what", "reported")  # of functions that hand `id` on
FEW_LETTERS = 8  # with no more of them, a message says what its parts hold
MOST_ALTERNATIVES = 8
DEEPEST = 12  # functions that call each other
VARIES = "…"
# A function that hands `id` on, its file, and the call in it that does.
Handing = tuple[Path, ast.FunctionDef, ast.Call | None]


@dataclass(frozen=True)
class Scope:
    """Where a name is looked up: a function, up to a line, with the arguments that are known."""

    path: Path
    around: ast.AST
    line: int
    known: dict[str, str] = field(default_factory=dict)
    deep: bool = False  # say what the parts of a text hold, too
    depth: int = 0


def words(site: Site) -> str:
    """Return the message of a site, with … for what depends on the input."""
    plain = _said(site, deep=False)
    if _says_something(plain):
        return plain
    return _said(site, deep=True)


def _says_something(text: str) -> bool:
    return sum(map(str.isalpha, text)) > FEW_LETTERS


def _said(site: Site, deep: bool) -> str:
    scope = Scope(site.path, site.around, site.line, deep=deep)
    if isinstance(site.node, ast.Tuple):
        return text_of(site.node.elts[0], scope)
    return " ".join(_message(site.node, scope).split()) or VARIES


def _message(call: ast.Call, scope: Scope) -> str:
    """Return the message of a call, by way of the function that it calls if that hands it on."""
    name = name_of(call)
    found = () if is_maker(call) else _all_handing_on().get(name, ())
    if not found:
        place = MAKERS.get(name, 0)
        return text_of(call.args[place], scope) if len(call.args) > place else VARIES
    # Of several functions of the name that which shares most folders with the call, if it takes such a call.
    nearest = sorted(found, key=lambda each: -len(os.path.commonpath((each[0], scope.path))))
    texts = (_message_by(handing, call, scope) for handing in nearest)
    return next((text for text in texts if text != VARIES), VARIES)


def _message_by(handing: Handing, call: ast.Call, scope: Scope) -> str:
    """Return the message of a call that a function hands on."""
    path, function, inner = handing
    known = {name: text for name, text in _arguments(call, function, scope).items() if text != VARIES}
    inside = Scope(path, function, inner.lineno if inner else 0, known, scope.deep)
    if inner is None:  # an exception that carries its text
        return known.get(next(name for name in MESSAGE_NAMES if name in _names(function)), VARIES)
    return _message(inner, inside)


def says_what_callers_say(site: Site) -> bool:
    """Return whether the whole message of a site is an argument of the function around it."""
    if not isinstance(site.node, ast.Call) or not isinstance(site.around, ast.FunctionDef):
        return False
    place = MAKERS.get(name_of(site.node), 0)
    said = site.node.args[place] if is_maker(site.node) and len(site.node.args) > place else None
    return isinstance(said, ast.Name) and said.id in MESSAGE_NAMES and said.id in _names(site.around)


def _names(function: ast.FunctionDef) -> list[str]:
    return [argument.arg for argument in (*function.args.args, *function.args.kwonlyargs)]


def _arguments(call: ast.Call, function: ast.FunctionDef, scope: Scope) -> dict[str, str]:
    """Return the texts of the arguments of a call, those of messages above all."""
    names = [name for name in _names(function) if name != "self"]
    positional = dict(zip(names, call.args, strict=False))
    given = positional | {word.arg: word.value for word in call.keywords if word.arg in names}
    wanted = MESSAGE_NAMES if not scope.deep else tuple(names)
    return {name: text_of(node, scope) for name, node in given.items() if name in wanted}


@cache
def _all_handing_on() -> "dict[str, list[Handing]]":
    found: dict[str, list[Handing]] = {}
    for path in sorted(PACKAGE.rglob("*.py")):
        for name, function in definitions_of(path):
            names = _names(function)
            if "id" in names and any(word in names for word in MESSAGE_NAMES):
                inner = (node for node in ast.walk(function) if isinstance(node, ast.Call))
                found.setdefault(name, []).append((path, function, next(filter(_hands_on, inner), None)))
    return found


def _hands_on(call: ast.Call) -> bool:
    given = id_of(call)
    return isinstance(given, ast.Name) and given.id == "id"


def text_of(node: ast.AST | None, scope: Scope) -> str:
    """Return the text that an expression gives."""
    if node is None or scope.depth > DEEPEST:
        return VARIES
    scope = replace(scope, depth=scope.depth + 1)
    if isinstance(node, ast.Constant):
        return VARIES if node.value is None else str(node.value)
    if isinstance(node, ast.JoinedStr):
        return "".join(_part(part, scope) for part in node.values)
    if isinstance(node, ast.BinOp):
        return (
            text_of(node.left, scope) + text_of(node.right, scope) if isinstance(node.op, ast.Add) else VARIES
        )
    if isinstance(node, ast.IfExp):
        return _alternatives([text_of(node.body, scope), text_of(node.orelse, scope)])
    if isinstance(node, ast.BoolOp):
        return _alternatives([text_of(each, scope) for each in node.values])
    if isinstance(node, ast.Name):
        return _named(node.id, scope)
    if isinstance(node, ast.Call):
        return _called(node, scope)
    if isinstance(node, ast.Attribute) and ast.unparse(node.value) == "self":
        return _returned(node.attr, scope)
    return VARIES


def _part(part: ast.AST, scope: Scope) -> str:
    if not isinstance(part, ast.FormattedValue):
        return text_of(part, scope)
    if isinstance(part.value, ast.Name) and part.value.id in scope.known:
        return scope.known[part.value.id]
    return text_of(part.value, scope) if scope.deep else VARIES


def _alternatives(texts: list[str]) -> str:
    distinct = list(dict.fromkeys(text for text in texts if text.strip()))
    return " / ".join(distinct) if 0 < len(distinct) <= MOST_ALTERNATIVES else VARIES


def _assigns(node: ast.AST, name: str) -> bool:
    return isinstance(node, (ast.Assign, ast.NamedExpr, ast.AugAssign)) and name in targets_of(node)


def _named(name: str, scope: Scope) -> str:
    """Return the text of a variable: the last one assigned before, an argument, or a constant."""
    assigned = [node for node in ast.walk(scope.around) if _assigns(node, name) and node.lineno < scope.line]
    if assigned and isinstance(scope.around, ast.FunctionDef):
        last = max(assigned, key=lambda node: node.lineno)
        before = replace(scope, line=last.lineno)
        if isinstance(last, ast.AugAssign):
            return _named(name, before) + VARIES
        return text_of(last.value, before)
    if name in scope.known:
        return scope.known[name]
    if isinstance(scope.around, ast.FunctionDef) and name in _names(scope.around):
        return _of_callers(name, scope) if scope.deep else VARIES
    value = constant(name, scope.path)
    return text_of(value, replace(scope, around=tree_of(scope.path))) if value else VARIES


def _called(call: ast.Call, scope: Scope) -> str:
    name = ast.unparse(call.func)
    if name == "no_such":
        what = text_of(call.args[0], scope)
        none = f"is not there: the deck has no {what}; add one, or remove this card"
        return f"{what} number … is outside … / {what} number … {none}"
    if isinstance(call.func, ast.Attribute) and call.func.attr == "format":
        return re.sub(r"\{[^}]*\}", VARIES, text_of(call.func.value, scope))
    if isinstance(call.func, ast.Name) or name.startswith("self."):
        return _returned(name.removeprefix("self."), scope, call)
    return VARIES


def _returned(name: str, scope: Scope, call: ast.Call | None = None) -> str:
    """Return the texts that a function or a property gives back."""
    path = scope.path
    found = [f for f in functions_of(path) if f.name == name]
    if not found and (origin := imported(name, path)):
        path = origin
        found = [f for f in functions_of(path) if f.name == name]
    if not found:
        return VARIES
    function = found[0]
    known = _arguments(call, function, scope) if call else {}
    returns = [node for node in ast.walk(function) if isinstance(node, ast.Return) and node.value]
    inside = [Scope(path, function, node.lineno, known, scope.deep, scope.depth) for node in returns]
    return _alternatives([text_of(node.value, each) for node, each in zip(returns, inside, strict=True)])


def _of_callers(name: str, scope: Scope) -> str:
    """Return the texts that callers give for an argument of the function around."""
    function = scope.around
    assert isinstance(function, ast.FunctionDef)
    texts = []
    for path, node in calls_by_name().get(function.name, ()):
        outside = Scope(path, around(path, node.lineno), node.lineno, {}, True, scope.depth + 3)
        texts.append(_arguments(node, function, outside).get(name, VARIES))
    # A name, a number or a file says nothing of the message.
    return _alternatives(texts) if any(map(_says_something, texts)) else VARIES
