"""Sensitivities against derivatives of closed forms, and differences of eighth order of whole runs."""

import json

import numpy as np
import pytest
from scipy.optimize import brentq

from flexmb_cli.errors import FlexmbError
from flexmb_cli.interface import read_deck, sensitivity, solve
from tests.study.sensitivity_decks import COLLISION, DECKS, OSCILLATOR, SLIDER_CRANK
from tests.study.studies import flexmb


def complex_step(function, numbers, *arguments):
    """Derivatives (rows, of, numbers) of a closed form (rows, of): exact to round-off."""
    columns = []
    for k in range(len(numbers)):
        changed = np.array(numbers, complex)
        changed[k] += 1e-30j
        columns.append(np.imag(function(*changed, *arguments)) / 1e-30)
    return np.stack(columns, axis=2)


def largest_errors(found, expected):
    """Largest errors (of, to), of the largest derivative."""
    return np.abs(found - expected).max(axis=0) / np.abs(expected).max(axis=0)


def slider(crank, rod, start, speed, t):
    """Position, velocity and acceleration of the slider of a crank at a steady speed."""
    theta = start + speed * t
    s, c = np.sin(theta), np.cos(theta)
    root = np.sqrt(rod**2 - crank**2 * s**2)
    first = -crank * s - crank**2 * s * c / root
    second = -crank * c - crank**2 * (c**2 - s**2) / root - crank**4 * s**2 * c**2 / root**3
    return np.stack([crank * c + root, speed * first, speed**2 * second], axis=1)


def test_kinematics_are_those_of_the_closed_form_of_a_slider_crank():
    """Closed form, differentiated by complex steps; the lengths stand in several places of the deck."""
    found = sensitivity(
        SLIDER_CRANK,
        ["body.4.x", "body.4.velocity.x", "body.4.acceleration.x"],
        ["crank", "rod", "start", "speed"],
    )
    expected = complex_step(slider, [1.0, 3.0, 0.5, 2.0], found.time)
    assert largest_errors(found.derivatives, expected).max() < 1e-10


def oscillator(mass, stiffness, damping, speed, t):
    """Stroke and rate of a damped oscillator that begins at rest length."""
    decay = damping / (2.0 * mass)
    omega = np.sqrt(stiffness / mass - decay**2)
    envelope = speed * np.exp(-decay * t)
    stroke = envelope / omega * np.sin(omega * t)
    return np.stack([stroke, envelope * np.cos(omega * t) - decay * stroke], axis=1)


@pytest.mark.parametrize("method", ["dop853", "radau", "alpha"])
def test_motions_are_those_of_the_closed_form_of_an_oscillator(method):
    """Closed form, differentiated by complex steps; the deck has a tolerance of 1e-9 a step."""
    found = sensitivity(
        OSCILLATOR,
        ["coordinate.1", "coordinate.1.u"],
        ["mass", "stiffness", "damping", "speed"],
        method=method,
    )
    expected = complex_step(oscillator, [2.0, 50.0, 1.5, 0.8], found.time)
    assert largest_errors(found.derivatives, expected).max() < 1e-7
    relative = found.derivatives[1:] * [2.0, 50.0, 1.5, 0.8] / found.values[1:, :, None]
    assert found.relative[1:] == pytest.approx(relative)
    assert np.isnan(found.relative[0, 0]).all()


def test_modes_are_those_of_the_closed_form_of_an_oscillator():
    """f = ω√(1 - ζ²)/2π and ζ = c/(2√(k m)), differentiated by complex steps."""

    def modes(mass, stiffness, damping):
        ratio = damping / (2.0 * np.sqrt(stiffness * mass))
        return np.array([[np.sqrt(stiffness / mass * (1.0 - ratio**2)) / (2.0 * np.pi), ratio]])

    found = sensitivity(OSCILLATOR, ["mode.1.frequency", "mode.1.damping"], ["mass", "stiffness", "damping"])
    expected = complex_step(modes, [2.0, 50.0, 1.5])
    assert largest_errors(found.derivatives, expected).max() < 1e-9


def test_equilibrium_and_its_modes_are_those_of_the_elastic_pendulum():
    """Closed form of pendulum.DAT: x = m g/k, f1 = √(g/(l + x))/2π, f2 = √(k/m)/2π with l = 0.3 m."""
    deck, to = read_deck(DECKS / "dafms/pendulum.DAT"), ["gravity.g3", "bkp.1.BKP(1)"]
    rest = sensitivity(deck, ["coordinate.2"], to, equilibrium=True)
    assert rest.derivatives[0, 0] == pytest.approx([0.2 / 19.6, -0.2 * 9.8 / 19.6**2], rel=1e-9)
    modes = sensitivity(deck, ["mode.1.frequency", "mode.2.frequency"], to, equilibrium=True)
    # d ln f1/d ln g = (1 - x/(l + x))/2
    assert modes.relative[0] == pytest.approx(np.array([[0.375, 0.125], [0.0, 0.5]]), abs=1e-9)


def speed_after(speed, loss):
    """Speed after a collision: w/χ - ln(1 + χ w)/χ² is the same at its end, with the other sign."""

    def lost(w):
        return w / loss - np.log1p(loss * w) / loss**2

    return brentq(lambda w: lost(-w) - lost(speed), 0.0, speed, xtol=1e-15)


def test_the_jump_at_a_contact_is_that_of_the_closed_form():
    """Hunt and Crossley (1975): speed after the collision; differences of the closed form."""
    found = sensitivity(COLLISION, ["body.2.velocity.z"], ["speed", "stiffness", "loss"])
    h = 1e-4
    by_speed, by_loss = (
        (8 * (f(h) - f(-h)) - (f(2 * h) - f(-2 * h))) / (12 * h)
        for f in (lambda x: speed_after(2.0 + x, 0.4), lambda x: speed_after(2.0, 0.4 + x))
    )
    assert found.derivatives[0, 0] == pytest.approx([-1.0, 0.0, 0.0], abs=1e-9)
    assert found.derivatives[-1, 0] == pytest.approx([by_speed, 0.0, by_loss], abs=1e-7)


EIGHTH_ORDER = ((1, 4 / 5), (2, -1 / 5), (3, 4 / 105), (4, -1 / 280))


def differences(path, found, name, h, **options):
    """Derivatives (rows, of) by differences of eighth order of runs that are solved anew."""
    value = float(found.to[name].value)

    def values(change):
        result = solve(read_deck(path, {name: repr(value + change)}), **options)
        return np.column_stack([result[quantity.name] for quantity in found.of])

    return sum(weight * (values(k * h) - values(-k * h)) for k, weight in EIGHTH_ORDER) / h


DRIVEN = [
    ("young/IN4-BAR.dat", "body.3.acceleration", "driver.1.B", 2e-3),
    ("young/IN-RSSR.dat", "body.3.velocity", "spherical.1.P_i.z", 1e-4),
    ("young/IN5BODY.dat", "body.4.position", "driver.1.B", 2e-3),
    ("young/dynamics/IN4-BAR-MASS.dat", "driver.1.effort", "mass.2.m", 1.0),
    ("young/dynamics/IN-RSSR-MASS.dat", "reaction.1.force", "driver.1.B", 1e-2),
]


@pytest.mark.parametrize("deck, of, to, h", DRIVEN)
def test_prescribed_motions_and_their_forces_are_those_of_differences(deck, of, to, h):
    """Runs are solved to round-off, so that their differences are known to 1e-10 of their largest."""
    path = DECKS / deck
    found = sensitivity(read_deck(path), [of], [to])
    expected = differences(path, found, to, h)
    assert np.abs(found.derivatives[:, :, 0] - expected).max() < 1e-9 * np.abs(expected).max()


FREE = [
    ("dafms/sliding_mass.DAT", "coordinate", "mass.2.BM", 2e-3),
    ("dafms/fourbar_rigid.DAT", "coordinate", "mass.2.BM", 5e-4),
    ("dafms/spatial_rigid.DAT", "coordinate", "mass.1.BM", 2e-4),
    ("vsdf/freeflying.vsdf", "body.1.velocity", "velocity.1.w.y", 0.01),
]


@pytest.mark.parametrize("deck, of, to, h", FREE)
def test_free_motions_are_those_of_differences(deck, of, to, h):
    """Differences of runs at a tolerance of 1e-13 a step, until small changes have grown a thousand times."""
    path, method = DECKS / deck, "dop853"
    found = sensitivity(read_deck(path), [of], [to], method=method, rtol=1e-11)
    expected = differences(path, found, to, h, method=method, rtol=1e-13)[:150]
    assert np.abs(found.derivatives[:150, :, 0] - expected).max() < 1e-7 * np.abs(expected).max()


def test_stops_and_friction_are_differentiated_to_the_length_of_the_steps_that_meet_them():
    """Their forces have corners inside of steps, which leave an error of the steps' length, 1e-5 s here."""
    path = DECKS / "young/dynamics/IN-ELEMENTS.dat"
    found = sensitivity(read_deck(path), ["coordinate"], ["stay.stiffness"], rtol=1e-11)
    expected = differences(path, found, "stay.stiffness", 0.02, rtol=1e-13)
    assert np.abs(found.derivatives[:, :, 0] - expected).max() < 1e-3 * np.abs(expected).max()


def test_a_number_at_the_end_of_its_range_is_differentiated_to_the_other_side():
    """The derivative by a damping of 0: that of the closed form, -t/(2 m) of the stroke and so on."""
    deck = OSCILLATOR.replace("SET damping = 1.5", "SET damping = 0")
    found = sensitivity(deck, ["coordinate.1", "coordinate.1.u"], ["damping"])
    expected = complex_step(oscillator, [2.0, 50.0, 0.0, 0.8], found.time)[:, :, 2:3]
    assert largest_errors(found.derivatives, expected).max() < 1e-6


@pytest.mark.parametrize(
    "of, to, message",
    [
        ("coordinate.1", "gravity.g4", "the deck has no number 'gravity.g4'; gravity holds KG, g1, g2, g3"),
        ("coordinate.1", "time.IT", "time.IT is a count or a word, by which nothing can be differentiated"),
        ("coordinate.1", "time.H", "time.H changes the report times, at which the values are compared"),
        ("coordinate.7", "gravity.g3", "coordinate.7: the result has no such quantity"),
        ("mode.7.frequency", "gravity.g3", "there are mode.1.frequency and mode.1.damping, up to mode 2"),
    ],
)
def test_what_cannot_be_differentiated_is_refused(of, to, message):
    with pytest.raises(FlexmbError) as failure:
        sensitivity(DECKS / "dafms/pendulum.DAT", [of], [to])
    assert message in str(failure.value)


def test_a_motion_in_which_a_joint_is_let_go_is_refused():
    lines = (
        "  JOINT hold inplane from=1(0,0,0) to=2(0,0,0) axis_from=(1,0,0)\n  RELEASE go of=hold time=0.5\n"
    )
    with pytest.raises(FlexmbError) as failure:
        sensitivity(OSCILLATOR.replace("END\n", f"{lines}END\n"), ["coordinate.1"], ["mass"])
    [fault] = failure.value.faults
    assert (fault.id, fault.subject) == ("SOLVE-192", "go")


def test_the_command_prints_rows_and_writes_a_file_that_table_reads(tmp_path):
    (tmp_path / "IN-SLIDER.dat").write_text(SLIDER_CRANK)
    asked = ["--of", "body.4.x", "--to", "crank", "--to", "rod", "--every", 10]
    printed = flexmb("sensitivity", "IN-SLIDER.dat", *asked, "-o", "s.h5", cwd=tmp_path).stdout
    found = sensitivity(SLIDER_CRANK, ["body.4.x"], ["crank", "rod"])
    rows = np.genfromtxt(printed.splitlines()[1:], delimiter=",")
    np.testing.assert_array_equal(rows[:, 2:], found.derivatives[::10, 0])
    assert printed.startswith(
        "time [s],value.body.4.x [m],derivative.body.4.x.crank [m],derivative.body.4.x.rod"
    )
    table = flexmb("table", "s.h5", "relative.body.4.x.rod", "--every", 10, cwd=tmp_path).stdout
    rows = np.genfromtxt(table.splitlines()[1:], delimiter=",")
    np.testing.assert_array_equal(rows[:, 1], found.relative[::10, 0, 1])
    record = json.loads(flexmb("sensitivity", "IN-SLIDER.dat", *asked, "--json", cwd=tmp_path).stdout)
    assert record["derivatives"] == found.derivatives[::10].tolist()
