"""Results of an earlier run, which a deck with errors leaves where they are."""

from pathlib import Path

from ..deck.several_models import named_model
from ..dialects import DIALECTS
from ..errors import Fault
from ..results.files.file_names import result_paths
from .outcome import RunOptions


def warnings_of_earlier_results(path: str, options: RunOptions) -> list[Fault]:
    """Return a warning that names the results of an earlier run of the deck at `path`, if there are any.

    The dialect of an unreadable deck is unknown, so the names of all dialects are looked for.
    """
    name, model = named_model(path)
    named = {
        file
        for dialect in DIALECTS
        for file in result_paths(
            Path(name).name,
            dialect,
            options.folder,
            options.out,
            options.h5,
            options.no_out,
            options.no_h5,
            model,
        ).files
    }
    there = ", ".join(sorted(file for file in named if Path(file).is_file() and not _is_of_study(file)))
    return [Fault("warning", f"still of an earlier run: {there}", id="RUN-042")] if there else []


def _is_of_study(file: str) -> bool:
    """Return whether a file is the table of `flexmb sweep STEM.toml`, which no run replaces unasked."""
    if not file.endswith(".h5"):
        return False
    # Decks without faults need no HDF5 library for this.
    from ..results.hdf5.stored_result import is_study

    return is_study(file)
