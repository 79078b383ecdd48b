"""`flexmb run --as-printed`: the errors of the program of 1996 give its printed numbers, cell by cell.

Liang Yong, YOUNG dissertation (1996), Appendix B, the OUT listings of 18 decks: every readable cell, with the
signs of the Euler parameters as printed.  Two listings are not met in full.  OUT1-4-3 comes from an earlier
program (19 cells).  Of OUT2-6-1 two cells follow from 1 - cos² near a half turn, which the program's reals of
eleven digits know to 3e-5, and one is a number within 1e-5 of half a unit.
"""

import json
import subprocess
import sys
from dataclasses import replace

import h5py
import numpy as np
import pytest

from flexmb_cli.deck.table_columns import SECTIONS
from flexmb_cli.errors import DeckError, ModelError
from flexmb_cli.results.diff.compare import compare
from flexmb_cli.run.outcome import RunOptions
from flexmb_cli.run.solution import run_deck
from flexmb_cli.solvers.as_printed.errors import ALL_ERRORS, OVERRUN, SCREW, TRANSPOSED, WRONG_INDEX
from flexmb_cli.solvers.as_printed.program import AsPrinted
from tests.dialects.young.published_cells import Cell, _computed, _lines_by_owner
from tests.dialects.young.published_listing import PRINTED, listing_text, our_listing, published_cells
from tests.solvers.kinematics.solved import REPOSITORY, coordinates, joined, mechanism_of, rows_of_deck

EARLIER_PROGRAM = "IN1-4-3"
NOT_MET = {EARLIER_PROGRAM: 19, "IN2-6-1": 3}


def emulated(deck, errors=ALL_ERRORS, **settings):
    return joined(list(AsPrinted(mechanism_of(deck), settings, errors).rows()))


def cells_that_differ(deck, rows):
    found = []
    for lines in _lines_by_owner(deck).values():
        for line in lines:
            section, index, step = line["section"], int(line["index"]), int(line["step"])
            for column, value in enumerate(_computed(rows, section, index - 1, step), start=1):
                cell = Cell(deck, section, index, column, step, line[f"v{column}"], value, line["ocr"])
                if cell.printed and not cell.agrees:
                    found.append(cell)
    return found


@pytest.mark.parametrize("deck", PRINTED)
def test_every_printed_cell_comes_out(deck):
    wrong = cells_that_differ(deck, emulated(deck))
    assert len(wrong) == NOT_MET.get(deck, 0), [str(cell) for cell in wrong]
    if deck == "IN2-6-1":
        assert all(abs(float(c.printed) - c.computed) <= max(6e-5, 4e-5 * abs(c.computed)) for c in wrong)


@pytest.mark.parametrize(
    ("deck", "error"),
    [("IN4-BAR", TRANSPOSED), ("IN4-BAR", OVERRUN), ("IN5BODY", WRONG_INDEX), ("IN2-6-1", SCREW)],
)
def test_without_one_of_the_errors_printed_cells_do_not_come_out(deck, error):
    """So each of them is in the program."""
    assert len(cells_that_differ(deck, emulated(deck, ALL_ERRORS - {error}))) > 8


@pytest.mark.parametrize("deck", ["IN4-BAR", "IN5BODY", "IN-RSSR", "IN2-6-1", "IN2-5-1", "IN1-3-4"])
def test_without_errors_it_is_the_motion_of_the_mechanism(deck):
    """A second program for the same equations, with another choice of rows and another elimination."""
    found, expected = emulated(deck, frozenset(), tolerance=1e-13), rows_of_deck(deck)
    for derivative in range(3):
        a, b = coordinates(found, derivative), coordinates(expected, derivative)
        if not derivative:
            sign = np.where((a[..., 3:] * b[..., 3:]).sum(-1) < 0.0, -1.0, 1.0)[..., None]
        a[..., 3:] *= sign
        assert np.abs(a - b).max() <= 1e-9 * max(1.0, np.abs(b).max())


def test_the_audit_is_that_of_the_mechanism():
    """The velocities of the four-bar break its equations, its positions meet them to FEPS."""
    rows = emulated("IN4-BAR")
    assert rows.constraint_residual.max() < 1e-3 and rows.velocity_residual.max() > 1.0


def printed(deck, folder):
    """The listing as a file; an unreadable cell shows what the emulation has."""
    cells, rows = {}, emulated(deck)
    for lines in _lines_by_owner(deck).values():
        for line in lines:
            key = int(line["step"]), line["section"], int(line["index"])
            values = zip(_computed(rows, key[1], key[2] - 1, key[0]), SECTIONS[key[1]].decimals, strict=True)
            words = [f"{value:.{places}f}" for value, places in values]
            cells[key] = [line[f"v{k}"] or word for k, word in enumerate(words, start=1)]
    path = folder / f"OUT{deck[2:]}.PAS"
    path.write_text(listing_text(deck, cells))
    return path


@pytest.mark.parametrize("deck", ["IN4-BAR", "IN5BODY"])
def test_an_archived_listing_compares_without_a_difference(deck, tmp_path):
    source = str(REPOSITORY / f"decks/young/{deck}.dat")
    outcome = run_deck(source, RunOptions(as_printed=True, folder=str(tmp_path), no_h5=True))
    assert outcome.exit_code == 0
    report = compare(printed(deck, tmp_path), outcome.files[0])
    assert report.differing == 0 and report.compared > 3000
    assert any("known errors of the program" in line.lower() for line in report.words)


@pytest.mark.parametrize("deck", ["IN4-BAR", "IN5BODY", "IN2-6-1"])
def test_diff_explains_each_cell_of_an_archived_listing_by_its_deck(deck, tmp_path):
    """The names of the files tell nothing, the deck does."""
    source = str(REPOSITORY / f"decks/young/{deck}.dat")
    archived, ours = tmp_path / "archived.txt", tmp_path / "ours.txt"
    archived.write_text(listing_text(deck, published_cells(deck)))
    ours.write_text(our_listing(deck))
    assert compare(archived, ours, explain=True).explained == 0
    report = compare(archived, ours, explain=True, deck=source)
    # The reals of eleven digits spoil two cells of the screw at a half turn.
    assert report.differing - report.explained == (2 if deck == "IN2-6-1" else 0)
    assert len(report.cells) == report.explained >= 15
    cells = {(cell.section, cell.item, cell.column): cause for cause, cell in report.cells}
    if deck == "IN4-BAR":
        assert cells["velocity", "body 2", "w-x"] == f"velocity: {OVERRUN}"
        assert cells["acceleration", "body 1", "dde2"] == f"acceleration: {TRANSPOSED}"
        assert {OVERRUN, TRANSPOSED} <= set(cells["acceleration", "body 2", "dw-x"][14:].split("; "))
    record = report.as_dict()["explained_cells"][0]
    assert set(record) == {"cause", "section", "item", "column", "time", "a", "b", "distance"}


def test_diff_does_not_explain_a_number_that_the_errors_do_not_give(tmp_path):
    archived, ours = tmp_path / "archived.txt", tmp_path / "ours.txt"
    cells = published_cells("IN4-BAR")
    key = (3, "velocity", 3)
    archived.write_text(listing_text("IN4-BAR", cells | {key: ["9.999", *cells[key][1:]]}))
    ours.write_text(our_listing("IN4-BAR"))
    report = compare(archived, ours, explain=True, deck=str(REPOSITORY / "decks/young/IN4-BAR.dat"))
    assert report.differing == report.explained + 1
    assert (report.worst.section, report.worst.item, report.worst.column) == ("velocity", "body 3", "dX")


def test_diff_takes_no_deck_of_another_dialect(tmp_path):
    (tmp_path / "ours.txt").write_text(our_listing("IN2-6-1"))
    listing = tmp_path / "ours.txt"
    with pytest.raises(DeckError, match="--deck needs a YOUNG deck without dynamics"):
        compare(listing, listing, explain=True, deck=str(REPOSITORY / "decks/dafms/pendulum.DAT"))


def test_all_outputs_are_marked_and_only_when_asked_for(tmp_path):
    deck = str(REPOSITORY / "decks/young/IN4-BAR.dat")
    for asked in (False, True):
        folder = tmp_path / str(asked)
        outcome = run_deck(deck, RunOptions(as_printed=asked, folder=str(folder)))
        table = (folder / "OUT4-BAR.dat").read_text()
        with h5py.File(folder / "OUT4-BAR.h5") as result:
            attributes = dict(result.attrs)
        assert table.startswith("NUMBERS WITH THE KNOWN ERRORS OF THE PROGRAM OF 1996") == asked
        assert (attributes.get("options"), "emulation" in attributes) == (
            ("as-printed", True) if asked else (None, False)
        )
        assert ("--as-printed" in attributes.get("notes", "")) == asked
        assert outcome.as_dict().get("as_printed", False) == asked
        assert any("--as-printed" in fault.message for fault in outcome.faults) == asked


def test_eleven_bodies_are_refused():
    """The program's arrays M10X7 hold ten."""
    mechanism = mechanism_of("IN5BODY")
    with pytest.raises(ModelError, match="holds 10 bodies, the deck has 15"):
        AsPrinted(replace(mechanism, bodies=mechanism.bodies * 3))


@pytest.mark.processes
def test_the_command_refuses_dynamics_and_says_it_of_other_dialects(tmp_path):
    def run(deck):
        command = [sys.executable, "-m", "flexmb_cli", "run", "--as-printed", "--json", "-o", str(tmp_path)]
        done = subprocess.run([*command, str(REPOSITORY / "decks" / deck)], capture_output=True, text=True)
        return done.returncode, json.loads(done.stdout)

    code, record = run("young/dynamics/IN-BRICARD.dat")
    assert code == 2 and "has no dynamics" in record["faults"][-1]["message"]
    code, record = run("dafms/pendulum_strict.DAT")
    assert code == 0 and any(
        "--as-printed has no effect on this DAFMS deck" in f["message"] for f in record["faults"]
    )
