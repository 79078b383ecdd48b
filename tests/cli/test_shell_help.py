"""What helps at the keyboard: completion, manual pages, exit codes in the help, colours of decks."""

import json
import os
import re
import shutil
import subprocess
import sys
from pathlib import Path

import pytest
from click.testing import CliRunner
from textmate_grammar.parsers.base import LanguageParser

from flexmb_cli.cli import COMMANDS, cli

TOP = Path(__file__).resolve().parents[2]
sys.path[:0] = [str(TOP / "docs/_ext"), str(TOP / "tests/write")]
import deck_grammar  # noqa: E402
import man_pages  # noqa: E402

from tests.results.results import write_result  # noqa: E402

SHIM = f'#!/bin/sh\nexec "{sys.executable}" -m flexmb_cli "$@"\n'
# What bash does at TAB: it calls the function that `complete` registered, with the words so far.
COMPLETE = """
eval "$(_FLEXMB_COMPLETE=bash_source flexmb)"
for line in "$@"; do
    COMPREPLY=(); COMP_WORDS=($line); COMP_CWORD=$((${#COMP_WORDS[@]} - 1)); COMP_LINE=$line
    _flexmb_completion flexmb 2>/dev/null
    echo "${COMPREPLY[@]}"
done
"""


@pytest.fixture
def shell(tmp_path):
    """A folder with a deck and a result, and the words that bash offers there after TAB, for each line."""
    bash = shutil.which("bash")
    if bash is None:
        pytest.skip("bash is not installed")
    (tmp_path / "bin").mkdir()
    shim = tmp_path / "bin/flexmb"
    shim.write_text(SHIM)
    shim.chmod(0o755)
    (tmp_path / "INdeck.dat").touch()
    write_result(tmp_path / "r.h5", 3)

    def offered(*lines):
        done = subprocess.run(
            [bash, "--norc", "-c", COMPLETE, "bash", *lines],
            capture_output=True, text=True, cwd=tmp_path, timeout=60,
            env=os.environ | {"PATH": f"{tmp_path / 'bin'}:{os.environ['PATH']}"},
        )  # fmt: skip
        assert done.returncode == 0, done.stderr
        return [line.split() for line in done.stdout.splitlines()]

    return offered


@pytest.mark.processes
def test_bash_completes_commands_options_and_choices(shell):
    lines = "flexmb e", "flexmb run --est", "flexmb run --layout h", "flexmb new d"
    assert shell(*lines) == [["export", "examples"], ["--estimate-error"], ["historic"], ["dafms"]]


@pytest.mark.processes
def test_bash_completes_examples_and_the_quantities_of_a_result(shell):
    lines = "flexmb examples IN4", "flexmb table r.h5 body.1.vel", "flexmb table none.h5 body"
    examples, *quantities = shell(*lines)
    assert "IN4-BAR" in examples
    assert quantities == [[f"body.1.velocity.{axis}" for axis in "xyz"], []]


@pytest.mark.processes
@pytest.mark.parametrize(
    "words", [["run", "IN"], ["diff", "IN"], ["sweep", "IN"], ["run", "x.dat", "--out", "IN"], ["plot", "IN"]]
)
def test_where_a_file_is_wanted_the_shell_is_asked_for_files(words):
    """click's script for bash, zsh and fish completes names of files where the answer is of this type."""
    environment = os.environ | {
        "_FLEXMB_COMPLETE": "bash_complete", "COMP_WORDS": f"flexmb {' '.join(words)}",
        "COMP_CWORD": str(len(words)),
    }  # fmt: skip
    done = subprocess.run(
        [sys.executable, "-m", "flexmb_cli"], capture_output=True, text=True, env=environment, timeout=60
    )
    assert done.stdout.splitlines() == ["file,IN"]


@pytest.mark.processes
@pytest.mark.parametrize("shell_name", ["zsh", "fish"])
def test_zsh_and_fish_accept_the_script(shell_name, tmp_path):
    script = subprocess.run(
        [sys.executable, "-m", "flexmb_cli"], capture_output=True, text=True, timeout=60,
        env=os.environ | {"_FLEXMB_COMPLETE": f"{shell_name}_source"},
    ).stdout  # fmt: skip
    assert "_FLEXMB_COMPLETE" in script and "flexmb" in script
    if shutil.which(shell_name) is None:
        pytest.skip(f"{shell_name} is not installed: its script is made, not run")
    (tmp_path / "script").write_text(script)
    done = subprocess.run([shell_name, "-n", str(tmp_path / "script")], capture_output=True, timeout=60)
    assert done.returncode == 0


@pytest.mark.parametrize("command", [None, *COMMANDS])
def test_every_help_states_the_exit_codes(command):
    shown = CliRunner().invoke(cli, [*([command] if command else []), "--help"]).output
    part = shown.partition("Exit codes:\n")[2].partition("\n\n")[0]
    assert [line.split()[0] for line in part.splitlines()] == ["0", "1", "2", "3", "130,"]


def test_the_manual_pages_are_those_of_the_program():
    written = {path.name: path.read_text(encoding="utf-8") for path in man_pages.FOLDER.glob("*.1")}
    assert written == man_pages.pages(), "run `python docs/_ext/man_pages.py`"


@pytest.mark.processes
def test_man_shows_every_page_without_a_warning():
    if shutil.which("groff") is None:
        pytest.skip("groff is not installed")
    for page in man_pages.FOLDER.glob("*.1"):
        done = subprocess.run(
            ["groff", "-man", "-Tutf8", "-ww", str(page)], capture_output=True, text=True, timeout=60
        )
        assert done.stderr == ""
        assert "EXIT STATUS" in re.sub(".\b|\x1b\\[\\d*m", "", done.stdout)


def test_the_grammar_is_made_of_the_words_of_the_readers():
    assert deck_grammar.FILE.read_text(encoding="utf-8") == deck_grammar.text(), (
        "run `python docs/_ext/deck_grammar.py`"
    )
    package = json.loads((TOP / "docs/editors/vscode/package.json").read_text())
    for part in package["contributes"]["grammars"]:
        assert (TOP / "docs/editors/vscode" / part["path"]).is_file()


def test_the_grammar_colours_the_decks():
    """Tokens of decks of the three dialects by a port of VS Code's engine; a line of a comment is one."""
    colours = LanguageParser(json.loads(deck_grammar.FILE.read_text(encoding="utf-8")) | {"fileTypes": []})
    card, number = "keyword.control.card.flexmb", "constant.numeric.flexmb"
    model, comment = "keyword.control.model.flexmb", "comment.block.flexmb"
    wanted = {
        "young/IN4-BAR.dat": {("4", number), ("0.00016", number), ("-0.00027", number), ("{", comment)},
        "young/dynamics/IN4-BAR-MASS.dat": {("MASS", card), ("GRAVITY", card)},
        "dafms/pendulum.DAT": {("DFMB", model), ("CONN", card), ("Q(k)", card), (".9999875", number)},
        "vsdf/slider_crank_flex.vsdf": {
            ("VSDF", model), ("RIGI", card), ("1.0E-3", number), ("RK45", "support.constant.method.flexmb"),
            ("fe/rod/rod.inp", "string.unquoted.file.flexmb"), ("REVO", "entity.name.type.flexmb"),
        },
    }  # fmt: skip
    for deck, pairs in wanted.items():
        text = (TOP / "decks" / deck).read_text(encoding="latin1")
        found = [(words.strip(), scopes[-1]) for _, words, scopes in colours.parse_string(text).flatten()]
        tokens = [(words[:1] if scope == comment else words, scope) for words, scope in found if words]
        assert not pairs - set(tokens), deck
        bare = [token for token in tokens if token[1] == "source.flexmb"]
        assert len(bare) < 0.02 * len(tokens) + 3, bare


@pytest.mark.parametrize("name", ["", *COMMANDS])
def test_help_texts_are_sound_as_pages_of_the_documentation(name):
    """reStructuredText takes such a `*` for the beginning of an emphasis, and warns."""
    command = cli.get_command(None, name) if name else cli
    texts = [
        command.help or "",
        command.epilog or "",
        *(getattr(p, "help", None) or "" for p in command.params),
    ]
    for text in texts:
        assert not re.search(r"(?:^|[\s([{<\-/:])\*(?=\S)", text), text
