"""Comparison of OUT tables and HDF5 results."""

import json
import re
from dataclasses import replace

import h5py
import numpy as np
import pytest

from flexmb_cli.results.diff.compare import compare
from flexmb_cli.results.diff.hdf5 import kind_of
from flexmb_cli.results.diff.tolerances import KINDS, Tolerance, ToleranceError, Tolerances, parse_kinds
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
        ("spin=1", "spin=1: there is no type 'spin'; the types are time, position, euler, "),
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
    assert text[0] == "type                compared  differ  largest  worst place"
    assert (
        "velocity                  42       1     0.25  velocity, body 1, dX at t = 2: 0.0 against 0.25"
        in text
    )
    assert text[-2] == "worst: velocity, body 1, dX at t = 2: 0.0 against 0.25"
    assert text[-1] == f"{a}, {b}: 1 of 519 numbers differ, 0 missing entries"


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
