"""Style files decide last, and labels of every size fit: their boxes lie in the picture."""

from itertools import pairwise

import numpy as np
import pytest
from click.testing import CliRunner

from flexmb_cli.cli.plot import plot
from flexmb_cli.results.figures.curves import Curve, Panel
from flexmb_cli.results.figures.label_fitting import number_boxes
from flexmb_cli.results.figures.look import Look
from flexmb_cli.results.figures.plots import fitted_figure
from flexmb_cli.results.quantities.readable import Readable
from tests.results.figures.turning_bar import write_bar

matplotlib = pytest.importorskip("matplotlib")
TIMES = np.linspace(0, 0.05, 50)
STRESS = ("principal stress", "body 1 element 10001", "1")
VELOCITY = ("velocity", "body 3", "x")


def panel(words, unit, count=1):
    curves = [
        Curve(f"{k}", TIMES, 3e5 * np.cos(k + 90 * TIMES), k, words=Readable(*words)) for k in range(count)
    ]
    return Panel("time [s]", unit, tuple(curves))


def figure_of(look, *panels, title=""):
    with matplotlib.rc_context():
        matplotlib.rcdefaults()
        if look:
            look.apply()
        figure = fitted_figure(panels, title, look)
        figure.draw_without_rendering()
    return figure


def written(folder, lines):
    (folder / "s.mplstyle").write_text(lines)
    return str(folder / "s.mplstyle")


LOOKS = [
    None, Look(60, size=12.0), Look(40, size=8.0),
    *(Look(85, size=8.0, style=name) for name in ("ggplot", "classic", "seaborn-v0_8-talk")),
    "axes.labelsize: 12",
]  # fmt: skip


@pytest.mark.parametrize("look", LOOKS, ids=str)
def test_labels_lie_beside_their_panels_and_numbers_do_not_meet(look, tmp_path):
    """Sizes of letters came from --font-size alone; pictures for the screen wrapped nothing."""
    if isinstance(look, str):
        look = Look(85, size=8.0, style=written(tmp_path, look))
    figure = figure_of(look, panel(STRESS, "Pa"), panel(VELOCITY, "m/s", 3), title="several words " * 12)
    labels = [axis.yaxis.label for axis in figure.axes]
    words = [" ".join(label.get_text().split()) for label in labels]
    assert words == ["principal stress 1 of body 1 element 10001 [Pa]", "velocity x of body 3 [m/s]"]
    for axis, label in zip(figure.axes, labels, strict=True):
        box = label.get_window_extent()
        assert box.height <= 1.01 * axis.bbox.height
        assert box.x0 >= -1 and box.y0 >= -1 and box.y1 <= figure.bbox.y1 + 1
        for direction, ends in ((axis.xaxis, ("x1", "x0")), (axis.yaxis, ("y1", "y0"))):
            boxes = number_boxes(direction)
            assert len(boxes) >= 2
            assert all(getattr(one, ends[0]) < getattr(other, ends[1]) for one, other in pairwise(boxes))
        assert axis.bbox.width > 0.25 * figure.bbox.width
    (title,) = figure.texts or [figure._suptitle]
    assert title.get_window_extent().x0 >= -1


def test_a_style_file_decides_on_lines_colours_grid_and_legend(tmp_path):
    """Each was passed to matplotlib by flexmb, so that the style changed nothing."""
    style = written(tmp_path, (
        "lines.linewidth: 6\naxes.prop_cycle: cycler('color', ['112233', '445566'])\n"
        "axes.grid: True\ngrid.color: red\ngrid.linewidth: 3\nlegend.loc: lower left\n"
        "legend.frameon: True\naxes.xmargin: 0.2\n"
    ))  # fmt: skip
    (axis,) = figure_of(Look(85, size=8.0, style=style), panel(VELOCITY, "m/s", 3)).axes
    assert [line.get_color() for line in axis.lines] == ["#112233", "#445566", "#112233"]
    assert [line.get_linewidth() for line in axis.lines] == [6, 6, 6]
    assert [line.get_linestyle() for line in axis.lines] == ["-", "-", "--"]
    grid = axis.xaxis.get_gridlines()[0]
    assert (grid.get_visible(), grid.get_color(), grid.get_linewidth()) == (True, "red", 3)
    legend = axis.get_legend().get_window_extent()
    assert (
        legend.x0 < axis.bbox.x0 + 0.1 * axis.bbox.width and legend.y0 < axis.bbox.y0 + 0.1 * axis.bbox.height
    )
    assert axis.get_legend().get_frame_on()
    assert axis.get_xlim()[0] == pytest.approx(-0.2 * TIMES[-1])


def test_a_style_without_grid_has_none(tmp_path):
    style = written(tmp_path, "axes.grid: False\n")
    (axis,) = figure_of(Look(85, size=8.0, style=style), panel(VELOCITY, "m/s")).axes
    assert not axis.xaxis.get_gridlines()[0].get_visible()


def test_a_style_that_crops_leaves_the_width_that_was_asked_for(deck, mechanism, rows, tmp_path):
    """Styles of journals have savefig.bbox: tight.  The width of a PNG stands in its bytes 16 to 20."""
    bar = write_bar(tmp_path / "r.h5", deck, mechanism, rows, np.arange(7.0))
    style, target = written(tmp_path, "savefig.bbox: tight\n"), tmp_path / "p.png"
    done = CliRunner().invoke(
        plot, [str(bar), "point.1", "--width", "85", "--style", style, "-o", str(target)]
    )
    assert done.exit_code == 0, done.output
    assert abs(int.from_bytes(target.read_bytes()[16:20], "big") - 85 / 25.4 * 300) <= 1


def test_settings_that_are_no_style_are_left_out_without_a_word(deck, mechanism, rows, tmp_path, recwarn):
    """matplotlib warned of a backend with a line of its source; that dpi ended with exit code 3."""
    bar = write_bar(tmp_path / "r.h5", deck, mechanism, rows, np.arange(7.0))
    style, target = written(tmp_path, "backend: svg\nfigure.dpi: 1e9\n"), tmp_path / "p.png"
    done = CliRunner().invoke(
        plot, [str(bar), "point.1", "--width", "85", "--style", style, "-o", str(target)]
    )
    assert done.exit_code == 0, done.output
    assert abs(int.from_bytes(target.read_bytes()[16:20], "big") - 85 / 25.4 * 300) <= 1
    assert not recwarn.list


@pytest.mark.parametrize("style, words", [
    ("nonsense", "--style nonsense: no such file, and no style of matplotlib, such as"),
    ("gplot", "--style gplot: no such file, and no style of matplotlib, such as ggplot, has this name"),
    (b"\xff\xfe\x00", "it is not a style file: it is not text in UTF-8"),
    (b"axes.grid: True\nlines.linewidht: 3\n",
     "line 2: matplotlib has no setting lines.linewidht; lines.linewidth is one"),
    (b"axes.grid: maybe\n", "line 1: axes.grid cannot be maybe"),
    (b"axes.grid True\n", "line 1 has no colon between a setting and its value"),
])  # fmt: skip
def test_what_is_no_style_is_said_in_words(deck, mechanism, rows, tmp_path, caplog, style, words):
    """The message was that of matplotlib, with the class of the path; its log reached the screen, too."""
    bar = write_bar(tmp_path / "r.h5", deck, mechanism, rows, np.arange(7.0))
    if isinstance(style, bytes):
        (tmp_path / "s.mplstyle").write_bytes(style)
        style = str(tmp_path / "s.mplstyle")
    options = ["--width", "85", "--style", style, "-o", str(tmp_path / "p.png")]
    done = CliRunner().invoke(plot, [str(bar), "point.1", *options])
    assert done.exit_code == 2
    assert words in done.output and "Posix" not in done.output
    assert not [record for record in caplog.records if record.name.startswith("matplotlib")]
