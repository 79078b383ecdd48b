"""Bytes to text: where a deck comes from, how large it may be, and in which code it is written."""

import hashlib
import os
import stat
import sys
from collections.abc import Iterable
from contextlib import suppress
from pathlib import Path
from typing import BinaryIO

from ..errors import DeckError, Fault, Place
from .record import DeckText

MOST_NAMES = 2000  # of a folder that are looked at
_TABLES = "open it in its program and save the deck as plain text"
# What a file begins with, what it is, and what to do.
_BEGINNINGS = (
    (b"\x89HDF\r\n\x1a\n", "an HDF5 file, as results are; flexmb table, plot and report read those"),
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
    nearest = get_close_matches(name.lower(), by_letters, n=1, cutoff=0.8)
    return by_letters[nearest[0]] if nearest else ""


_PIECE = 2**20  # bytes


def first_bytes(stream: BinaryIO, most: int) -> bytes:
    """Return the first `most` bytes of a stream, or all of them.

    A plain `stream.read(most)` would reserve `most` bytes even for a short stream.
    """
    expected = size_of(stream)
    pieces = [stream.read(min(expected + 1, most))]
    size = len(pieces[0])
    # A pipe or a device has no size, and a file may have grown.
    while expected < size < most and (piece := stream.read(min(_PIECE, most - size))):
        pieces.append(piece)
        size += len(piece)
    return b"".join(pieces)


def size_of(stream: BinaryIO) -> int:
    """Return the bytes of a file; 0 of a pipe, a device and a stream in memory."""
    with suppress(OSError, ValueError):  # a stream in memory has no descriptor
        return os.fstat(stream.fileno()).st_size
    return 0


LARGEST_DECK = 64 * 1024 * 1024
STANDARD_INPUT = "-"


def read_text(path: str | Path, what: str = "deck") -> DeckText:
    """The deck at `path`, or on standard input for "-"; messages call it `what` it should be.

    Raises DeckError without a place when there is no such file, when it is no file, may not be
    read or is larger than `LARGEST_DECK` bytes, and with a place when it is not text.
    """
    if str(path) == STANDARD_INPUT:
        return decode(STANDARD_INPUT, _first_bytes(sys.stdin.buffer, what), what)
    path = Path(path)
    return decode(path.name, _file_bytes(path, what), what)


def decode(name: str, raw: bytes, what: str = "deck") -> DeckText:
    """The text of `raw`: UTF-8 with or without byte order mark, else Latin-1 with a warning."""
    _refuse_other_kind(raw, what)
    digest = hashlib.sha256(raw).hexdigest()
    try:
        return DeckText(name, raw.decode("utf-8-sig"), digest)
    except UnicodeDecodeError as fault:
        place = _place_of(raw, fault.start)
        warning = Fault("warning", f"the {what} is not UTF-8 and is read as Latin-1", place, id="DECK-009")
        return DeckText(name, raw.decode("latin-1"), digest, (warning,))


def _file_bytes(path: Path, what: str) -> bytes:
    try:
        status = path.stat()
        if stat.S_ISDIR(status.st_mode):
            remedy = f"; give the files in it, such as {path}/*" if what == "deck" else ""
            raise _unreadable(f"is a directory, not a {what}{remedy}", id="DECK-051")
        if status.st_size > LARGEST_DECK:
            raise _too_large(what)
        with path.open("rb") as stream:
            return _first_bytes(stream, what)
    except FileNotFoundError:
        raise _unreadable(f"no such file{_meant_instead(path)}", id="DECK-011") from None
    except PermissionError:
        raise _unreadable("permission denied", id="DECK-052") from None
    except (OSError, ValueError) as fault:
        raise _unreadable(f"cannot be read: {_reason(fault)}", id="DECK-053") from None


def _first_bytes(stream: BinaryIO, what: str) -> bytes:
    # Pipes and devices have no size beforehand: one byte more than allowed is enough to know.
    raw = first_bytes(stream, LARGEST_DECK + 1)
    if len(raw) > LARGEST_DECK:
        raise _too_large(what)
    return raw


def _reason(fault: Exception) -> str:
    number = getattr(fault, "errno", None)
    return os.strerror(number) if number else "the name is not a file name"


def _meant_instead(path: Path) -> str:
    """Return what else may be meant by a name that no file has."""
    if "=" in path.name:
        return f"; is it a number to change, --set {path}?"
    # difflib is imported for this message only.

    other = similar_name(path)
    return f"; is {path.with_name(other)} meant?" if other else ""


def _refuse_other_kind(raw: bytes, what: str) -> None:

    if kind := kind_of_file(raw):
        raise DeckError([Fault("error", f"this is not a {what} but {kind}", id="DECK-040")])
    _refuse_nul(raw, what)


def _refuse_nul(raw: bytes, what: str) -> None:
    where = raw.find(b"\0")
    if where < 0:
        return
    message = (
        f"the {what} holds a NUL byte, so it is not text; save it as UTF-8 (is it UTF-16, or a binary file?)"
    )
    raise DeckError([Fault("error", message, _place_of(raw, where), id="DECK-010")])


def _place_of(raw: bytes, offset: int) -> Place:
    before = raw[:offset].replace(b"\r\n", b"\n").replace(b"\r", b"\n")
    last_line = before[before.rfind(b"\n") + 1 :]
    return Place(before.count(b"\n") + 1, len(last_line.decode("utf-8", "replace")) + 1)


def _too_large(what: str) -> DeckError:
    return _unreadable(f"larger than {LARGEST_DECK // 1024**2} MB, which no {what} is", id="DECK-054")


def _unreadable(message: str, *, id: str) -> DeckError:
    return DeckError([Fault("error", message, id=id)])
