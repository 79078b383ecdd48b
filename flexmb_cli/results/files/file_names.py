"""File names of a deck's results, the refusal of two results at one place, and of files of others.

flexmb replaces unasked its own files, of any age, whole or cut, and empty ones.
"""

import os
import re
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import Any

from ...dialects import DIALECTS
from ...dialects.recognise import dialect_named, every_dialect
from ...errors import OutputError

STANDARD_INPUT = STANDARD_OUTPUT = "-"
STALE = ".stale"  # after the name of a result that the latest run of its deck did not make


@dataclass(frozen=True)
class ResultPaths:
    """Paths of one deck's results; None: not written; `out` "-": standard output.

    `series` are further tables of the dialect; `named` those paths that the user chose.
    """

    out: str | None
    h5: str | None
    series: tuple[str, ...] = ()
    named: tuple[str, ...] = ()

    @property
    def files(self) -> tuple[str, ...]:
        """The files that will be written, in the order OUT, HDF5, series."""
        places = (self.out, self.h5, *self.series)
        return tuple(path for path in places if path is not None and path != STANDARD_OUTPUT)

    @property
    def resume(self) -> str | None:
        """<stem>.resume beside the results, for what a stopped run leaves; None when no result is a file."""
        if beside := self.h5 or next(iter(self.series), None):
            return _stem(beside) + ".resume"
        if self.out in (None, STANDARD_OUTPUT) or not _is_plain(self.out):
            return None
        # Tables of several decks may differ in their suffix only.
        return f"{self.out}.resume"


def out_name(deck_name: str, dialect: str, model: int = 0) -> str:
    """OUT<rest> for a deck IN<rest> of a dialect that has it so, else <stem>.OUT; `deck_name` has no folder.

    Of several models the k-th gets <stem>-k.OUT, `model` 0 is the only one.
    """
    if deck_name == STANDARD_INPUT:
        return "flexmb.OUT"
    old, new = dialect_named(dialect).renamed if dialect in DIALECTS else ("", "")
    if old and deck_name.startswith(old):
        return new + deck_name.removeprefix(old)
    return _stem(deck_name) + _suffix(model) + ".OUT"


def _suffix(model: int) -> str:
    return f"-{model}" if model else ""


def h5_name(deck_name: str, dialect: str, model: int = 0) -> str:
    """The OUT file's stem with `.h5`."""
    return _stem(out_name(deck_name, dialect, model)) + ".h5"


def series_names(deck_name: str, dialect: str, model: int = 0) -> tuple[str, ...]:
    """Names of the further tables of a dialect, such as <stem>.T2 and <stem>.T3."""
    stem = "flexmb" if deck_name == STANDARD_INPUT else _stem(deck_name) + _suffix(model)
    endings = dialect_named(dialect).series if dialect in DIALECTS else ()
    return tuple(stem + ending for ending in endings)


def result_paths(
    deck_name: str,
    dialect: str,
    folder: str = ".",
    out: str | None = None,
    h5: str | None = None,
    no_out: bool = False,
    no_h5: bool = False,
    model: int = 0,
) -> ResultPaths:
    """Paths of a deck's results from the options of `flexmb run`."""
    series = () if no_out else series_names(deck_name, dialect, model)
    if out is None and dialect in DIALECTS and not dialect_named(dialect).writer:
        no_out = True
    return ResultPaths(
        out=None if no_out else out or _within(folder, out_name(deck_name, dialect, model)),
        h5=None if no_h5 else h5 or _within(folder, h5_name(deck_name, dialect, model)),
        series=tuple(_within(folder, name) for name in series),
        named=tuple(path for path in (out, h5) if path),
    )


def refuse_shared(results: list[tuple[str, ResultPaths]], names: Sequence[str] = ()) -> None:
    """Raise `OutputError` when two results, or a result and a deck, would be the same file.

    `results` are pairs (deck's path as given, "-" for standard input; its `ResultPaths`);
    `names` what the user calls each, "2:DECK" for a model of several.
    """
    decks = {_identity(deck): deck for deck, _ in results if deck != STANDARD_INPUT}
    owners: dict[str, int] = {}
    for number, (deck, paths) in enumerate(results):
        for path in paths.files:
            _refuse_overwriting(deck, path, decks)
            _refuse_second(results, number, path, owners)
    shown = names or [deck for deck, _ in results]
    tables = [name for name, (_, paths) in zip(shown, results, strict=True) if paths.out == STANDARD_OUTPUT]
    if len(tables) > 1:
        raise OutputError(
            f"{tables[0]} and {tables[1]} would both write to standard output; run them one by one",
            id="RESULT-008",
        )


def _refuse_overwriting(deck: str, path: str, decks: dict[str, str]) -> None:
    victim = decks.get(_identity(path))
    if victim is not None and victim == deck and Path(deck).suffix.lower() == ".h5":
        raise OutputError(
            f"{deck}: this is named like a result; give the deck it was computed from, or read it with "
            "flexmb table, plot or report",
            id="RESULT-027",
        )
    if victim is not None:
        raise OutputError(
            f"{deck}: its result {path} would overwrite the deck {victim}; choose another folder",
            id="RESULT-009",
        )


def _refuse_second(
    results: list[tuple[str, ResultPaths]], number: int, path: str, owners: dict[str, int]
) -> None:
    if not _is_plain(path):
        return
    first = owners.get(_identity(path))
    owners[_identity(path)] = number
    if first is None:
        return
    deck, other = results[number][0], results[first][0]
    if first == number:
        raise OutputError(f"{deck}: two of its results would be the same file {path}", id="RESULT-010")
    raise OutputError(
        f"{other} and {deck} would both write {path}; run them with different output folders", id="RESULT-011"
    )


def _is_plain(path: str) -> bool:
    """Return whether two results at `path` would destroy each other; /dev/null takes many."""
    return os.path.isfile(path) or not os.path.exists(path)


def _identity(path: str) -> str:
    return os.path.normcase(os.path.realpath(path))


def _stem(name: str) -> str:
    return os.path.splitext(name)[0]


def _within(folder: Any, name: str) -> str:
    return os.path.normpath(os.path.join(folder, name))


HDF5_SIGNATURE = b"\x89HDF\r\n\x1a\n"
_READ, _BEGIN_BYTES = 2**16, 400  # bytes that are looked at, and those of a heading
_SHORTEST_HDF5 = 2**8  # bytes; a file cut before holds nothing
# Files that are no tables: an HDF5 result by `Conventions`, its first attribute; VTKHDF by the superblock 2,
# where VTK and h5py by themselves write others; pages by their content security policy.
_MARKED = re.compile(
    rb"\x89HDF\r\n\x1a\n(.{,1000}flexmb-|\x02.{,100}VTKHDF)|MATLAB 5.0 MAT-file, written by flexmb"
    rb"|\x89PNG\r\n.{,200}Software\0flexmb"
    rb"|<!doctype html>\s<html lang=\"en\">\s?<head>\s?<meta charset=\"utf-8\">.{,100}script-src 'sha256-",
    re.DOTALL | re.IGNORECASE,
)


def refuse_foreign(paths: Iterable[str], force: bool = False, alike: str = "") -> None:
    """Raise OutputError where a file that flexmb did not make stands at one of `paths`.

    `alike`: with what files of this command begin, if they have no mark of their own.
    """
    for path in paths:
        if not force and os.path.isfile(path) and not is_own(path, alike):
            message = (
                f"{path}: a file stands there that flexmb did not make; --force replaces it, or rename it"
            )
            raise OutputError(message, id="RESULT-082")


def is_own(path: str, alike: str = "") -> bool:
    """Return whether the file at `path` is empty, or one that flexmb made."""
    try:
        with open(path, "rb") as file:
            content = file.read(_READ)
            if not content.strip(b"\0"):  # what a loss of power leaves
                return not any(part.strip(b"\0") for part in iter(partial(file.read, _READ), b""))
    except OSError:
        return False
    cut = HDF5_SIGNATURE.startswith(content[:8]) and len(content) < _SHORTEST_HDF5
    if cut or _MARKED.match(content):
        return True
    return _is_table(content.decode("latin-1"), path) or bool(alike and content.startswith(alike.encode()))


def _is_table(text: str, path: str) -> bool:
    """Return whether it is a printed table, or a part of one from its beginning."""
    begin, whole = "".join(text[:_BEGIN_BYTES].lower().split()), len(text) <= _BEGIN_BYTES
    *lines, _ = text.replace("\r", "").split("\n")
    for dialect in every_dialect():
        heads = dialect.listing_begins
        if begin.startswith(heads) or (whole and any(head.startswith(begin) for head in heads)):
            return True
        if dialect.series_row and path.endswith(dialect.series):
            cut = not lines and re.fullmatch(r" *|   [-+ .*\dE]*", text)
            return bool(cut or (lines and all(re.fullmatch(dialect.series_row, line) for line in lines)))
    return False
