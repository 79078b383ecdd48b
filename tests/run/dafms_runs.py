"""Runs of DAFMS decks in this process, and what stands in their results."""

from pathlib import Path

import h5py

from flexmb_cli.run.outcome import Listener, RunOptions
from flexmb_cli.run.solution import run_deck

DECKS = Path(__file__).parents[2] / "decks" / "dafms"
NAMES = sorted(path.stem for path in DECKS.glob("*.DAT"))
ENDINGS = ("OUT", "h5", "T2", "T3")


def run(name, folder, listener=None, **options):
    """Outcome of a supplied deck, or of the deck at a path, with its results in `folder`."""
    path = name if isinstance(name, Path) else DECKS / f"{name}.DAT"
    return run_deck(str(path), RunOptions(folder=str(folder), **options), listener)


def altered(folder, name, *changes):
    """A supplied deck with each `old` replaced once by `new`, as a file."""
    text = (DECKS / f"{name}.DAT").read_text()
    for old, new in changes:
        assert old in text, f"{old!r} is not in {name}"
        text = text.replace(old, new, 1)
    path = folder / f"{name}.DAT"
    path.write_text(text)
    return path


def loaded(folder, name):
    """Every dataset of a result that holds numbers, by path."""
    found = {}
    with h5py.File(Path(folder) / f"{name}.h5") as file:
        file.visititems(
            lambda path, item: (
                found.update({path: item[:]})
                if isinstance(item, h5py.Dataset) and item.dtype.kind == "f"
                else None
            )
        )
    return found


def stop_after(blocks):
    """A listener that stands for Ctrl-C after so many blocks of rows."""
    left = [blocks]

    def advance(rows):
        left[0] -= 1
        if left[0] == 0:
            raise KeyboardInterrupt

    return Listener(advance=advance)
