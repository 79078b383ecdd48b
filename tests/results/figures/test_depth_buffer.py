"""What hides what in films, pixel by pixel, against what elementary geometry says."""

import numpy as np
import pytest

pytest.importorskip("matplotlib")

from flexmb_cli.results.figures import film
from flexmb_cli.results.figures.depth_buffer import DepthBuffer
from flexmb_cli.results.figures.scene import BodyShape, Scene

RED, GREEN = np.eye(3)[0], np.eye(3)[1]
TWO_TRIANGLES = np.array([[0, 1, 2], [0, 2, 3]])


def rectangle(left, right, top, bottom, depth):
    """Two triangles whose depth is a function of x."""
    x, y = np.array([left, right, right, left]), np.array([bottom, bottom, top, top])
    return np.stack([x, y, depth(x)], axis=1).astype(float)[TWO_TRIANGLES]


def drawn(*calls):
    """The picture of 80 by 40 pixels after calls (method, arguments)."""
    buffer = DepthBuffer(80, 40)
    buffer.begin()
    for method, *arguments in calls:
        getattr(buffer, method)(*arguments)
    return buffer.picture().astype(int)


def flat(depth):
    return lambda x: np.full(len(x), depth)


def test_crossing_plates_are_seen_up_to_the_line_in_which_they_meet():
    """A plate at depth 0 and one at depth x - 40 meet at x = 40, in whatever order they are drawn."""
    red = "triangles", rectangle(10, 70, 5, 35, flat(0.0)), RED[None]
    green = "triangles", rectangle(10, 70, 5, 35, lambda x: x - 40.0), GREEN[None]
    for picture in (drawn(red, green), drawn(green, red)):
        assert (picture[5:35, 10:40] == (255, 0, 0)).all()
        # At 45 degrees the light is 0.55 + 0.45 / sqrt(2) = 0.868 of the whole, in 64 levels.
        inclined = picture[5:35, 40:70]
        assert (inclined[..., [0, 2]] == 0).all() and abs(inclined[..., 1] - 221).max() <= 4
        picture[5:35, 10:70] = 255
        assert (picture == 255).all()


def test_a_sphere_behind_a_plate_shows_the_circle_in_which_they_meet():
    """A sphere of radius 10 whose middle is 6 after the plate cuts a circle of radius 8 out of it."""
    middle = np.array([[40.0, 20.0, -6.0]])
    picture = drawn(
        ("triangles", rectangle(0, 80, 0, 40, flat(0.0)), RED[None]), ("tubes", middle, middle, 10.0, GREEN)
    )
    green = picture[..., 1] > picture[..., 0]
    assert green.sum() == pytest.approx(np.pi * 8**2, rel=0.02)
    rows, columns = np.nonzero(green)
    assert np.hypot(rows + 0.5 - 20, columns + 0.5 - 40).max() < 8.5


def test_a_line_goes_behind_a_plate():
    """It is at the plate's depth at x = 40."""
    line = np.array([[5.0, 20.0, -35.0], [75.0, 20.0, 35.0]])
    picture = drawn(("triangles", rectangle(0, 80, 0, 40, flat(0.0)), RED[None]), ("path", line, GREEN))
    green = np.flatnonzero((picture[..., 1] > 0).any(axis=0))
    assert abs(green[0] - 40) <= 1 and green[-1] in (74, 75)
    assert len(green) == green[-1] - green[0] + 1


def test_triangles_that_share_sides_leave_no_gap_and_no_pixel_twice():
    """A fan of 100 triangles round a point covers its polygon, whose area is that of the 100."""
    angles = np.linspace(0, 2 * np.pi, 101)
    rim = np.stack([40.3 + 18 * np.cos(angles), 20.1 + 18 * np.sin(angles), 0 * angles], axis=1)
    fan = np.stack([np.broadcast_to((40.3, 20.1, 0.0), (100, 3)), rim[:-1], rim[1:]], axis=1)
    picture = drawn(("triangles", fan, RED[None]))
    covered = 1 - picture[..., 1] / 255
    assert covered.sum() == pytest.approx(50 * 18**2 * np.sin(2 * np.pi / 100), rel=5e-3)
    assert covered[12:28, 32:48].min() == 1


def test_values_at_corners_go_over_into_each_other():
    """Linear over the picture: the colour k of 80 in the column k."""
    colours = np.stack([np.arange(80) / 79, np.zeros(80), np.zeros(80)], axis=1)
    corners = rectangle(0, 80, 0, 40, flat(0.0))
    picture = drawn(("triangles", corners, colours, corners[..., 0] / 80))
    assert np.abs(picture[..., 0] - 255 * np.arange(80) / 79).max() <= 4
    assert (np.diff(picture[20, :, 0]) > 0).all()


def test_closed_surfaces_show_the_side_that_faces_the_viewer():
    corners = rectangle(0, 80, 0, 40, flat(0.0))
    assert (drawn(("triangles", corners, RED[None], None, True))[..., 1] == 0).all()
    assert (drawn(("triangles", corners[:, ::-1], RED[None], None, True)) == 255).all()


def plate(number, inclined):
    """A plate from x = -1 to 1 m and y = -0.5 to 0.5 m, at z = 0 or z = x / 2."""
    x, y = np.array([-1, 1, 1, -1.0]), np.array([-0.5, -0.5, 0.5, 0.5])
    places = np.stack([x, y, x / 2 if inclined else 0 * x], axis=1)
    return BodyShape(number, "", places, TWO_TRIANGLES, np.zeros((1, 3)), np.eye(3)[None])


def test_a_film_shows_crossing_shapes_up_to_the_line_in_which_they_meet():
    """Seen along z: the flat plate left of x = 0, column 160 of 320, the inclined one right of it.

    The plates are 2 m wide and fill 320 / 1.12 pixels, columns 17.14 to 302.86.
    """
    none = np.zeros((1, 0, 3))
    shapes = plate(1, False), plate(2, True)
    scene = Scene(np.zeros(1), (), (), none, none, (), none, np.zeros(3), shapes=shapes)
    picture = film._Canvas(scene, [], film.FilmLook(320, 200, 25, "z"), {}).frame(0).astype(int)
    rows = picture[30:170]
    blue, orange = rows[..., 2] > rows[..., 0] + 50, rows[..., 0] > rows[..., 2] + 50
    assert blue[:, 18:160].all() and not blue[:, 160:].any()
    assert orange[:, 160:302].all() and not orange[:, :160].any()
    assert not (blue | orange)[:, :17].any() and not (blue | orange)[:, 303:].any()
