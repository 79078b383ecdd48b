"""Rigid links of a VSDF deck against the same links in YOUNG's coordinates and constraints."""

import math
from dataclasses import replace

import numpy as np
import pytest

from flexmb_cli.fe.build_mechanism import flexible_mechanism
from flexmb_cli.model.integrators import Integrator
from flexmb_cli.model.loads import DynamicModel, MassProperties
from flexmb_cli.model.mechanism import Body, Ground, Joint, Mechanism, TimeGrid
from flexmb_cli.run.check.check import check_deck
from flexmb_cli.run.outcome import RunOptions
from flexmb_cli.solvers.constrained.flexible_dynamics import FlexibleDynamics
from flexmb_cli.solvers.constrained.young_dynamics import ForwardDynamics
from tests.dialects.vsdf.vsdf_decks import RIGID, build, changed

GRID = TimeGrid(0.0, 1.0, 0.1)
UP = (0.0, 0.0, 1.0)
SECOND = "    2 REVO    1    3    4    2    1    2\n"


def vsdf_rows(text):
    mechanism, _ = flexible_mechanism(build(text))
    mechanism = replace(mechanism, time=GRID, integrator=Integrator("RK45", 0.0, 1e-11))
    (rows,) = FlexibleDynamics(mechanism).rows()
    return rows


def young_rows():
    """The two links of RIGID; body 1 is the ground."""
    p = (1.0, 0.0, 0.0, 0.0)
    bodies = (Body("body 1", (0.0,) * 3, p), Body("body 2", (0.0,) * 3, p), Body("body 3", (1.0, 0, 0), p))
    joints = (
        Joint("revolute", "revolute joint 1", 0, 1, (0.0,) * 3, (0.0,) * 3, UP, UP),
        Joint("revolute", "revolute joint 2", 1, 2, (1.0, 0.0, 0.0), (0.0,) * 3, UP, UP),
    )
    mechanism = Mechanism(bodies, GRID, joints, grounds=(Ground("ground 1", 0, (0.0,) * 6),))
    masses = (
        MassProperties("mass 1", 1, 2.0, (0.5, 0.0, 0.0), (0.1, 0.2, 0.2, 0.0, 0.0, 0.0)),
        MassProperties("mass 2", 2, 1.0, (0.25, 0.0, 0.0), (0.05, 0.1, 0.1, 0.0, 0.0, 0.0)),
    )
    model = DynamicModel(
        mechanism, "forward", masses, gravity=(0.0, -9.81, 0.0), integrator=Integrator(tolerance=1e-11)
    )
    (rows,) = ForwardDynamics(model).rows()
    return rows


def test_two_links_move_as_those_of_a_young_deck():
    ours, theirs = vsdf_rows(RIGID), young_rows()
    for field in ("position", "velocity", "acceleration", "angular_velocity", "angular_acceleration"):
        wanted = getattr(theirs, field)[:, 1:]
        np.testing.assert_allclose(getattr(ours, field), wanted, rtol=0, atol=2e-8, err_msg=field)
    np.testing.assert_allclose(ours.reaction_force, theirs.reaction_force, rtol=0, atol=1e-7)
    np.testing.assert_allclose(ours.reaction_torque, theirs.reaction_torque, rtol=0, atol=1e-7)
    np.testing.assert_allclose(ours.kinetic, theirs.kinetic, rtol=0, atol=1e-7)


def check(tmp_path, text):
    deck = tmp_path / "deck.vsdf"
    deck.write_text(text)
    return check_deck(str(deck), RunOptions())


def test_check_names_equations_that_repeat_others_by_joint_and_line(tmp_path):
    again = changed((SECOND, f"{SECOND}    3 REVO    0    1    2    1    1    2\n"))
    report = check(tmp_path, again)
    assert report.outcome.exit_code == 0
    assert report.counts["equations"] == 15
    assert report.rank == 10
    assert report.counts["degrees_of_freedom"] == 2
    assert len(report.redundant) == 5
    for group in report.redundant:
        assert {name.split(",")[0] for name in group} == {"joint 1", "joint 3"}
    (warning,) = [fault for fault in report.outcome.faults if fault.severity == "warning"]
    assert "5 equations repeat others, among those of joint 1, joint 3" in warning.message
    line = again.splitlines()[warning.place.line - 1]
    assert line in ("    1 REVO    0    1    2    1    1    2", "    3 REVO    0    1    2    1    1    2")


@pytest.mark.long_motion
def test_links_that_repeat_a_joint_move_as_without_it():
    again = changed((SECOND, f"{SECOND}    3 REVO    0    1    2    1    1    2\n"))
    once, twice = vsdf_rows(RIGID), vsdf_rows(again)
    np.testing.assert_allclose(twice.position, once.position, rtol=0, atol=1e-8)
    # Either of the two bears one half, as least norm has it.
    np.testing.assert_allclose(twice.reaction_force[:, 0], 0.5 * once.reaction_force[:, 0], atol=1e-6)


def test_links_are_assembled_from_a_start_that_does_not_close(tmp_path):
    """The second link begins 0.3 m off; its hinge brings it back, with no deformation to help."""
    report = check(tmp_path, changed(("    2       1.0\nNODE", "    2       1.2       0.2       0.1\nNODE")))
    assert report.outcome.exit_code == 0
    assert max(gap for _, gap, _, unit in report.gaps if unit == "m") == pytest.approx(0.2, abs=0.01)
    assert max(gap for _, _, gap, _ in report.gaps) < 1e-12


def test_what_cannot_be_assembled_is_told_by_joint_and_line(tmp_path):
    deck = changed((SECOND, f"{SECOND}3,DIST,0,1,,2,3,,,,9.0\n"))
    report = check(tmp_path, deck)
    assert report.outcome.exit_code == 1
    (fault,) = [fault for fault in report.outcome.faults if fault.severity == "error"]
    assert "cannot be assembled" in fault.message
    assert "joint 3 (distance" in fault.message
    assert math.isfinite(report.outcome.norms["gap"])
