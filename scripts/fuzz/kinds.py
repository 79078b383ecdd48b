"""The kinds of input that flexmb reads: seeds of each, how it is damaged, and the command that gets it."""

import random
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from pathlib import Path

from answer import Answer
from damaged_bricks import brick_seeds, modes_of_brick
from damaged_decks import check_deck, read_deck_of
from damaged_exchanges import (
    check_with_shape,
    compare_by_tolerances,
    compare_matlab_file,
    compare_table,
    convert_deck,
    draw_in_style,
    shape_seeds,
    table_seeds,
)
from damaged_leftovers import (
    cache_seeds,
    draft_seeds,
    go_on_with_draft,
    reduce_from_cache,
    resume_file_seeds,
    resume_from_file,
)
from damaged_results import (
    argument_seeds,
    compare_listing,
    name_quantities,
    result_seeds,
    show_damaged_bytes,
    show_damaged_structure,
)
from damaged_studies import go_on_from_parts, prepare_study, study_seeds


@dataclass(frozen=True)
class Kind:
    """`seeds` fills a folder once; `attempt` damages files in `work`, a fresh folder, and answers."""

    name: str
    seeds: Callable[[Path], None]
    attempt: Callable[[random.Random, Path, Path], Answer]
    slow: float = 2.0  # s of processor time


def no_seeds(folder: Path) -> None:
    """Decks are taken from decks/."""


def kinds() -> Iterator[Kind]:
    """All kinds, the quick ones first."""
    for dialect in ("young", "dafms", "vsdf"):
        yield Kind(f"{dialect}-deck", no_seeds, lambda *a, dialect=dialect: read_deck_of(dialect, *a))
    yield Kind("study", study_seeds, prepare_study)
    yield Kind("finite-element-file", brick_seeds, modes_of_brick)
    yield Kind("listing", result_seeds, compare_listing)
    yield Kind("hdf5-bytes", result_seeds, show_damaged_bytes)
    yield Kind("hdf5-structure", result_seeds, show_damaged_structure)
    yield Kind("argument", argument_seeds, name_quantities)
    yield Kind("matlab-file", table_seeds, compare_matlab_file)
    yield Kind("table", table_seeds, compare_table)
    yield Kind("tolerances", result_seeds, compare_by_tolerances)
    # Here the mechanism is assembled, by kernels that are interpreted.
    yield Kind("checked-deck", no_seeds, check_deck, slow=5.0)
    yield Kind("shape", shape_seeds, check_with_shape, slow=5.0)
    yield Kind("conversion", no_seeds, convert_deck, slow=5.0)
    yield Kind("style", result_seeds, draw_in_style, slow=5.0)
    yield Kind("draft", draft_seeds, go_on_with_draft)
    yield Kind("body-cache", cache_seeds, reduce_from_cache)
    yield Kind("study-parts", study_seeds, go_on_from_parts)
    yield Kind("journal", resume_file_seeds, resume_from_file)


KINDS = {kind.name: kind for kind in kinds()}
