"""Mechanisms are assembled nearest to their estimates, however far these are.

Expected: closed forms of slider-cranks; for random linkages (random_linkages.py) the position they were built
at, and what scipy.optimize.least_squares finds from the estimates and from places about them.
"""

import math
from functools import cache
from pathlib import Path

import numpy as np
import pytest

from flexmb_cli.deck.text import decode
from flexmb_cli.dialects.recognise import dialect_named, read_deck
from flexmb_cli.errors import FlexmbError
from flexmb_cli.model.mechanism import Mechanism
from flexmb_cli.solvers.constrained.flexible_dynamics import FlexibleDynamics
from flexmb_cli.solvers.constrained.young_dynamics import ForwardDynamics
from flexmb_cli.solvers.kinematics.analysis import KinematicAnalysis
from tests.solvers.kinematics.random_linkages import TYPES, Judge, linkage

SEEDS = 100  # of each type in the campaign
NEAREST = 1.0 + 1e-6


def assembled(text):
    """The coordinates (bodies, 7) at the start of a YOUNG deck."""
    model = dialect_named("young").build(read_deck(decode("x.dat", text.encode())), Path())[0]
    if isinstance(model, Mechanism):
        analysis = KinematicAnalysis(model)
        next(analysis.rows())
        return analysis.state[0].reshape(-1, 7)
    return ForwardDynamics(model).assembled(0.0).reshape(-1, 7)


def masses(bodies):
    cards = "".join(f"MASS {k + 2} 1 0 0 0 0.1 0.1 0.1\n" for k in range(bodies - 1))
    return f"DYNAMICS forward\n{cards}END\n"


def slider_crank(angle, at, bar, cards=""):
    """Two bars from the origin to a slider that is driven to x = `at`, estimated at angle and -angle."""
    c, s = math.cos(0.5 * angle), math.sin(0.5 * angle)
    return f"""4 1 0 1 0 1 1 1 0 0 0 1
0 0 0 1 0 0 0
0 0 0 {c} 0 0 {s}
{bar * math.cos(angle)} {bar * math.sin(angle)} 0 {c} 0 0 {-s}
{at} 0 0 1 0 0 0
4 1 {at} 0 0
2 3 {bar} 0 0 0 0 0
1 2 0 0 0 0 0 0 0 0 1 0 0 1
3 4 {bar} 0 0 0 0 0 {bar} 0 1 0 0 1
1 4 0 0 0 0 0 0 1 0 0 1 0 0 0 1 0 0 0 1
1 0 0 0 0 0 0
0 0.1 0.1
{cards}"""


@pytest.mark.parametrize("cards", ["", masses(4)], ids=["kinematics", "dynamics"])
@pytest.mark.parametrize(
    ("angle", "at", "bar"),
    [(0.3, 0.4, 0.5), (0.1, 0.4, 0.5), (0.0, 0.4, 0.5), (-0.3, 0.4, 0.5), (0.2, 0.4, 0.6)],
)
def test_a_slider_crank_closes_on_the_side_of_its_estimate(angle, at, bar, cards):
    """The bars' joint stands at ±√(bar² - (at/2)²); bars in line may go to either side."""
    height = math.sqrt(bar**2 - 0.25 * at**2)
    found = assembled(slider_crank(angle, at, bar, cards))[2, :2]
    if angle == 0.0:
        found[1] = abs(found[1])
    assert found == pytest.approx([0.5 * at, math.copysign(height, angle)], abs=1e-12)


VSDF = """VSDF slider-crank, driven at its slider
BODY
    1,RIGD
    2,RIGD
    3,RIGD
RIGI
    1,1.0,0.0,0.0,0.0
    0.1,0.1,0.1,0.0,0.0,0.0
    2,1.0,0.0,0.0,0.0
    0.1,0.1,0.1,0.0,0.0,0.0
    3,1.0,0.0,0.0,0.0
    0.1,0.1,0.1,0.0,0.0,0.0
POSI
    2,{x},{y},0
    3,0.4,0,0
EULP
    1,{c},0,0,{s}
    2,{c},0,0,-{s}
NODE
    1,1,0.5,0,0
    2,1,0,0,0
    0,1,0,0,0
    0,2,0,0,0.5
    1,2,0,0,0
    1,3,0,0,0.5
    2,2,0.5,0,0
    2,3,0.5,0,0.5
    3,1,0,0,0
    3,2,0,0,0.5
    0,3,0.5,0,0
    0,4,0,-0.5,0
    3,3,0.5,0,0
    3,4,0,-0.5,0
JOIN
    1,SPHE,1,1,,2,1,,,
    2,REVO,0,1,2,1,2,3,,
    3,CYLI,2,2,3,3,1,2,,
    4,TRAN,0,1,3,3,1,3,4,4
MOTN
    1,TRAX,3,1,0.4,0.0,0.0,0.0
TIME
    0.1,0.1,0.0
END
STAR
STOP
"""


@pytest.mark.parametrize("angle", [0.3, 0.1, 0.02])
def test_a_slider_crank_of_a_vsdf_deck_closes_on_the_side_of_its_positions(angle):
    """The bars' joint stands at √(0.5² - 0.2²)."""
    x, y = 0.5 * math.cos(angle), 0.5 * math.sin(angle)
    text = VSDF.format(x=x, y=y, c=math.cos(0.5 * angle), s=math.sin(0.5 * angle))
    deck = read_deck(decode("x.vsdf", text.encode()))
    mechanism = dialect_named("vsdf").build(deck, Path())[0]
    found = FlexibleDynamics(mechanism).assembled(0.0)[7:9]
    assert found == pytest.approx([0.2, math.sqrt(0.21)], abs=1e-12)


@cache
def judged(kind, seed, restarts):
    """A linkage, estimates of it, its judge, and the distance of the nearest assembly."""
    made = linkage(kind, seed)
    estimates = made.estimates()
    judge = Judge(made, estimates)
    assert judge.closed(made.bodies), "the linkage is built closed"
    return made, estimates, judge, judge.nearest(restarts)


def outcome(kind, seed, restarts, cards=""):
    """The distance of the assembly from the estimates over that of the nearest, None if there is none."""
    made, estimates, judge, nearest = judged(kind, seed, restarts)
    try:
        q = assembled(made.deck(estimates, cards and masses(len(made.bodies))))
    except FlexmbError:
        return None
    poses = [(x[:3], x[3:]) for x in q]
    assert judge.closed(poses)
    return judge.distance(poses) / nearest


@pytest.mark.parametrize("kind", TYPES)
def test_a_random_linkage_closes_on_its_nearest_assembly(kind):
    """Every other type with masses; the campaign takes all both ways."""
    number = TYPES.index(kind)
    assert outcome(kind, 2 + number % 2, 0, number % 2 and "masses") <= NEAREST


@pytest.mark.campaign
@pytest.mark.parametrize("cards", ["", "masses"], ids=["kinematics", "dynamics"])
def test_a_thousand_random_linkages_close_on_their_nearest_assembly(cards, capsys):
    """All can be closed; at least 99.5 % must close, and 99 % on the nearest assembly that is known."""
    found = {kind: [outcome(kind, seed, 8, cards) for seed in range(SEEDS)] for kind in TYPES}
    closed = {kind: sum(x is not None for x in ratios) for kind, ratios in found.items()}
    nearest = {kind: sum(x is not None and x <= NEAREST for x in ratios) for kind, ratios in found.items()}
    with capsys.disabled():
        print(*(f"\n{kind}: {closed[kind]} close, {nearest[kind]} nearest of {SEEDS}" for kind in TYPES))
    assert sum(closed.values()) >= 0.995 * SEEDS * len(TYPES)
    assert sum(nearest.values()) >= 0.99 * SEEDS * len(TYPES)


def test_a_mechanism_far_from_the_origin_closes_as_near_it():
    """Lengths are measured in the size of the mechanism, not in its distance from the origin."""
    made = linkage("four_bar", 5)
    shift = np.array([300.0, -200.0, 100.0])
    made.bodies = [made.bodies[0], *((r + shift, p) for r, p in made.bodies[1:])]
    for k, (kind, i, j, (P_i, P_j), v) in enumerate(made.joints):
        made.joints[k] = kind, i, j, [P_i + shift * (i == 0), P_j + shift * (j == 0)], v
    estimates = made.estimates()
    judge = Judge(made, estimates)
    poses = [(x[:3], x[3:]) for x in assembled(made.deck(estimates))]
    assert judge.distance(poses) <= NEAREST * judge.nearest(0)
