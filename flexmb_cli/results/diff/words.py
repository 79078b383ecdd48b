"""Compare the words of two results: titles, headings, echoed names, and what HDF5 results keep as text."""

from collections import Counter
from collections.abc import Iterator
from typing import TYPE_CHECKING

from ...deck.listing import Listing

if TYPE_CHECKING:
    import numpy as np


# Attributes of HDF5 results that hold words; `status` and `analysis` count without `--words`.
WORDS_OF_RESULTS = ("notes", "settings", "options", "message")


def compare_words(a: Listing, b: Listing) -> list[str]:
    """Return a sentence for every line of words that only one of the listings has in its place."""
    if len(a.words) == len(b.words):
        pairs = zip(a.words, b.words, strict=True)
        return [f"line {line}: {one!r} against {two!r}" for (line, one), (_, two) in pairs if one != two]
    return [*_only_in(a, b), *_only_in(b, a)]


def _only_in(a: Listing, b: Listing) -> Iterator[str]:
    """Yield the lines that `a` has more often than `b`: where lines are missing, places do not match."""
    left = Counter(text for _, text in b.words)
    for line, text in a.words:
        if left[text]:
            left[text] -= 1
        else:
            yield f"line {line}: {text!r} is only in {a.name}"


def compare_names(name: str, first: "np.ndarray", second: "np.ndarray") -> list[str]:
    """Return a sentence for every text that differs in two datasets `name` of equal shape."""
    pairs = enumerate(zip(first.ravel().tolist(), second.ravel().tolist(), strict=True), 1)
    return [f"/{name}, row {row}: {_plain(a)!r} against {_plain(b)!r}" for row, (a, b) in pairs if a != b]


def _plain(text: bytes) -> str:
    return text.decode("utf-8", errors="replace") if isinstance(text, bytes) else str(text)
