"""Recognition of files that are no decks, by their first bytes."""

from collections.abc import Iterable
from pathlib import Path

MOST_NAMES = 2000  # of a folder that are looked at
_TABLES = "open it in its program and save the deck as plain text"
# What a file begins with, what it is, and what to do.
_BEGINNINGS = (
    (
        b"\x89HDF\r\n\x1a\n",
        "an HDF5 file, as results are; flexmb table, plot and report read those",
    ),
    (b"PK\x03\x04", f"a zip archive or an office document; {_TABLES}"),
    (b"\xd0\xcf\x11\xe0", f"an office document; {_TABLES}"),
    (b"%PDF", "a PDF document; copy the deck's text into a file of its own"),
    (b"\x1f\x8b", "compressed by gzip; unpack it: gunzip -c FILE | flexmb run -"),
    (b"\x89PNG", "a picture"),
)


def kind_of_file(raw: bytes) -> str:
    """Return what the file is that begins with `raw`, and what to do; empty where nothing is known."""
    return next((kind for beginning, kind in _BEGINNINGS if raw.startswith(beginning)), "")


def similar_name(path: Path) -> str:
    """Return the file of the same folder whose name is like that of `path`, or an empty text."""
    try:
        names = [entry.name for entry, _ in zip(path.parent.iterdir(), range(MOST_NAMES), strict=False)]
    except OSError:
        return ""
    return _same_stem(path.name, names) or _nearest(path.name, names)


def _same_stem(name: str, names: Iterable[str]) -> str:
    stems = {other.rpartition(".")[0].lower(): other for other in sorted(names, reverse=True)}
    return stems.get(name.lower(), "")


def _nearest(name: str, names: Iterable[str]) -> str:
    from difflib import get_close_matches

    by_letters = {other.lower(): other for other in names}
    found = get_close_matches(name.lower(), by_letters, n=1, cutoff=0.8)
    return by_letters[found[0]] if found else ""
