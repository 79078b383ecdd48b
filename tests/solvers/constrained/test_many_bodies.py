"""Mechanisms of more bodies than dense matrices serve: chains in rest, swinging and given a velocity."""

import sys
from pathlib import Path

import numpy as np
import pytest

sys.path.insert(0, str(Path(__file__).parents[3] / "scripts/bench"))
from four_bars import deck_of

from flexmb_cli import solve
from flexmb_cli.deck.text import decode
from flexmb_cli.dialects.recognise import read_deck
from flexmb_cli.dialects.young.build_dynamics import build_young_dynamics
from flexmb_cli.kernels import _jit
from flexmb_cli.run.check.check import check_deck
from flexmb_cli.run.outcome import RunOptions
from flexmb_cli.solvers.constrained.young_dynamics import ForwardDynamics
from tests.growth import LINEAR, growth

BODIES = 110  # 660 speeds


def chain(bodies, cards="", gravity=-9.81, end=0.002, joint="REVO"):
    """Bars of length 1 m and mass 1 kg in line along x, hinged about y."""
    each = range(1, bodies + 1)
    nodes = "".join(f" {k},1,0,0,0\n {k},2,0,1,0\n {k},3,1,0,0\n {k},4,1,1,0\n" for k in each)
    return (
        "VSDF CHAIN\nBODY\n" + "".join(f" {k},RIGD\n" for k in each) + "RIGI\n"
        + "".join(f" {k},1.0,0.5,0,0\n 0.01,0.1,0.1\n" for k in each) + f"NODE\n{nodes}POSI\n"
        + "".join(f" {k},{k - 1},0,0\n" for k in each) + f"JOIN\n 1,{joint},0,0,0,1,1,2\n"
        + "".join(f" {k},{joint},{k - 1},3,4,{k},1,2\n" for k in range(2, bodies + 1))
        + f"{cards}GRAV\n 0,0,{gravity}\nTIME\n {end},{end}\nINTG\n RK45,1e-9\nOUTN\n 1,3\nEND\nSTAR\nSTOP\n"
    )  # fmt: skip


def checked(tmp_path, text):
    path = tmp_path / "chain.vsdf"
    path.write_text(text)
    report = check_deck(str(path), RunOptions())
    return report, [fault for fault in report.outcome.faults if fault.severity != "note"]


def test_a_chain_is_free_to_turn_in_every_hinge(tmp_path):
    """Grübler: 6 b − 5 b; the rank took 12 s and 360 MB for 300 bodies."""
    report, faults = checked(tmp_path, chain(BODIES))
    assert not faults
    assert (report.rank, report.counts["degrees_of_freedom"]) == (5 * BODIES, BODIES)
    assert report.redundant == []
    assert [group[0] for group in report.free] == [f"body {k} ωy" for k in range(1, BODIES + 1)]


def test_a_closed_chain_repeats_equations(tmp_path):
    """Hinges about parallel axes: one displacement and two turns of the loop are given twice.

    In line one stretch is, too, to first order: bars may leave the line without getting longer.
    """
    ground = f"NODE\n 0,1,{BODIES},0,0\n 0,2,{BODIES},1,0\nJOIN\n {BODIES + 1},REVO,0,1,2,{BODIES},3,4\n"
    report, faults = checked(tmp_path, chain(BODIES, ground))
    assert [fault.message[:26] for fault in faults] == ["4 equations repeat others,"]
    assert len(report.redundant) == 4
    assert report.rank == 5 * (BODIES + 1) - 4


@pytest.mark.skipif(_jit.interpreted(), reason="nothing is compiled")
def test_the_time_of_check_grows_with_the_number_of_bodies(tmp_path):
    """Four times the bodies took sixty times as long."""
    assert growth(lambda bodies: checked(tmp_path, chain(bodies)), BODIES) < LINEAR


@pytest.mark.skipif(_jit.interpreted(), reason="nothing is compiled")
def test_the_time_of_the_start_grows_with_the_number_of_four_bars():
    """Dense matrices made it grow with the cube; each four-bar has three equations that repeat others."""

    def start(count):
        text = deck_of(count, "DOP853", 1e-8)
        ForwardDynamics(build_young_dynamics(read_deck(decode("x.dat", text.encode())))[0]).start()

    assert growth(start, 10) < LINEAR


@pytest.mark.long_motion
def test_a_free_chain_falls_with_gravity(tmp_path):
    """Far from the hinge by which it hangs a chain released in line falls by g t²/2.

    The hinge's force decays along the chain by a constant factor a bar.
    """
    path = tmp_path / "chain.vsdf"
    path.write_text(chain(BODIES))
    result = solve(path)
    fallen = result["body/position"][-1, -1, 2]
    assert fallen == pytest.approx(-0.5 * 9.81 * 0.002**2, rel=1e-6)


def test_a_given_velocity_that_fits_is_kept(tmp_path):
    """The first bar turns about its hinge at 3 rad/s; no other speed is given, and least squares decide."""
    report, faults = checked(tmp_path, chain(BODIES, "VELO\n 1,0,0,0,0,3,0\n"))
    assert not faults and report.outcome.exit_code == 0


def test_a_velocity_that_joints_forbid_is_changed_by_an_impulse(tmp_path):
    """A bar of J_y + m a² = 0.1 + 0.25 about its hinge, moved at −1 m/s along z at its origin.

    With all other bodies light the impulse leaves ω = m a v/(J_y + m a²) of it: a = 0.5 m from the hinge.
    """
    cards = "VELO\n 1,0,0,-1,0,0,0\n"
    _, faults = checked(tmp_path, chain(BODIES, cards))
    assert [fault.id for fault in faults] == ["SOLVE-008"]
    shown = faults[0].message.split("angular (")[1].split(")")[0]
    np.testing.assert_allclose([float(x) for x in shown.split(",")], [0.0, 0.5 / 0.35, 0.0], atol=1e-5)
