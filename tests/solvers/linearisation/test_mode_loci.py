"""Modes over a number of a deck: whirl of an overhung rotor, and the root locus of a damped mass."""

import json
from pathlib import Path

import numpy as np
import pytest
from scipy.interpolate import CubicSpline
from scipy.optimize import brentq

from tests.study.sensitivity_decks import OSCILLATOR
from tests.study.studies import flexmb

ROTOR = Path(__file__).resolve().parents[3] / "decks/vsdf/rotor.vsdf"
# Shaft of decks/vsdf/fe/rotor/shaft.bdf; disc of the deck.
E, RHO, D, L = 2.1e11, 7850.0, 0.02, 0.5
MASS, POLAR, DIAMETRAL = 10.0, 0.2, 0.1


def whirl(speed):
    """Whirl frequencies (4,), Hz, of a disc on a cantilever beam: positive ones turn with the disc.

    Complex deflection and slope of the tip: gyroscopic moment of the disc (Genta, Dynamics of Rotating
    Systems, 2005, chapter 2), stiffness and mass of one Hermitian beam element with rotary inertia.
    """
    second = np.pi * D**4 / 64.0
    K = E * second * np.array([[12.0 / L**3, -6.0 / L**2], [-6.0 / L**2, 4.0 / L]])
    M = np.diag([MASS, DIAMETRAL])
    M += RHO * np.pi * D**2 / 4.0 * L / 420.0 * np.array([[156.0, -22.0 * L], [-22.0 * L, 4.0 * L * L]])
    M += RHO * second / (30.0 * L) * np.array([[36.0, -3.0 * L], [-3.0 * L, 4.0 * L * L]])
    G = np.diag([0.0, POLAR * speed])
    A = np.block([[np.zeros((2, 2)), np.eye(2)], [-np.linalg.solve(M, K), 1j * np.linalg.solve(M, G)]])
    return np.sort(np.linalg.eigvals(A).imag) / (2.0 * np.pi)


def loci(folder, *arguments):
    """The record of `--json`, its lists as arrays."""
    record = json.loads(flexmb("modes", *arguments, "--json", cwd=folder).stdout)["loci"]
    return record | {
        key: np.array(record[key], float) for key in ("values", "frequency", "real", "imaginary")
    }


def test_whirl_and_critical_speeds_of_an_overhung_rotor_are_those_of_the_gyroscopic_beam(tmp_path):
    """Each column is one mode of the closed form all along, although two of them are equal at rest.

    Critical speeds: where splines through the closed form at the same speeds meet that of the spin.
    """
    found = loci(
        tmp_path, ROTOR, "--over", "velocity.1.w.x", 0, 300, 5, "--frequencies", 0, 150, "--order", 1
    )
    speeds, frequency = found["values"], found["frequency"]
    expected = np.abs([whirl(speed) for speed in speeds])[:, [1, 2, 0, 3]]
    assert frequency[:, np.argsort(frequency[-1])] == pytest.approx(expected, rel=1e-7)
    curves = [CubicSpline(speeds, curve - speeds / (2.0 * np.pi)) for curve in expected.T]
    critical = sorted(value for curve in curves for value in curve.roots(extrapolate=False))
    assert len(critical) == 3
    assert sorted(one["value"] for one in found["critical"]) == pytest.approx(critical, rel=1e-6)
    # The forward one, by the closed form itself.
    forward = brentq(lambda speed: whirl(speed)[2] - speed / (2.0 * np.pi), 20.0, 200.0)
    assert critical[1] == pytest.approx(forward, rel=1e-3)


def test_the_root_locus_of_a_damped_mass_is_that_of_its_quadratic_equation(tmp_path):
    """s = -c/2m + i sqrt(k/m - c²/4m²); from c = 20 on nothing oscillates."""
    (tmp_path / "IN-MASS.dat").write_text(OSCILLATOR)
    found = loci(tmp_path, "IN-MASS.dat", "--over", "damping", 0, 27, 4, "--locus", "locus.csv")
    c = found["values"]
    with np.errstate(invalid="ignore"):
        expected = np.where(c < 20.0, -c / 4.0 + 1j * np.sqrt(25.0 - c**2 / 16.0), np.nan)
    roots = found["real"][:, 0] + 1j * found["imaginary"][:, 0]
    assert roots == pytest.approx(expected, abs=1e-8, nan_ok=True)
    table = np.genfromtxt(tmp_path / "locus.csv", delimiter=",", skip_header=1)
    assert table[:, 4] == pytest.approx(expected.imag, abs=1e-8, nan_ok=True)
    assert (tmp_path / "locus.csv").read_text().startswith("damping,mode 1 frequency [Hz],mode 1 damping,")


def test_a_picture_shows_both_diagrams(tmp_path):
    (tmp_path / "IN-MASS.dat").write_text(OSCILLATOR)
    flexmb(
        "modes", "IN-MASS.dat", "--over", "damping", 0, 10, 3, "--order", 2, "--locus", "l.svg", cwd=tmp_path
    )
    picture = (tmp_path / "l.svg").read_text()
    assert all(f"<!-- {words} -->" in picture for words in ("frequency [Hz]", "imaginary part [1/s]"))


@pytest.mark.parametrize(
    ("arguments", "identifier"),
    [
        (["--order", 1], "CLI-170"),
        (["--over", "damping", 2, 1, 5], "CLI-171"),
        (["IN-MASS.dat", "--over", "damping", 0, 1, 5], "CLI-172"),
        (["--over", "damping", 0, 1, 5, "--locus", "l.txt"], "CLI-173"),
        (["--over", "damping", 0, 1, 5, "--out", "l.npz"], "CLI-174"),
        (["--over", "damping", 0, 1, 5, "--frequencies", 2, 1], "CLI-175"),
        (["--over", "dampin", 0, 1, 5], "RUN-170"),
        (["--over", "damping", 30, 40, 2], "RUN-171"),
    ],
)
def test_what_cannot_be_followed_is_refused(arguments, identifier, tmp_path):
    (tmp_path / "IN-MASS.dat").write_text(OSCILLATOR)
    ended = flexmb("modes", "IN-MASS.dat", *arguments, "--json", cwd=tmp_path, check=False)
    assert ended.returncode == 2
    assert identifier in [fault["id"] for fault in json.loads(ended.stdout)["faults"]]
