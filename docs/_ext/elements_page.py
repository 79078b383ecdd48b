"""Write the tables of docs/reference/elements.md from the table of the words of the block ELEMENTS.

python docs/_ext/elements_page.py
"""

from pathlib import Path
from string import ascii_lowercase

from flexmb_cli.dialects.elements_block.old_cards import LINES, new_lines
from flexmb_cli.dialects.elements_block.words import WORDS

FILE = Path(__file__).resolve().parents[2] / "docs/reference/elements.md"
GONE = (
    "These cards are errors now, whose message gives the line for that very card; "
    "`scripts/elements_block DECK` of the sources rewrites decks."
)
BEGIN = "<!-- written by docs/_ext/elements_page.py -->"
_SHAPES = {
    "coordinate": "2.angle",
    "end": "1(x,y,z) or 1:4",
    "vector": "(x,y,z)",
    "function": "name of a function",
    "file": "file name",
    "whole number": "integer",
    "number": "number",
    "signals": "signal or (signal,signal)",
    "numbers": "number or (number,number)",
    "axis": "x, y or z",
    "name": "name",
}


def _rows(word) -> list[str]:
    rows = []
    for key in word.keys:
        along, about = key.units
        unit = along if along == about else f"{along}; {about}"
        given = "needed" if key.needed else "" if key.default is None else _default(key.default)
        shape = _SHAPES[key.kind]
        rows.append(f"| `{key.name}=` | {key.meaning} | {shape} | {unit or '-'} | {given or 'optional'} |")
    return rows


def _default(value) -> str:
    return "(" + ",".join(f"{x:g}" for x in value) + ")" if isinstance(value, tuple) else f"{value:g}"


def _tables() -> list[str]:
    lines: list[str] = []
    for word in WORDS:
        kinds = f" `{'` or `'.join(word.kinds)}`" if word.kinds else ""
        name = "" if word.unnamed else " name"
        lines += [f"### `{word.word}{name}`{kinds}", "", f"{word.meaning[0].upper()}{word.meaning[1:]}.", ""]
        if word.keys:
            lines += [
                "| key | meaning | what stands there | unit | default |",
                "|---|---|---|---|---|",
                *_rows(word),
                "",
            ]
        for groups in word.choices:
            ways = " or ".join(" and ".join(f"`{key}=`" for key in group) for group in groups)
            lines += [f"Of {ways}, one must be given.", ""]
    return lines


def _old() -> list[str]:
    """Rows of the cards that the block replaces, each with the line for fields named by letters."""
    fields = {"young": ["1"], "vsdf": ["1", "2", "3", "4"], "dafms": ["1", "2", "3", "4", "5", "6"]}
    rows = []
    for dialect, words in LINES.items():
        for word in words:
            # Of functions and couplings, which take any count, the first ones.
            letters = ascii_lowercase[len(fields[dialect]) - 1 :]
            few = 3 if LINES[dialect][word].startswith(("FUNCTION", "COUPLING")) else None
            number = ["1"] if word == "COUP" else []  # the coupling's, of its terms
            card = [*number, *fields[dialect], *letters[:few]]
            ((_, line),) = new_lines(dialect, word, [card], {})
            line = f"{line} …" if few and line else line
            what = f"`{line}`" if line else "nothing: all results hold joint coordinates"
            rows.append(f"| {dialect.upper()} `{word}` | {what} |")
    return ["| card | line of the block |", "|---|---|", *rows, ""]


def text(page: str) -> str:
    """Return the page with its tables written anew."""
    head = page.partition(BEGIN)[0]
    introduction = "Letters and numbers stand for the fields of a card, in their order."
    old = ["## Cards of earlier versions", "", GONE, "", introduction, "", *_old()]
    return "\n".join([f"{head}{BEGIN}", "", "## Words", "", *_tables(), *old])


if __name__ == "__main__":
    FILE.write_text(text(FILE.read_text(encoding="utf-8")), encoding="utf-8")
