"""Decks converted to other dialects: both move alike by their own equations and integrators.

YOUNG and VSDF decks are solved in absolute coordinates, DAFMS decks by Kane's equations in relative ones.
"""

import re
from pathlib import Path

import numpy as np
import pytest

from flexmb_cli.cli.convert import UNITS as CHOICES
from flexmb_cli.deck.units import UNITS
from flexmb_cli.errors import ModelError
from flexmb_cli.interface import read_deck, solve
from flexmb_cli.model.vectors import rotation_matrix
from flexmb_cli.run.convert import converted
from flexmb_cli.run.model import model_of
from flexmb_cli.run.outcome import Outcome, Run, RunOptions
from tests.dialects.vsdf.vsdf_decks import changed

DECKS = Path(__file__).resolve().parents[3] / "decks"
SUFFIX = {"young": ".dat", "dafms": ".DAT", "vsdf": ".vsdf"}
SUPPLIED = sorted(
    str(path.relative_to(DECKS))
    for pattern in ("young/*.dat", "young/dynamics/*.dat", "dafms/*.DAT", "vsdf/*.vsdf")
    for path in DECKS.glob(pattern)
)
# What is converted, with the largest difference of mass centres, m; DAFMS decks have ten columns a number.
EXACT, COLUMNS = 1e-9, 1e-6
CONVERTED = {
    ("young/dynamics/IN-ANDREWS.dat", "vsdf"): EXACT,
    ("young/dynamics/IN-ARM.dat", "vsdf"): EXACT,
    ("young/dynamics/IN-CAM.dat", "vsdf"): 1e-6,  # through impacts
    ("young/dynamics/IN-CAM.dat", "dafms"): 1e-6,
    ("young/dynamics/IN-ELEMENTS.dat", "vsdf"): 2e-7,  # both methods at 1e-9, through friction and a stop
    ("young/dynamics/IN4-BAR-MASS.dat", "vsdf"): EXACT,
    ("young/dynamics/IN-ARM.dat", "dafms"): COLUMNS,
    ("young/dynamics/IN-PAIR.dat", "dafms"): COLUMNS,
    ("young/dynamics/IN-PAIR.dat", "vsdf"): EXACT,
    ("young/dynamics/IN-SPRING.dat", "dafms"): COLUMNS,
    ("young/dynamics/IN-SPRING.dat", "vsdf"): 1e-8,  # both at 1e-9 a step; 3e-13 at 1e-13
    ("young/dynamics/IN-BRICARD.dat", "vsdf"): COLUMNS,  # its motion amplifies errors a thousand times in 5 s
    ("dafms/sliding_mass.DAT", "vsdf"): EXACT,
    ("dafms/arm_elements.DAT", "vsdf"): EXACT,
    ("dafms/arm_elements.DAT", "young"): EXACT,
    ("dafms/fourbar_rigid.DAT", "vsdf"): EXACT,
    ("dafms/spatial_rigid.DAT", "vsdf"): EXACT,
    ("dafms/spatial_rigid.DAT", "young"): EXACT,
    ("dafms/motor_gear.DAT", "vsdf"): EXACT,
    ("dafms/motor_gear.DAT", "young"): EXACT,
    ("dafms/sliding_mass.DAT", "young"): EXACT,
    ("dafms/fourbar_rigid.DAT", "young"): EXACT,
}
# Of those with dynamics, or of rigid bodies, why the others are refused.
REFUSED = {
    ("young/dynamics/IN-ANDREWS.dat", "dafms"): "revolute joint 6: the joint closes a loop",
    ("young/dynamics/IN-BALL.dat", "vsdf"): "contacts do not convert",
    ("young/dynamics/IN-BALL.dat", "dafms"): "contacts do not convert",
    ("young/dynamics/IN-PID.dat", "vsdf"): "signals do not convert",
    ("young/dynamics/IN-PID.dat", "dafms"): "signals do not convert",
    ("young/dynamics/IN-MACHINE.dat", "vsdf"): "signals do not convert",
    ("young/dynamics/IN-MACHINE.dat", "dafms"): "signals do not convert",
    ("young/dynamics/IN-CATCH.dat", "vsdf"): "lines JOINT of this type are not converted",
    ("young/dynamics/IN-CATCH.dat", "dafms"): "lines JOINT of this type are not converted",
    ("young/dynamics/IN-HOLD.dat", "vsdf"): "lines JOINT of this type are not converted",
    ("young/dynamics/IN-HOLD.dat", "dafms"): "lines JOINT of this type are not converted",
    ("young/dynamics/IN-RAIL.dat", "vsdf"): "points on curves and rolling bodies are not converted",
    ("young/dynamics/IN-RAIL.dat", "dafms"): "points on curves and rolling bodies are not converted",
    ("young/dynamics/IN-ROLL.dat", "vsdf"): "points on curves and rolling bodies are not converted",
    ("young/dynamics/IN-ROLL.dat", "dafms"): "points on curves and rolling bodies are not converted",
    ("young/dynamics/IN-BREAK.dat", "vsdf"): "contacts do not convert",
    ("young/dynamics/IN-BREAK.dat", "dafms"): "contacts do not convert",
    ("young/dynamics/IN-BRICARD.dat", "dafms"): "closes a loop",
    ("young/dynamics/IN-RSSR-MASS.dat", "vsdf"): "simplified constraint 1: a held Euler parameter",
    ("young/dynamics/IN-RSSR-MASS.dat", "dafms"): "simplified constraint 1: a held Euler parameter",
    ("young/dynamics/IN4-BAR-MASS.dat", "dafms"): "closes a loop",
    ("young/dynamics/IN-ELEMENTS.dat", "dafms"): "forces in DAFMS are constant",
    ("young/dynamics/IN-LINK.dat", "dafms"): "a held Euler parameter",
    ("young/dynamics/IN-LINK.dat", "vsdf"): "a held Euler parameter",
}
WHY = {"young": "kinematics only", "dafms": "the body is flexible", "vsdf": "the body is flexible (FLEX)"}


def convert(path, form, folder, name="new", **units):
    """Write the deck at `path` in another dialect; the path of the new deck."""
    new = folder / (name + SUFFIX[form])
    new.write_text(converted(str(path), form, **units), encoding="utf-8")
    return new


def motion(path, scale=1.0):
    """Mass centres (times, bodies, 3) of the moving bodies in m, and their angular velocities."""
    values = solve(path)
    model = model_of(read_deck(path).deck, Run(Outcome(str(path)), RunOptions()))
    bodies, centres = bodies_of(model)
    r, p = (values[f"body/{name}"][:, bodies] for name in ("position", "euler_parameters"))
    A = np.array([[rotation_matrix(q) for q in row] for row in p])
    return scale * (r + np.einsum("tbij,bj->tbi", A, centres)), values["body/angular_velocity"][:, bodies]


def bodies_of(model):
    """Numbers of the moving bodies and their mass centres (bodies, 3)."""
    if hasattr(model, "masses"):
        held = {ground.body for ground in model.mechanism.grounds}
        masses = sorted((m for m in model.masses if m.body not in held), key=lambda m: m.body)
        return [m.body for m in masses], np.array([m.centre for m in masses])
    if hasattr(model, "hinges"):
        return list(range(len(model.bodies))), np.array([body.centre for body in model.bodies])
    return list(range(len(model.bodies))), np.array([body.s0 / body.m for body in model.bodies])


def assert_alike(path, others, limit):
    """The motions of decks differ by less than `limit`, m, and 100 times as much in rad/s of turning."""
    centres, omega = motion(path)
    assert max(np.abs(centres - centres[0]).max(), np.abs(omega).max()) > 0.01
    for other in others:
        found, turning = motion(other)
        assert np.abs(found - centres).max() < limit
        assert np.abs(turning - omega).max() < 100 * limit * max(1.0, np.abs(omega).max())


@pytest.mark.long_motion
@pytest.mark.parametrize("deck", SUPPLIED)
def test_a_supplied_deck_moves_alike_in_other_dialects_or_is_refused_with_the_reason(deck, tmp_path):
    own = deck.partition("/")[0]
    for form in SUFFIX:
        if (deck, form) in CONVERTED:
            new = convert(DECKS / deck, form, tmp_path, form)
            assert_alike(DECKS / deck, [new], CONVERTED[deck, form])
            continue
        with pytest.raises(ModelError) as stopped:
            converted(str(DECKS / deck), form)
        reported = " ".join(fault.sentence for fault in stopped.value.faults)
        assert (
            REFUSED.get((deck, form), f"a {own.upper()} deck already" if form == own else WHY[own])
            in reported
        )


# A chain of every joint that a tree knows, and a free body; it begins at 0.5 s, all estimates are off, and
# hardly two numbers are the same.
CHAIN = """\
8 0 1 1 1 2 1 1 0 0 0 1
0 0 0 1 0 0 0
0.31 0.02 0.01 0.99 0.05 0.02 0.1
0.71 0.11 0.02 1 0.01 0 0
1.12 0.1 0.15 0.98 0.1 0.1 0
1.5 0.1 0.1 1 0 0.1 0
1.9 0.15 0.1 1 0 0 0.2
0.3 0.5 0.2 0.9 0.3 0.1 0.2
0.2 -0.9 0.4 0.8 0.1 -0.2 0.3
4 0.1 0.2 0.3
5 6 0.2 0 0.03 -0.2 0.01 0
4 5 0.2 0.02 0 -0.2 0 0.01 0.2 1.02 0 -0.2 0 1.01
1 2 0.1 0 0 -0.2 0.03 0 0.1 0.6 0.8 -0.2 0.63 0.8
7 2 -0.1 0 -0.2 0 0.2 0.1 -0.1 0 0.8 0 0.2 1.1
3 4 0.2 0 0.05 -0.2 0 0 0.2 0 1.05 -0.2 0 1
2 3 0.2 0.01 0 -0.2 0 0 1.2 0.01 0 0.8 0 0 0.2 0.01 1 -0.2 1 0
1 0 0 0 0 0 0
0.5 0.8 0.1

DYNAMICS forward
MASS 2 2 0.05 0.01 0.02 0.3 0.4 0.5 0.02 0.03 -0.04
MASS 3 1.5 0.03 0 0.01 0.2 0.3 0.25 0.01 0 0.02
MASS 4 1.2 0 0.02 0 0.22 0.27 0.3
MASS 5 1.1 0.02 0 0.03 0.1 0.12 0.15 0 0.01 0
MASS 6 0.9 0.1 0 0 0.05 0.08 0.07
MASS 7 0.7 0 0 0.05 0.06 0.05 0.04
MASS 8 3 0.1 0.2 0.05 0.3 0.2 0.4 0.01 0.02 0.03
GRAVITY 0.5 -0.3 -9.81
ELEMENTS
  START at=3.angle rate=0.8
VELOCITY 8 0.1 0.2 3 0.5 -0.4 0.3
ELEMENTS
  SPRING tspring-1 at=3.angle stiffness=20 rest=0.2 damping=0.5 preload=1.5
  SPRING aspring-1 at=6.stroke stiffness=300 rest=0.02 damping=4
  FUNCTION 1 table 0 0 0.6 2 0.9 1
  MOTOR tmotor-1 at=4.angle effort=1
  MOTOR amotor-1 at=5.stroke effort=1
TORQUE 8 0.3 0.2 0.1 0 1
TOLERANCE 1e-12
END
"""


# A physical pendulum of 500 kg, 2 m long, in millimetres, tonnes and newtons.
MILLIMETRES = """\
2 0 1 0 0 1 0 0 0 0 0 1
0 0 0 1 0 0 0
0 0 0 1 0 0 0
2 2000 0 0
1 2 0 0 0 0 0 0 0 0 1 0 0 1
1 0 0 0 0 0 0
0 1 0.1

DYNAMICS forward
MASS 2 0.5 1000 0 0 2e5 2e5 2e5
GRAVITY 0 -9810 0
FORCE 2 2000 0 0 100 0 0 1
ELEMENTS
  SPRING tspring-1 at=1.angle stiffness=3e6 rest=0.1 damping=2e4
SPRING 1 2 500 1500 0 1000 0 0 2 500 0.1
ELEMENTS
  FUNCTION 5 polynomial 0 0 0 1e-4
  FUNCTION 6 polynomial 0 2e5
  SPRING lspring-1 from=1(500,1500,0) to=2(1500,0,0) stiffness=1 rest=900 damping=0.1 preload=20 curve=5
  SPRING tspring-2 at=1.angle stiffness=0 rest=0.1 preload=1e5 damper=6
  CABLE cable-1 from=1(1500,-1500,0) to=2(1500,0,0) stiffness=30 rest=1500 damping=1e-4
  BUSHING bushing-1 from=1(0,0,0) to=2(0,0,0) k=(0,0,0) kr=(0,0,1e6) c=(0,0,0) cr=(0,0,1e4)
  FRICTION friction-1 joint=1 dynamic=0.1 static=0.15 stribeck=50 creep=2 radius=30 preload=100
TOLERANCE 1e-11
END
"""


@pytest.mark.long_motion
def test_a_deck_in_millimetres_becomes_one_in_si_units_and_back(tmp_path):
    """1 t mm^2 is 1e-3 kg m^2, 1 N mm 1e-3 N m, and 1 N/mm 1000 N/m."""
    (tmp_path / "mm.dat").write_text(MILLIMETRES)
    metres = convert(tmp_path / "mm.dat", "vsdf", tmp_path, unit="mm")
    text = metres.read_text()
    assert "1,500.0,1.0,0.0,0.0\n    200.0,200.0,200.0" in text
    assert re.search(r"at=1.angle stiffness=3000.0 rest=0.1 damping=20.0\n", text)
    assert re.search(r" stiffness=2000.0 rest=0.5 damping=100.0\n", text)
    for other, scale in ((metres, 1.0), (convert(metres, "young", tmp_path, "cm", to_unit="cm"), 0.01)):
        found, turning = motion(other, scale)
        centres, omega = motion(tmp_path / "mm.dat", 1e-3)
        assert np.abs(centres - centres[0]).max() > 0.1
        assert np.abs(found - centres).max() < EXACT and np.abs(turning - omega).max() < 10 * EXACT


TURNED = (
    "ELEMENTS\n"
    "  BUSHING bushing-1 from=0(0,0,0) to=2(0,0,0) k=(1,1,1) kr=(9,9,9)\n"
)  # body 2 begins away from its estimate


@pytest.mark.parametrize(
    ("form", "old", "new", "reported"),
    [
        (
            "vsdf",
            "ELEMENTS\n  SPRING tspring-1 at=3.angle",
            f"{TURNED}ELEMENTS\n  SPRING tspring-1 at=3.angle",
            "bodies of the bushing have turned by 0.13",
        ),
        (
            "dafms",
            "FUNCTION 1 table 0 0 0.6 2 0.9 1",
            "FUNCTION 1 sine 0 1 2",
            "only tables of loads are converted to DAFMS",
        ),
        ("vsdf", "MASS 3 1.5 0.03 0 0.01 0.2 0.3 0.25 0.01 0 0.02\n", "", "body 3: a VSDF body needs a mass"),
        ("dafms", "TORQUE 8 0.3 0.2 0.1 0", "TORQUE 8 0.3 0.2 0.1 1", "loads in DAFMS keep to inertial axes"),
        (
            "dafms",
            "ELEMENTS\n  START at=3.angle rate=0.8\n",
            "FORCE 4 1 0 0 5 0 0\nELEMENTS\n  START at=3.angle rate=0.8\n",
            "DAFMS has forces at the origin O_k of a body only",
        ),
        ("dafms", "8 0 1 1 1 2 1 1 0 0 0 1", "8 0 1 1 1 2 1 0 1 0 0 1", "no hinge like a screw joint"),
    ],
)
def test_what_a_dialect_does_not_know_is_refused_by_name_and_place(form, old, new, reported, tmp_path):
    text = CHAIN.replace(old, new)
    if "screw" in reported:
        text = text.replace(" -0.2 1 0\n", " -0.2 1 0 0.1\n")
    (tmp_path / "chain.dat").write_text(text)
    with pytest.raises(ModelError) as stopped:
        converted(str(tmp_path / "chain.dat"), form)
    fault = next(fault for fault in stopped.value.faults if reported in fault.sentence)
    assert fault.place is not None and fault.subject


def test_the_command_offers_the_units_that_there_are():
    assert tuple(CHOICES) == tuple(UNITS)


NATURAL = "TABL\n    1       0.0       0.0\n    1       0.5       0.3\n    1       2.0       1.0\n"


@pytest.mark.parametrize(
    ("tables", "law", "kind"), [("", "2       2.0       0.2", "spin-up"), (NATURAL, "4       1.0", "natural")]
)
def test_a_law_that_young_has_not_is_refused_by_its_name_with_a_remedy(tables, law, kind, tmp_path):
    cards = f"{tables}MOTN\n    1 ANGL    1    {law}\nGRAV"
    (tmp_path / "links.vsdf").write_text(changed(("GRAV", cards)))
    with pytest.raises(ModelError, match=rf"motion 1: .*YOUNG has no card of a {kind}.*; give it as a table"):
        converted(str(tmp_path / "links.vsdf"), "young")
