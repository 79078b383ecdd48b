"""Recognition of YOUNG decks by their first lines."""

from collections.abc import Sequence
from itertools import islice

from ...deck import number
from ...deck.words import Word, words


def begins_young(lines: Sequence[str]) -> bool:
    """Twelve integers; half of them are enough, so that the reader can name the faulty ones."""
    start = list(islice(words(lines), 12))
    return bool(start) and _is_integer(start[0]) and sum(map(_is_integer, start)) >= 6


def _is_integer(word: Word) -> bool:
    try:
        number.integer(word.text)
    except number.Misspelt:
        return False
    return True
