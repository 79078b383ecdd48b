"""Study files: what is understood, and what is said of the rest."""

import math
from itertools import pairwise

import pytest

from flexmb_cli.deck.text import decode
from flexmb_cli.errors import DeckError
from flexmb_cli.study.reader import read_study
from tests.growth import LINEAR, growth

HEAD = 'deck = "a.dat"\n'
RESULTS = '[results]\ntop = "max body.3.z"\n'
PARAMETERS = '[parameters]\n"driver.1.B" = [1, 2.5]\n"point.1.x" = { from = 0, to = 1, count = 3 }\n'
GRID = HEAD + PARAMETERS + RESULTS


def study(text):
    return read_study(decode("study.toml", text.encode()))


def test_a_grid_takes_every_combination_and_varies_the_last_parameter_fastest():
    found = study(GRID)
    assert found.cases == 6
    rows = [found.row_of(case) for case in range(6)]
    assert rows == [[1, 0], [1, 0.5], [1, 1], [2.5, 0], [2.5, 0.5], [2.5, 1]]


def test_parameters_that_go_together():
    text = GRID.replace(HEAD, HEAD + 'sampling = "together"\n').replace("count = 3", "count = 2")
    assert [study(text).row_of(case) for case in range(2)] == [[1, 0], [2.5, 1]]


def test_logarithmic_steps_keep_their_ratio_and_their_ends():
    text = GRID.replace("from = 0, to = 1, count = 3", 'from = 0.1, to = 1000, count = 5, scale = "log"')
    values = study(text).parameters[1].values
    assert (values[0], values[-1]) == (0.1, 1000.0)
    assert [b / a for a, b in pairwise(values)] == pytest.approx([10] * 4, rel=1e-14)


@pytest.mark.parametrize(
    "text, message, line",
    [
        ("deck = \n", "not TOML: Invalid value", 1),
        (GRID.replace(HEAD, ""), 'names the deck: deck = "IN-RSSR.dat"', None),
        (HEAD + RESULTS, "the table [parameters] is missing or empty; it has entries such as", None),
        (GRID.replace("max body", "most body"), "TAKE one of last, first, max, min, mean, series", 6),
        (GRID.replace("max body.3.z", "max"), 'a result is written "TAKE QUANTITY"', 6),
        (GRID.replace('"point.1.x"', "point.1.x"), 'stands in quotes: "point.1.x" = …', 4),
        (GRID.replace("[1, 2.5]", "[]"), "needs a list of numbers or a range", 3),
        (GRID.replace("[1, 2.5]", '[1, "2"]'), "a list holds finite numbers only", 3),
        (GRID.replace("[1, 2.5]", "[1, inf]"), "a list holds finite numbers only", 3),
        (GRID.replace("[1, 2.5]", "[1, true]"), "a list holds finite numbers only", 3),
        (GRID.replace("count = 3", "count = 1"), "a range needs a count from 2 to 1000000", 4),
        (GRID.replace("to = 1", "upto = 1"), "unknown in point.1.x; known are from, to, count, scale", None),
        (GRID.replace("count = 3", 'count = 3, scale = "log"'), "a logarithmic range needs positive ends", 4),
        (GRID.replace("count = 3", 'count = 3, scale = "ln"'), "scale is one of linear, log", 4),
        (HEAD + 'sampling = "random"\n' + GRID[len(HEAD) :], "is one of grid, together, latin-hypercube", 2),
        (HEAD + "sample = 3\n" + GRID[len(HEAD) :], "unknown in study; known are deck, dialect,", 2),
        (HEAD + "count = 3\n" + GRID[len(HEAD) :], "belongs to sampling = 'latin-hypercube'", 2),
        (HEAD + "seed = -1\n" + GRID[len(HEAD) :], "is an integer from 0 to 4294967295", 2),
        (
            HEAD + 'sampling = "latin-hypercube"\n' + GRID[len(HEAD) :],
            "a latin-hypercube needs `count`, the number of its cases",
            2,
        ),
        (
            HEAD + 'sampling = "latin-hypercube"\ncount = 0\n' + GRID[len(HEAD) :],
            "is an integer from 1 to 100000000",
            3,
        ),
        (
            HEAD + 'sampling = "together"\n' + GRID[len(HEAD) :],
            "with sampling = 'together' all need as many values: driver.1.B has 2, point.1.x has 3",
            3,
        ),
        (
            HEAD + "[parameters]\n"
            + "".join(f'"p.{k}" = {{ from = 0, to = 1, count = 1000 }}\n' for k in range(3)) + RESULTS,
            "make 1000000000 cases; more than 100000000 are refused",
            2,
        ),
    ],
)  # fmt: skip
def test_faults_of_a_study(text, message, line):
    with pytest.raises(DeckError) as caught:
        study(text)
    faults = [fault for fault in caught.value.faults if message in fault.message]
    assert faults, [fault.message for fault in caught.value.faults]
    assert (faults[0].place.line if faults[0].place else None) == line


def test_all_faults_are_told_at_once():
    text = GRID.replace("[1, 2.5]", "[]").replace("max body", "most body")
    with pytest.raises(DeckError) as caught:
        study(text)
    assert [fault.subject for fault in caught.value.faults] == ["driver.1.B", "top"]


def test_the_middle_of_a_range_is_between_its_ends():
    values = study(GRID.replace("from = 0, to = 1", "from = -1, to = 1")).parameters[1].values
    assert values == (-1.0, 0.0, 1.0) and not math.copysign(1, values[0]) > 0


@pytest.mark.parametrize("name", ["", " ", ".", "..", "a/b", "/a", "a\\u0000b", " a", "a "])
def test_a_result_needs_a_name_that_a_table_can_hold(name):
    with pytest.raises(DeckError, match="a name of a result has letters, digits, marks and blanks"):
        study(GRID.replace(RESULTS, "") + f'[results]\n"{name}" = "max body.3.z"\n')


@pytest.mark.parametrize(
    "text, place",
    [
        (GRID, (6, 1)),
        (GRID.replace("top", '  "top"'), (6, 4)),
        (GRID.replace("[results]\ntop", "[ results ]\ntop"), (6, 1)),
        # The same name as a parameter's: it stands first among the parameters.
        (GRID.replace("point.1.x", "top"), (6, 1)),
        ('results.top = "max body.3.z"\n' + HEAD + PARAMETERS, (1, 9)),
        (HEAD + 'results = { top = "max body.3.z" }\n' + PARAMETERS, None),
    ],
)
def test_a_result_knows_where_it_stands(text, place):
    (kept,) = study(text).results
    assert (kept.place and kept.place[:2]) == place


def test_a_parameter_knows_where_it_stands():
    assert [varied.place for varied in study(GRID).parameters] == [(3, 2, 10), (4, 2, 9)]


@pytest.mark.parametrize("line", ['"a.{}" = "wrong"', "key{} = true"])
def test_many_wrong_names_are_told_in_time_in_proportion_to_their_number(line):
    """Each name was looked for on every line: hours for a megabyte."""

    def told(count):
        with pytest.raises(DeckError) as caught:
            study(HEAD + "[parameters]\n" + "".join(line.format(k) + "\n" for k in range(count)))
        assert caught.value.faults[count // 2].place.line == count // 2 + 3

    assert growth(told, 800) < LINEAR


def test_a_name_of_many_parts_is_refused_before_it_is_read():
    """Of a quarter of a million parts tomllib makes as many tables, and looks through them for each."""
    text = GRID + ".".join(250_000 * ["a"]) + " = 1\n"
    with pytest.raises(DeckError, match="more than 64 parts") as caught:
        study(text)
    assert caught.value.faults[0].place.line == len(text.splitlines())


def test_dots_in_lists_comments_and_paths_make_no_deep_name():
    text = GRID.replace("[1, 2.5]", "[" + "1.5, " * 100 + "]").replace(HEAD, HEAD + "#" + "." * 100 + "\n")
    assert len(study(text).parameters[0].values) == 100


def test_a_text_without_quotes_is_told_to_stand_in_them():
    with pytest.raises(DeckError, match=r'texts stand in quotes: top = "max body\.3\.z"'):
        study(HEAD + "[results]\ntop = max body.3.z\n")
