"""VSDF decks read without flexmb: the cards whose numbers a judge of results needs, by column or comma.

The formats are those of decks/vsdf/FORMAT.md; what is not read is named, so that it counts as not judged.
"""

from dataclasses import dataclass
from pathlib import Path

# Fields of a data card: I an integer, A a word, T the rest of the line, F a real; "/" the next card.
FORMATS = {
    "BODY": "IAIIII",
    "RIGI": "IFFFF/FFFFFF",
    "NODE": "IIFFF",
    "FEMN": "IAT",
    "FEMM": "IAT",
    "POSI": "IFFF",
    "JOIN": "IAIIIIIIIIF",
    "SPRI": "IIIIIFFF",
    "GRAV": "FFF",
    "TIME": "FFF",
}
# What these ask for moves no joint and stores no energy: pictures, choices of output, the integrator.
SILENT = {"OUTN", "OUTS", "INTG", "GEOM", "GSTL", "FEMK", "FEMP", "EULP", "PLAC", "VSDF", "END", "STAR"}
WIDTHS = {"I": 5, "A": 5, "F": 10}


@dataclass(frozen=True)
class VsdfText:
    """Fields of a deck's cards by keyword; the keywords that were not read; where its files lie."""

    cards: dict[str, list[list]]
    unread: tuple[str, ...]
    folder: Path

    def get(self, word: str) -> list[list]:
        """Return the cards of a keyword."""
        return self.cards.get(word, [])


def read_vsdf_text(text: str, folder: Path) -> VsdfText | None:
    """Return the cards of a deck; None where a field is not what its format says."""
    blocks, unread = {}, set()
    for line in text.splitlines()[1:]:
        if line.startswith("*") or not line.strip():
            continue
        if line[0].isalpha():
            word = line[:4].strip().upper()
            if word == "STOP":
                break
            lines = blocks.setdefault(word, [])
            if word not in FORMATS and word not in SILENT:
                unread.add(word)
        else:
            lines.append(line)
    try:
        cards = {
            word: list(_cards(lines, FORMATS[word])) for word, lines in blocks.items() if word in FORMATS
        }
    except (ValueError, IndexError):
        return None
    return VsdfText(cards, tuple(sorted(unread)), folder)


def _cards(lines, form):
    parts = form.split("/")
    for k in range(0, len(lines), len(parts)):
        yield [
            value
            for line, part in zip(lines[k : k + len(parts)], parts, strict=True)
            for value in _fields(line, part)
        ]


def _fields(line, form):
    words = _words(line, form)
    for kind, word in zip(form, words, strict=True):
        word = word.strip()
        if kind == "I":
            yield int(word or 0)
        elif kind == "F":
            # An empty field is not always 0: a distance, a length at rest.
            yield float(word.replace("D", "e").replace("d", "e")) if word else None
        else:
            yield word


def _words(line, form):
    if "," in line:
        words = [*line.split(","), *[""] * len(form)][: len(form)]
        return [(word.split() or [""])[0] for word in words]
    words, at = [], 0
    for kind in form:
        width = WIDTHS.get(kind, len(line))
        words.append(line[at : at + width])
        at += width
    return words
