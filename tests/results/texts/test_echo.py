"""The echo of a deck."""

from pathlib import Path

from flexmb_cli.dialects.settings import apply_settings
from flexmb_cli.dialects.vsdf.build import build_vsdf
from flexmb_cli.results.texts.echo import echo
from tests.dialects.vsdf.vsdf_decks import changed
from tests.dialects.vsdf.vsdf_decks import read as read_deck
from tests.dialects.young.young_decks import one_body, read

DECK = one_body(["1 4 0 1.5D0 -.5"], ["1 1 0", "1 2 0", "1 3 0", "1 5 0", "1 6 0"])

EXPECTED = """
IN.dat: read as a YOUNG deck, which begins with twelve integers
 line  name                    value  unit     meaning
    1  counts.NBODY                1  -        number of bodies
    1  counts.NDRIVE               1  -        number of drivers
    3  driver.1.body               1  -        number of the body
    3  driver.1.direction          4  -        1 2 3: along x y z; 4 5 6: about x y z
    3  driver.1.C                  0  rad      angle at t = 0
    3  driver.1.B              1.5D0  rad/s    angular velocity at t = 0
    3  driver.1.A                -.5  rad/s^2  angular acceleration
    4  simplified.1.value          0  m        value of the coordinate
    7  simplified.4.value          0  rad      angle v: e = sin(v/2)
    9  time.start                  0  s        time of the first row, Ti
--set  time.end                 2.50  s        no row is later, Te
    9  time.step                 0.5  s        time between rows, dT
"""


def test_the_echo_shows_line_name_spelling_unit_and_meaning_in_columns():
    lines = echo(apply_settings(read(DECK), ["time.end=2.50"])).splitlines()
    for line in EXPECTED.strip("\n").splitlines():
        assert line in lines
    assert len(lines) == 2 + 12 + 7 + 5 + 5 * 3 + 3


def test_the_echo_ends_with_a_line_end_and_has_no_trailing_blanks():
    text = echo(read(DECK))
    assert text.endswith("\n")
    assert all(line == line.rstrip() for line in text.splitlines())


def test_the_echo_of_an_empty_pin_shows_where_its_node_is_held():
    """Node 4 of body 1 stands at (1, 0, 1) in a body whose origin is at (0.5, 0, 2)."""
    pins = "PINN\n    1    4  111\n    1    3  100       7.0\nGRAV"
    deck = read_deck(changed(("POSI\n", "POSI\n    1       0.5       0.0       2.0\n"), ("GRAV", pins)))
    build_vsdf(deck, Path())
    lines = [line.split()[:3] for line in echo(deck).splitlines()]
    assert [line[2] for line in lines if line[1].startswith("pin.1.p.")] == ["1.5", "0", "3"]
    assert [line[2] for line in lines if line[1].startswith("pin.2.p")] == ["7.0", "0.0", "0.0"]


def test_the_echo_names_the_axes_of_velocities_and_forces_on_flexible_bodies():
    cards = "VELO\n    1       1.0\nFORC\n    1    2       1.0\nGRAV"
    text = echo(read_deck(changed(("GRAV", cards))))
    assert "velocity of the body frame's origin (FLEX: n1), global axes, x" in text
    assert "angular velocity, axes of the body frame (FLEX: e1 from n1 to n2), z" in text
    assert "1: in axes of the body frame (FLEX: e1 from n1 to n2), else global" in text
