"""Write the TextMate grammar of the decks in docs/editors/vscode, with the words of the readers' own tables.

python docs/_ext/deck_grammar.py
"""

import json
import re
from pathlib import Path

from flexmb_cli.dialects.dafms.cards import CARDS as DAFMS
from flexmb_cli.dialects.vsdf.cards import BY_WORD, DATA_WORDS
from flexmb_cli.dialects.young.cards import BY_KEYWORD
from flexmb_cli.dialects.young.dynamic_cards import LAST_CARD

FILE = Path(__file__).resolve().parents[2] / "docs/editors/vscode/syntaxes/flexmb.tmLanguage.json"
# Lines of their own that open and close models.
MODEL_WORDS = ("STAR", "STOP", "END")
REAL = r"[-+]?(\d+\.?\d*|\.\d+)([EeDd][-+]?\d+|[-+]\d+)?"


def grammar() -> dict:
    """Return the grammar; scopes are those that themes of VS Code and TextMate know."""
    dafms = [re.escape(word.strip()) for word in DAFMS]
    vsdf = [re.escape(word) for word in BY_WORD]
    young = [*map(re.escape, BY_KEYWORD), LAST_CARD]
    return {
        "$schema": "https://raw.githubusercontent.com/martinring/tmlanguage/master/tmlanguage.json",
        "name": "flexmb deck",
        "scopeName": "source.flexmb",
        "fileTypes": ["vsdf"],
        "patterns": [
            {"begin": r"\{", "end": r"\}", "name": "comment.block.flexmb"},
            {"match": r"^\*.*$", "name": "comment.line.asterisk.flexmb"},
            {"match": r"^(VSDF|DFMB)\b\s*(.*)$", "captures": {
                "1": {"name": "keyword.control.model.flexmb"},
                "2": {"name": "string.unquoted.title.flexmb"}}},
            {"match": rf"^({'|'.join(MODEL_WORDS)})\s*$", "name": "keyword.control.model.flexmb"},
            {"match": rf"^({'|'.join(dict.fromkeys([*vsdf, *dafms]))})(?=\s*$)",
             "name": "keyword.control.card.flexmb"},
            {"match": rf"(?i)^\s*({'|'.join(sorted(young, key=len, reverse=True))})\b",
             "name": "keyword.control.card.flexmb"},
            {"match": rf"\b({'|'.join(DATA_WORDS)})\b", "name": "support.constant.method.flexmb"},
            {"match": r"(?i)\b[\w./\\-]+\.(inp|mas|sti|dof|mtx|op4|bdf|dat|cdb|hb|pch|csv|txt|stl)\b",
             "name": "string.unquoted.file.flexmb"},
            {"match": rf"(?<![\w.]){REAL}(?![\w.])", "name": "constant.numeric.flexmb"},
            {"match": r"\b[A-Z]{2,4}[0-9]?\b", "name": "entity.name.type.flexmb"},
        ],
    }  # fmt: skip


def text() -> str:
    """Return the file's text."""
    return json.dumps(grammar(), indent=2) + "\n"


if __name__ == "__main__":
    FILE.parent.mkdir(parents=True, exist_ok=True)
    FILE.write_text(text(), encoding="utf-8")
