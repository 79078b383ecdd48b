"""Drivers by rates, whose coordinates are integrals without a card, in other dialects: closed forms."""

import numpy as np
import pytest

from flexmb_cli.errors import ModelError
from flexmb_cli.interface import solve
from flexmb_cli.run.convert import converted
from tests.run.convert.test_convert_decks import COLUMNS, EXACT, assert_alike, convert

START, END = 0.1, 1.1  # s
# An arm turns about z of the ground, a slide runs along it: joints 1 and 2; both are driven by rates.
ARM = f"""\
3 0 0 0 0 1 0 1 0 0 0 1
0 0 0 1 0 0 0
0.2 0 0 1 0 0 0
0.7 0 0 1 0 0 0
1 2 0 0 0 -0.2 0 0 0 0 1 -0.2 0 1
2 3 0.2 0 0 -0.3 0 0 1.2 0 0 0.7 0 0 0.2 1 0 -0.3 0 1
1 0 0 0 0 0 0
{START} {END} 0.05

DYNAMICS forward
MASS 2 1.5 0.05 0.1 0 0.2 0.3 0.5
MASS 3 0.8 0.02 0 0.1 0.1 0.2 0.2
GRAVITY 1.2 -9.81 0.4
"""


def ramp(t, t0, v0, t1, v1):
    """The integral of a ramp from START on, whose first value holds there."""
    x = np.clip(t - t0, 0.0, t1 - t0)
    return v0 * (t - START) + (v1 - v0) / (t1 - t0) * (x**2 / 2) + (v1 - v0) * np.clip(t - t1, 0.0, None)


def sine(t, mean, size, w, phase):
    """The integral of a sine from START on."""
    return mean * (t - START) - size / w * (np.cos(w * t + phase) - np.cos(w * START + phase))


def step(t, t0, v0, t1, v1):
    """The integral of a smooth step from START on."""
    s = np.clip((t - t0) / (t1 - t0), 0.0, 1.0)
    rise = (v1 - v0) * (t1 - t0) * (2.5 * s**4 - 3 * s**5 + s**6)
    return v0 * (t - START) + rise + (v1 - v0) * np.clip(t - t1, 0.0, None)


R, S, P = (0.3, 0.5, 0.7, 3.0), (0.2, 0.4, 5.0, 0.3), (0.2, 0.1, 0.9, -0.6)
LINES = {
    name: f"ELEMENTS\n  FUNCTION {k} {name.lower()} {' '.join(map(str, c))}\n"
    for name, k, c in (("RAMP", 1, R), ("SINE", 2, S), ("STEP", 4, P))
}
RATES = {
    "ramp": (f"{LINES['RAMP']}ELEMENTS\n  DRIVE angle-1 at=1.angle rate=1\n", lambda t: (ramp(t, *R), 0 * t)),
    "table": (
        f"{LINES['RAMP'].replace('ramp', 'table')}  DRIVE angle-1 at=1.angle rate=1\n",
        lambda t: (ramp(t, *R), 0 * t),
    ),
    "ramp and sine": (
        f"{LINES['RAMP']}{LINES['SINE']}ELEMENTS\n"
        "  FUNCTION 3 sum 1 2\n"
        "  DRIVE angle-1 at=1.angle rate=3\n"
        f"{LINES['STEP']}ELEMENTS\n"
        "  DRIVE stroke-1 at=2.stroke rate=4\n",
        lambda t: (ramp(t, *R) + sine(t, *S), step(t, *P)),
    ),
    "step, sine and line": (
        f"{LINES['STEP']}{LINES['SINE']}ELEMENTS\n"
        "  FUNCTION 6 polynomial 0.4 1.2\n"
        "  FUNCTION 3 sum 4 2 6\n"
        "  DRIVE stroke-1 at=2.stroke rate=3\n",
        lambda t: (0 * t, step(t, *P) + sine(t, *S) + 0.4 * (t - START) + 0.6 * (t**2 - START**2)),
    ),
}


def arm(folder, cards):
    at = (at for at in ("1.angle", "2.stroke") if at not in cards)
    held = "".join(f"  DRIVE held at={at} value=8\n" for at in at)
    (folder / "arm.dat").write_text(
        f"{ARM}{cards}ELEMENTS\n  FUNCTION 8 polynomial 0\n{held}TOLERANCE 1e-12\nEND\n"
    )
    return folder / "arm.dat"


def slide(path):
    """Origin (times, 3), m, of the slide, the outermost body; its number differs."""
    places = solve(path)["body/position"]
    return places[:, np.argmax(places[0, :, 0])]


@pytest.mark.long_motion
@pytest.mark.parametrize(("cards", "followed"), RATES.values(), ids=RATES)
def test_a_driver_by_a_rate_moves_alike_and_by_its_closed_form(cards, followed, tmp_path):
    young = arm(tmp_path, cards)
    vsdf, tree = (convert(young, form, tmp_path) for form in ("vsdf", "dafms"))
    back = [convert(new, "young", tmp_path, f"back{k}") for k, new in enumerate((vsdf, tree))]
    crossed = [convert(vsdf, "dafms", tmp_path, "crossed"), convert(tree, "vsdf", tmp_path, "crossed")]
    assert_alike(young, [vsdf, back[0]], EXACT)
    assert_alike(young, [tree, crossed[0]], COLUMNS)
    assert_alike(tree, [back[1], crossed[1]], EXACT)
    t = np.linspace(START, END, 21)
    angle, stroke = followed(t)
    way = np.column_stack([np.cos(angle), np.sin(angle), 0 * t])
    for path in (young, vsdf, tree, *back, *crossed):
        found = slide(path)
        # In a tree the origin lies at the hinge.
        assert np.abs(found - (found[0, 0] + stroke)[:, None] * way).max() < EXACT


# A free body whose x follows the integral of a ramp from `{0}` on.
LOOSE = f"""\
2 1 0 0 0 0 0 0 0 0 0 1
0 0 0 1 0 0 0
{{0}} 0 0 1 0 0 0
2 1 {{0}} 0 0
1 0 0 0 0 0 0
{START} {END} 0.05

DYNAMICS forward
MASS 2 1.5 0 0 0 0.2 0.3 0.5
GRAVITY 0 -9.81 0
{LINES["RAMP"]}ELEMENTS
  DRIVE drive-1 driver=1 rate=1
TOLERANCE 1e-12
END
"""


def loose(folder, start):
    (folder / "loose.dat").write_text(LOOSE.format(start))
    return folder / "loose.dat"


def test_a_coordinate_of_a_body_by_a_rate_moves_by_its_closed_form(tmp_path):
    young = loose(tmp_path, 0.0)
    vsdf = convert(young, "vsdf", tmp_path)
    t = np.linspace(START, END, 21)
    wanted = np.column_stack([ramp(t, *R), -9.81 / 2 * (t - START) ** 2, 0 * t])
    for path in (young, vsdf, convert(vsdf, "young", tmp_path)):
        moving = solve(path)["body/position"]
        assert min(np.abs(moving[:, k] - wanted).max() for k in range(moving.shape[1])) < EXACT


def test_an_integral_that_begins_elsewhere_is_refused_in_vsdf_with_the_remedy(tmp_path):
    with pytest.raises(ModelError, match=r"it begins at 0\.3 .*VSDF begins integrals at 0: lay the origin"):
        converted(str(loose(tmp_path, 0.3)), "vsdf")
