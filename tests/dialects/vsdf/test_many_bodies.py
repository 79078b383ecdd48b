"""Large VSDF decks: bodies, joints and nodes kept as numbers are those of the objects of small decks."""

import dataclasses
import json
import math
import sys
import tracemalloc
from pathlib import Path

import numpy as np
import pytest

from flexmb_cli.deck import lazy, many_records
from flexmb_cli.deck.record import DeckText
from flexmb_cli.dialects.recognise import read_deck
from flexmb_cli.dialects.vsdf.build import build_model, build_vsdf
from flexmb_cli.dialects.vsdf.many_bodies import ManyBodies, ManyJoints
from flexmb_cli.dialects.vsdf.nodes import ManyNodes
from flexmb_cli.fe import build_mechanism
from flexmb_cli.model.arrays.flexible import flexible_arrays
from flexmb_cli.results.texts.check_text import check_text
from flexmb_cli.run.check import check as parts
from flexmb_cli.run.check import flexible
from flexmb_cli.run.check.check import check_deck
from flexmb_cli.run.outcome import RunOptions
from tests.dialects.vsdf.vsdf_decks import DECKS, RIGID, changed

sys.path.insert(0, str(Path(__file__).parents[3] / "scripts/bench"))
import large_element_kinds

ARRAYS = ("q", "coordinate_scale", "masses", "loads", "gravity")
# A body with a set, velocities, an attitude, products of inertia, a body placed by a node, a joint at points
# of the ground, one with a size, loads and outputs.
MANY_SORTS = changed(
    ("POSI\n", "POSI\n1,0.5,-0.0,0.25\n"),
    ("NODE\n", "EULP\n1,0.6,0,0.8,0\nVELO\n2,1,2,3,4,5,6\nNSET\n1,9,1,2\nNODE\n"),
    ("GRAV\n", "FORC\n1,3,1,2,3\n2,3,0,0,1,1\nPINN\n1,4,001\nOUTN\n2,3,1\n1,9\nGRAV\n"),
)


@pytest.fixture
def many(monkeypatch):
    """Decks of any size are read and built as large ones are."""
    monkeypatch.setattr(many_records, "MANY_NUMBERS", 3)
    monkeypatch.setattr(many_records, "MANY_RECORDS", 0)
    monkeypatch.setattr("flexmb_cli.dialects.vsdf.nodes.MANY_RECORDS", 0)
    monkeypatch.setattr(build_mechanism, "MANY_PARTS", 0)


def plain(item):
    """Return an item as lists and dictionaries, so that arrays and lazy sequences compare."""
    if dataclasses.is_dataclass(item) and not isinstance(item, lazy.Made):
        return {field.name: plain(getattr(item, field.name)) for field in dataclasses.fields(item)}
    if isinstance(item, np.ndarray):
        return item.tolist()
    if isinstance(item, float) and math.isnan(item):
        return "nan"
    if hasattr(item, "keys"):
        return {key: plain(item[key]) for key in item}
    if hasattr(item, "__len__") and not isinstance(item, str):
        return [plain(one) for one in item]
    return item


def built(text, build):
    return build(read_deck(DeckText("x", text, ""), "vsdf"), DECKS)


@pytest.mark.parametrize("text", [RIGID, MANY_SORTS, large_element_kinds.vsdf_chain(131 * 5)])
def test_the_model_of_a_large_deck_is_that_of_a_small_one(text, request):
    """Expected: the objects that the builders make of a deck that is small."""
    expected = [plain(built(text, build)) for build in (build_vsdf, build_model)]
    request.getfixturevalue("many")
    model, _ = built(text, build_vsdf)
    assert isinstance(model.bodies, ManyBodies) and isinstance(model.joints, ManyJoints)
    assert isinstance(model.ground.nodes, ManyNodes) or not model.ground.nodes
    assert [plain(built(text, build)) for build in (build_vsdf, build_model)] == expected


def test_arrays_of_a_large_mechanism_are_those_of_a_small_one(request):
    """A run takes bodies and joints from them.  Expected: the arrays of the same deck when it is small."""
    found = []
    for _ in range(2):
        arrays = flexible_arrays(built(MANY_SORTS, build_model)[0])
        found.append([getattr(arrays, name).tobytes() for name in ARRAYS])
        request.getfixturevalue("many")
    assert found[0] == found[1] and all(found[0])


def test_faults_of_a_large_deck_are_those_of_a_small_one(request):
    """Expected: what is said of the same deck when it is small."""
    text = MANY_SORTS.replace("2 REVO    1    3", "2 REVO    1    7").replace("2,1,2,3,4", "5,1,2,3,4")
    text = text.replace("GRAV\n", "PLAC\n7,1,0,0,0\nNODE\n1,1,2,0,0\nGRAV\n", 1)
    said = []
    for _ in range(2):
        with pytest.raises(Exception) as caught:
            built(text, build_vsdf)
        said.append([(fault.id, fault.place, fault.sentence) for fault in caught.value.faults])
        request.getfixturevalue("many")
    assert said[0] == said[1] and len(said[0]) >= 4


def test_columns_of_a_large_deck_are_numbers(many):
    """Those without a default were arrays of objects, which take four times the memory."""
    deck = read_deck(DeckText("x", RIGID, ""), "vsdf")
    numbers = many_records.column(deck.section("node"), "node")
    assert numbers.dtype == float and numbers.tolist() == [1, 2, 1, 2, 3, 4, 1, 2, 3]


def test_a_chain_takes_less_than_two_kilobytes_a_body(many, monkeypatch):
    """A body with its nodes, hinge and points took 4 to 6 kB; 1.7 kB are 12 times its 144 characters."""
    monkeypatch.setattr("flexmb_cli.dialects.vsdf.many_bodies._MOST_MADE", 10)
    text = large_element_kinds.vsdf_chain(131 * 2000)
    deck = read_deck(DeckText("x", text, ""), "vsdf")
    tracemalloc.start()
    mechanism, _ = build_model(deck, DECKS)
    kept, peak = tracemalloc.get_traced_memory()
    tracemalloc.stop()
    assert len(mechanism.bodies) == 2000
    assert kept < 1400 * 2000 and peak < 1700 * 2000


def test_what_is_too_large_to_be_assembled_is_counted_in_words_and_json(tmp_path, monkeypatch):
    """The text wanted the number of equations and ended with a fault of flexmb itself."""
    monkeypatch.setattr(parts, "MOST_ASSEMBLED", 11)
    path = tmp_path / "x.vsdf"
    path.write_text(RIGID)
    report = check_deck(str(path), RunOptions())
    assert report.outcome.exit_code == 0
    assert "  speeds 12, modal 0, report times 101\n" in check_text(report)
    assert [body["mass"] for body in json.loads(json.dumps(report.as_dict()))["bodies"]] == [2.0, 1.0]


def test_equations_that_are_too_many_are_not_assembled(tmp_path, monkeypatch):
    """80,000 motions of one body ended for want of memory, 3,600 took minutes without compiled kernels.

    Expected: five equations of each of two hinges, and fifty motions.
    """
    monkeypatch.setattr(parts, "MOST_DENSE_EQUATIONS", 59)
    path = tmp_path / "x.vsdf"
    motions = "".join(f"{k},ANGL,1,1\n" for k in range(1, 51))
    path.write_text(RIGID.replace("GRAV\n", f"MOTN\n{motions}GRAV\n", 1))
    report = check_deck(str(path), RunOptions())
    assert "60 equations of 12 coordinates are more than the 59" in report.outcome.faults[-1].message
    mechanism, _ = built(RIGID.replace("GRAV\n", f"MOTN\n{motions}GRAV\n", 1), build_model)
    assert flexible._is_small(mechanism)
    monkeypatch.setattr(parts, "INTERPRETED_LOADS", 51)
    assert not flexible._is_small(mechanism)


def test_rigid_bodies_beside_a_flexible_one_are_made_when_they_are_looked_at(many):
    """100,000 of them took 1,250 bytes each, where a deck of 26 bytes a body may take 312 beside 200 MB."""
    flexible = (DECKS / "pendulum.vsdf").read_text()
    numbers = range(2, 1002)
    heads, masses = ("".join(line.format(k) for k in numbers) for line in ("{},RIGD\n", "{},1\n 1,1,1\n"))
    text = flexible.replace("\nEND", f"\nBODY\n{heads}RIGI\n{masses}END", 1)
    model, _ = built(text, build_vsdf)
    build_mechanism.flexible_mechanism(model)
    tracemalloc.start()
    mechanism, _ = build_mechanism.flexible_mechanism(model)
    kept = tracemalloc.get_traced_memory()[0]
    tracemalloc.stop()
    assert [len(mechanism.bodies), mechanism.bodies[0].modes, mechanism.bodies[1000].m] == [1001, 9, 1.0]
    assert kept < 312 * len(mechanism.bodies)
