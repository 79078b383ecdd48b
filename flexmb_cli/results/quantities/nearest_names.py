"""Names that are near one that does not exist, word by word, so that long lists of names stay cheap."""

from collections.abc import Sequence
from difflib import SequenceMatcher

NAMES_SHOWN = 3
LEAST_LIKENESS = 0.6
# No word is compared with more labels of an axis: those of large models differ by numbers only.
LABELS = 200


def nearest(words: Sequence[str], forms: Sequence[Sequence[Sequence[str]]]) -> list[str]:
    """At most three names near `words`; a form of names is a list of words to choose from for every place."""
    scored = [_best(words, form) for form in forms]
    scored = [(likeness, name) for likeness, name in scored if likeness >= LEAST_LIKENESS]
    ordered = dict.fromkeys(name for _, name in sorted(scored, key=lambda pair: -pair[0]))
    return list(ordered)[:NAMES_SHOWN]


def _best(words: Sequence[str], form: Sequence[Sequence[str]]) -> tuple[float, str]:
    chosen = [_closest(word, choices) for word, choices in zip(words, form, strict=False)]
    # A name with more words than were given stands for all of them.
    total = sum(likeness for likeness, _ in chosen) / max(len(words), len(chosen), 1)
    return total, ".".join(word for _, word in chosen)


def _closest(word: str, choices: Sequence[str]) -> tuple[float, str]:
    if word in choices:
        return 1.0, word
    return max(((_likeness(word, choice), choice) for choice in choices[:LABELS]), key=lambda pair: pair[0])


def _likeness(word: str, choice: str) -> float:
    if word.isdigit() and choice.isdigit():
        # A number out of range is a near miss whatever its digits.
        return 0.5
    return SequenceMatcher(None, word.lower(), choice.lower()).ratio()
