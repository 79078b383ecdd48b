"""Comparison of OUT tables and HDF5 results."""

import io
import json
import re
import subprocess
import sys
import tracemalloc
from dataclasses import replace
from pathlib import Path

import h5py
import numpy as np
import pytest

from flexmb_cli.deck import listing
from flexmb_cli.deck.listing import TableError
from flexmb_cli.dialects.young.listing import OutTable
from flexmb_cli.results.diff import hdf5
from flexmb_cli.results.diff.accept import accept
from flexmb_cli.results.diff.compare import compare
from flexmb_cli.results.diff.hdf5 import kind_of
from flexmb_cli.results.diff.listings import read_listing
from flexmb_cli.results.diff.tolerances import KINDS, Tolerance, ToleranceError, Tolerances, parse_kinds
from flexmb_cli.results.hdf5.kinematic import kinematic_layout, kinematic_values
from flexmb_cli.results.hdf5.result_file import ResultFile
from tests.results.results import SERIES, write_result

FIELD_OF = {
    "position": "position",
    "euler": "euler_parameters",
    "velocity": "velocity",
    "euler_rate": "euler_parameter_rates",
    "omega": "angular_velocity",
    "acceleration": "acceleration",
    "euler_acceleration": "euler_parameter_accelerations",
    "alpha": "angular_acceleration",
    "point_position": "point_position",
    "point_velocity": "point_velocity",
    "point_acceleration": "point_acceleration",
}


@pytest.fixture
def table(tmp_path, deck):
    def write(name, rows, layout="safe", failed=False, deck=deck):
        stream = io.StringIO()
        out = OutTable((stream,), deck, layout)
        out.begin()
        out.rows(kinematic_values(rows))
        if failed:
            out.failed()
        path = tmp_path / name
        path.write_text(stream.getvalue())
        return path

    return write


@pytest.fixture
def result(tmp_path, deck, mechanism):
    def write(name, rows, status="complete"):
        file = ResultFile(tmp_path / name, deck, kinematic_layout(mechanism))
        file.rows(kinematic_values(rows))
        file.close(status)
        return tmp_path / name

    return write


@pytest.fixture(params=["OUT", "h5"])
def store(request, table, result):
    """Write rows in one of the two formats."""
    write = table if request.param == "OUT" else result
    return lambda name, rows: write(f"{name}.{request.param}", rows)


def shifted(rows, field, amount, row=2, item=-1, column=0):
    changed = getattr(rows, field).copy()
    changed[row, item, column] += amount
    return replace(rows, **{field: changed})


TIMES = np.arange(7.0)


def test_a_result_is_equal_to_itself(store, rows):
    path = store("a", rows(TIMES))
    report = compare(path, path)
    assert report.equal
    assert report.exit_code == 0
    assert report.text() == f"{path}, {path}: no difference in {report.compared} numbers\n"


def test_every_number_of_the_table_is_compared(table, rows):
    path = table("a.OUT", rows(TIMES))
    echoed = 12 + 2 * 7 + 5 + 4 + 8 + 2 * 3 + 19 + 3
    assert compare(path, path).compared == echoed + 7 * (1 + 2 * 27 + 9)


@pytest.mark.parametrize("kind", FIELD_OF)
def test_a_change_is_found_in_its_kind_and_place(store, rows, kind):
    base = rows(TIMES)
    changed = store("b", shifted(base, FIELD_OF[kind], 0.25))
    report = compare(store("a", base), changed)
    assert report.exit_code == 1
    assert {name: tally.differing for name, tally in report.tallies.items() if tally.differing} == {kind: 1}
    assert report.worst.time == 2.0
    assert abs(report.worst.b - report.worst.a - 0.25) < 0.011  # w-x is printed with two decimals


def test_the_worst_place_is_named_in_the_table(table, rows):
    base = rows(TIMES)
    report = compare(table("a", base), table("b", shifted(base, "acceleration", 0.25, item=1, column=1)))
    assert report.worst.sentence == "acceleration, body 2, ddY at t = 2: 0.0 against 0.25"


def test_the_worst_place_is_named_in_the_hdf5_result(result, rows):
    base = rows(TIMES)
    report = compare(result("a", base), result("b", shifted(base, "acceleration", 0.25, item=1, column=1)))
    assert report.worst.sentence == "/body/acceleration, body 2, y at t = 2: -0.0 against 0.25"


def test_one_printed_digit_is_a_difference(table, rows):
    base = rows(TIMES)
    a, b = table("a", base), table("b", shifted(base, "velocity", 0.001, item=0))
    assert compare(a, b).differing == 1
    assert compare(a, b, Tolerances(last_digit=1)).equal


@pytest.mark.parametrize(("units", "equal"), [(1, False), (2, False), (3, True), (4, True)])
def test_units_of_the_last_digit_are_exact(table, rows, units, equal):
    base = rows(TIMES)
    a, b = table("a", base), table("b", shifted(base, "velocity", 0.003, item=0))
    assert compare(a, b, Tolerances(last_digit=units)).equal is equal


def test_the_last_digit_is_that_of_the_column(table, rows):
    """w-x and w-y are printed with two decimals, w-z with three."""
    base = rows(TIMES)
    a = table("a", base)
    assert compare(
        a, table("b", shifted(base, "angular_velocity", 0.01, column=0)), Tolerances(last_digit=1)
    ).equal
    assert not compare(
        a, table("c", shifted(base, "angular_velocity", 0.01, column=2)), Tolerances(last_digit=1)
    ).equal


def test_signs_of_zero_and_spacing_do_not_count(table, rows):
    base = rows(TIMES)
    minus = replace(base, angular_acceleration=np.full((7, 2, 3), -1e-9))
    a, b = table("a", base), table("b", minus, layout="historic")
    assert "-0.000" in b.read_text()
    assert compare(a, b).equal


def test_the_two_layouts_of_one_result_do_not_differ(table, rows):
    base = rows(TIMES)
    large = replace(
        base, acceleration=base.acceleration * 12345.6789, point_velocity=base.point_velocity * 98765.4321
    )
    assert compare(table("a", large), table("b", large, layout="historic")).equal


@pytest.mark.parametrize(
    ("tolerance", "equal"),
    [
        (Tolerance(atol=0.011), True),
        (Tolerance(atol=0.009), False),
        (Tolerance(rtol=0.0011), True),
        (Tolerance(rtol=0.0009), False),
        (Tolerance(atol=0.009, rtol=0.0011), True),
        (Tolerance(atol=0.011, rtol=0.0009), True),
    ],
)
def test_a_value_differs_when_it_exceeds_both_tolerances(tolerance, equal):
    differs, distance = tolerance.exceeded(np.array([10.0]), np.array([10.01]))
    assert differs[0] == (not equal)
    assert distance[0] == pytest.approx(0.01)


@pytest.mark.parametrize(
    ("a", "b", "equal"),
    [
        (np.nan, np.nan, True),
        (np.nan, 0.0, False),
        (0.0, np.nan, False),
        (np.inf, np.inf, True),
        (np.inf, -np.inf, False),
        (np.inf, 1e300, False),
        (0.0, -0.0, True),
        (1e308, -1e308, False),
    ],
)
def test_numbers_that_are_none_equal_only_their_like(a, b, equal):
    tolerance = Tolerance(atol=1e300, rtol=0.5)
    assert tolerance.exceeded(np.array([a]), np.array([b]))[0][0] == (not equal)


def test_hdf5_results_are_compared_to_nine_figures(result, rows):
    base = rows(TIMES)
    a = result("a", base)
    size = base.velocity[2, 1, 0]
    assert compare(a, result("b", shifted(base, "velocity", 0.9e-9 * size))).equal
    assert not compare(a, result("c", shifted(base, "velocity", 1.1e-9 * size))).equal
    assert compare(a, result("d", shifted(base, "velocity", 0.9e-12, item=0))).equal
    assert not compare(a, result("e", shifted(base, "velocity", 1.1e-12, item=0))).equal
    assert not compare(a, result("b", shifted(base, "velocity", 0.9e-9 * size)), Tolerances(rtol=0)).equal


def test_kinds_have_their_own_tolerances(store, rows):
    base = rows(TIMES)
    a, b = store("a", base), store("b", shifted(base, "acceleration", 0.01))
    assert compare(a, b, Tolerances(kinds=parse_kinds(["acceleration=0.011"]))).equal
    assert compare(a, b, Tolerances(kinds=parse_kinds(["acceleration=inf"]))).equal
    assert not compare(a, b, Tolerances(kinds=parse_kinds(["velocity=0.011"]))).equal


def test_settings_of_kinds_are_understood():
    assert parse_kinds(["omega=1e-3", "alpha=.5,1E-6"]) == {
        "omega": Tolerance(1e-3),
        "alpha": Tolerance(0.5, 1e-6),
    }
    assert parse_kinds([f"{kind}=1" for kind in KINDS]).keys() == set(KINDS)


@pytest.mark.parametrize(
    ("setting", "message"),
    [
        ("spin=1", "spin=1: there is no kind 'spin'; the kinds are time, position, euler, "),
        ("omega", "omega: write omega=ATOL or omega=ATOL,RTOL with numbers not below zero"),
        ("omega=-1", "omega=-1: write omega=ATOL"),
        ("omega=\u0130nf", "omega=\u0130nf: write omega=ATOL"),
        ("omega=nan", "omega=nan: write omega=ATOL"),
        ("omega=1,2,3", "omega=1,2,3: write omega=ATOL"),
        ("omega=1_0", "omega=1_0: write omega=ATOL"),
        ("omega=1e999", "omega=1e999: write omega=ATOL"),
    ],
)
def test_settings_that_make_no_sense_are_refused(setting, message):
    with pytest.raises(ToleranceError) as caught:
        parse_kinds(["euler=1", setting])
    assert str(caught.value).startswith(message)
    assert caught.value.exit_code == 2


def turned_over(rows, when):
    """The same attitudes of body 2 with the other sign of the Euler parameters at the rows `when`."""
    changed = {}
    for field in ("euler_parameters", "euler_parameter_rates", "euler_parameter_accelerations"):
        changed[field] = getattr(rows, field).copy()
        changed[field][when, 1] *= -1
    return replace(rows, **changed)


def test_the_same_attitude_with_the_other_sign_counts_only_unless_allowed(store, rows):
    base = rows(TIMES)
    a, b = store("a", base), store("b", turned_over(base, [3, 5]))
    assert not compare(a, b).equal
    assert compare(a, b, same_attitude=True).equal
    assert compare(b, a, same_attitude=True).equal


def test_rates_with_the_other_sign_than_their_parameters_differ_all_the_same(store, rows):
    base = rows(TIMES)
    rates = base.euler_parameter_rates.copy()
    rates[3, 1] *= -1
    a, b = store("a", base), store("b", replace(base, euler_parameter_rates=rates))
    report = compare(a, b, same_attitude=True)
    assert {kind for kind, tally in report.tallies.items() if tally.differing} == {"euler_rate"}


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
    assert report.missing == [f"position: 1 lines of {a} are not in {b}: body 2 at t = 1"]
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
    with pytest.raises(TableError, match="this is no HDF5 result, the other file is") as caught:
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


def test_the_report_is_plain_data_for_json(store, rows):
    base = rows(TIMES)
    report = compare(store("a", base), store("b", shifted(base, "velocity", np.nan)))
    reported = json.loads(json.dumps(report.as_dict(), allow_nan=False))
    assert reported["equal"] is False
    assert reported["kinds"]["velocity"]["differing"] == 1
    assert reported["worst"]["b"] == "nan"
    assert reported["worst"]["time"] == 2.0


def test_the_summary_shows_every_kind_and_the_worst_place(table, rows):
    base = rows(TIMES)
    a, b = table("a", base), table("b", shifted(base, "velocity", 0.25, item=0))
    text = compare(a, b).text().splitlines()
    assert text[0] == "kind                compared  differ  largest  worst place"
    assert (
        "velocity                  42       1     0.25  velocity, body 1, dX at t = 2: 0.0 against 0.25"
        in text
    )
    assert text[-2] == "worst: velocity, body 1, dX at t = 2: 0.0 against 0.25"
    assert text[-1] == f"{a}, {b}: 1 of 519 numbers differ, 0 things are missing"


@pytest.mark.parametrize("series", SERIES, ids=lambda series: series.path)
def test_a_change_in_any_dataset_is_found_in_its_kind(tmp_path, series):
    a, b = write_result(tmp_path / "a.h5", 5), write_result(tmp_path / "b.h5", 5)
    with h5py.File(b, "a") as file:
        dataset = file[series.path]
        place = tuple(length - 1 for length in dataset.shape)
        dataset[place] *= 1 + 1e-8
    report = compare(a, b)
    kind = kind_of(series.path)
    assert kind in KINDS
    assert {name: tally.differing for name, tally in report.tallies.items() if tally.differing} == {kind: 1}
    assert report.worst.section == f"/{series.path}"
    assert report.worst.time == 1.0


def flexmb(*arguments, cwd):
    return subprocess.run(
        [sys.executable, "-m", "flexmb_cli", "diff", *map(str, arguments)],
        cwd=cwd, capture_output=True, text=True, encoding="utf-8", timeout=60,
    )  # fmt: skip


def test_update_takes_the_second_file_as_reference(table, rows, tmp_path):
    base = rows(TIMES)
    a, b = table("a", base), table("b", shifted(base, "velocity", 0.25, item=0))
    a.chmod(0o640)
    done = flexmb("a", "b", "--update", cwd=tmp_path)
    assert done.returncode == 0
    verdict = "a, b: 1 of 519 numbers differ, 0 things are missing"
    assert done.stdout.splitlines()[-2:] == [verdict, "a: taken from b"]
    assert a.read_bytes() == b.read_bytes()
    assert a.stat().st_mode & 0o777 == 0o640
    assert sorted(path.name for path in tmp_path.iterdir()) == ["a", "b"]


def test_update_leaves_a_reference_that_agrees(table, rows, tmp_path):
    base = rows(TIMES)
    a, _ = table("a", base), table("b", shifted(base, "velocity", 0.001, item=0))
    before = a.read_bytes()
    done = flexmb("a", "b", "--update", "--last-digit", "1", cwd=tmp_path)
    assert (done.returncode, done.stdout.splitlines()[-1]) == (0, "a: left as it is")
    assert a.read_bytes() == before


def test_update_makes_a_reference_that_is_not_there(store, rows, tmp_path):
    b = store("b", rows(TIMES))
    reported = json.loads(flexmb("new", b, "--update", "--json", cwd=tmp_path).stdout)
    assert reported["updated"] is True
    assert (tmp_path / "new").read_bytes() == b.read_bytes()


def test_update_refuses_what_is_no_result_and_what_cannot_be_written(table, rows, tmp_path):
    a = table("a", rows(TIMES))
    before = a.read_bytes()
    (tmp_path / "letter").write_text("Dear Sir,\n")
    for arguments, message in (
        (["a", "letter"], "no OUT table is found in it"),
        (["new", "letter"], "no OUT table is found in it"),
        (["a", "none"], "no such file"),
        (["none/new", "a"], "its folder does not exist"),
        (["a", "-"], "standard input"),
    ):
        done = flexmb(*arguments, "--update", cwd=tmp_path)
        assert done.returncode == 2
        assert message in done.stderr
    assert a.read_bytes() == before
    assert not (tmp_path / "new").exists()


def test_fewer_decimals_agree_when_they_are_the_rounded_ones(table, rows):
    """OUT1-4-3 of Appendix B has two decimals where later listings have three."""
    a = table("a", rows(TIMES))
    text = a.read_text()
    b, c = a.with_name("b"), a.with_name("c")
    b.write_text(re.sub(r"(\d\.\d\d\d)(?=\s)", lambda match: f"{float(match[1]):.2f}", text))
    c.write_text(b.read_text().replace("-0.87", "-0.88"))
    assert b.read_text() != text
    assert compare(a, b).equal
    assert compare(a, c).tallies["position"].differing > 0


def test_comparing_results_takes_no_more_memory_than_a_part_of_them(tmp_path, monkeypatch):
    monkeypatch.setattr(hdf5, "NUMBERS_AT_ONCE", 2**16)

    def peak(rows):
        path = write_result(tmp_path / f"{rows}.h5", rows)
        tracemalloc.start()
        assert compare(path, path, same_attitude=True).equal
        _, most = tracemalloc.get_traced_memory()
        tracemalloc.stop()
        return most

    # Twelve Euler parameters a row are the largest dataset: a part is 5461 rows of them.
    assert peak(44000) < 1.2 * peak(22000)


def test_update_follows_no_link_of_a_result_to_another_file(result, rows):
    """A reference that took its rows from elsewhere would change without being touched."""
    a, b = result("a.h5", rows(TIMES)), result("b.h5", rows(TIMES))
    with h5py.File(b, "r+") as file:
        del file["time"]
        file["time"] = h5py.ExternalLink(a.name, "/time")
    before = a.read_bytes()
    with pytest.raises(TableError, match="time is a link to elsewhere") as caught:
        accept(a, b)
    assert caught.value.name == str(b)
    assert a.read_bytes() == before


@pytest.mark.skipif(not Path("/dev/zero").exists(), reason="needs a device that never ends")
def test_a_file_without_end_is_refused_before_memory_is_full(monkeypatch):
    monkeypatch.setattr(listing, "LARGEST_LISTING", 2**20)
    with pytest.raises(TableError, match="larger than 1 MB: compare the HDF5 results"):
        read_listing("/dev/zero")
