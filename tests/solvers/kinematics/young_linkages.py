"""YOUNG decks of planar linkages in any position, and what a user reads when one is run."""

import math

from flexmb_cli.errors import compiler_style
from flexmb_cli.run.outcome import RunOptions
from flexmb_cli.run.solution import run_deck

SECTIONS = (
    "drivers", "points", "spherical", "universal", "revolute", "cylindrical", "translational", "screw",
    "simplified", "distance", "ground",
)  # fmt: skip
AT_REST = (1, 0, 0, 0, 0, 0, 0)
HELD = tuple((2, direction, 0) for direction in range(1, 6))


def young(bodies, time, cards="", **sections):
    """A deck, one record a line: counts on line 1, the bodies from line 2 on."""
    records = [bodies, *(sections.get(name, ()) for name in SECTIONS), [time]]
    lines = [" ".join(str(len(items)) for items in records[:-1])]
    lines += [" ".join(f"{value:.15g}" for value in item) for items in records for item in items]
    return "\n".join(lines) + "\n" + cards


def turned(x, y, angle):
    """Estimate of a body at (x, y, 0), turned about z."""
    return x, y, 0, math.cos(angle / 2), 0, 0, math.sin(angle / 2)


def four_bar_bodies(ground, crank, coupler, rocker, angle):
    """Ground, crank, coupler, rocker in place; the rocker's pivot is at (ground, 0)."""
    x, y = crank * math.cos(angle), crank * math.sin(angle)
    diagonal = math.hypot(x - ground, y)
    inside = (diagonal**2 + rocker**2 - coupler**2) / (2 * diagonal * rocker)
    direction = math.atan2(y, x - ground) - math.acos(min(1.0, max(-1.0, inside)))
    end = ground + rocker * math.cos(direction), rocker * math.sin(direction)
    along = math.atan2(end[1] - y, end[0] - x)
    return turned(0, 0, 0), turned(0, 0, angle), turned(x, y, along), turned(*end, direction)


def four_bar(ground, crank, coupler, rocker, function, time):
    """Crank of body 2 driven by C + B t + A t²/2; spherical joint on line 7, universal 8, revolute 9."""
    return young(
        four_bar_bodies(ground, crank, coupler, rocker, function[0]),
        time,
        drivers=[(2, 6, *function)],
        spherical=[(2, 3, crank, 0, 0, 0, 0, 0)],
        universal=[(3, 4, coupler, 0, 0, 0, 0, 0, coupler, 1, 0, 0, 0, 1)],
        revolute=[(1, 4, ground, 0, 0, -rocker, 0, 0, ground, 0, 1, -rocker, 0, 1)],
        simplified=HELD,
        ground=[AT_REST],
    )


def slider_crank(crank, rod, function, time, angle=None):
    """Crank driven about z; or the slider along x, where the first crank `angle` is given."""
    first = function[0] if angle is None else angle
    x, y = crank * math.cos(first), crank * math.sin(first)
    slide = x + math.sqrt(max(0.0, rod**2 - y**2))
    slides = range(2, 7)
    return young(
        (turned(0, 0, 0), turned(0, 0, first), turned(x, y, math.atan2(-y, slide - x)), turned(slide, 0, 0)),
        time,
        drivers=[(2, 6, *function) if angle is None else (4, 1, *function)],
        spherical=[(2, 3, crank, 0, 0, 0, 0, 0)],
        universal=[(3, 4, rod, 0, 0, 0, 0, 0, rod, 1, 0, 0, 0, 1)],
        simplified=(*HELD, *((4, direction, 0) for direction in slides)),
        ground=[AT_REST],
    )


def gear(time, start=0.0, rate=1.0):
    """Two bodies about z with equal e3, the first one driven: at half a turn θ and 2π - θ cross."""
    return young(
        (turned(0, 0, 0), turned(0, 0, start), turned(3, 0, start)),
        time,
        drivers=[(2, 6, start, rate, 0)],
        revolute=[(1, k, 3 * (k - 2), 0, 0, 0, 0, 0, 3 * (k - 2), 0, 1, 0, 0, 1) for k in (2, 3)],
        distance=[(3, 2, 6, 0)],
        ground=[AT_REST],
    )


def outcome(folder, deck, name="IN.dat", **options):
    """What became of a deck's text, with its results in `folder`."""
    path = folder / name
    path.write_text(deck)
    return run_deck(str(path), RunOptions(folder=str(folder), **options))


def reported(found):
    """What a user reads of a run, deck lines and carets left out."""
    return [compiler_style("IN.dat", [fault]) for fault in found.faults]
