"""Pictures for print at all widths: nothing is clipped, nothing covers anything."""

from itertools import pairwise

import numpy as np
import pytest
from click.testing import CliRunner

from flexmb_cli.cli.plot import plot
from flexmb_cli.results.figures.curves import Curve, Panel
from flexmb_cli.results.figures.label_fitting import Letters
from flexmb_cli.results.figures.look import Look
from flexmb_cli.results.figures.plots import fitted_figure, picture
from flexmb_cli.results.quantities.readable import Readable
from tests.results.figures.turning_bar import write_bar

matplotlib = pytest.importorskip("matplotlib")
TIMES = np.linspace(0, 0.5, 200)
NAMES = ("von Mises stress of body 2 element 1234", "x", "largest von Mises stress of body 2", "y")


def figure_of(look, *panels):
    with matplotlib.rc_context():
        matplotlib.rcdefaults()
        look.apply()
        figure = fitted_figure(panels, "", look)
        figure.draw_without_rendering()
    return figure


def panel(names):
    """Waves that leave no corner free."""
    waves = [np.cos(40 * TIMES + k) * 1e6 for k in range(len(names))]
    return Panel("time [s]", "Pa", tuple(Curve(*pair, k) for k, pair in enumerate(named(names, waves))))


def named(names, waves):
    return [(name, TIMES, wave) for name, wave in zip(names, waves, strict=True)]


@pytest.mark.parametrize("count", [4, 6])
@pytest.mark.parametrize("millimetres", [40, 60, 85, 180])
def test_nothing_is_clipped_and_legends_cover_no_curve(millimetres, count):
    """The boxes of labels and legends lie within the picture, and no two numbers of an axis meet."""
    waves = panel((NAMES * 2)[:count])
    figure = figure_of(Look(millimetres, size=8.0), waves, waves)
    for axis in figure.axes:
        legend = axis.get_legend().get_window_extent()
        assert not legend.overlaps(axis.bbox)
        for box in (legend, axis.yaxis.label.get_window_extent(), axis.xaxis.label.get_window_extent()):
            assert box.x0 >= -1 and box.x1 <= figure.bbox.x1 + 1
            assert box.y0 >= -1 and box.y1 <= figure.bbox.y1 + 1
        assert not legend.overlaps(axis.xaxis.label.get_window_extent()) or not axis.get_xlabel()
        low, high = axis.get_xlim()
        ticks = zip(axis.get_xticks(), axis.get_xticklabels(), strict=True)
        boxes = [text.get_window_extent() for x, text in ticks if low <= x <= high]
        assert len(boxes) >= 2
        assert all(one.x1 < other.x0 for one, other in pairwise(boxes))
        assert axis.bbox.width > 0.4 * figure.bbox.width


def test_a_legend_that_covers_nothing_stays_inside():
    flat = Panel("time [s]", "m", tuple(Curve(name, TIMES, TIMES * k) for k, name in enumerate("ab")))
    (axis,) = figure_of(Look(85, size=8.0), flat).axes
    legend = axis.get_legend().get_window_extent()
    assert axis.bbox.x0 <= legend.x0 and legend.y1 <= axis.bbox.y1 and legend.y0 >= axis.bbox.y0


def test_pictures_for_print_have_300_dots_per_inch():
    """85 mm are 85/25.4 in, 1003 dots of a PNG; its width stands in bytes 16 to 20 (PNG, section 11.2.2)."""
    flat = Panel("time [s]", "m", (Curve("a", TIMES, TIMES, 0),))
    file = picture([flat], "png", look=Look(85, size=8.0))
    assert abs(int.from_bytes(file[16:20], "big") - 85 / 25.4 * 300) <= 1


def test_letters_that_leave_no_room_are_a_usage_error(deck, mechanism, rows, tmp_path):
    """Matplotlib drew curves of no size, with a warning in its own words."""
    bar = write_bar(tmp_path / "r.h5", deck, mechanism, rows, np.arange(7.0))
    options = ["--width", "20", "--font-size", "16", "-o", str(tmp_path / "p.png")]
    done = CliRunner().invoke(plot, [str(bar), "point.1", "body.2.velocity", *options])
    assert done.exit_code == 2
    assert "letters of 16 points leave no room for curves in 20 mm" in done.output
    assert not (tmp_path / "p.png").exists()


@pytest.mark.parametrize("millimetres, points, words", [
    (40, 10, ("principal stress", "body 1 element 1000001", "1")),
    (40, 8, ("principal stress", "body 1 element 1000001", "1")),
    (60, 14, ("node of the largest von Mises stress", "body 1", "")),
])  # fmt: skip
def test_labels_keep_three_fifths_of_the_size_that_was_asked_for(millimetres, points, words):
    """They got smaller without limit, down to 1.6 points; asked for were 0.6 of the size, and 5 points."""
    curve = Curve("", TIMES, 3e5 * np.cos(90 * TIMES), 0, words=Readable(*words))
    figure = figure_of(Look(millimetres, size=points), Panel("time [s]", "Pa", (curve,)))
    (axis,) = figure.axes
    assert axis.yaxis.label.get_fontsize() >= 0.999 * max(0.6 * points, min(5, points))
    assert axis.yaxis.label.get_window_extent().height <= 1.01 * axis.bbox.height
    assert axis.bbox.width > 0.2 * figure.bbox.width


def test_lines_of_labels_end_before_units_and_not_within_them():
    """The colour bar of a study ended a line with "[N"."""
    wrapped = Letters("axes.labelsize").wrapped
    assert wrapped("tspring.1.stiffness [N m/rad]", 0.1) == "tspring.1.stiffness\n[N m/rad]"
    assert wrapped("body [1 of 2", 0.1) == "body\n[1\nof\n2"


def test_a_panel_narrower_than_a_seventh_of_its_picture_is_refused():
    """Its label had 1.6 of 4 points, and the numbers below it lay on each other."""
    words = Readable("principal stress", "body 1 element 1000001", "1")
    curve = Curve("", TIMES / 10, 3e5 * np.cos(90 * TIMES), 0, words=words)
    with pytest.raises(ValueError, match="letters of 4 points leave no room for curves in 20 mm"):
        figure_of(Look(20, size=4.0), Panel("time [s]", "Pa", (curve,)))
