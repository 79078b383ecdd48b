"""Every card of functions and elements of DAFMS decks: driven runs against runs by their effort.

The driven coordinate follows a polynomial given in advance: no run is compared with itself.
"""

import functools
import re
from dataclasses import dataclass

import numpy as np
import pytest

from flexmb_cli.dialects.dafms.cards import EXTENSIONS
from flexmb_cli.dialects.elements_block.old_cards import LINES
from flexmb_cli.dialects.elements_block.writer import spline_block
from tests.dialects.dafms.test_dafms_elements import TWO_LINKS, card, function, integers, reals, rows_of

pytestmark = pytest.mark.long_motion
POWERS = (1.2, 0.9, -0.7)
REVERSING = (1.2, -5.0, -4.0)  # comes to rest after 0.1 s, and goes back
# Numbers of steps and their lengths, s: of the driven run and of the runs by its effort.
FINE, SPARSE = ("  200", "     0.001"), ("    4", "      0.05")
SLOPES = function(5, "polynomial", 0, 0, 0, 40)
CASES = {
    "FUNC": [
        function(5, "spline", 0, 0.3, 0.1, 1.1, 0.2, 0.8, 0.3, 0.4),
        "ELEMENTS\n  MOTOR motf-1 at=2.r3 effort=5",
    ],
    "MOTF": [function(5, "sine", 0, 3, 5), "ELEMENTS\n  MOTOR motf-1 at=2.r3 effort=5"],
    "PREF": [function(5, "sine", 0, 0.7, 3), "ELEMENTS\n  DRIVE pref-1 at=2.r3 value=5"],
    "HSPR": [
        SLOPES,
        "ELEMENTS\n  SPRING hspr-1 at=1.r3 stiffness=8 rest=0.1 damping=0.4 preload=1.6 curve=5",
    ],
    "HSTO": ["ELEMENTS\n  STOP hsto-1 at=1.r3 lower=-1 upper=-0.2 stiffness=60 damping=0.3"],
    "LSPR": [
        SLOPES,
        "ELEMENTS\n"
        "  SPRING lspr-1 from=0(1,2,0) to=2(0.6,0,0) curve=5 stiffness=30 rest=1.2 "
        "damping=0.5 preload=2",
    ],
    "CABL": ["ELEMENTS\n  CABLE cabl-1 from=0(1,2,0) to=1(0.6,0,0) stiffness=80 rest=1.2 damping=0.1"],
    "BUSH": [
        "ELEMENTS\n"
        "  BUSHING bush-1 from=0(1,2,0) to=2(0.6,0,0) k=(9,16,25) kr=(0.6,0.9,1.6) "
        "c=(0.5,0.6,0.7) cr=(0.2,0.3,0.4)"
    ],
    "COUP": ["ELEMENTS\n  COUPLING coup-1 1.r3=2 2.r3=3"],
    "FRIC": [
        "ELEMENTS\n"
        "  FRICTION fric-1 joint=1 dynamic=0.2 static=0.3 stribeck=0.1 creep=0.01 radius=0.05 "
        "preload=3"
    ],
    "SPRI": [card("SPRI", integers(1, 3) + reals(8, 0.4))],
    "DAMP": [card("DAMP", integers(1, 3) + reals(0.7))],
    "MOTR": [card("MOTR", integers(1, 3) + reals(0.9))],
}
# Bodies, constraints, settings and pictures, and tables of loads.
OTHERS = {
    "GRAV",
    "UNCO",
    "LOOP",
    "PROD",
    "PRES",
    "TABL",
    "TABM",
    "ELDA",
    "NROT",
    "GSTF",
    "TOLR",
    "METH",
    "GEOM",
}
METHODS = ["dop853", "radau"]  # `METH 4` takes Radau's method where there are elements
NEAR = 1e-8  # rad, m, rad/s, m/s, and N or N m relative to the largest
SECOND = -0.8  # rad/s, of the second link where gears couple it: 2 y1 + 3 y2 = 0
# The first hinge slides along axis 1, or turns about and slides along axis 3.
SLIDE = TWO_LINKS.replace("    1    0    0    0    0\n", "    1    1    1    0    0\n", 1).replace(
    "    1    1    0    0    1\n", "    1    0    0    0    0\n", 1
)
SLEEVE = TWO_LINKS.replace("    1    0    0    0    0\n", "    1    1    0    0    1\n", 1).replace(
    "Y(L)\n", "Y(L)\n" + 2 * "       0.0" + "\n", 1
)
# A third link like the second, on its end.
THREE_LINKS = (
    re.sub(r"^(?!\A)    2(.*\n)", r"\g<0>    3\1", TWO_LINKS, flags=re.MULTILINE)
    .replace("    2    3\n", "    3    3\n", 1)
    .replace("    0    1\nMASS", "    0    1    2\nMASS")
)


@dataclass(frozen=True)
class Case:
    """Cards on a model whose first hinge is driven in one freedom: its number, that among all, a motion."""

    cards: list[str]
    model: str = TWO_LINKS
    freedom: int = 3
    place: int = 0
    powers: tuple[float, float, float] = POWERS
    speeds: tuple[float, ...] = (0.0, 0.0)  # of all, those driven by functions aside

    @property
    def driver(self):
        """Cards that drive the freedom."""
        return [
            function(90, "polynomial", 0, *self.powers),
            f"ELEMENTS\n  DRIVE driven at={hinge(1, self.freedom)} value=90",
        ]

    def starting(self, steps):
        """The model with the first speeds and with so many steps."""
        speeds = list(self.speeds)
        speeds[self.place] = self.powers[0]
        model = self.model.replace("    5\n       0.1\n", "\n".join([*steps, ""]))
        head, given = model.split("Y(L)\n")
        values = [f"{v:10.3f}" for v in speeds] + ["       0.0"] * len(speeds)
        lines = ["".join(values[k : k + 5]) for k in range(0, len(values), 5)]
        return "\n".join([f"{head}Y(L)", *lines, given[given.index("RC(K") :]])


def hinge(body, freedom):
    """The coordinate of a hinge by its number among rotations 1 to 3 and translations 4 to 6."""
    return f"{body}.r{freedom}" if freedom <= 3 else f"{body}.t{freedom - 3}"


def coupled(*terms):
    """One coupling of terms (body, freedom, factor)."""
    sums = (f"{hinge(*where)}={factor}" for *where, factor in terms)
    return f"ELEMENTS\n  COUPLING coup-1 {' '.join(sums)}"


def slippery(*numbers):
    keys = ("dynamic", "static", "stribeck", "creep", "radius", "preload")
    values = (f"{key}={value}" for key, value in zip(keys, numbers, strict=True))
    return f"ELEMENTS\n  FRICTION fric-1 joint=1 {' '.join(values)}"


ALL = {word: Case(cards, speeds=(0.0, SECOND if word == "COUP" else 0.0)) for word, cards in CASES.items()}
ALL |= {
    "rack and pinion": Case([coupled((1, 4, 1), (2, 3, 0.2))], SLIDE, 4, 1, POWERS, (-6.0, 0.0)),
    "belt": Case([coupled((1, 3, 0.3), (2, 3, -0.1))], speeds=(0.0, 3.6)),
    "differential": Case([coupled((1, 3, -2), (2, 3, 1), (3, 3, 1))], THREE_LINKS, speeds=(0.0, 1.4, 1.0)),
    "spring of a stroke": Case(
        ["ELEMENTS\n  SPRING hspr-1 at=1.t1 stiffness=80 rest=0.1 damping=0.9 preload=1.6"], SLIDE, 4, 1
    ),
    "stop of a stroke": Case(
        ["ELEMENTS\n  STOP hsto-1 at=1.t1 lower=-1 upper=-0.2 stiffness=300 damping=0.3"], SLIDE, 4, 1
    ),
    "turning": Case([slippery(0.2, 0.25, 0.5, 0.1, 0.04, 3)], powers=REVERSING),
    "sliding": Case([slippery(0.2, 0.25, 5, 0.5, 0, 3)], SLIDE, 4, 1, REVERSING),
    "turning and sliding": Case(
        [
            slippery(0.2, 0.25, 0.5, 0.1, 0.04, 3),
            function(5, "sine", 0, 0.02, 9),
            "ELEMENTS\n  DRIVE pref-1 at=1.t3 value=5",
        ],
        SLEEVE,
        3,
        0,
        REVERSING,
        (0.0, 0.0, 0.18),
    ),
}


def motion(t, powers):
    a, b, c = powers
    return t * (a + t * (b + t * c)), a + t * (2 * b + t * 3 * c)


def joined(*lists):
    """Cards as one text, entries of functions and of equal words in one block each."""
    blocks: dict[str, list[str]] = {}
    texts = [each for cards in lists for each in cards]
    elements = [text for text in texts if text.startswith("ELEMENTS")]
    for text in (text for text in texts if text not in elements):
        word, count, *lines = text.rstrip("\n").split("\n")
        entry = blocks.setdefault(word, [])
        entry.append((int(count), lines))  # type: ignore[arg-type]
    return "\n".join(
        "\n".join([word, integers(sum(n for n, _ in found)), *(line for _, lines in found for line in lines)])
        for word, found in blocks.items()
    ) + "".join(f"\n{text.rstrip()}" for text in elements)


def run(word, steps, *cards, method="dop853"):
    return rows_of(joined(*cards), method, ALL[word].starting(steps))


def test_every_card_has_a_case():
    assert set(CASES) == {*(card.word for card in EXTENSIONS), *LINES["dafms"]} - OTHERS


@functools.cache
def driven(word):
    return run(word, FINE, ALL[word].cards, ALL[word].driver)


@pytest.mark.parametrize("word", CASES)
def test_the_card_acts_on_the_driver(word):
    bare = run(
        word,
        SPARSE,
        [function(8, "polynomial", 0), "ELEMENTS\n  MOTOR motf-1 at=2.r3 effort=8"],
        ALL[word].driver,
    )
    given = driven(word)
    same = np.searchsorted(given.time, bare.time - 1e-9)
    assert np.max(np.abs(bare.driver_effort[:, -1] - given.driver_effort[same, -1])) > 1e-3


@pytest.mark.parametrize("method", METHODS)
@pytest.mark.parametrize("word", ALL)
def test_the_effort_of_a_driven_run_gives_the_motion_back(word, method):
    case, given = ALL[word], driven(word)
    points = list(zip(given.time.tolist(), given.driver_effort[:, -1].tolist(), strict=True))
    motor = [
        spline_block([(99, "effort", points)]),
        f"ELEMENTS\n  MOTOR given at={hinge(1, case.freedom)} effort=99",
    ]
    found = run(word, SPARSE, case.cards, motor, method=method)
    same = np.searchsorted(given.time, found.time - 1e-9)
    angle, rate = motion(found.time, case.powers)
    assert found.q[:, case.place] == pytest.approx(angle, abs=NEAR)
    assert found.y[:, case.place] == pytest.approx(rate, abs=NEAR)
    assert found.q == pytest.approx(given.q[same], abs=NEAR)
    assert found.y == pytest.approx(given.y[same], abs=NEAR)
    efforts = given.element_effort[same]
    # The motor stands after all others.
    others, scale = found.element_effort[:, : efforts.shape[1]], np.abs(efforts).max(initial=1.0)
    assert others == pytest.approx(efforts, abs=10 * NEAR * scale)
