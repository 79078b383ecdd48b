"""Curves as pictures: which are drawn by default, in which panels, and always by the same bytes."""

import re
import shutil
import sys
import time
from pathlib import Path

import h5py
import numpy as np
import pytest
from click.testing import CliRunner

from flexmb_cli.cli.plot import plot
from flexmb_cli.results.figures.curves import Curve, Panel, Source, default_curves, panels
from flexmb_cli.results.figures.plots import style
from flexmb_cli.results.figures.report_page import curves_html
from flexmb_cli.results.quantities.quantities import open_result, resolve
from flexmb_cli.results.quantities.readable import Readable
from tests.results.figures.turning_bar import tip, write_bar
from tests.results.results import write_result

TIMES = np.arange(7.0)


@pytest.fixture
def bar(tmp_path, deck, mechanism, rows):
    return write_bar(tmp_path / "r.h5", deck, mechanism, rows, TIMES)


@pytest.fixture
def draw(bar, tmp_path):
    def run(*arguments):
        return CliRunner().invoke(plot, [str(bar), *map(str, arguments)])

    return run


def test_by_default_the_coordinates_of_points_that_move_are_drawn(bar):
    """The bar turns about y: its point keeps y = 0."""
    with open_result(bar) as file:
        assert [quantity.name for quantity in default_curves(file).quantities] == ["point.1.x", "point.1.z"]


def test_every_unit_has_its_panel(bar):
    with open_result(bar) as file:
        wanted = resolve(file, ["point.1.x", "body.2.omega.y", "point.1.z"])
        drawn = panels([Source("", file, slice(None), resolve(file, ["time"])[0], wanted)])
    assert [(panel.unit, len(panel.curves)) for panel in drawn] == [("m", 2), ("rad/s", 1)]
    labels = ["position of point 1 [m]", "angular velocity y of body 2 [rad/s]"]
    assert [panel.y_label for panel in drawn] == labels
    assert drawn[0].curves[1].y == pytest.approx(tip(TIMES)[:, 2], abs=1e-14)


def test_a_panel_of_different_quantities_says_what_they_are():
    """Of the von Mises stress of a node and a component of an element the last word is common."""
    words = [Readable("von Mises stress", "node 1", ""), Readable("stress", "element 2", "xx")]
    curves = tuple(Curve(each.label, TIMES, TIMES, words=each) for each in words)
    assert Panel("time [s]", "Pa", curves).y_label == "stress [Pa]"
    other = Curve("", TIMES, TIMES, words=Readable("pressure", "node 1", ""))
    assert Panel("time [s]", "Pa", (*curves, other)).y_label == "stresses [Pa]"
    assert Panel("time [s]", "kg", (*curves, other)).y_label == "[kg]"


def test_energies_are_drawn_by_default_as_changes_and_their_sum_by_itself(tmp_path):
    """The potential's 1e6 J mean nothing; between two rows 3 J go from it to the motion, 1e-6 J are lost."""
    energies = {"kinetic": [2.0, 5.0], "potential": [1e6, 1e6 - 3.0], "total": [1e6 + 2.0, 1e6 + 2.0 - 1e-6]}
    with h5py.File(tmp_path / "r.h5", "w") as file:
        file["time"] = [0.0, 1.0]
        file["time"].make_scale("time")
        for name, values in energies.items():
            file[f"energy/{name}"] = values
            file[f"energy/{name}"].attrs["units"] = "J"
            file[f"energy/{name}"].dims[0].attach_scale(file["time"])
    with open_result(tmp_path / "r.h5") as file:
        wanted, time = default_curves(file).quantities, resolve(file, ["time"])[0]
        changes, drift = panels([Source("", file, slice(None), time, wanted, energies_change=True)])
        (together,) = panels([Source("", file, slice(None), time, wanted)])
    assert {curve.label: curve.y.tolist() for curve in changes.curves} == {
        "kinetic energy": [0.0, 3.0],
        "potential energy": [0.0, -3.0],
    }
    assert (changes.y_label, drift.y_label) == ("change of energy [J]", "change of total energy [uJ]")
    assert drift.curves[0].y == pytest.approx([0.0, -1.0], rel=1e-3)
    assert together.unit == "MJ"
    assert [curve.y[0] for curve in together.curves] == pytest.approx([2e-6, 1.0, 1.000002], rel=1e-12)


def test_energies_that_do_not_change_are_not_drawn_but_named(tmp_path):
    pytest.importorskip("matplotlib")
    path = write_result(tmp_path / "r.h5", 3)
    with h5py.File(path, "r+") as file:
        for name, values in (("kinetic", [0.0, 1.0, 2.0]), ("strain", [0.0, 0.0, 0.0])):
            file[f"energy/{name}"] = values
            file[f"energy/{name}"].attrs["units"] = "J"
            file[f"energy/{name}"].dims[0].attach_scale(file["time"])
    with open_result(path) as file:
        drawn = {quantity.name for quantity in default_curves(file).quantities}
    assert {"energy.kinetic", "energy.total"} <= drawn
    assert "energy.strain" not in drawn
    done = CliRunner().invoke(plot, [str(path), "-o", str(tmp_path / "p.png")])
    assert f"{path}: note: not drawn, since they do not change: energy.strain\n" in done.output
    named = CliRunner().invoke(plot, [str(path), "energy.strain", "-o", str(tmp_path / "p.png")])
    assert "not drawn" not in named.output


@pytest.fixture
def crowd(tmp_path):
    """A result with the von Mises stress of 144 elements; that of element k grows to k MPa."""
    count = 144
    with h5py.File(tmp_path / "crowd.h5", "w") as file:
        file["time"], file["body/name"] = [0.0, 1.0], ["body 1"]
        file["deck"], file.attrs["deck_name"], file.attrs["dialect"] = "", "crowd.vsdf", "vsdf"
        file["stress/body 1/element"] = np.arange(1, count + 1)
        stress = file.create_dataset("stress/body 1/element_von_mises", (2, count), "f8")
        stress[1], stress.attrs["units"] = 1e6 * np.arange(1, count + 1), "Pa"
        for dim, path in zip(stress.dims, ("time", "stress/body 1/element"), strict=True):
            file[path].make_scale(path.rpartition("/")[2])
            dim.attach_scale(file[path])
    return tmp_path / "crowd.h5"


def test_of_a_crowd_of_stresses_the_largest_are_drawn_and_the_rest_is_counted(crowd, tmp_path):
    """The first twelve were drawn, without a word about the others."""
    pytest.importorskip("matplotlib")
    with open_result(crowd) as file:
        drawn = [quantity.name for quantity in default_curves(file).quantities]
    assert drawn == [f"stress.1.element{k}.von_mises" for k in range(133, 145)]
    told = "of 144 curves of von Mises stress [Pa] the 12 with the largest values are drawn, 132 are left out"
    done = CliRunner().invoke(plot, [str(crowd), "-o", str(tmp_path / "p.png")])
    assert f"{crowd}: note: {told}; give NAMEs to draw others\n" in done.output
    assert (
        "left out" not in CliRunner().invoke(plot, [str(crowd), "-q", "-o", str(tmp_path / "p.png")]).output
    )
    with open_result(crowd) as file:
        assert f"<p>O{told[1:]}; flexmb plot with NAMEs draws others.</p>" in curves_html(file)


@pytest.mark.parametrize("results", [1, 2, 3])
def test_no_two_of_many_curves_look_alike(results):
    """Eight colours alone repeated from the ninth quantity on."""
    looks = [str(style(quantity, result, results)) for quantity in range(64) for result in range(results)]
    assert len(set(looks)) == len(looks)
    assert len({style(0, result, results)["color"] for result in range(results)}) == 1


def test_decks_of_results_laid_over_each_other_are_all_in_the_title(bar, tmp_path):
    pytest.importorskip("matplotlib")
    other = shutil.copy(bar, tmp_path / "o.h5")
    with h5py.File(bar) as file:
        name = file.attrs["deck_name"]
    for changed, title in ((name, name), ("other.dat", f"{name}, other.dat")):
        with h5py.File(other, "r+") as file:
            file.attrs["deck_name"] = changed
        target = tmp_path / "p.svg"
        done = CliRunner().invoke(plot, [str(bar), "point.1.x", "--with", str(other), "-o", str(target)])
        assert done.exit_code == 0, done.output
        assert f"<!-- {title} -->" in target.read_text()


def test_a_path_has_equal_axes(bar):
    with open_result(bar) as file:
        x, z = resolve(file, ["point.1.x", "point.1.z"])
        (path,) = panels([Source("", file, slice(None), x, [z])])
    assert path.same_unit
    assert (path.x_label, path.y_label) == ("x of point 1 [m]", "z of point 1 [m]")
    assert np.hypot(path.curves[0].x, path.curves[0].y) == pytest.approx(2.0)


def test_results_laid_over_each_other_keep_the_colours_of_their_quantities(bar):
    with open_result(bar) as one, open_result(bar) as other:
        sources = [
            Source(label, file, slice(None), resolve(file, ["time"])[0], resolve(file, ["point.1"]))
            for label, file in (("a", one), ("b", other))
        ]
        (position, *_) = panels(sources)
    reported = [(curve.label, curve.quantity, curve.result) for curve in position.curves]
    assert reported[0] == ("a: x of point 1", 0, 0)
    assert reported[len(reported) // 2] == ("b: x of point 1", 0, 1)


@pytest.mark.parametrize(("form", "begins"), [("png", b"\x89PNG"), ("svg", b"<?xml"), ("pdf", b"%PDF")])
def test_pictures_are_of_the_form_and_the_same_every_time(draw, tmp_path, form, begins):
    pytest.importorskip("matplotlib")
    target = tmp_path / f"p.{form}"
    done = draw("point.1.x", "body.2.velocity", "-o", target)
    assert done.exit_code == 0, done.output
    first = target.read_bytes()
    assert first.startswith(begins)
    time.sleep(1.1)
    draw("point.1.x", "body.2.velocity", "-o", target)
    assert target.read_bytes() == first


def test_the_title_is_the_decks_name_and_no_mathematics(draw, tmp_path):
    pytest.importorskip("matplotlib")
    assert draw("point.1.x", "-o", tmp_path / "p.svg", "--title", r"costs $5 or $\frac$").exit_code == 0
    assert "costs $5 or $\\frac$" in (tmp_path / "p.svg").read_text()


@pytest.mark.parametrize(
    ("arguments", "reported"),
    [
        (["-o", "p.gif"], "written as .png, .svg or .pdf"),
        (["point.1.nothing", "-o", "p.png"], "no such quantity"),
        (["--x", "point.1.velocity", "-o", "p.png"], "means 3 quantities"),
        (["--from", "100", "-o", "p.png"], "no rows in this window of time"),
        (["point.1.x", "--x", "point.1.x", "-o", "p.png"], "nothing to draw over point.1.x: name another"),
        (["point.1.nothing", "-o", "p.png"], "r.h5: point.1.nothing: the result has"),
        (["point.1.x", "--x", "nothing", "-o", "p.png"], "r.h5: --x nothing: the result has"),
    ],
)
def test_what_cannot_be_drawn_is_said_and_leaves_no_file(draw, tmp_path, monkeypatch, arguments, reported):
    pytest.importorskip("matplotlib")
    monkeypatch.chdir(tmp_path)
    done = draw(*arguments)
    assert done.exit_code != 0
    assert reported in done.output + str(done.exception)
    assert sorted(path.name for path in tmp_path.iterdir()) == ["r.h5"]


def test_a_missing_library_is_named_with_its_remedy(draw, monkeypatch):
    monkeypatch.setitem(sys.modules, "matplotlib", None)
    done = draw("-o", "p.png")
    assert done.exception.exit_code == 2
    assert "flexmb plot needs matplotlib, which" in str(done.exception)


@pytest.mark.parametrize("names", [[], ["time"]])
def test_a_run_that_failed_before_its_first_row_is_told_as_the_reason(tmp_path, names):
    pytest.importorskip("matplotlib")
    path = write_result(tmp_path / "none.h5", 0, "failed", "locks at once")
    done = CliRunner().invoke(plot, [str(path), *names, "-o", str(tmp_path / "p.png")])
    assert "nothing to draw: the run is not complete, it has no rows: locks at once" in str(done.exception)


def pdf_width(content):
    """Width of a PDF's page, mm."""
    box = re.search(rb"/MediaBox \[ ?0 0 ([0-9.]+) ", content)
    return float(box[1]) / 72 * 25.4


@pytest.mark.parametrize("width", ["85", "170"])
def test_a_picture_for_print_has_the_width_asked_for(bar, tmp_path, width):
    pytest.importorskip("matplotlib")
    target = tmp_path / "p.pdf"
    done = CliRunner().invoke(plot, [str(bar), "point.1", "--width", width, "-o", str(target), "-q"])
    assert done.exit_code == 0, done.output
    assert pdf_width(target.read_bytes()) == pytest.approx(float(width), abs=0.05)


@pytest.mark.parametrize("options, message", [
    (["--font", "serif"], "--font: for pictures of print; give --width, too"),
    (["--width", "85", "--style", "nowhere.mplstyle"], "--style nowhere.mplstyle"),
    (["--width", "85", "--style", "https://example.org/a"], "nothing is fetched from a network"),
])  # fmt: skip
def test_options_of_print_that_cannot_be_met_are_usage_errors(bar, tmp_path, options, message):
    pytest.importorskip("matplotlib")
    done = CliRunner().invoke(plot, [str(bar), "point.1", *options, "-o", str(tmp_path / "p.png")])
    assert done.exit_code == 2
    assert message in done.output


def test_a_font_that_is_not_installed_is_told_once(bar, tmp_path, caplog):
    """Matplotlib logs every text that it measures; the picture is that in matplotlib's own font."""
    pytest.importorskip("matplotlib")
    pictures = []
    for k, (words, warnings) in enumerate(
        [([], 0), (["--font", "No Such Font"], 1), (["--font", "serif"], 0)]
    ):
        target = tmp_path / f"{k}.png"
        done = CliRunner().invoke(plot, [str(bar), "point.1", "--width", "85", *words, "-o", str(target)])
        assert done.exit_code == 0, done.output
        assert done.output.count("--font No Such Font: no such font is installed") == warnings
        assert done.output.count("warning") == warnings
        pictures.append(target.read_bytes())
    assert "findfont" not in caplog.text
    assert pictures[0] == pictures[1] != pictures[2]


@pytest.mark.parametrize("lines, missing", [
    ("font.family: No Such Font\n", True),
    ("font.family: serif\nfont.serif: No Such Font\n", True),
    ("font.family: serif\nfont.serif: No Such Font, DejaVu Serif\n", False),
    ("font.family: No Such Font\ntext.usetex: True\n", False),
])  # fmt: skip
def test_a_font_of_a_style_file_that_is_not_installed_is_told_once(bar, tmp_path, caplog, lines, missing):
    """LaTeX finds its own fonts; where there is none, that is told instead."""
    pytest.importorskip("matplotlib")
    (tmp_path / "s.mplstyle").write_text(lines)
    options = ["--width", "85", "--style", str(tmp_path / "s.mplstyle"), "-o", str(tmp_path / "p.png")]
    done = CliRunner().invoke(plot, [str(bar), "point.1", *options])
    family = "serif" if "serif" in lines else "No Such Font"
    assert done.output.count(f"s.mplstyle: font {family}: no such font is installed") == missing
    assert "findfont" not in caplog.text


def test_a_style_file_of_gigabytes_is_not_read(bar, tmp_path):
    """One of 3 GB that takes no room on the disk took 2.9 GB of memory, and more than 40 s."""
    pytest.importorskip("matplotlib")
    with (tmp_path / "s.mplstyle").open("wb") as file:
        file.truncate(2**21)
    options = ["--width", "85", "--style", str(tmp_path / "s.mplstyle"), "-o", str(tmp_path / "p.svg")]
    done = CliRunner().invoke(plot, [str(bar), "point.1", *options])
    assert done.exit_code == 2
    assert "it is not a style file: it has more than a megabyte" in done.output


def test_a_style_file_starts_no_program(bar, tmp_path):
    """It drew by LaTeX, with a preamble of its own, though nobody asked for it."""
    pytest.importorskip("matplotlib")
    (tmp_path / "s.mplstyle").write_text("text.usetex: True\n")
    options = ["--width", "85", "--style", str(tmp_path / "s.mplstyle"), "-o", str(tmp_path / "p.svg")]
    done = CliRunner().invoke(plot, [str(bar), "point.1", *options])
    assert done.exit_code == 2
    assert "text.usetex starts LaTeX, another program: give --latex, too" in done.output


def test_a_style_of_a_file_imports_no_package_of_its_name(bar, tmp_path, monkeypatch):
    """matplotlib takes name.mplstyle for a style of the package `name`, and imports it."""
    pytest.importorskip("matplotlib")
    monkeypatch.chdir(tmp_path)
    monkeypatch.syspath_prepend(str(tmp_path))
    Path("journal").mkdir()
    Path("journal/__init__.py").write_text("open('seen', 'w')")
    Path("journal.mplstyle").write_text("lines.linewidth: 2\n")
    done = CliRunner().invoke(
        plot, [str(bar), "point.1", "--width", "85", "--style", "journal.mplstyle", "-q"]
    )
    assert (done.exit_code, Path("seen").exists()) == (0, False), done.output


def test_a_style_file_decides_last(bar, tmp_path):
    """The style's figure colour is on the picture's edge."""
    pytest.importorskip("matplotlib")
    image = pytest.importorskip("PIL.Image")
    (tmp_path / "s.mplstyle").write_text("figure.facecolor: 102030\nsavefig.facecolor: 102030\n")
    target = tmp_path / "p.png"
    options = ["--width", "85", "--style", str(tmp_path / "s.mplstyle"), "-o", str(target), "-q"]
    assert CliRunner().invoke(plot, [str(bar), "point.1", *options]).exit_code == 0
    assert image.open(target).convert("RGB").getpixel((0, 0)) == (0x10, 0x20, 0x30)
