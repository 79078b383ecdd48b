"""`plot`, `report` and `export` of the table of a study, and the table in xarray."""

import json
import re
from base64 import b64encode
from dataclasses import replace
from hashlib import sha256

import numpy as np
import pytest
from click.testing import CliRunner

from flexmb_cli.cli.export import export
from flexmb_cli.cli.plot import plot
from flexmb_cli.cli.report import report
from flexmb_cli.study.figures import curve_family, kind_for, study_page
from flexmb_cli.study.table import Column, TableHead, write_table
from flexmb_cli.study.text import cases_table, open_study
from tests.results.figures.test_content_policy import Loaded

LENGTH, RATE = Column("parameter/length", "m", "length"), Column("parameter/rate", "rad/s", "rate")
TOP, PATH = Column("result/top", "m", "max of z"), Column("result/path", "m", "series of z", 3)


def study(path, pairs, failed=()):
    """A study whose result `top` is 10 length + rate; cases `failed` have none."""
    head = TableHead("a = 1", "deck", "a.dat", "0" * 64, (LENGTH, RATE, TOP, PATH), len(pairs))
    rows = [
        (n, int(n in failed), 3, "", [x, y, np.nan if n in failed else 10 * x + y, np.full(3, x)])
        for n, (x, y) in enumerate(pairs, 1)
    ]
    write_table(str(path), head, rows)
    return path


LINE = [(x, 2.0) for x in (0.3, 0.1, 0.2)]
GRID = [(x, y) for x in (0.1, 0.2, 0.3) for y in (1.0, 2.0)]
CLOUD = [(0.1, 1.0), (0.25, 3.0), (0.3, 2.0)]


def called(command, *arguments):
    return CliRunner().invoke(command, [*map(str, arguments)])


@pytest.mark.parametrize(("pairs", "kind"), [(LINE, "curve"), (GRID, "map"), (CLOUD, "scatter")])
def test_the_picture_suits_the_parameters(pairs, kind, tmp_path):
    pytest.importorskip("matplotlib")
    path = study(tmp_path / "s.h5", pairs)
    with open_study(path) as file:
        cases = cases_table(file, (), str(path))
    assert kind_for(cases) == kind
    done = called(plot, path, "-o", tmp_path / "s.svg", "--title", "T")
    assert done.exit_code == 0, done.output
    assert f"{kind} of top [m]" in done.stderr
    labels = re.findall(r"<!-- (.*?) -->", (tmp_path / "s.svg").read_text())
    assert {"T", "length [m]", "top [m]"} <= set(labels)
    # The same table gives the same bytes.
    called(plot, path, "-o", tmp_path / "again.svg", "--title", "T")
    assert (tmp_path / "again.svg").read_bytes() == (tmp_path / "s.svg").read_bytes()


@pytest.mark.parametrize(("pairs", "kind"), [(LINE, "curve"), (GRID, "map"), (CLOUD, "scatter")])
def test_a_result_that_varies_by_round_off_is_drawn_flat_and_says_so(pairs, kind, tmp_path):
    """2 m and 2 m + 4e-16 m, one unit of the last place of a double, are the same result."""
    pytest.importorskip("matplotlib")
    head = TableHead("a = 1", "deck", "a.dat", "0" * 64, (LENGTH, RATE, TOP), len(pairs))
    rows = [(n, 0, 3, "", [*pair, np.nextafter(2, 3) if n % 2 else 2]) for n, pair in enumerate(pairs, 1)]
    write_table(str(tmp_path / "s.h5"), head, rows)
    assert called(plot, tmp_path / "s.h5", "-o", tmp_path / "s.svg").exit_code == 0
    labels = re.findall(r"<!-- (.*?) -->", (tmp_path / "s.svg").read_text())
    assert "varies by round-off only" in labels and "2.0" in {label.strip("0") + "0" for label in labels}
    called(plot, study(tmp_path / "varied.h5", pairs), "-o", tmp_path / "varied.svg")
    assert "round-off" not in (tmp_path / "varied.svg").read_text()


def test_series_are_drawn_over_their_times_coloured_by_the_parameter(tmp_path):
    """Case n has the times n, 2 n, 3 n; the failed case is left out."""
    pytest.importorskip("matplotlib")
    times = Column("result/time", "s", "series of time", 3)
    head = TableHead("a = 1", "deck", "a.dat", "0" * 64, (LENGTH, PATH, times), 3)
    rows = [(n, int(n == 2), 3, "", [n / 10, np.full(3, n), n * np.arange(1, 4)]) for n in (1, 2, 3)]
    write_table(str(tmp_path / "s.h5"), head, rows)
    with open_study(tmp_path / "s.h5") as file:
        family = curve_family(file, ["path"], "s.h5")
    assert family.times.tolist() == [[1.0, 2.0, 3.0], [3.0, 6.0, 9.0]]
    assert family.series["path [m]"][:, 0].tolist() == [1.0, 3.0]
    done = called(plot, tmp_path / "s.h5", "path", "-o", tmp_path / "s.svg")
    assert done.exit_code == 0 and "2 cases of path [m]; 1 failed cases are left out" in done.stderr
    labels = re.findall(r"<!-- (.*?) -->", (tmp_path / "s.svg").read_text())
    assert {"time [s]", "path [m]", "length [m]"} <= set(labels)


FAMILY = Column("result/time", "s", "series of time", 3)


@pytest.mark.parametrize(
    "words", [["path"], ["--kind", "curve"], ["--kind", "scatter"], ["--kind", "parallel"]]
)
def test_a_picture_of_a_study_for_print_has_the_width_the_font_and_no_title(words, tmp_path):
    """85 mm at 300 dots per inch are 1003.9 pixels."""
    pytest.importorskip("matplotlib")
    head = TableHead("a = 1", "deck", "a.dat", "0" * 64, (LENGTH, TOP, PATH, FAMILY), 3)
    series = np.array([1.0, 2.0, 4.0])
    write_table(
        str(tmp_path / "s.h5"), head, [(n, 0, 3, "", [n / 10, n, n * series, series]) for n in (1, 2, 3)]
    )
    printed = [tmp_path / "s.h5", *(words if words[0] == "path" else ["top", *words]), "--width", 85]
    assert called(plot, *printed, "-o", tmp_path / "s.png").exit_code == 0
    assert int.from_bytes((tmp_path / "s.png").read_bytes()[16:20], "big") == 1003
    assert called(plot, *printed, "-o", tmp_path / "s.svg").exit_code == 0
    assert called(plot, *printed, "--font", "monospace", "-o", tmp_path / "font.svg").exit_code == 0
    texts = [(tmp_path / name).read_text() for name in ("s.svg", "font.svg")]
    assert texts[0] != texts[1] and "DejaVuSansMono" in texts[1]
    assert not any("<!-- a.dat -->" in text for text in texts)


def test_a_map_for_print_has_the_width(tmp_path):
    """85 mm at 300 dots per inch are 1003.9 pixels; 40 mm are 472.4.  The width stands in bytes 16 to 20."""
    pytest.importorskip("matplotlib")
    path, picture = study(tmp_path / "s.h5", GRID), tmp_path / "s.png"
    for millimetres, pixels in ((85, 1003), (40, 472)):
        done = called(plot, path, "top", "--kind", "map", "--width", millimetres, "-o", picture)
        assert done.exit_code == 0, done.output
        assert int.from_bytes(picture.read_bytes()[16:20], "big") == pixels


def test_print_options_of_a_picture_of_a_study_need_a_width(tmp_path):
    pytest.importorskip("matplotlib")
    path = study(tmp_path / "s.h5", LINE)
    done = called(plot, path, "--font", "serif", "-o", tmp_path / "s.png")
    assert done.exit_code == 2 and "--font: for pictures of print; give --width, too" in done.output
    done = called(plot, path, "--width", 20, "--font-size", 40, "-o", tmp_path / "s.png")
    assert done.exit_code == 2 and "letters of 40 points leave no room" in done.output
    assert not (tmp_path / "s.png").exists()


def test_the_numbers_drawn_are_those_of_the_table(tmp_path):
    """Of a 3 by 2 grid with one failed case five cases are left, each with 10 length + rate."""
    path = study(tmp_path / "s.h5", GRID, failed=(4,))
    with open_study(path) as file:
        cases = cases_table(file, ("top",), str(path))
    assert cases.failed == 1 and not cases.is_grid
    length, rate, top = (*cases.parameters.values(), cases.results["top [m]"])
    np.testing.assert_array_equal(top, 10 * length + rate)
    assert len(top) == 5


@pytest.mark.parametrize(
    ("arguments", "reported"),
    [
        (["--kind", "curve"], "a curve needs one parameter that varies"),
        (["--x", "length"], "the table of a study has no times"),
        (["path", "top"], "is a series of each case: draw it alone"),
        (["path"], "its series have no times: solve the study again"),
        (["tip"], "no such parameter or result; near it are"),
    ],
)
def test_what_cannot_be_drawn_of_a_study_is_refused_without_a_file(arguments, reported, tmp_path):
    pytest.importorskip("matplotlib")
    path = study(tmp_path / "s.h5", GRID)
    done = called(plot, path, "-o", tmp_path / "s.png", *arguments)
    assert done.exit_code != 0
    assert reported in done.output + str(done.exception)
    assert not (tmp_path / "s.png").exists()


def test_parallel_coordinates_have_an_axis_for_every_column(tmp_path):
    pytest.importorskip("matplotlib")
    path = study(tmp_path / "s.h5", CLOUD)
    assert called(plot, path, "--kind", "parallel", "-o", tmp_path / "s.svg").exit_code == 0
    labels = re.findall(r"<!-- (.*?) -->", (tmp_path / "s.svg").read_text())
    lines = [line for label in labels for line in label.split("\n")]
    assert {"0.1 to 0.3", "1 to 3", "2 to 5.5"} <= set(lines)
    # Below its axis, and at the scale of the colours, which goes from 2 to 5.5 m.
    assert lines.count("top [m]") == 2 and {"2.5", "5.0"} <= set(lines)


def test_the_page_of_a_study_holds_its_numbers(tmp_path):
    pytest.importorskip("plotly")
    path = study(tmp_path / "s.h5", CLOUD)
    assert called(report, path, "-o", tmp_path / "s.html").exit_code == 0
    page = (tmp_path / "s.html").read_text(encoding="utf-8")
    figures = json.loads(re.search(r"const figures = (\{.*\});", page)[1].replace("<\\/", "</"))
    (parallel,) = figures["parallel"]["data"]
    assert [axis["label"] for axis in parallel["dimensions"]] == ["length [m]", "rate [rad/s]", "top [m]"]
    assert parallel["dimensions"][2]["values"] == [2.0, 5.5, 5.0]
    assert figures["result0"]["data"][0]["y"] == [1.0, 3.0, 2.0]


def test_the_policy_of_the_page_of_a_study_allows_its_own_scripts_and_no_network(tmp_path):
    """Without a policy a fault of the library could have loaded anything from anywhere."""
    pytest.importorskip("plotly")
    assert called(report, study(tmp_path / "s.h5", CLOUD), "-o", tmp_path / "s.html").exit_code == 0
    found = Loaded((tmp_path / "s.html").read_text(encoding="utf-8"))
    rules = dict(rule.strip().split(" ", 1) for rule in found.policy.split(";"))
    digests = [b64encode(sha256(script.encode()).digest()).decode() for script in found.scripts]
    assert len(digests) == 2
    assert rules == {
        "default-src": "'none'",
        "script-src": " ".join([*(f"'sha256-{digest}'" for digest in digests), "'unsafe-eval'"]),
        "style-src": "'unsafe-inline'",
        "img-src": "data: blob:",
        "form-action": "'none'",
        "base-uri": "'none'",
    }
    assert (found.before_policy, found.handlers, found.addresses) == ([], [], [])


def test_names_of_a_study_neither_end_the_script_nor_turn_the_writing(tmp_path):
    """`<!--<script>` made the browser read the end of the script as a part of it."""
    with open_study(study(tmp_path / "s.h5", CLOUD)) as file:
        cases = cases_table(file, (), "s.h5")
    cases = replace(cases, deck_name="\u202eabc", results={"<!--<script>\u202e": cases.results["top [m]"]})
    page = study_page(cases, "\u202eb\x1b<!--<script>", "1;")
    assert "\u202e" not in page and "\x1b" not in page and "\\u202e" not in page
    assert page.count("<script>") == 2 and "<!--" not in page


def test_exports_of_a_study_hold_every_column(tmp_path):
    path = study(tmp_path / "s.h5", CLOUD)
    assert called(export, path, "--to", "csv", "-o", tmp_path / "s.csv").exit_code == 0
    lines = (tmp_path / "s.csv").read_text().splitlines()
    assert lines[0].startswith("case,parameter.length [m],parameter.rate [rad/s],result.path.1 [m]")
    assert lines[2].startswith("2,0.25,3.0,0.25,0.25,0.25,5.5,0,3")
    assert called(export, path, "--to", "mat", "-o", tmp_path / "s.mat").exit_code == 0
    from scipy.io import loadmat

    table = loadmat(tmp_path / "s.mat", simplify_cells=True)["flexmb"]
    np.testing.assert_array_equal(table["result"]["top"], [2.0, 5.5, 5.0])
    refused = called(export, path, "--to", "vtkhdf")
    assert refused.exit_code == 2 and "no motion to show" in refused.output


def test_xarray_has_the_parameters_as_coordinates(tmp_path):
    """As docs/reference/studies.md shows: a map over two parameters by their names."""
    xarray = pytest.importorskip("xarray")
    pytest.importorskip("h5netcdf")
    path = study(tmp_path / "s.h5", GRID)
    tree = xarray.open_datatree(path, engine="h5netcdf")
    cases = tree["result"].to_dataset().assign_coords(tree["parameter"].to_dataset().data_vars)
    grid = cases.set_index(case=["length", "rate"]).unstack("case")
    assert grid["top"].dims == ("length", "rate")
    assert float(grid["top"].sel(length=0.2, rate=2.0)) == 4.0


def test_parameters_are_those_of_the_text_in_its_order(tmp_path):
    """The table has them by the alphabet; a picture of series takes the first of the text for its colours."""
    path = tmp_path / "a.h5"
    text = "[parameters]\nrate = [1, 2]\nlength = [0.1, 0.2, 0.3]\n"
    head = TableHead(text, "deck", "a.dat", "0" * 64, (LENGTH, RATE, TOP), len(GRID))
    write_table(str(path), head, ((n, 0, 3, "", [x, y, x]) for n, (x, y) in enumerate(GRID, 1)))
    with open_study(str(path)) as table:
        assert [name.split()[0] for name in cases_table(table, (), "").varied] == ["rate", "length"]


def test_few_values_of_the_second_parameter_have_lines_of_their_own():
    from matplotlib.figure import Figure

    from flexmb_cli.study.figures import CurveFamily, _draw_cases
    from flexmb_cli.study.text import CasesTable

    x, y = np.array(GRID).T
    times = np.tile(np.arange(3.0), (len(GRID), 1))
    family = CurveFamily(CasesTable("a.dat", {"length": x, "rate": y}, {}, 0), times, {})
    figure = Figure()
    axis = figure.subplots()
    _draw_cases(figure, axis, family, times, None)
    lines = axis.get_lines()[: len(GRID)]
    assert [line.get_linestyle() for line in lines] == ["-", "--"] * 3
    assert [text.get_text() for text in axis.get_legend().get_texts()] == ["rate = 1", "rate = 2"]
