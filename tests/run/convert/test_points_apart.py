"""Joints whose two points are apart along the axis at the start move alike in other programs and dialects.

A guide: a rod turns about the origin, a collar on it hangs at a slider, whose line runs through the origin.
So the rod keeps its direction and the collar moves at the slider's rate.  A bead: an arm turns freely about
the origin and a bead slides along it without weight; its polar coordinates follow from Lagrange's equations.
All is turned in space, and the frames of the bodies lie askew in their bodies.
"""

import re
import subprocess
import sys

import mujoco
import numpy as np
import pytest
from scipy.integrate import solve_ivp
from scipy.spatial.transform import Rotation

from flexmb_cli.errors import ModelError
from flexmb_cli.results.models import exudyn_joints
from flexmb_cli.run.convert import converted
from tests.run.convert.test_convert_decks import COLUMNS, convert, motion

TURNED = Rotation.from_rotvec([0.4, -0.9, 0.7])
FRAMES = Rotation.from_rotvec([[0, 0, 0], [0.3, 0.5, -0.2], [-0.7, 0.1, 0.4], [0.2, -0.3, 0.6]])
# Where the points of the joint lie along its axis, m from the middle of what slides, on body I and on body J.
# The pivot is at -1.1 m: with one point there and the other in the middle, equations were taken for repeated.
APART = ((-1.1, 0.0), (0.0, -1.1), (-0.5, 0.3), (-1.1, 0.3))
X, Y, Z = np.eye(3)


class Deck:
    """Numbers of a YOUNG deck from places and directions before the turn; body 1 is the ground."""

    def __init__(self, origins):
        self.origins = [TURNED.apply(origin) for origin in origins]
        self.A = [TURNED * FRAMES[k] if k else FRAMES[0] for k in range(len(origins))]

    def local(self, body, place):
        return self.A[body - 1].inv().apply(TURNED.apply(place) - self.origins[body - 1])

    def bodies(self):
        return [[*r, *A.as_quat(scalar_first=True)] for r, A in zip(self.origins, self.A, strict=True)]

    def joint(self, i, j, P_i, P_j, *directions, pitch=()):
        """Numbers of a joint: points on both bodies, then points in directions from them, on both each."""
        numbers = [*self.local(i, P_i), *self.local(j, P_j)]
        for on_i, on_j in directions:
            numbers += [*self.local(i, P_i + on_i), *self.local(j, P_j + on_j)]
        return [i, j, *numbers, *pitch]

    def velocity(self, body, at, v, omega):
        """The card of speeds of the body's origin, given the velocity at a place."""
        omega = TURNED.apply(omega)
        lever = self.origins[body - 1] - TURNED.apply(at)
        return ["VELOCITY", body, *(TURNED.apply(v) + np.cross(omega, lever)), *omega]

    def text(self, counts, joints, cards, time):
        rows = [
            counts,
            *self.bodies(),
            *joints,
            [1, 0, 0, 0, 0, 0, 0],
            time,
            [],
            ["DYNAMICS forward"],
            *cards,
        ]
        return "\n".join(" ".join(map(str, row)) for row in [*rows, ["TOLERANCE 1e-12"], ["END"], []])


def sphere(deck, body, mass, moment, place):
    return ["MASS", body, mass, *deck.local(body, place), moment, moment, moment]


def guide(kind, places, swapped):
    """The guide; body 2 the rod, 3 the collar, 4 the slider, at 2 m/s.  `swapped`: body I is the collar."""
    middle = 1.1 * X
    deck = Deck([0 * X, 0.6 * X + 0.1 * Y, middle - 0.2 * Z, middle + 0.1 * Y])
    on_i, on_j = (middle + place * X for place in places)
    sides = [(Y, Z)] if kind == "translational" else []
    rail = deck.joint(*((3, 2) if swapped else (2, 3)), on_i, on_j, (X, X), *sides)
    joints = [
        deck.joint(1, 2, 0 * X, 0 * X, (Z, Z)),
        deck.joint(4, 3, middle, middle, (Z, Z)),
        *([rail] if kind == "cylindrical" else []),
        deck.joint(1, 4, 0 * X, 0 * X, (X, X), (Y, Z)),
        *([rail] if kind == "translational" else []),
    ]
    cards = [
        sphere(deck, 2, 2, 0.2, 0.6 * X), sphere(deck, 3, 1, 0.1, middle), sphere(deck, 4, 1, 0.1, middle),
        ["GRAVITY", *TURNED.apply([0, -9.81, 0])], deck.velocity(4, middle, 2 * X, 0 * X),
    ]  # fmt: skip
    sliding = kind == "translational"
    counts = [4, 0, 0, 0, 0, 2, 1 - sliding, 1 + sliding, 0, 0, 0, 1]
    return deck.text(counts, joints, cards, [0, 0.2, 0.1])


ARM, MASS, MOMENT, PITCH, STIFFNESS, REST = 0.3, 1.4, 0.05, 0.15, 20.0, 0.1
BEGIN = 1.1, 0.3, 2.5  # m, m/s, rad/s: the bead's distance and its rate, the arm's rate
TIMES = np.linspace(0.0, 0.5, 6)
RAILS = {
    "translational": [0 * Y],
    "cylindrical": [0 * Y],
    "two cylindrical": [0.2 * Y, -0.1 * Y],
    "screw": [0 * Y],
}


def bead(kind, places):
    """The arm, body 2, and the bead, body 3, with a spring along the rail; on two rails it does not spin."""
    r, rate, turning = BEGIN
    middle = r * X
    deck = Deck([0 * X, 0.3 * X + 0.2 * Y, middle + 0.1 * Z])
    on_i, on_j = (middle + place * X for place in places)
    sides = [] if "cylindrical" in kind else [(Y, Z)]
    size = (PITCH,) * (kind == "screw")
    rails = [deck.joint(2, 3, on_i + side, on_j + side, (X, X), *sides, pitch=size) for side in RAILS[kind]]
    # A screw of YOUNG counts the distance of its points: with P_J before P_I its thread turns the other way.
    spin = {"cylindrical": 4.0, "screw": np.copysign(rate / PITCH, places[1] - places[0])}.get(kind, 0.0)
    cards = [
        sphere(deck, 2, 1, ARM, 0 * X),
        sphere(deck, 3, MASS, MOMENT, middle),
        [f"ELEMENTS\n  SPRING along at=2.stroke stiffness={STIFFNESS} rest={REST}"],
        deck.velocity(2, 0 * X, 0 * X, turning * Z),
        deck.velocity(3, middle, rate * X + r * turning * Y, turning * Z + spin * X),
    ]
    kinds = [len(rails) * (each in kind) for each in ("cylindrical", "translational", "screw")]
    counts = [3, 0, 0, 0, 0, 1, *kinds, 0, 0, 1]
    joints = [deck.joint(1, 2, 0 * X, 0 * X, (Z, Z)), *rails]
    return deck.text(counts, joints, cards, [0, TIMES[-1], TIMES[1]])


def places_of_bead(kind):
    """Global places of the bead's centre (times, 3) by T = (I + J + m r²) θ'²/2 + (m + J/p²) r'²/2."""
    along = MASS + (MOMENT / PITCH**2 if kind == "screw" else 0.0)

    def slope(_, y):
        r, rate, _, turning = y
        pull = -STIFFNESS * (r - BEGIN[0] - REST)
        faster = -2 * MASS * r * rate * turning / (ARM + MOMENT + MASS * r * r)
        return rate, (MASS * r * turning**2 + pull) / along, turning, faster

    begin = BEGIN[0], BEGIN[1], 0.0, BEGIN[2]
    r, _, angle, _ = solve_ivp(slope, (0, TIMES[-1]), begin, "DOP853", TIMES, rtol=1e-12, atol=1e-13).y
    return TURNED.apply(np.stack([r * np.cos(angle), r * np.sin(angle), 0 * r], axis=1))


def by_exudyn(folder, decks):
    """Positions (times, 3 bodies) that the scripts of decks give, all run by one process."""
    for n, text in enumerate(decks):
        (folder / f"d{n}.dat").write_text(text)
        (folder / f"s{n}.py").write_text(converted(str(folder / f"d{n}.dat"), "exudyn"))
    program = f"import runpy\nfor n in range({len(decks)}): runpy.run_path(f's{{n}}.py')"
    done = subprocess.run([sys.executable, "-c", program], cwd=folder, capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    return [
        np.loadtxt(folder / f"d{n}-exudyn.csv", delimiter=",", skiprows=1)[:, 1:] for n in range(len(decks))
    ]


GUIDES = [
    (kind, places, number % 2 == 1)
    for kind in ("translational", "cylindrical")
    for number, places in enumerate(APART)
]


BEADS = [(kind, places) for kind in ("translational", "two cylindrical") for places in APART[:2]]


@pytest.fixture(scope="module")
def moved(tmp_path_factory):
    """Decks of guides and beads, and their positions in Exudyn."""
    decks = [*(guide(*case) for case in GUIDES), *(bead(*case) for case in BEADS)]
    return list(zip(decks, by_exudyn(tmp_path_factory.mktemp("exudyn"), decks), strict=True))


@pytest.mark.processes
def test_a_guide_keeps_all_equations_in_exudyn(moved):
    """The collar moves at the slider's rate and the rod keeps its direction, to round-off."""
    for (deck, found), case in zip(moved, GUIDES, strict=False):
        rod, collar = (np.array(deck.split("\n")[k].split()[:3], float) for k in (2, 3))
        sliding = collar + np.outer([0.0, 0.2, 0.4], TURNED.apply(X))
        np.testing.assert_allclose(
            found[:, :6], np.hstack([[rod] * 3, sliding]), atol=1e-9, err_msg=str(case)
        )


@pytest.mark.processes
def test_a_bead_on_a_turning_arm_moves_by_lagranges_equations_in_exudyn(moved):
    """On one rail, and on two, of which the second repeats all but one of its equations."""
    for (_, found), case in zip(moved[len(GUIDES) :], BEADS, strict=True):
        origin = places_of_bead(case[0]) + TURNED.apply(0.1 * Z)
        np.testing.assert_allclose(found[:, 3:6], origin, atol=1e-7, err_msg=str(case))


@pytest.mark.long_motion
@pytest.mark.parametrize("kind", RAILS)
@pytest.mark.parametrize("places", APART[:2])
def test_a_bead_on_a_turning_arm_moves_by_lagranges_equations_in_other_dialects(kind, places, tmp_path):
    (tmp_path / "bead.dat").write_text(bead(kind, places))
    wanted = places_of_bead(kind)
    decks = [tmp_path / "bead.dat", convert(tmp_path / "bead.dat", "vsdf", tmp_path)]
    decks.append(convert(decks[1], "young", tmp_path, "back"))
    for deck in decks:
        np.testing.assert_allclose(motion(deck)[0][:, -1], wanted, atol=1e-9)
    if len(RAILS[kind]) == 1 and kind != "screw":
        tree = convert(decks[0], "dafms", tmp_path)
        np.testing.assert_allclose(motion(tree)[0][:, -1], wanted, atol=COLUMNS)
        np.testing.assert_allclose(by_mujoco(converted(str(tree), "mjcf")), wanted, atol=COLUMNS)


def by_mujoco(text):
    """Global places of the last body's centre (times, 3)."""
    model = mujoco.MjModel.from_xml_string(text.replace('timestep="0.0001"', 'timestep="0.001"'))
    data = mujoco.MjData(model)
    mujoco.mj_resetDataKeyframe(model, data, 0)
    rows = []
    for time in TIMES:
        while data.time < time - 1e-9:
            mujoco.mj_step(model, data)
        mujoco.mj_forward(model, data)
        rows.append(data.xipos[-1].copy())
    return np.array(rows)


def test_a_script_with_other_degrees_of_freedom_than_the_deck_is_refused(tmp_path, monkeypatch):
    (tmp_path / "guide.dat").write_text(guide(*GUIDES[0]))
    monkeypatch.setattr(exudyn_joints, "INDEPENDENT", 0.9)
    with pytest.raises(ModelError) as stopped:
        converted(str(tmp_path / "guide.dat"), "exudyn")
    assert re.search(r"the script would have \d+ degrees of freedom, the deck has 1:", str(stopped.value))
