"""Corrections of least norm on equations whose solutions are known by hand."""

import math

import numpy as np
import pytest

from flexmb_cli.solvers.projection import Corrections, Instant, improving, project, shortened, whole

NO_ANGLES = np.zeros(0)
ROUND_OFF = Corrections(met=1e-14, most=50, dependent=1e-9)


class Sphere:
    """|q| = 1 in any number of dimensions, `times` over: all but one equation repeat another."""

    def __init__(self, times=1):
        self.times = times

    def residual(self, q, t, expected):
        return np.full(self.times, 0.5 * (q @ q - 1.0))

    def jacobian(self, q):
        return np.tile(q, (self.times, 1))

    def moved(self, q, step):
        return q + step


class Arctangent(Sphere):
    """arctan q = 0: Newton's method diverges from beyond 1.3917, where arctan q = 2 q / (1 + q²)."""

    def residual(self, q, t, expected):
        return np.arctan(q)

    def jacobian(self, q):
        return np.diag(1.0 / (1.0 + q**2))


def found(equations, q, corrections=ROUND_OFF, advance=whole, columns=None):
    return project(Instant(equations, 0.0, NO_ANGLES), np.array(q), corrections, advance, columns)


@pytest.mark.parametrize("times", [1, 3])
def test_a_point_comes_onto_a_sphere_along_its_radius(times):
    q, gap = found(Sphere(times), [1.2, -0.4, 0.3])
    assert q == pytest.approx(np.array([1.2, -0.4, 0.3]) / 1.3, abs=1e-15)
    assert np.abs(gap).max() <= 1e-14


def test_only_the_columns_that_are_free_change():
    """From (0.8, 0.5) along x: x = √(1 - 0.25)."""
    q, _ = found(Sphere(), [0.8, 0.5], columns=np.array([True, False]))
    assert q == pytest.approx([math.sqrt(0.75), 0.5], abs=1e-15)


@pytest.mark.parametrize(("advance", "end"), [(improving, 1.5), (shortened, 0.0)])
def test_a_correction_that_widens_the_gap_is_refused_or_shortened(advance, end):
    q, _ = found(Arctangent(), [1.5], advance=advance)
    assert q == pytest.approx([end], abs=1e-14)


def test_whole_corrections_may_widen_the_gap_until_it_is_hopeless():
    """The arctangents of 0.2 and 1.5 are 0.197 and 0.983."""
    q, _ = found(Arctangent(), [1.5], Corrections(met=1e-14, most=3, dependent=1e-9))
    assert abs(q[0]) > 1.5
    assert found(Arctangent(), [1.5], Corrections(1e-14, 3, 1e-9, hopeless=0.5))[0] == [1.5]
    assert found(Arctangent(), [0.2], Corrections(1e-14, 9, 1e-9, hopeless=0.5))[0] == pytest.approx([0.0])


def test_equations_that_are_no_numbers_end_the_corrections():
    q, gap = found(Sphere(), [np.nan, 1.0])
    assert np.isnan(gap).all()
    assert q[1] == 1.0
