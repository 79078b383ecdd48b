"""Results of an earlier run, which must not pass for those of a run that leaves none."""

import os
import re
from itertools import count
from pathlib import Path

from ..deck.record import Deck
from ..deck.several_models import named_model
from ..dialects import DIALECTS
from ..dialects.recognise import recognise
from ..errors import DONE, Fault, FlexmbError
from ..results.files.file_names import STALE, STANDARD_INPUT, ResultPaths, is_own, result_paths
from .outcome import Outcome, RunOptions

_BEGINNING = 10_000  # characters of a deck by which its dialect is recognised
# What stands at the beginning of converted decks, of scripts for Exudyn and of MJCF files.
_CONVERTED = re.compile(
    rb"converted from the [A-Z]+ deck |, written by flexmb for Exudyn|\A<mujoco model=.*\n  <compiler angle="
)


def _dialect_of(path: str, options: RunOptions) -> str:
    """Return the dialect of a deck by its beginning, "auto" if it has none; its run reports the faults."""
    # What is not a regular file can be read only once.
    if options.dialect != "auto" or not os.path.isfile(path):
        return options.dialect
    try:
        with Path(path).open(encoding="latin-1") as stream:
            return recognise(stream.read(_BEGINNING).splitlines())
    except (OSError, FlexmbError):
        return options.dialect


def paths_of(name: str, dialect: str, options: RunOptions, model: int) -> ResultPaths:
    """Return where the results of the deck `name`, without its folder, go."""
    places = options.folder, options.out, options.h5, options.no_out, options.no_h5
    return result_paths(name, dialect, *places, model)


class EarlierResults:
    """The files that stand in the places of the results of the deck at `path`; make it before the run.

    `paths`: where its results go by its `dialect`, "auto" where it has none: then those of all count.
    """

    def __init__(self, path: str, options: RunOptions):
        name, model = named_model(path)
        self.deck = name if name == STANDARD_INPUT else Path(name).name
        self.dialect = _dialect_of(name, options)
        self.paths = paths_of(self.deck, self.dialect, options, model)
        others = (paths_of(self.deck, known, options, model) for known in DIALECTS)
        self._standing = {
            file: state
            for paths in ([self.paths] if self.dialect in DIALECTS else others)
            for file in paths.files
            if (state := _state(file)) and state != _state(name)  # not the deck itself
        }

    def paths_of(self, deck: Deck, options: RunOptions) -> ResultPaths:
        """Return where the results of the deck go, once it is read."""
        if deck.dialect == self.dialect:
            return self.paths
        return paths_of(self.deck, deck.dialect, options, deck.model)

    def set_aside(self, outcome: Outcome) -> None:
        """Rename the results of an earlier run, and warn, where the run that ended left none of its own."""
        if outcome.files or outcome.exit_code == DONE:
            return
        # What this run, or another one, has put there since is no earlier result.
        files = [file for file, state in self._standing.items() if _state(file) == state and is_own(file)]
        # A run replaces no table of `flexmb sweep STEM.toml` unasked.
        files = sorted(file for file in files if not _is_study(file))
        # The name of another deck may be a slip; results keep names as UTF-8 can hold them.
        name = os.fsencode(self.deck).decode("utf-8", "backslashreplace")
        if {_attribute(file, "deck_name") for file in files} - {"", name}:
            return
        renamed = list(filter(None, map(_set_aside, files)))
        if renamed:
            message = f"results of an earlier run are renamed, since this one has none: {', '.join(renamed)}"
            outcome.faults.append(Fault("warning", message, id="RUN-042"))
        if stay := ", ".join(filter(os.path.lexists, files)):
            message = f"left by an earlier run, and cannot be renamed: {stay}"
            outcome.faults.append(Fault("warning", message, id="RUN-072"))


def _set_aside(file: str) -> str:
    """Rename a file to NAME.stale, NAME.stale.2 …: nothing is lost; return the name, "" where it stays."""
    ends = (f"{STALE}.{number}" if number > 1 else STALE for number in count(1))
    free = next(name for name in (file + end for end in ends) if not os.path.lexists(name))
    try:
        os.rename(file, free)
    except OSError:
        return ""
    return free


def set_conversion_aside(file: str, text: str = "") -> str:
    """Rename a model that an earlier call has converted; return its new name, "" where there is none.

    `text` itself stays; another one may have been edited since.
    """
    data = text.encode()
    if not os.path.isfile(file):
        return ""
    try:
        with open(file, "rb") as stream:
            content = stream.read(max(_BEGINNING, len(data) + 1))
    except OSError:
        return ""
    return _set_aside(file) if content != data and _CONVERTED.search(content[:400]) else ""


def set_study_aside(file: str) -> str:
    """Rename the table of an earlier study; return its new name, "" where there is none."""
    return _set_aside(file) if _is_study(file) else ""


def _state(file: str) -> tuple[int, ...] | None:
    """Return the identity of a regular file and of its content, None where there is none."""
    try:
        file_state = os.stat(file)
    except (OSError, ValueError):
        return None
    return (
        (file_state.st_dev, file_state.st_ino, file_state.st_size, file_state.st_mtime_ns)
        if os.path.isfile(file)
        else None
    )


def _is_study(file: str) -> bool:
    return _attribute(file, "Conventions").startswith("flexmb-study-")


def _attribute(file: str, name: str) -> str:
    """Return an attribute of an HDF5 result, "" of other files: they need no HDF5 library."""
    if not file.endswith(".h5"):
        return ""
    from ..results.hdf5.stored_result import root_attribute

    return root_attribute(file, name)
