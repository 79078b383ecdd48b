"""What one of two results lacks, or has in another form."""

from dataclasses import replace

import h5py
import numpy as np
import pytest

from flexmb_cli.deck.listing import TableError
from flexmb_cli.results.diff.compare import compare
from flexmb_cli.results.diff.tolerances import Tolerances, parse_kinds
from tests.results.diff.test_diff import TIMES


def test_missing_rows_are_a_difference_and_the_others_are_compared(table, rows):
    a, b = table("a", rows(TIMES)), table("b", rows(TIMES[:5]))
    report = compare(a, b)
    assert report.missing == [f"2 rows of {a} are not in {b}: t = 5, 6"]
    assert report.differing == 0
    assert report.tallies["time"].compared == 5


def test_rows_are_matched_by_time_when_some_are_missing(table, rows):
    a, b = table("a", rows(TIMES)), table("b", rows([0.0, 2.0, 4.0, 6.0]))
    report = compare(a, b)
    assert report.missing == [f"3 rows of {a} are not in {b}: t = 1, 3, 5"]
    assert report.differing == 0


def test_missing_rows_of_an_hdf5_result_are_a_difference(result, rows):
    base = rows(TIMES)
    a, b = result("a.h5", base), result("b.h5", rows(TIMES[:5]), status="failed")
    report = compare(a, b)
    assert report.missing[0] == "status: complete against failed"
    assert "/body/position: shape (7, 2, 3) against (5, 2, 3)" in report.missing
    assert report.differing == 0
    assert report.tallies["position"].compared == 5 * 2 * 3


def test_rows_of_equal_printed_time_are_kept_apart(table, rows):
    """Steps below half a millisecond print several rows with the same time."""
    time = np.arange(9) * 2e-4
    a, b = table("a", rows(time)), table("b", rows(time[:-1]))
    report = compare(a, b)
    assert len(report.missing) == 1
    assert report.differing == 0


def test_other_times_are_a_difference(store, rows):
    report = compare(store("a", rows(TIMES)), store("b", replace(rows(TIMES), time=TIMES + 0.5)))
    assert report.tallies["time"].differing == 7


def test_a_missing_body_is_a_difference(table, rows):
    a = table("a", rows(TIMES))
    b = a.with_name("b")
    lines = a.read_text().splitlines(keepends=True)
    cut = [n for n, line in enumerate(lines) if line.startswith("  2 ") and len(line) > 70]
    b.write_text("".join(line for n, line in enumerate(lines) if n != cut[3]))
    report = compare(a, b)
    assert report.missing == [f"position: 1 line of {a} is not in {b}: body 2 at t = 1"]
    assert report.differing == 0


def test_a_missing_section_is_a_difference(table, rows, deck):
    base, nothing = rows(TIMES), np.zeros((7, 0, 3))
    a = table("a", base)
    counts, *others = deck.records
    numbers = tuple(replace(n, value=0) if n.key == "NPOINT" else n for n in counts.numbers)
    without = replace(deck, records=(counts.with_numbers(numbers), *others))
    bare = replace(base, point_position=nothing, point_velocity=nothing, point_acceleration=nothing)
    b = table("b", bare, deck=without)
    for report in (compare(a, b), compare(b, a)):
        assert report.missing == [f"point: there is no such section in {b}"]
        assert report.tallies["echo"].differing == 1


def test_a_missing_column_is_a_difference(table, rows):
    a = table("a", rows(TIMES))
    b = a.with_name("b")
    text = a.read_text().replace("   e3\n", "\n")
    lines = text.splitlines(keepends=True)
    # Lines of the positions are the only ones whose fields are ten wide.
    b.write_text(
        "".join(line[:63] + "\n" if len(line) == 74 and line[3:7] == "    " else line for line in lines)
    )
    report = compare(a, b)
    assert report.missing == [f"position: {b} has no column e3"]
    assert report.differing == 0


def test_a_missing_dataset_is_a_difference_in_either_direction(result, rows):
    a, b = result("a.h5", rows(TIMES)), result("b.h5", rows(TIMES))
    with h5py.File(b, "a") as file:
        del file["body/angular_velocity"]
    assert compare(a, b).missing == [f"/body/angular_velocity: not in {b}"]
    assert compare(b, a).missing == [f"/body/angular_velocity: not in {b}"]


def test_other_names_and_shapes_are_differences(result, rows):
    a, b = result("a.h5", rows(TIMES)), result("b.h5", rows(TIMES))
    with h5py.File(b, "a") as file:
        file["joint/name"][0] = "screw 1"
        del file["body/position"]
        file["body/position"] = np.zeros((7, 3, 3))
    report = compare(a, b)
    assert report.missing == ["/body/position: shape (7, 2, 3) against (7, 3, 3)"]
    assert [words.partition(",")[0] for words in report.words] == ["/joint/name"]


def test_a_deck_of_other_spelling_is_no_difference(result, rows):
    a, b = result("a.h5", rows(TIMES)), result("b.h5", rows(TIMES))
    with h5py.File(b, "a") as file:
        file["deck"][()] = "2 1 1 1 0 0 0 0 0 2 0 1 { a comment }\n"
    assert compare(a, b).equal


def test_the_mark_of_a_failure_is_a_difference(table, rows):
    a, b = table("a", rows(TIMES)), table("b", rows(TIMES), failed=True)
    assert compare(a, b).missing == [f"only {b} ends with CONVERGENCE FAILED or RUN STOPPED"]


def test_another_echo_is_a_difference_that_can_be_left_out(table, rows, deck):
    a, b = table("a", rows(TIMES)), table("b", rows(TIMES), deck=deck.with_values({"driver.1.B": 1.057}))
    report = compare(a, b)
    assert report.worst.sentence == "echo, ENTER INITIAL POSITION, VELOCITY & ACCELERATION: 1.05 against 1.06"
    assert compare(a, b, Tolerances(kinds=parse_kinds(["echo=inf"]))).equal


def test_a_table_without_echo_differs_unless_the_echo_is_left_out(table, rows):
    a = table("a", rows(TIMES))
    b = a.with_name("b")
    b.write_text(a.read_text().partition("-- KINEMATIC")[2])
    assert compare(a, b).missing == [f"echo of the input: 71 numbers in {a}, 0 in {b}"]
    assert compare(a, b, Tolerances(kinds=parse_kinds(["echo=inf"]))).equal


@pytest.mark.parametrize("swapped", [False, True])
def test_a_table_and_an_hdf5_result_cannot_be_compared(table, result, rows, swapped):
    paths = [table("a.OUT", rows(TIMES)), result("a.h5", rows(TIMES))]
    with pytest.raises(TableError, match="this is not an HDF5 result, the other file is") as caught:
        compare(*(paths[::-1] if swapped else paths))
    assert caught.value.name == str(paths[0])
    assert caught.value.exit_code == 2


@pytest.mark.parametrize("other, reported", [("absent", "no such file"), (".", "directory|folder")])
def test_beside_an_hdf5_result_too_a_file_that_cannot_be_opened_is_told(
    result, rows, tmp_path, other, reported
):
    with pytest.raises(TableError, match=reported) as caught:
        compare(result("a.h5", rows(TIMES)), tmp_path / other)
    assert caught.value.name == str(tmp_path / other)


def test_a_missing_file_is_named(table, rows, tmp_path):
    with pytest.raises(TableError, match="no such file") as caught:
        compare(table("a", rows(TIMES)), tmp_path / "none")
    assert (caught.value.name, caught.value.exit_code) == (str(tmp_path / "none"), 2)
    with pytest.raises(TableError, match="it is a folder"):
        compare(tmp_path, tmp_path)


def test_a_file_that_is_no_table_is_refused(tmp_path):
    (tmp_path / "letter").write_text("Dear Sir,\n")
    with pytest.raises(TableError, match="no OUT table is found in it"):
        compare(tmp_path / "letter", tmp_path / "letter")


def test_a_damaged_hdf5_result_is_refused(result, rows):
    path = result("a.h5", rows(TIMES))
    path.write_bytes(path.read_bytes()[:2000])
    with pytest.raises(TableError, match="damaged HDF5 file"):
        compare(path, path)
