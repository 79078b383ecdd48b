"""The grammars, and what flexmb does with a file of each."""

import os
import traceback
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

from answer import Answer
from damaged_bricks import brick_seeds
from damaged_decks import built
from damaged_results import result_seeds, show_damaged_structure
from damaged_studies import prepared, study_seeds
from fe_grammars import finite_element_files
from fe_readers import read_file
from grammars import dafms_decks, studies, vsdf_decks, young_decks
from hypothesis import strategies as st
from kinds import no_seeds

from flexmb_cli.errors import BAD_INPUT, DONE


@dataclass(frozen=True)
class Structure:
    """A grammar: `attempt` writes an example of `strategy` into a fresh folder and answers it."""

    strategy: st.SearchStrategy
    seeds: Callable[[Path], None]
    attempt: Callable[[object, Path, Path], Answer]
    slow: float = 2.0


def _deck(text, seeds, work):
    (work / "x.deck").write_text(text)
    return built("x.deck", text.encode(), seeds)


def _study(text, seeds, work):
    os.link(seeds / "IN1-3-1.dat", work / "IN1-3-1.dat")
    (work / "x.toml").write_text(text)
    return prepared(work / "x.toml")


def _finite_element_file(example, _seeds, work):
    reader, raw = example
    (work / "x").write_bytes(raw)
    (work / "reader.txt").write_text(reader)
    try:
        return Answer(BAD_INPUT if read_file(reader, work / "x") else DONE, "", "")
    except Exception:
        return Answer(None, "", "", traceback.format_exc())


STRUCTURES = {
    "young-deck": Structure(young_decks(), no_seeds, _deck),
    "dafms-deck": Structure(dafms_decks(), no_seeds, _deck),
    "vsdf-deck": Structure(vsdf_decks(), brick_seeds, _deck),
    "study": Structure(studies(), study_seeds, _study),
    "finite-element-file": Structure(finite_element_files(), no_seeds, _finite_element_file),
    "hdf5": Structure(st.randoms(use_true_random=False), result_seeds, show_damaged_structure),
}
