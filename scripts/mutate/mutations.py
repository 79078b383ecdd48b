"""Mutants of compiled functions: single edits of signs, factors and indices.

What is not mechanics stays as it is: loop bounds, conditions, sizes of arrays, whole-number counters,
records of an integrator's clock, and the functions that `bookkeeping.toml` lists.
"""

import ast
import fnmatch
import itertools
import random
import re
import tomllib
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

from tree import is_kernel

HERE = Path(__file__).parent
ALLOCATIONS = {"empty", "zeros", "ones", "range", "len", "namedtuple"}
PAIRS = {
    "sin": "cos",
    "cos": "sin",
    "plus": "minus",
    "minus": "plus",
    "inward": "outward",
    "outward": "inward",
}
BODY_PAIRS = re.compile(r"_([ij])$")


@dataclass(frozen=True)
class Mutant:
    """One edit: bytes `begin` to `end` of a file become `text`."""

    file: str
    line: int
    lines: range  # of the statement
    function: str
    kind: str
    begin: int
    end: int
    text: str
    before: str
    after: str

    @property
    def key(self) -> str:
        """Return what the edit is, wherever its function may move."""
        return f"{self.function}: {self.before} -> {self.after}"

    @property
    def name(self) -> str:
        """Return the key with its file."""
        return f"{self.file}: {self.key}"


def skipped_functions() -> dict[str, str]:
    """Return {pattern of function names: reason} of what is no mechanics."""
    return tomllib.loads((HERE / "bookkeeping.toml").read_text(encoding="utf-8"))


def all_mutants(tree: Path, files: list[Path]) -> list[Mutant]:
    """Return the mutants of all files; raise ValueError for a pattern that fits no function."""
    patterns, used, found = skipped_functions(), set(), []
    for path in files:
        source = path.read_bytes()
        # Integrators make kernels within functions, for the parts of a method.
        for node in filter(is_kernel, ast.walk(ast.parse(source))):
            fits = {p for p in patterns if fnmatch.fnmatchcase(f"{path.stem}.{node.name}", p)}
            used |= fits
            if not fits:
                found += _Finder(source, str(path.relative_to(tree)), node.name).mutants(node)
    if used != patterns.keys():
        raise ValueError(f"bookkeeping.toml: no function is named {sorted(patterns.keys() - used)}")
    return list({mutant.name: mutant for mutant in found}.values())


def sample(mutants: list[Mutant], size: int, seed: int) -> list[Mutant]:
    """Return `size` mutants, spread evenly over files and kinds."""
    generator = random.Random(seed)
    keyed = sorted(mutants, key=lambda m: (m.file, m.kind, generator.random()))
    stride = max(1.0, len(keyed) / size)
    start = generator.random() * stride
    return [keyed[int(start + k * stride)] for k in range(min(size, len(keyed)))]


class _Finder:
    """Edits within one function."""

    def __init__(self, source, file, function):
        self.source, self.file, self.function = source, file, function
        self.starts = [0]
        for line in source.splitlines(keepends=True):
            self.starts.append(self.starts[-1] + len(line))

    def mutants(self, function) -> list[Mutant]:
        return [self._mutant(*edit) for statement in _statements(function) for edit in self._edits(statement)]

    def _mutant(self, statement, kind, begin, end, text):
        first, last = self._span(statement)
        before, after = (
            self.source[first:last],
            self.source[first:begin] + text.encode() + self.source[end:last],
        )
        line, lines = (
            self.source.count(b"\n", 0, begin) + 1,
            range(statement.lineno, statement.end_lineno + 1),
        )
        words = (" ".join(part.decode().split()) for part in (before, after))
        return Mutant(self.file, line, lines, self.function, kind, begin, end, text, *words)

    def _span(self, node):
        begin = self.starts[node.lineno - 1] + node.col_offset
        return begin, self.starts[node.end_lineno - 1] + node.end_col_offset

    def _edits(self, statement) -> Iterator[tuple]:
        if isinstance(statement, ast.AugAssign) and isinstance(statement.op, ast.Add | ast.Sub):
            begin, end = self._span(statement.target)[1], self._span(statement.value)[0]
            yield statement, "sign", *self._swapped(begin, end, {b"+=": "-=", b"-=": "+="})
        for node in _mechanics(statement):
            for edit in self._of_node(node):
                yield statement, *edit

    def _swapped(self, begin, end, swaps):
        """(begin, end, text) of the operator between two places."""
        for old, new in swaps.items():
            place = self.source.find(old, begin, end)
            if place >= 0:
                return place, place + len(old), new
        raise AssertionError(self.source[begin:end])

    def _of_node(self, node):
        if isinstance(node, ast.BinOp):
            yield from self._of_operation(node)
        elif isinstance(node, ast.UnaryOp) and isinstance(node.op, ast.USub):
            begin = self._span(node)[0]
            yield "sign", begin, begin + 1, "+"
        elif isinstance(node, ast.Constant) and type(node.value) is float and node.value != 0.0:
            yield "factor", *self._span(node), "1.0" if node.value == 2.0 else repr(2.0 * node.value)
        elif isinstance(node, ast.Call) and isinstance(node.func, ast.Name | ast.Attribute):
            yield from self._of_call(node)
        elif isinstance(node, ast.Subscript):
            yield from self._of_index(node.slice)

    def _of_operation(self, node):
        between = self._span(node.left)[1], self._span(node.right)[0]
        if isinstance(node.op, ast.Add | ast.Sub):
            yield "sign", *self._swapped(*between, {b"+": "-", b"-": "+"})
        elif isinstance(node.op, ast.Mult):
            yield "factor", *self._swapped(*between, {b"*": "/"})
            # One factor is left out, the one that is no sum.
            begin, end = self._span(node)
            kept = (
                node.left if isinstance(node.right, ast.Constant | ast.Name | ast.Subscript) else node.right
            )
            first, last = self._span(kept)
            yield "factor", begin, end, f"({self.source[first:last].decode()})"
        elif isinstance(node.op, ast.Div):
            yield "factor", *self._swapped(*between, {b"/": "*"})
        elif isinstance(node.op, ast.Pow) and isinstance(node.right, ast.Constant):
            yield "factor", *self._span(node.right), str(node.right.value + 1)

    def _of_call(self, node):
        name = node.func.id if isinstance(node.func, ast.Name) else node.func.attr
        if name in PAIRS:
            end = self._span(node.func)[1]
            yield "factor" if name in ("sin", "cos") else "sign", end - len(name), end, PAIRS[name]
        elif name == "cross" and len(node.args) == 2:
            (begin, end), (first, last) = map(self._span, node.args)
            one, two = self.source[begin:end], self.source[first:last]
            yield "sign", begin, last, (two + self.source[end:first] + one).decode()

    def _of_index(self, index):
        parts = index.elts if isinstance(index, ast.Tuple) else [index]
        for part in parts:
            if isinstance(part, ast.Constant) and isinstance(part.value, int):
                yield "index", *self._span(part), str((part.value + 1) % 3)
            elif isinstance(part, ast.Constant) and BODY_PAIRS.search(part.value):
                other = BODY_PAIRS.sub(lambda m: "_j" if m[1] == "i" else "_i", part.value)
                yield "index", *self._span(part), f'"{other}"'
            elif _offset(part):
                yield "index", *self._span(part.right), str(part.right.value + 1)
        for a, b in itertools.pairwise(parts):
            if isinstance(a, ast.Name) and isinstance(b, ast.Name) and a.id != b.id:
                yield "index", self._span(a)[0], self._span(b)[1], f"{b.id}, {a.id}"


def _offset(node):
    return (
        isinstance(node, ast.BinOp)
        and isinstance(node.op, ast.Add | ast.Sub)
        and isinstance(node.right, ast.Constant)
        and isinstance(node.right.value, int)
    )


def _statements(function) -> Iterator[ast.stmt]:
    """Assignments and other plain statements of a function that compute."""
    for node in ast.walk(function):
        if isinstance(node, ast.AugAssign) and isinstance(node.value, ast.Constant):
            continue
        if isinstance(node, ast.Assign | ast.AugAssign) and _is_record(node):
            continue
        if isinstance(node, ast.Assign | ast.AugAssign | ast.Return) or (
            isinstance(node, ast.Expr) and isinstance(node.value, ast.Call)
        ):
            yield node


def _is_record(node):
    """Whether a statement sets what an integrator counts and plans."""
    targets = node.targets if isinstance(node, ast.Assign) else [node.target]
    return any(isinstance(n, ast.Name) and n.id == "clock" for t in targets for n in ast.walk(t))


def _mechanics(node) -> Iterator[ast.AST]:
    """The expressions below a statement, but not those of loop bounds, sizes and conditions."""
    for child in ast.iter_child_nodes(node):
        if isinstance(child, ast.stmt | ast.Compare):
            continue
        if isinstance(child, ast.IfExp):
            for part in (child.body, child.orelse):
                yield part
                yield from _mechanics(part)
            continue
        if isinstance(child, ast.Call) and ast.unparse(child.func).rpartition(".")[2] in ALLOCATIONS:
            continue
        if isinstance(child, ast.Attribute) or (isinstance(child, ast.Subscript) and _is_shape(child)):
            continue
        if isinstance(child, ast.Slice):
            continue
        yield child
        yield from _mechanics(child)


def _is_shape(node):
    return isinstance(node.value, ast.Attribute) and node.value.attr == "shape"
