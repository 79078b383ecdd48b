"""Energy of every card of loads, functions and elements: what is stored, what is dissipated, what is put in.

The energies of the bodies are computed here from their motion, not taken from the program.
"""

import math

import numpy as np
import pytest
from scipy.integrate import simpson

from flexmb_cli.kernels._jit import interpreting
from flexmb_cli.model.joint_elements import names_of
from flexmb_cli.results.hdf5.dynamic import element_layout
from tests.solvers.constrained.body_balances import rotation, tensor
from tests.solvers.constrained.element_decks import FREE, METHODS, ROTOR, analysis_of, model_of, rows_of
from tests.solvers.constrained.elements.element_cases import CASES, END, KEYWORDS, POWERS

TIMES = f"0 {END} 0.001"
# Stops in contact throughout, where the power is smooth; a spring without its damper.
OTHER_CARDS = {
    "TSTOP": ("lower=-1 upper=0.1283 stiffness=60", "lower=-1 upper=-0.3 stiffness=20"),
    "ASTOP": ("lower=-1 upper=0.1283", "lower=-1 upper=-0.1"),
    "SPRING": ("30 0.5 0.7", "30 0.5 0"),
}
STORE = {"SPRING", "TSPRING", "ASPRING", "LSPRING", "CABLE", "BUSHING", "TSTOP", "ASTOP"}
DISSIPATE = (STORE | {"DAMPER", "FRICTION"}) - {"SPRING"}
# Equations of bodies that move freely, and cards of the start and of results, which do no work.
DO_NOTHING = {"COUPLING", "REVCYL", "REVSPH", "SPHSPH", "RATE", "JOINTS"}


def mechanism_and_cards(keyword):
    case = CASES[keyword]
    cards = case.cards.replace(*OTHER_CARDS.get(keyword, ("", "")))
    return case.mechanism, f"{cards}ELEMENTS\n  START at={case.at} rate={POWERS[0]}\nTOLERANCE 1e-12\n"


def energy_of_bodies(model, rows):
    """Kinetic energy and that of the weights (T,), from masses, positions and velocities."""
    total = np.zeros(len(rows.time))
    for item in model.masses:
        b = item.body
        A = np.array([rotation(p) for p in rows.euler_parameters[:, b]])
        w = rows.angular_velocity[:, b]
        arm = A @ np.array(item.centre)
        speed = rows.velocity[:, b] + np.cross(w, arm)
        own = np.einsum("tji,tj->ti", A, w)
        total += 0.5 * item.mass * np.sum(speed**2, axis=1)
        total += 0.5 * np.einsum("ti,ij,tj->t", own, tensor(item.inertia), own)
        total -= item.mass * (rows.position[:, b] + arm) @ np.array(model.gravity)
    return total


def test_springs_along_a_line_store_half_their_stiffness_times_the_square_of_their_stretch():
    """Ends at (2, 0.3) and (3, 0) m: stretch √1.09 - 0.5 m with 30 and 40 N/m."""
    cards = "MASS 2 1 0 0 0 1 1 1\nSPRING 0 2 2 0.3 0 3 0 0 30 0.5\n"
    cards += "ELEMENTS\n  SPRING line from=0(2,0.3,0) to=2(3,0,0) stiffness=40 rest=0.5\n"
    with interpreting():
        block = next(analysis_of(model_of(FREE, "0 0.001 0.001", cards)).rows())
    square = (math.sqrt(1.09) - 0.5) ** 2
    assert block.element_energy[0] == pytest.approx([15 * square, 20 * square], rel=1e-12)


@pytest.mark.long_motion
@pytest.mark.parametrize("keyword", KEYWORDS)
def test_the_energy_audit_closes_with_the_card_and_not_without(keyword):
    mechanism, cards = mechanism_and_cards(keyword)
    rows = rows_of(mechanism, TIMES, cards)
    bodies = energy_of_bodies(model_of(mechanism, TIMES, cards), rows)
    scale = np.abs(bodies).max()
    stored, power = rows.element_energy.sum(axis=1), rows.element_power
    assert np.ptp(bodies + stored - rows.applied_work) < 1e-8 * scale
    assert np.ptp(rows.total) < 1e-8 * scale
    lost = np.array([simpson(power[: k + 1], x=rows.time[: k + 1], axis=0) for k in (100, 200)])
    assert rows.element_work[[100, 200]] == pytest.approx(lost, abs=1e-8 * scale)
    if keyword in STORE | DISSIPATE | {"TMOTOR", "AMOTOR"}:
        assert rows.applied_work[[100, 200]] == pytest.approx(lost.sum(axis=1), abs=1e-8 * scale)
    motors = keyword in {"TMOTOR", "AMOTOR"}
    assert rows.dissipated[[100, 200]] == pytest.approx(-lost.sum(axis=1) * (not motors), abs=1e-8 * scale)
    closes_without = np.ptp(bodies) < 1e-3 * scale
    assert closes_without == (keyword in DO_NOTHING)


@pytest.mark.long_motion
@pytest.mark.parametrize("keyword", sorted(STORE | DISSIPATE))
def test_what_an_element_does_is_what_it_releases_and_dissipates(keyword):
    """∫ effort · rate dt = -Δ(energy stored) + ∫ power dt, by Simpson's rule over rows of 1 ms."""
    mechanism, cards = mechanism_and_cards(keyword)
    rows = rows_of(mechanism, TIMES, cards)
    done = simpson(rows.element_effort * rows.element_rate, x=rows.time, axis=0)
    lost = simpson(rows.element_power, x=rows.time, axis=0)
    released = rows.element_energy[0] - rows.element_energy[-1]
    assert done == pytest.approx(released + lost, abs=1e-8)
    assert (np.abs(released).max() > 1e-3) == (keyword in STORE)
    assert (lost.min() < -1e-3) == (keyword in DISSIPATE)
    assert np.all(rows.element_power <= 1e-15)


@pytest.mark.long_motion
@pytest.mark.parametrize("method", METHODS)
def test_dampers_dissipate_the_energy_that_a_damped_oscillator_loses(method):
    """I q̈ + (c1 + c2) q̇ + k q = 0 from rest at 0: Rao, Mechanical Vibrations, section 2.6.

    Of two dampers in one joint each takes its share of c.
    """
    inertia, k, c, spin = 0.5, 8.0, (0.1, 0.3), 3.0
    decay, omega = sum(c) / (2 * inertia), math.sqrt(k / inertia)
    damped = math.sqrt(omega**2 - decay**2)
    cards = (
        f"MASS 2 1 0 0 0 1 1 {inertia}\n"
        "ELEMENTS\n"
        f"  SPRING tspring-1 at=1.angle stiffness={k} damping={c[0]}\n"
        f"  SPRING tspring-2 at=1.angle stiffness=0 damping={c[1]}\n"
        f"ELEMENTS\n  START at=1.angle rate={spin}\n{METHODS[method]}"
    )
    rows = rows_of(ROTOR, "0 2 0.125", cards)
    t, fade = rows.time, np.exp(-decay * rows.time)
    angle = spin / damped * fade * np.sin(damped * t)
    rate = spin * fade * (np.cos(damped * t) - decay / damped * np.sin(damped * t))
    lost = (inertia * (spin**2 - rate**2) - k * angle**2) / 2
    near = 1e-5 if method == "GALF" else 1e-7
    assert rows.dissipated == pytest.approx(lost, abs=near)
    assert rows.element_work == pytest.approx(-np.outer(lost, c) / sum(c), abs=near)


def test_joint_coordinates_alone_bring_no_work():
    """Without springs nothing is dissipated, and no dataset says so."""
    layout = element_layout(model_of(ROTOR, "0 0.1 0.1", "MASS 2 1 0 0 0 1 1 1\n"))
    assert not {"element/work", "energy/dissipated"} & {series.path for series in layout.series}


def test_springs_store_the_energy_of_their_formula():
    """preload s + k s²/2 + ∫ curve: 1.6 · 0.2 + 8 · 0.02 + 10 · 0.2⁴ J at s = 0.2; ½ k s² of a cable."""
    cards = (
        "MASS 2 2.5 0 0 0 0.4 0.5 0.6\n"
        "ELEMENTS\n"
        "  FUNCTION 5 polynomial 0 0 0 40\n"
        "  SPRING lspring-1 from=0(0,0,0) to=2(1.2,0,0) stiffness=8 rest=1 preload=1.6 "
        "curve=5\n"
        "ELEMENTS\n"
        "  CABLE cable-1 from=0(0,0,0) to=2(0,0,2) stiffness=90 rest=1.5\n"
        "  CABLE cable-2 from=0(0,0,0) to=2(0,1,0) stiffness=90 rest=1.5\n"
        "  BUSHING bushing-1 from=0(0.1,0,0) to=2(0,0,0) k=(90,0,0) kr=(0,0,0)\n"
    )
    rows = rows_of(FREE, "0 0.01 0.01", cards)
    bushing = [0.45, 0, 0, 0, 0, 0]
    wanted = [1.6 * 0.2 + 8 * 0.02 + 10 * 0.2**4, 11.25, 0.0, *bushing]
    assert rows.element_energy[0] == pytest.approx(wanted, abs=1e-14)
    assert rows.potential[0] == pytest.approx(sum(wanted), rel=1e-14)


def test_a_spring_whose_ends_pass_through_each_other_keeps_its_energy():
    """A preload cannot act where there is no direction; the energy of the place is 0 at length = rest = 0."""
    slide = "2 0 0 0 0 0 0 1 0 0 0 1\n" + "0 0 0 1 0 0 0\n" * 2
    slide += "1 2 0 0 0 0 0 0 1 0 0 1 0 0 0 1 0 0 0 1\n1 0 0 0 0 0 0\n"
    rows = rows_of(
        slide,
        "0 0.1 0.1",
        "MASS 2 2 0 0 0 1 1 1\n"
        "ELEMENTS\n"
        "  SPRING lspring-1 from=0(0,0,0) to=2(0,0,0) stiffness=50\n"
        "  START at=1.stroke rate=1\n",
    )
    assert rows.element_energy[0] == 0.0 and rows.element_effort[0] == 0.0
    assert rows.element_energy[1] == pytest.approx(25 * rows.joint_coordinate[1, 0] ** 2, rel=1e-12)


def test_names_of_elements_stand_beside_their_efforts_with_motors_behind_all_others():
    """The bearing carries 80 N of the two springs in line and 30 N of preload: 0.2 · 110 N of friction."""
    cards = (
        "MASS 2 1 0 0 0 1 1 0.5\n"
        "ELEMENTS\n"
        "  MOTOR tmotor-1 at=1.angle effort=1\n"
        "  FUNCTION 1 polynomial 7\n"
        "  FRICTION friction-1 joint=1 dynamic=0.2 static=0.2 stribeck=1 creep=1e-4 "
        "radius=0.1 preload=30\n"
        "ELEMENTS\n"
        "  STOP tstop-1 at=1.angle lower=-1 upper=-0.1 stiffness=50\n"
        "  SPRING lspring-1 from=0(3,0,0) to=2(1,0,0) stiffness=20 rest=1\n"
        "SPRING 0 2 4 0 0 1 0 0 30 1\n"
        "ELEMENTS\n  SPRING tspring-1 at=1.angle stiffness=8 rest=0.25\n  START at=1.angle rate=1\n"
    )
    model = model_of(ROTOR, "0 0.1 0.1", cards)
    names = [name for name, _ in names_of(model.elements, model.springs)]
    rows = rows_of(ROTOR, "0 0.1 0.1", cards)
    efforts = {
        "spring 1": -60,
        "friction-1": -22,
        "tstop-1": -5,
        "lspring-1": -20,
        "tspring-1": 2,
        "tmotor-1": 7,
    }
    assert names == list(efforts)
    assert rows.element_effort[0] == pytest.approx(list(efforts.values()), rel=1e-12)
