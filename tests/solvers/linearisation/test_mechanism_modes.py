"""`flexmb modes` on mechanisms of every dialect, against closed forms."""

import json
import math
import subprocess
import sys
from pathlib import Path

import pytest

TOP = Path(__file__).parents[3]
G = 9.81


def flexmb(*arguments, deck=""):
    command = [sys.executable, "-m", "flexmb_cli", "modes", *arguments]
    return subprocess.run(command, input=deck, capture_output=True, text=True, cwd=TOP, timeout=300)


def found(*arguments, deck=""):
    done = flexmb(*arguments, "--json", deck=deck)
    assert done.returncode == 0, done.stderr
    return json.loads(done.stdout)["mechanism"]


PENDULUM = """{ a rod of 2 kg, its centre half a metre from the revolute joint, let go horizontally }
2 0 0 0 0 1 0 0 0 0 0 1
0 0 0 1 0 0 0
0 0 0 1 0 0 0
1 2 0 0 0 0 0 0 0 1 0 0 1 0
1 0 0 0 0 0 0
0 1 0.5
DYNAMICS forward
MASS 2 2.0 0.5 0 0 0.1 0.1 0.1
GRAVITY 0 0 -9.81
END
"""


def test_a_young_deck_settles_and_swings():
    """omega² = m g s/(J + m s²); hanging, the x axis points down."""
    mechanism = found("-", "--equilibrium", deck=PENDULUM)
    assert mechanism["frequency"] == pytest.approx([math.sqrt(2 * G * 0.5 / 0.6) / math.tau], rel=1e-8)
    assert mechanism["degrees_of_freedom"] == 1
    e0, _, e2, _ = mechanism["position"]["body 2"][3:]
    assert 2 * e0 * e2 == pytest.approx(1.0, abs=1e-9)


def test_the_text_names_what_moves_and_where_it_rests():
    done = flexmb("-", "--equilibrium", deck=PENDULUM)
    assert done.stdout.splitlines() == [
        "-: YOUNG deck",
        "  linearised motion about the equilibrium at t = 0 s: DOF 1",
        "    body 1: 0 0 0 1 0 0 0",
        "    body 2: 0 0 0 0.707107 0 0.707107 0",
        "    mode            Hz  damping ratio  moves most",
        "       1      0.643545       0.000000  body 2 ωy 1.00",
    ]


def test_an_elastic_pendulum_of_the_thesis_hangs_and_swings():
    """Thesis, table 4.1: omega_1² = g/l with g = 9.8, l = 0.4 m loaded, and omega_2 = 2 omega_1."""
    mechanism = found("decks/dafms/pendulum.DAT", "--equilibrium")
    expected = [math.sqrt(9.8 / 0.4) / math.tau, 2 * math.sqrt(9.8 / 0.4) / math.tau]
    assert mechanism["frequency"] == pytest.approx(expected, rel=1e-8)
    assert mechanism["position"]["body 1 rotation 1"] == pytest.approx([0.0], abs=1e-9)


def turning_cantilever(w):
    """The supplied cantilever, turning evenly from the start."""
    deck = (TOP / "decks/vsdf/spinup.vsdf").read_text()
    function = f"ROTZ    1    1       0.0{w:10.7f}"
    return deck.replace("ROTZ    1    2       6.0      15.0", function).replace(
        " fe/", f" {TOP}/decks/vsdf/fe/"
    )


@pytest.mark.long_motion
def test_a_cantilever_that_turns_slowly_has_southwells_frequencies():
    """In plane omega² = omega_0² + (1.193 - 1) w², the turning being slow against the mode: w = 1 rad/s."""
    mechanism = found("-", "--at", "0", deck=turning_cantilever(1.0))
    omega = [math.tau * frequency for frequency in mechanism["frequency"]]
    in_plane = math.sqrt(3.805**2 + 0.193)
    assert min(abs(value / in_plane - 1.0) for value in omega) < 1e-3


@pytest.mark.long_motion
def test_a_cantilever_that_turns_fast_flaps_as_published():
    """Wright, Smith, Thresher and Wang, J. Appl. Mech. 49 (1982), 197: 13.1702 at the speed 12.

    Both in units of sqrt(EI/mu L^4), which is the first frequency at rest over 3.5160.
    """
    at_rest = found("-", "--at", "0", deck=turning_cantilever(0.0))["frequency"][0] * math.tau
    unit = at_rest / 3.5160
    mechanism = found("-", "--at", "0", deck=turning_cantilever(12.0 * unit))
    assert mechanism["frequency"][0] * math.tau == pytest.approx(13.1702 * unit, rel=5e-3)


@pytest.mark.long_motion
def test_a_soft_rod_hangs_a_little_slower_than_a_rigid_one():
    """Compound pendulum about the joint's edge: omega² = g d/(k² + d²), elastic deflection lowers it."""
    mechanism = found("decks/vsdf/pendulum.vsdf", "--equilibrium")
    d2 = 0.05**2 + 0.0075**2
    rigid = math.sqrt(G * math.sqrt(d2) / ((0.1**2 + 0.015**2) / 12 + d2)) / math.tau
    assert 0.995 * rigid < mechanism["frequency"][0] < rigid
    assert mechanism["degrees_of_freedom"] == 10


def test_a_vsdf_deck_is_asked_for_its_bodies_only():
    done = flexmb("decks/vsdf/pendulum.vsdf", "--json")
    assert json.loads(done.stdout)["mechanism"] is None


BAR = """VSDF BAR OF 20-NODE BRICKS, HELD AT ITS END FACE ON A FRAME THAT TURNS ABOUT Z
BODY
    1 FLEX   10
FEMN
    1 INP  {folder}/rod.inp
FEMM
    1 CCX  {folder}/rod.mas
FEMK
    1 CCX  {folder}/rod.sti
FEMP
    1 CCX  {folder}/rod.dof
CLMP
    1    1    2    3    4    5    6    7    8    9   10   11   12   13
MOTN
    1 TRAX    1    1
    2 TRAY    1    1
    3 TRAZ    1    1
    4 ROTX    1    1
    5 ROTY    1    1
    6 ROTZ    1    1       0.0     100.0
TIME
       0.1     0.005
END
STAR
STOP
"""


@pytest.mark.long_motion
def test_a_bar_on_a_turning_frame_settles_stretched_and_bent_a_little():
    """0.5 m, 10 mm across in the plane, 20 mm high, of steel, 100 rad/s about an edge of its end face.

    Stretching, a clamped-free rod: phi = sqrt(2/m) sin(pi x/2L), omega = (pi/2L) sqrt(E/rho), so eta =
    Omega² rho A integral(x phi)/omega².  Bending in the plane, its axis 5 mm off the axis of turning: eta =
    Omega² y sqrt(0.6131 m)/(omega² - Omega²), 0.6131 the effective mass of a cantilever's first mode
    (Blevins, Formulas for Natural Frequency and Mode Shape), omega that of the bricks at rest; stiffening
    is not asked for.
    """
    done = flexmb("-", "--equilibrium", "--json", deck=BAR.format(folder=TOP / "decks/vsdf/fe/rod"))
    mechanism, bar = json.loads(done.stdout)["mechanism"], json.loads(done.stdout)["bodies"][0]
    eta, turning, length, mass = mechanism["position"]["body 1 modal"], 100.0, 0.5, 7850.0 * 1e-4
    omega = math.pi / (2.0 * length) * math.sqrt(2.1e11 / 7850.0)
    stretch = turning**2 * mass / length * math.sqrt(2.0 / mass) * 4.0 * length**2 / math.pi**2 / omega**2
    assert max(abs(value) for value in eta[6:]) == pytest.approx(stretch, rel=1e-2)
    bending = math.tau * bar["frequencies"][0]
    moved = turning**2 * 0.005 * math.sqrt(0.6131 * mass) / (bending**2 - turning**2)
    assert abs(eta[0]) == pytest.approx(moved, rel=1e-2)
    expected = math.sqrt(bending**2 - turning**2) / math.tau
    assert mechanism["frequency"][0] == pytest.approx(expected, rel=5e-4)
    assert not mechanism["frozen"]


@pytest.mark.processes
def test_a_motion_whose_coefficients_change_is_called_frozen():
    done = flexmb("-", deck=PENDULUM)
    assert "    frozen at t = 0 s: the coefficients change along the motion" in done.stdout.splitlines()


REFUSED = {"decks/young/IN4-BAR.dat": "error: modes need masses and a free motion"}


@pytest.mark.parametrize("deck", REFUSED)
def test_what_has_no_small_motions_is_refused(deck):
    done = flexmb(deck)
    assert done.returncode == 2
    assert REFUSED[deck] in done.stderr
    assert done.stdout == ""
