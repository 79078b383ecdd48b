"""YOUNG decks read without flexmb: what a judge of its results needs, by the order of numbers alone.

Liang Yong, YOUNG dissertation (1996), chapter 5: counts, then bodies, drivers, points, joints by their type,
simplified constraints, distances, grounds, time; comments in braces.
"""

import re
from dataclasses import dataclass

COUNTED = (
    ("body", 7), ("driver", 5), ("point", 4), ("spherical", 8), ("universal", 14), ("revolute", 14),
    ("cylindrical", 14), ("translational", 20), ("screw", 21), ("simplified", 3), ("distance", 4),
    ("ground", 7),
)  # fmt: skip
JOINTS = tuple(name for name, _ in COUNTED[3:9])


@dataclass(frozen=True)
class YoungText:
    """Numbers of a deck by section, a list a record; the three of time; (keyword, numbers) of its cards."""

    sections: dict[str, list[list[float]]]
    time: tuple[float, float, float]
    cards: tuple[tuple[str, list[float]], ...]

    @property
    def joints(self) -> list[tuple[str, list[float]]]:
        """(type, numbers) in the deck's order."""
        return [(name, numbers) for name in JOINTS for numbers in self.sections[name]]


def read_young_text(text: str) -> YoungText | None:
    """The numbers of a deck; None where its words are not simply those numbers in their order."""
    head, *rest = re.split(r"^\s*DYNAMICS\s+\w+\s*$", re.sub(r"\{[^}]*\}", " ", text), flags=re.MULTILINE)
    try:
        words = _numbers(head)
        cards = tuple(_cards(rest[0])) if rest else ()
    except (ValueError, TypeError):  # no number, or one before the first keyword
        return None
    counts, at, sections = words[:12], 12, {}
    if len(counts) < 12 or any(count != int(count) or not 0 <= count < 100 for count in counts):
        return None
    for (name, width), count in zip(COUNTED, counts, strict=True):
        sections[name] = [words[at + k * width : at + (k + 1) * width] for k in range(int(count))]
        at += int(count) * width
    if len(words) < at + 3:
        return None
    return YoungText(sections, tuple(words[at : at + 3]), cards)


def _numbers(text):
    """The numbers up to the first word; prose may follow the last of a deck."""
    found = []
    for word in text.split():
        try:
            found.append(float(word))
        except ValueError:
            break
    return found


def _cards(text):
    card = None
    for word in text.split():
        if word.isalpha() and word.lower() not in ("nan", "inf", "infinity"):
            if card:
                yield card
            if word == "END":
                return
            card = word, []
        else:
            card[1].append(float(word))
    if card:
        yield card
