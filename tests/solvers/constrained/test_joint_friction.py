"""Dry friction in joints: braking, stick and slip, and what the smooth curve leaves of sticking."""

import math

import numpy as np
import pytest

from flexmb_cli.errors import AnalysisError
from tests.solvers.constrained.element_decks import METHODS, ROTOR, SLIDER, rows_of

G = 9.81
# Body 2 on a screw along z of the ground.
SCREW = """2 0 0 0 0 0 0 0 1 0 0 1
0 0 0 1 0 0 0
0 0 0 1 0 0 0
1 2 0 0 0 0 0 0 0 0 1 0 0 1 1 0 0 1 0 0 PITCH
1 0 0 0 0 0 0
"""


@pytest.mark.long_motion
@pytest.mark.parametrize("card", METHODS.values(), ids=METHODS)
def test_a_rotor_is_braked_by_its_bearing(card):
    """I ω̇ = -μ m g r: it stops after ω0 I/(μ m g r) = 0.764… s; the energy lost is ½ I ω0²."""
    mu, m, r, inertia, spin = 0.25, 2.0, 0.04, 0.3, 0.5
    cards = (
        f"MASS 2 {m} 0 0 0 0.2 0.2 {inertia}\nGRAVITY 0 -{G} 0\nELEMENTS\n  START at=1.angle rate={spin}\n"
        "ELEMENTS\n"
        f"  FRICTION friction-1 joint=1 dynamic={mu} static={mu} stribeck=0.1 creep=1e-6 "
        f"radius={r}\n"
        f"{card}"
    )
    rows = rows_of(ROTOR, "0 1 0.05", cards)
    slow = mu * m * G * r / inertia
    stop = spin / slow
    sliding = rows.time < 0.98 * stop
    wanted = spin * rows.time - slow * rows.time**2 / 2
    assert rows.joint_coordinate[sliding, 0] == pytest.approx(wanted[sliding], abs=1e-6)
    assert rows.joint_coordinate[-1, 0] == pytest.approx(spin**2 / (2 * slow), rel=1e-4)
    assert abs(rows.joint_rate[-1, 0]) < 1e-5
    assert rows.applied_work[-1] == pytest.approx(-inertia * spin**2 / 2, rel=1e-4)
    assert rows.element_work[-1] == pytest.approx([-inertia * spin**2 / 2], rel=1e-4)
    lost = inertia / 2 * (spin**2 - (spin - slow * rows.time) ** 2)
    assert rows.dissipated[sliding] == pytest.approx(lost[sliding], rel=1e-5)
    assert rows.element_effort[sliding, 0] == pytest.approx(np.full(sliding.sum(), -mu * m * G), rel=1e-9)


@pytest.mark.parametrize("end", ["0 0 0", "-7 0 0"])
def test_friction_follows_the_reaction_that_it_changes(end):
    """A slider pushed by P at 30° against its guide: N = m g + P sin 30°, so m a = P cos 30° - μ N.

    Points of the joint on its line set no force, but the length by which equations are scaled.
    """
    push, mu, m = 40.0, 0.2, 3.0
    cards = (
        f"MASS 2 {m} 0 0 0 1 1 1\n"
        f"GRAVITY 0 -{G} 0\n"
        "ELEMENTS\n"
        "  START at=1.stroke rate=1\n"
        f"  FRICTION friction-1 joint=1 dynamic={mu} static={mu} stribeck=0.1 creep=1e-6\n"
        f"FORCE 2 0 0 0 {push * math.cos(math.pi / 6)!r} {-push / 2} 0\n"
    )
    rows = rows_of(SLIDER.replace("1 2 0 0 0 0 0 0", f"1 2 {end} 0 0 0"), "0 0.5 0.1", cards)
    a = (push * math.cos(math.pi / 6) - mu * (m * G + push / 2)) / m
    assert rows.acceleration[:, 1, 0] == pytest.approx(np.full(6, a), rel=1e-10)
    assert rows.joint_coordinate[:, 0] == pytest.approx(rows.time + a * rows.time**2 / 2, abs=1e-9)
    # The push works, and friction takes: together m a v.
    assert rows.applied_power == pytest.approx(m * a * (1.0 + a * rows.time), rel=1e-9)


def test_a_joint_that_should_stick_creeps_at_the_speed_that_is_stated():
    """On a slope with tan 10° < μ: μ tanh(v/c) = tan 10°, so v = c atanh(tan 10°/μ)."""
    slope, mu, creep = math.radians(10), 0.3, 1e-5
    cards = (
        f"MASS 2 2 0 0 0 1 1 1\nGRAVITY {G * math.sin(slope)!r} {-G * math.cos(slope)!r} 0\n"
        f"ELEMENTS\n  FRICTION friction-1 joint=1 dynamic={mu} static={mu} stribeck=0.1 creep={creep}\nRAD5\n"
    )
    rows = rows_of(SLIDER, "0 1 0.5", cards)
    assert rows.joint_rate[-1, 0] == pytest.approx(creep * math.atanh(math.tan(slope) / mu), rel=1e-6)


@pytest.mark.long_motion
def test_a_mass_on_a_belt_sticks_and_slips_with_the_period_of_the_closed_form():
    """Belt speed V, spring k: it sticks while the spring stretches from -x1 to x1 about the sliding
    equilibrium, x1 = (μs - μd) m g/k, and slips for (2 π - 2 atan(x1 ω/V))/ω.

    Thomsen, Journal of Low Frequency Noise 18 (1999); T = 2 x1/V + 2 (π - atan(x1 ω/V))/ω.
    The belt is body 2 on a driven slide, the mass body 3 on it; smoothing errs by its speeds over V.
    """
    V, k, m, static, dynamic = 0.1, 100.0, 1.0, 0.4, 0.3
    deck = (
        "3 0 0 0 0 0 0 2 0 0 0 1\n" + "0 0 0 1 0 0 0\n" * 3
        + "1 2 0 0 0 0 0 0 1 0 0 1 0 0 0 1 0 0 0 1\n2 3 0 0 0 0 0 0 1 0 0 1 0 0 0 1 0 0 0 1\n1 0 0 0 0 0 0\n"
    )  # fmt: skip
    cards = (
        "MASS 2 1 0 0 0 1 1 1\n"
        f"MASS 3 {m} 0 0 0 1 1 1\n"
        f"GRAVITY 0 -{G} 0\n"
        "ELEMENTS\n"
        f"  FUNCTION 1 polynomial 0 {V}\n"
        "  DRIVE stroke-1 at=1.stroke value=1\n"
        "ELEMENTS\n"
        f"  SPRING lspring-1 from=0(-1,0,0) to=3(0,0,0) stiffness={k} rest=1\n"
        f"  FRICTION friction-1 joint=2 dynamic={dynamic} static={static} stribeck=1e-4 "
        "creep=1e-6\n"
        "RAD5 1e-7\n"
    )
    rows = rows_of(deck, "0 4 0.002", cards)
    speed = rows.velocity[:, 2, 0]
    slips = np.flatnonzero((speed[:-1] > 0) & (speed[1:] <= 0))
    found = np.diff(rows.time[slips] + 0.002 * speed[slips] / (speed[slips] - speed[slips + 1]))[1:]
    omega, x1 = math.sqrt(k / m), (static - dynamic) * m * G / k
    period = 2 * x1 / V + 2 * (math.pi - math.atan(x1 * omega / V)) / omega
    assert len(found) > 3
    assert found == pytest.approx(np.full(len(found), period), rel=0.003)


# Raised by a lead of 0.1665 m a radian it nearly jams: friction takes all but a thousandth.  Lowered by
# leads above r/μ, friction changes its own normal force by more than the half, and than the whole.
@pytest.mark.parametrize(
    ("sense", "sign", "pitch"),
    [(1.0, 1.0, 0.003), (-1.0, -1.0, 0.003), (-1.0, -1.0, 0.17), (-1.0, -1.0, 0.3), (1.0, 1.0, 0.1665)],
)
def test_a_power_screw_lifts_its_load_by_the_torque_of_machine_design(sense, sign, pitch):
    """Shigley, Mechanical Engineering Design, section 8-2, square thread: to raise a load F by a thread of
    radius r and lead angle λ takes T = F r (tan λ + μ)/(1 - μ tan λ), to lower it F r (μ - tan λ)/(1 + μ tan
    λ).
    """
    r, mu, load = 0.02, 0.12, 2.0 * 9.81
    slope = pitch / r
    screw = SCREW.replace("PITCH", f"{pitch}")
    cards = (
        "MASS 2 2 0 0 0 1 1 1\n"
        "GRAVITY 0 0 -9.81\n"
        "ELEMENTS\n"
        f"  FUNCTION 1 polynomial 0 {sense}\n"
        "  DRIVE angle-1 at=1.angle value=1\n"
    )
    cards += (
        "ELEMENTS\n"
        f"  FRICTION friction-1 joint=1 dynamic={mu} static={mu} stribeck=1 creep=1e-6 "
        f"radius={r}\n"
        "TOLERANCE 1e-10"
    )
    rows = rows_of(screw, "0 0.2 0.1", cards)
    torque = load * r * (slope + sign * mu) / (1.0 - sign * mu * slope)
    assert rows.driver_effort[-1, 0] == pytest.approx(torque, rel=1e-8)
    # What the friction takes is what the driver gives beyond the weight's potential.
    power = torque * sense - load * pitch * sense
    assert rows.element_power[-1, 0] == pytest.approx(-power, rel=1e-8)


@pytest.mark.long_motion
@pytest.mark.parametrize("mass", [5.0, 12.0])
@pytest.mark.parametrize(
    ("card", "near"), [("RAD5\n", 1e-6), ("GALF 0 0.9\nTOLERANCE 1e-4\n", 1e-3)], ids=["RAD5", "GALF"]
)
def test_a_screw_at_rest_that_locks_itself_creeps_by_implicit_methods(card, near, mass):
    """On flanks of the lead angle λ the load stands where μ tanh(v/c) = tan λ = p/r, v = ω √(r² + p²).

    From rest friction grows by m p²/I, 0.5 and 1.2, beyond what its normal force at rest says.
    """
    p, r, mu, creep = 3.18e-4, 0.004, 0.15, 1e-6
    cards = (
        f"MASS 2 {mass} 0 0 0 1 1 1e-6\n"
        "GRAVITY 0 0 -9.81\n"
        "ELEMENTS\n"
        f"  FRICTION friction-1 joint=1 dynamic={mu} static={mu} stribeck=1 creep={creep} "
        f"radius={r}\n"
        f"{card}"
    )
    rows = rows_of(SCREW.replace("PITCH", f"{p}"), "0 0.02 0.01", cards)
    wanted = -creep * math.atanh(p / (mu * r)) / math.hypot(r, p)
    assert rows.joint_rate[-1, 0] == pytest.approx(wanted, rel=near)


CRANK_SLIDER = """4 0 0 0 0 3 0 1 0 0 0 1
0 0 0 1 0 0 0
0 0 0 1 0 0 0
1 0 0 1 0 0 0
2.05 0 0 1 0 0 0
1 2 0 0 0 0 0 0 0 0 1 0 0 1
2 3 1 0 0 0 0 0 1 0 1 0 0 1
3 4 1.05 0 0 0 0 0 1.05 0 1 0 0 1
1 4 2.05 0 0 0 0 0 3.05 0 0 1 0 0 2.05 1 0 0 0 1
1 0 0 0 0 0 0
"""


def crank_slider(mu, force, analysis):
    """A crank of 1 m at 1 rad/s, a rod of 1.05 m without mass, a slider of 2 kg that a force pushes."""
    cards = (
        "MASS 2 1 0 0 0 1 1 1\nMASS 3 1e-9 0 0 0 1e-12 1e-12 1e-12\nMASS 4 2 0 0 0 1 1 1\n"
        "ELEMENTS\n"
        "  FUNCTION 1 polynomial 0 1\n"
        "  DRIVE angle-1 at=1.angle value=1\n"
        f"  FRICTION friction-1 joint=4 dynamic={mu} static={mu} stribeck=1 creep=1e-7\n"
        f"FORCE 4 0 0 0 {force} 0 0\n"
    )
    return rows_of(CRANK_SLIDER, "0 1.6 0.1", cards, analysis)


@pytest.mark.parametrize("analysis", ["inverse", pytest.param("forward", marks=pytest.mark.long_motion)])
def test_friction_that_helps_the_rod_follows_newtons_law_beyond_the_reach_of_substitution(analysis):
    """Rod at the angle φ with the force S: m a = S cos φ + F + μ S sin φ where the slider returns.

    At 1.4 s μ tan φ = 1.09: substitution would grow from one normal force to the next.
    """
    mu, force, m, rod = 0.4, -30.0, 2.0, 1.05
    rows = crank_slider(mu, force, analysis)
    t = rows.time[1:]
    root = np.sqrt(rod**2 - np.sin(t) ** 2)
    v = -np.sin(t) - np.sin(t) * np.cos(t) / root
    a = -np.cos(t) - (np.cos(2 * t) / root + (np.sin(t) * np.cos(t)) ** 2 / root**3)
    sine, cosine = np.sin(t) / rod, root / rod
    friction = mu * sine * (m * a - force) / (cosine + mu * sine)
    assert np.max(mu * sine / cosine) > 1.2
    assert rows.element_effort[1:, 0] == pytest.approx(friction, rel=1e-6)
    assert rows.driver_effort[1:, 0] == pytest.approx((m * a - force - friction) * v, rel=1e-6)


def test_a_joint_that_jams_ends_the_run_and_keeps_the_rows_before():
    """With μ tan φ above 1 friction against the rod grows with its own normal force: none holds."""
    with pytest.raises(AnalysisError, match="friction jams a joint") as raised:
        crank_slider(0.35, 30.0, "inverse")
    # μ tan φ = 1 where sin φ = 1/√(1 + μ²), which is beyond the reach of the rod up to 1.4 s.
    assert 1.4 < raised.value.time < 1.6


@pytest.mark.long_motion
@pytest.mark.parametrize("card", METHODS.values(), ids=METHODS)
def test_a_jam_that_steps_only_come_near_to_ends_a_free_motion_as_a_jam(card):
    """Three frictions, and a flywheel that nothing drives: steps vanish in front of the jam, all slides.

    Friction of the slider alone locks where tan φ = 1/μ, sin φ = sin ωt/1.05: at 1.346 s; the bearings
    of the rod add to it, so that it jams before.
    """
    cards = (
        "MASS 2 1 0 0 0 1 1 1e6\n"
        "MASS 3 0.01 0 0 0 1e-3 1e-3 1e-3\n"
        "MASS 4 2 0 0 0 1 1 1\n"
        "ELEMENTS\n"
        "  START at=1.angle rate=1\n"
        "ELEMENTS\n"
        "  FRICTION friction-1 joint=4 dynamic=0.4 static=0.4 stribeck=1 creep=1e-4\n"
        "  FRICTION friction-2 joint=3 dynamic=0.2 static=0.2 stribeck=1 creep=1e-4 "
        "radius=0.05 preload=5\n"
        "  FRICTION friction-3 joint=2 dynamic=0.2 static=0.2 stribeck=1 creep=1e-4 "
        "radius=0.05 preload=5\n"
        f"FORCE 4 0 0 0 30 0 0\n{card}"
    )
    with pytest.raises(AnalysisError, match="friction jams a joint") as raised:
        rows_of(CRANK_SLIDER, "0 1.6 0.4", cards)
    assert 1.25 < raised.value.time < 1.346


def test_steps_that_friction_shortens_name_another_method_and_a_larger_creep_speed():
    """GALF by the default tolerance cannot follow the first 10 ns; no joint jams in the state at rest."""
    cards = (
        "MASS 2 12 0 0 0 1 1 1e-6\n"
        "GRAVITY 0 0 -9.81\n"
        "ELEMENTS\n"
        "  FRICTION friction-1 joint=1 dynamic=0.15 static=0.15 stribeck=1 creep=1e-6 "
        "radius=0.004\n"
        "GALF 0 0.9\n"
    )
    with pytest.raises(AnalysisError, match=r"try RAD5, or a smaller one, or a larger creep speed$"):
        rows_of(SCREW.replace("PITCH", "3.18e-4"), "0 0.02 0.01", cards)
