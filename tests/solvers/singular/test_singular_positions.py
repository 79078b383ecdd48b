"""Parallelograms that swing through the positions where their bars lie in line, and motions branch.

Their coupler stays parallel to the ground; on the other branch it turns.  The crank turns as a pendulum with
the moments of all bars does, which DOP853 of SciPy integrates with a tolerance of 1e-12.
"""

import math
from dataclasses import dataclass, replace

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from flexmb_cli.errors import AnalysisError
from flexmb_cli.fe.build_mechanism import flexible_mechanism
from flexmb_cli.kernels.constrained.angle_unwrapping import EXPECTED
from flexmb_cli.kernels.constrained.near_singular_row import fill_doubtful_row
from flexmb_cli.model.integrators import Integrator
from flexmb_cli.model.mechanism import TimeGrid
from flexmb_cli.solvers.constrained.flexible_dynamics import FlexibleDynamics
from flexmb_cli.solvers.constrained.system import blank_report
from tests.dialects.vsdf.vsdf_decks import build

WEIGHT = 3.0  # m/s²
ROWS = 100
INERTIA = 0.1  # of each bar about its centre, kg m²


@dataclass(frozen=True)
class Parallelogram:
    """Cranks on bearings `base` apart; masses of the first crank, the coupler and the second crank."""

    angle: float  # rad, at the start
    speed: float  # rad/s
    base: float  # m
    crank: float  # m
    masses: tuple[float, float, float]  # kg
    gravity: float = 0.0
    longer: float = 0.0  # by how much the second crank is longer than the first, m

    def mechanism(self, integrator, end=6.0):
        """Four hinges about z on six bearings of the ground and the bars."""
        c, s = self.crank * math.cos(self.angle), self.crank * math.sin(self.angle)
        p = f"{math.cos(0.5 * self.angle):.17g},0,0,{math.sin(0.5 * self.angle):.17g}"
        lengths = self.crank, self.base, self.crank + self.longer
        nodes = [
            f"{body},{node},{x:.17g},0,{z}"
            for body, length in enumerate((self.base, *lengths))
            for node, (x, z) in enumerate(((0, 0), (0, 1), (length, 0), (length, 1)), 1)
        ]
        bars = list(zip((1, 2, 3), self.masses, lengths, strict=True))
        lines = ["VSDF parallelogram", "BODY", "1,RIGD", "2,RIGD", "3,RIGD", "RIGI"]
        for k, mass, length in bars:
            lines += [f"{k},{mass},{0.5 * length:.17g}", f"0.01,{INERTIA},{INERTIA}"]
        lines += ["POSI", f"2,{c:.17g},{s:.17g},0", f"3,{self.base},0,0", "EULP", f"1,{p}", f"3,{p}"]
        lines += ["VELO", f"1,0,0,0,0,0,{self.speed}", f"2,{-self.speed * s:.17g},{self.speed * c:.17g},0"]
        lines += [f"3,0,0,0,0,0,{self.speed}", "NODE", *nodes, "JOIN", "1,REVO,0,1,2,1,1,2"]
        lines += ["2,REVO,1,3,4,2,1,2", "3,REVO,2,3,4,3,3,4", "4,REVO,0,3,4,3,1,2"]
        lines += ["TIME", "6,0.05", "INTG", "RAD5,1e-6", "END", "STAR", "STOP"]
        # Data stand after a blank.
        text = "".join(f" {line}\n" if "," in line else f"{line}\n" for line in lines)
        found, _ = flexible_mechanism(build(text), cached=False)
        time = TimeGrid(0.0, end, end / ROWS)
        return replace(found, integrator=integrator, gravity=(0.0, -self.gravity, 0.0), time=time)

    def turn(self, times):
        """The angle of the cranks, rad."""
        first, coupler, second = self.masses
        arm = self.crank * (0.5 * first + coupler + 0.5 * second)
        moment = 2.0 * INERTIA + self.crank**2 * (0.25 * first + coupler + 0.25 * second)

        def slope(_, y):
            return [y[1], -self.gravity * arm * math.cos(y[0]) / moment]

        start = (self.angle, self.speed)
        return solve_ivp(slope, (0, times[-1]), start, "DOP853", times, rtol=1e-12, atol=1e-12).y[0]


def turns(rows, body):
    e = rows.euler_parameters[:, body]
    return 2.0 * np.arctan2(e[:, 3], e[:, 0])


def run(parallelogram, integrator, end=6.0):
    """(times, angles of crank and coupler, what stopped it)."""
    analysis, blocks, stopped = FlexibleDynamics(parallelogram.mechanism(integrator, end)), [], ""
    try:
        blocks.extend(analysis.rows())
    except AnalysisError as error:
        stopped = str(error)
    found = [np.concatenate([of(rows) for rows in blocks]) for of in
             (lambda rows: rows.time, lambda rows: turns(rows, 0), lambda rows: turns(rows, 1))]  # fmt: skip
    return (*found, stopped)


def parallelograms():
    for angle in (0.3, 2.0):
        for gravity in (0.0, WEIGHT):
            yield Parallelogram(angle, 1.5, 2.0, 1.0, (1.0, 1.0, 1.0), gravity)
            yield Parallelogram(angle, 3.0, 1.0, 2.0, (1.0, 5.0, 1.0), gravity)
            yield Parallelogram(angle, -2.1, 3.0, 1.0, (0.5, 1.0, 4.0), gravity)


def stops_of(parallelogram, integrator, error):
    """What stopped a run, all rows of which are on the smooth branch."""
    times, crank, coupler, stopped = run(parallelogram, integrator)
    assert np.abs(np.sin(0.5 * coupler)).max() < error
    assert np.abs(np.sin(0.5 * (crank - parallelogram.turn(times)))).max() < error
    assert not stopped or "a singular position of joint 1" in stopped
    return stopped


@pytest.mark.long_motion
@pytest.mark.parametrize(("tolerance", "passes"), [(1e-4, 12), (1e-5, 12), (1e-6, 12), (1e-8, 9), (1e-10, 1)])
def test_radaus_method_passes_smoothly_or_stops(tolerance, passes):
    """Up to six passes each; 20 of 32 couplers once turned on the other branch at 1e-4, 7 at 1e-6.

    The smaller the tolerance, the nearer to a position in line steps come, where round-off decides.
    """
    stops = [stops_of(one, Integrator("RAD5", 0.0, tolerance), 300.0 * tolerance) for one in parallelograms()]
    assert len(stops) - sum(map(bool, stops)) >= passes


def test_radaus_method_steps_over_a_position_in_line():
    """Where it steps up to it instead, step lengths fall to nothing 0.04 s before."""
    swinging = Parallelogram(0.5, -2.0, 2.0, 1.0, (1.0, 1.0, 1.0), WEIGHT)
    times, crank, coupler, stopped = run(swinging, Integrator("RAD5", 0.0, 1e-8), 0.5)
    assert not stopped and times[-1] == 0.5
    assert np.abs(coupler).max() < 1e-7
    assert crank == pytest.approx(swinging.turn(times), abs=1e-7)


@pytest.mark.long_motion
@pytest.mark.parametrize("length", [0.0, 0.02])
def test_generalised_alpha_passes_smoothly(length):
    for parallelogram in parallelograms():
        assert not stops_of(parallelogram, Integrator("GALF", length, 1e-6, 0.9), 0.02)


@pytest.mark.long_motion
@pytest.mark.parametrize("tolerance", [1e-6, 1e-8])
def test_a_run_that_ends_in_line_stops_there_by_name(tolerance):
    """Cranks that turn steadily at 1.5 rad/s from 0.5 rad lie in line at (π - 0.5)/1.5 s."""
    end = (math.pi - 0.5) / 1.5
    steady = Parallelogram(0.5, 1.5, 2.0, 1.0, (1.0, 1.0, 1.0))
    analysis = FlexibleDynamics(steady.mechanism(Integrator("RAD5", 0.0, tolerance), end))
    blocks = []
    with pytest.raises(AnalysisError, match="a singular position"):
        blocks.extend(analysis.rows())
    assert np.abs(np.concatenate([turns(rows, 1) for rows in blocks])).max() < 1e-7
    assert blocks[-1].time[-1] > 0.8 * end


@pytest.mark.long_motion
def test_a_run_by_a_coarse_tolerance_ends_in_line_without_accelerations():
    end = (math.pi - 0.5) / 1.5
    steady = Parallelogram(0.5, 1.5, 2.0, 1.0, (1.0, 1.0, 1.0))
    analysis = FlexibleDynamics(steady.mechanism(Integrator("RAD5", 0.0, 1e-5), end))
    blocks = list(analysis.rows())
    assert np.isnan(blocks[-1].angular_acceleration[-1, 0, 2])
    assert np.abs(np.concatenate([turns(rows, 1) for rows in blocks])).max() < 1e-7
    assert "a singular position" in analysis.warnings[-1].message


@pytest.mark.parametrize(
    ("card", "number", "length"), [("RAD5", 1e-5, 0), ("RK45", 1e-8, 0), ("GALF", 1e-6, 0)]
)
def test_a_row_in_line_has_no_reactions_and_is_told(card, number, length):
    """From 0.5 rad at -2 rad/s the row at 0.25 s stands in line, on the motion: 2 rad/s and no acceleration
    of the turn; the coupler goes round on 1 m.

    An earlier version stopped there by RAD5.
    """
    steady = Parallelogram(0.5, -2.0, 3.0, 1.0, (0.5, 1.0, 4.0))
    analysis = FlexibleDynamics(steady.mechanism(Integrator(card, length, number), 0.5))
    blocks = list(analysis.rows())
    times, speeds, accelerations, inwards, forces = (
        np.concatenate([getattr(rows, name) for rows in blocks])
        for name in ("time", "angular_velocity", "angular_acceleration", "acceleration", "reaction_force")
    )
    assert times[50] == pytest.approx(0.25, abs=1e-15)
    assert speeds[:, 0, 2] == pytest.approx(-2.0, abs=1e-3)
    assert np.abs(accelerations[:, 0, 2]).max() < 0.01
    assert inwards[50, 1] == pytest.approx([-4.0, 0.0, 0.0], abs=0.01)
    assert np.flatnonzero(np.isnan(forces).any(axis=(1, 2))).tolist() == [50]
    (told,) = [note.message for note in analysis.warnings if note.id == "SOLVE-041"]
    assert "at t = 0.25 s a row is so near to a singular position" in told


def test_a_doubtful_row_that_round_off_does_not_rule_is_that_of_the_equations():
    """Away from the line: the coupler of 1 kg circles at 2 rad/s on 1 m, and both cranks pull it inwards."""
    steady = Parallelogram(0.5, -2.0, 3.0, 1.0, (0.5, 1.0, 4.0))
    analysis = FlexibleDynamics(steady.mechanism(Integrator("RK45", 0.0, 1e-8), 0.5))
    analysis.start()
    integration, report = analysis.integration, blank_report(analysis.arrays, np.zeros(1), analysis.works)
    place = integration.z.copy(), integration.units, integration.angles[EXPECTED]
    report.rates[0] = np.nan
    fill_doubtful_row(analysis.system, analysis.work, integration.z, place, 0.0, 1e-8, report, 0)
    rows, inwards = analysis.block(report), -4.0 * np.array([math.cos(0.5), math.sin(0.5), 0.0])
    assert rows.reaction_force[0, 1] - rows.reaction_force[0, 2] == pytest.approx(inwards, abs=1e-9)
    assert rows.acceleration[0, 1] == pytest.approx(inwards, abs=1e-9)
    assert turns(rows, 0) == pytest.approx([0.5], abs=1e-12)


def test_the_rows_of_a_block_are_looked_at_at_once(monkeypatch):
    """A call of numpy's for each row took as long as ten steps."""
    sizes, svd = [], np.linalg.svd
    monkeypatch.setattr(
        np.linalg, "svd", lambda a, *how, **named: sizes.append(a.shape) or svd(a, *how, **named)
    )
    mechanism = Parallelogram(0.5, 1.5, 2.0, 1.0, (1.0, 1.0, 1.0)).mechanism(Integrator("RAD5", 0.0, 1e-4))
    analysis = FlexibleDynamics(replace(mechanism, time=TimeGrid(0.0, 0.01, 0.002)))
    assert sum(len(rows.time) for rows in analysis.rows()) == 6
    equations, speeds = len(analysis.arrays.equations), analysis.arrays.speeds
    assert sizes.count((6, equations, speeds)) == 1
    assert sizes.count((equations, speeds)) < 6  # those of the start
