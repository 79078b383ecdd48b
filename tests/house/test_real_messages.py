"""What bad input is told is what the page of messages shows under the fault's identifier."""

import re
import sys
from pathlib import Path

import pytest

from flexmb_cli.deck.listing import read_bytes
from flexmb_cli.deck.text import decode, read_text
from flexmb_cli.dialects.recognise import read_deck
from flexmb_cli.dialects.settings import apply_settings
from flexmb_cli.errors import FlexmbError
from flexmb_cli.results.diff.tolerances import parse_kinds
from flexmb_cli.results.quantities.quantities import open_result
from flexmb_cli.study.reader import read_study

TOP = Path(__file__).resolve().parents[2]
sys.path.insert(0, str(TOP / "docs" / "_ext"))
import fault_messages  # noqa: E402

ROWS = dict(
    re.findall(r"^\| (\S+) \| (.*) \|$", fault_messages.PAGE.read_text(encoding="utf-8"), re.MULTILINE)
)

YOUNG = (TOP / "decks/young/IN4-BAR.dat").read_text()
STUDY = """deck = "a.dat"
count = 3
unknown = 1
dialect = "other"
seed = -1
[parameters]
"driver.1.A" = "text"
"driver.1.B" = ["text"]
"driver.1.C" = { from = 1 }
"driver.1.D" = { from = 1, to = 2 }
"driver.1.E" = { from = 1, to = 2, scale = "other" }
"driver.1.F" = { from = 0, to = 2, scale = "log" }
driver.1.G = { from = 0, to = 2 }
[results]
top = "body.1.z"
"a/b" = "max body.1.z"
"""


def _reported(read, *given):
    with pytest.raises(FlexmbError) as raised:
        read(*given)
    return raised.value.faults


def _deck(dialect, text):
    return lambda: read_deck(decode("deck", text.encode()), dialect)


def _folder():
    read_bytes(TOP)


BAD = {
    "DECK-006": lambda: read_bytes("no such table"),
    "DECK-055": _folder,
    "DECK-011": lambda: read_text("no such deck"),
    "DECK-051": lambda: read_text(TOP),
    "DECK-053": lambda: read_text("a\0b"),
    "RESULT-015": lambda: open_result("no such result").__enter__(),
    "RESULT-065": lambda: open_result(TOP / "README.md").__enter__(),
    "DECK-012": _deck("auto", ""),
    "DECK-013": _deck("auto", "prose\n"),
    "DECK-062": _deck("auto", 'deck = "a.dat"\n'),
    "DECK-063": _deck("auto", "# Title\n"),
    "YOUNG-177": _deck("young", ""),
    "YOUNG-176": _deck("young", "1 2 3"),
    "YOUNG-056": _deck("young", YOUNG.replace("6.10", "6.l0", 1)),
    "YOUNG-169": _deck("young", YOUNG.replace("}", "", 1) if "}" in YOUNG else "{ " + YOUNG),
    "DAFMS-154": _deck("dafms", "    0    3\n"),
    "DAFMS-155": _deck("dafms", "99999    3\n"),
    "DAFMS-156": _deck("dafms", "    1    4\n"),
    "DAFMS-157": _deck("dafms", "    1    3\nSTOP\n"),
    "DECK-005": _deck("dafms", "    x    3\n"),
    "DECK-046": _deck("dafms", "    1    3\n"),
    "VSDF-155": _deck("vsdf", "PROSE\nEND\n"),
    "VSDF-156": _deck("vsdf", "VSDF title\nNONE\nEND\n"),
    "VSDF-161": _deck("vsdf", "VSDF title\n"),
    "VSDF-154": _deck("vsdf", "VSDF title\n 1\nEND\n"),
    "STUDY-033": lambda: read_study(decode("study", STUDY.encode())),
    "STUDY-038": lambda: read_study(decode("study", b'deck = ""\n')),
    "DIFF-011": lambda: parse_kinds(["nothing=1"]),
    "DIFF-036": lambda: parse_kinds(["force=x"]),
    **{
        name: lambda setting=setting: apply_settings(_deck("young", YOUNG)(), [setting])
        for name, setting in {
            "DECK-016": "time.end=x",
            "DECK-057": "time.end",
            "DECK-058": "time.none=1",
            "DECK-059": "counts.NBODY=1",
        }.items()
    },
}


@pytest.mark.parametrize("name", BAD)
def test_the_page_shows_what_the_program_says(name):
    faults = _reported(BAD[name])
    assert name in [fault.id for fault in faults]
    for fault in faults:
        template = ROWS[fault.id]
        assert any(_is_of(fault.message, words) for words in template.split(" / ")), (fault, template)


def _is_of(message, words):
    """Whether a message has these words; … stands for anything."""
    return re.search(re.escape(words).replace("…", ".*"), " ".join(message.split())) is not None


def test_a_message_of_other_words_is_not_taken_for_one_of_the_page():
    assert _is_of("no such file; is a.dat meant?", "no such file…")
    assert not _is_of("no such file", "cannot be read: …")
