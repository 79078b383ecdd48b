"""Help texts, messages, documentation, docstrings and comments use the literature's terms, not former ones.

`REPLACED` is the list of words to replace that the project's writing guide gives: each with the word that
stands instead.  Left out of it are those that are also words of the field or of every day, such as near,
turns, measures, arms (of robots), spans (a null space), pulls (a cable) and law (a field of MOTN cards).
"""

import ast
import re
import sys
import tokenize
from pathlib import Path

import click
import pytest

from flexmb_cli.cli import cli

TOP = Path(__file__).resolve().parents[2]
sys.path.insert(0, str(TOP / "docs" / "_ext"))
import fault_messages  # noqa: E402

REPLACED = {
    # Terms.
    "march|marches|marching|stepper": "integrator, continuation",
    "rider|riders|ridden": "node frame, flexible parent",
    "lump|lumps": "nodal mass, node",
    "grip|grips|gives? way|give way|felt": "Schur complement, constraint Jacobian",
    "leap|leaps": "singular step",
    "settle|settles": "projection",
    "passages|passed positions": "singular configurations passed, bifurcation",
    "weakness": "conditioning",
    "tilt": "driver axis",
    "parted joints": "initial gaps",
    "small motions": "linearised motion, modes",
    "orphans|blocked stops": "parent watch, signal mask",
    "line custom": "shifted lines",
    "parts of a study": "checkpoints of a sweep",
    "freedoms": "degrees of freedom",
    "kind|kinds": "type",
    "told|tells|tell": "reported",
    "taken from": "updated from",
    "things? (?:are|is) missing": "missing entries",
    "journal": "resume file",
    "heap check": "heap bounds",
    "doubts": "warnings",
    "forgiving": "full-disk guard",
    "strangers|strangers'|stranger's": "untrusted",
    # Sentences: no personified programs, no riddles.
    "hears|knows|(?:is|are|was|were) asked": "has; is entered",
    "goes on|going on|go on (?:with|on|from)|goes on (?:with|from)": "continue",
    "says what, which": "has the form",
    "(?:what|which) tells": "default selection",
    "not asked for": "left out",
}
# Habits of sentences that a user would read twice; in help texts, messages and pages only.
HABITS = {
    "behind": "after; cause of",
    "wanted": "expected",
    "else why not": "otherwise it says why",
    "(?:can|may) be given again": "repeatable",
    "nothing but errors": "errors only",
    "(?<!here )(?:is|are|was|were) no(?! longer| more)": "is not a; has no",
    "says? nothing": "has no effect",
    "not so": "correct ...",
    "parted by": "separated by",
}
FORMER, HABIT = (
    re.compile(rf"(?<![\w-])(?:{'|'.join(words)})(?![\w-])", re.IGNORECASE) for words in (REPLACED, HABITS)
)
# A sentence that begins with a condition says If; Where begins questions and headings.
CONDITION = re.compile(r"(?:^|[.:;] )Where\b(?![^.:;|]*\?)", re.MULTILINE)
# Messages that name the field `kind` of a FUNC card.
FIELDS_CALLED_KIND = {"DAFMS-086", "VSDF-086"}
# What is not prose, or not flexmb's own.
NO_PROSE = (
    r"```(?!console).*?```",  # programs and files
    r"^\$ .*$",  # commands; what they print is read
    r"`[^`\n]*`",
    r"\$[^$\n]+\$",  # formulas
    r"\]\([^)]*\)",  # addresses
    r"\bJournal\b",  # in titles of publications
    r"^\[kinds\]$",  # a table of files of tolerances
)
MADE = {"_build", "gallery", "reproduced.md", "messages.md"}
PAGES = [
    TOP / "README.md",
    *sorted(page for page in (TOP / "docs").rglob("*.md") if not MADE & set(page.parts)),
]


def former_words(text):
    return [match.group() for match in FORMER.finditer(text)]


def read_twice(text):
    """Former words, and habits of sentences, in a text that users read."""
    found = [match.group() for pattern in (HABIT, CONDITION) for match in pattern.finditer(text)]
    return former_words(text) + found


def commands(command, name):
    yield name, command
    if isinstance(command, click.Group):
        context = click.Context(command)
        for word in command.list_commands(context):
            yield from commands(command.get_command(context, word), f"{name} {word}")


def prose(page):
    return without_code(page.read_text(encoding="utf-8"))


def without_code(text):
    for pattern in NO_PROSE:
        text = re.sub(
            pattern, " ", text, flags=re.DOTALL | re.MULTILINE if "```" in pattern else re.MULTILINE
        )
    return text


@pytest.mark.parametrize(
    "name, command", [*commands(cli, "flexmb")], ids=lambda x: x if type(x) is str else ""
)
def test_help_texts(name, command):
    text = command.get_help(click.Context(command, info_name=name))
    # The names of options stay, since scripts use them.
    assert not read_twice(" ".join(text.replace("--kind", "").split()))


def test_messages_of_faults():
    rows = [line for line in fault_messages.page().splitlines() if line.startswith("| ")]
    found = {row: read_twice(re.sub(r"`[^`]*`", " ", row)) for row in rows}
    named = {row: words for row, words in found.items() if words and row.split()[1] not in FIELDS_CALLED_KIND}
    assert len(rows) > 400 and not named


@pytest.mark.parametrize("page", PAGES, ids=lambda page: str(page.relative_to(TOP)))
def test_documentation(page):
    assert not read_twice(prose(page))


def docstrings_and_comments(module):
    """The docstrings of a module and its parts, and its comments, with their lines."""
    with tokenize.open(module) as file:
        comments = [
            (token.start[0], token.string)
            for token in tokenize.generate_tokens(file.readline)
            if token.type == tokenize.COMMENT
        ]
    described = (ast.Module, ast.ClassDef, ast.FunctionDef)
    for node in ast.walk(ast.parse(module.read_text(encoding="utf-8"))):
        if isinstance(node, described) and ast.get_docstring(node) is not None:
            yield node.body[0].lineno, ast.get_docstring(node)
    yield from comments


def test_docstrings_and_comments():
    found = [
        f"{module.relative_to(TOP)}:{line}: {words}"
        for module in sorted((TOP / "flexmb_cli").rglob("*.py"))
        for line, text in docstrings_and_comments(module)
        if (words := former_words(without_code(text)))
    ]
    assert not found


def test_a_former_word_is_found():
    """The summary that `diff` printed before, and the former help of `table` (findings on release 0.1.0)."""
    assert former_words("1534 of 3189 numbers differ, 0 things are missing") == ["things are missing"]
    assert former_words("A NAME says what, which, the quantity") == ["says what, which"]
    assert not former_words("degrees of freedom, type of joint")


def test_a_habit_is_found():
    """Messages, help and pages of before (sentences that had to be read twice)."""
    assert read_twice("x, line 2: whole numbers wanted; read 'a'") == ["wanted"]
    assert read_twice("METH = 5 is no integrator") == ["is no"]
    assert read_twice("Behind the last number. Where a body is flexible, say nothing but errors") == [
        "Behind", "say nothing", ". Where",
    ]  # fmt: skip
    assert not read_twice("There is no joint; it is no longer read. Where are the tips?")
