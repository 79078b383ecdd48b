"""The start of forward runs: velocities that do not fit the joints, and loads without effect.

Expected velocities: the angular momentum about a hinge is what an impulse in that hinge leaves unchanged
(closed forms for bars of length L, mass m and inertia I = m L²/12 about their centres, hanging in a line).
"""

from dataclasses import replace

import numpy as np
import pytest

from flexmb_cli.deck.record import DeckText
from flexmb_cli.dialects.young.build_dynamics import build_young_dynamics
from flexmb_cli.dialects.young.dynamic_cards import read_young_deck
from flexmb_cli.errors import ModelError
from flexmb_cli.model import laws
from flexmb_cli.model.loads import DynamicModel, InitialVelocity, MassProperties
from flexmb_cli.model.mechanism import Driver, Joint, Mechanism, TimeGrid
from flexmb_cli.run.check.check import check_deck
from flexmb_cli.run.outcome import RunOptions
from flexmb_cli.solvers.constrained.young_dynamics import ForwardDynamics
from flexmb_cli.solvers.kinematics.inverse_dynamics import InverseDynamics
from tests.dialects.vsdf.vsdf_decks import changed
from tests.solvers.constrained.dynamic_runs import AT_REST, GROUND, body
from tests.solvers.constrained.element_decks import FREE, SLIDER, model_of

L, V = 0.8, 2.5
MASSES = (3.0, 0.7)
TIME = TimeGrid(0.0, 0.1, 0.1)
UPPER, LOWER = (0.0, 0.0, L / 2), (0.0, 0.0, -L / 2)


def hanging(count, velocities, masses=MASSES):
    """Return `count` bars hanging from the ground and from each other, given the velocities of some."""
    bodies = [GROUND, *(body(k + 2, (0.0, 0.0, -L * (k + 0.5))) for k in range(count))]
    y = (0.0, 1.0, 0.0)
    ends = [((0.0,) * 3, UPPER), (LOWER, UPPER)]
    joints = [Joint("revolute", f"revolute {k + 1}", k, k + 1, *ends[k], y, y) for k in range(count)]
    inertias = [(m * L**2 / 12, m * L**2 / 12, 0.01 * m, 0.0, 0.0, 0.0) for m in masses]
    given = [MassProperties(f"mass {k + 1}", k + 1, masses[k], inertia=inertias[k]) for k in range(count)]
    cards = [InitialVelocity(f"velocity {k}", k, v, w) for k, v, w in velocities]
    mechanism = Mechanism(tuple(bodies), TIME, tuple(joints), grounds=(AT_REST,))
    return DynamicModel(mechanism, "forward", tuple(given), velocities=tuple(cards))


def started(model):
    analysis = ForwardDynamics(model)
    return next(analysis.rows()), analysis.warnings


def test_a_velocity_that_the_hinge_forbids_keeps_its_angular_momentum_about_it():
    rows, warnings = started(hanging(1, [(1, (V, 0.0, 0.0), (0.0, 0.0, 0.0))]))
    # m V L/2 = (I + m L²/4) ω, and the bar's centre, below the hinge, moves along +x for ω about -y.
    omega = V * (L / 2) / (L**2 / 12 + L**2 / 4)
    assert rows.angular_velocity[0, 1] == pytest.approx([0.0, -omega, 0.0], abs=1e-12)
    assert ["does not fit the joints" in fault.message for fault in warnings] == [True]


def test_two_bars_move_as_after_impulses_in_both_hinges():
    """Body 2 is given V, body 3 no velocity at all; unequal masses tell weights from none."""
    rest = (0.0, 0.0, 0.0)
    rows, _ = started(hanging(2, [(1, (V, 0.0, 0.0), rest), (2, rest, rest)]))
    m1, m2 = MASSES
    I1, I2 = m1 * L**2 / 12, m2 * L**2 / 12
    # Angular momenta of both bars about the upper hinge, and of the lower bar about the lower one.
    balance = [
        [I1 + m1 * L**2 / 4 + m2 * 1.5 * L * L, I2 + m2 * 1.5 * L * L / 2],
        [m2 * L / 2 * L, I2 + m2 * L**2 / 4],
    ]
    first, second = np.linalg.solve(balance, [m1 * V * L / 2, 0.0])
    assert rows.angular_velocity[0, 1:, 1] == pytest.approx([-first, -second], abs=1e-12)


def test_a_velocity_that_fits_is_kept_and_the_other_bar_stays_slow():
    """The lower bar has no card; ω of the upper one fits its hinge, and no momentum is taken from it."""
    rows, warnings = started(hanging(2, [(1, (V, 0.0, 0.0), (0.0, -2 * V / L, 0.0))]))
    assert rows.angular_velocity[0, 1] == pytest.approx([0.0, -2 * V / L, 0.0], abs=1e-12)
    assert not warnings


def test_a_massless_bar_leaves_the_others_what_they_are_given():
    """Without mass it takes no part in the impulse: the upper bar alone decides."""
    rest = (0.0, 0.0, 0.0)
    model = hanging(2, [(1, (V, 0.0, 0.0), rest), (2, rest, rest)], masses=(3.0, 1e-9))
    rows, _ = started(model)
    omega = V * (L / 2) / (L**2 / 3)
    assert rows.angular_velocity[0, 1, 1] == pytest.approx(-omega, rel=1e-7)


def spring(free_length, analysis="forward"):
    """Return a driven or free bar with a spring between its upper end and the ground, where they meet."""
    model = hanging(1, [])
    hold = laws.spring("spring 1", laws.Line(0, 1, (0.0,) * 3, UPPER), 100.0, free_length)
    driver = Driver("driver 1", 1, 5, 0.0, 1.0, 0.0)
    drivers = (driver,) if analysis == "inverse" else ()
    return replace(
        model, analysis=analysis, springs=(hold,), mechanism=replace(model.mechanism, drivers=drivers)
    )


@pytest.mark.parametrize("analysis", [ForwardDynamics, InverseDynamics])
def test_a_spring_without_length_or_direction_is_refused(analysis):
    kind = "forward" if analysis is ForwardDynamics else "inverse"
    with pytest.raises(
        ModelError, match=r"spring 1: its ends coincide at t = 0 s, where it pushes with 20 N"
    ):
        next(analysis(spring(0.2, kind)).rows())
    assert next(analysis(spring(0.0, kind)).rows()).time[0] == 0.0


def test_a_spring_of_a_vsdf_deck_without_length_or_direction_is_refused(tmp_path):
    """Its ends are the two points of a hinge, which assembly brings together to round-off."""
    deck = tmp_path / "a.vsdf"
    cards = "SPRI\n    1    1    3    2    1      10.0       0.0       0.2\nGRAV\n"
    deck.write_text(changed(("GRAV\n", cards)))
    outcome = check_deck(str(deck), RunOptions()).outcome
    assert outcome.exit_code == 2
    assert "spring 1: its ends coincide at t = 0 s" in outcome.faults[-1].sentence
    assert outcome.faults[-1].place[:2] == (26, 5)


HELD = """2 0 0 0 0 1 0 0 0 0 0 1
0 0 0 1 0 0 0
0 0 -1 1 0 0 0
1 2 0 0 0 0 0 1 0 1 0 0 1 0
1 0 0 0 0 0 0
0 1 0.1
DYNAMICS forward
MASS 2 1 0 0 0 1 1 1
{}
"""


@pytest.mark.parametrize(
    ("card", "sentence"),
    [
        ("FORCE 1 0 0 0 1 0 0", "force 1: moves nothing: body 1 is held at rest by a ground constraint"),
        ("TORQUE 1 0 0 1", "torque 1: moves nothing: body 1 is held at rest by a ground constraint"),
    ],
)
def test_a_load_on_a_grounded_body_is_noted(card, sentence):
    deck = read_young_deck(DeckText("IN.dat", HELD.format(card), ""))
    (note,) = build_young_dynamics(deck)[1]
    assert note.severity == "note" and note.sentence.startswith(sentence)
    assert note.place[0] == 9


@pytest.mark.parametrize(
    ("deck", "cards", "told"),
    [
        (
            FREE.replace("0 0 0 1 0 0 0\n1 0", "5 0 0 1 0 0 0\n1 0"),
            "ELEMENTS\n  JOINT sphsph-1 sphsph from=0(0,0,0) to=2(0,0,0) length=1\n",
            (
                "sphsph-1 (distance, line 9): 4.0e+00 m",
                "body 2 is moved by 4 m and turned by 0 rad",
                "correct",
            ),
        ),
        (
            SLIDER.replace("1 0 0 0 1 0 0 0 1", "1 0 0 0 0 1 0 0 1"),
            "",
            ("joint 1 (h_i · h_j, line 4): 1.0e+00", "turned by 1.57 rad", "stand at right angles"),
        ),
    ],
    ids=["link of 1 m over 5 m", "h_j parallel to h_i"],
)
def test_a_joint_that_is_far_from_closing_at_the_estimates_is_named_with_its_distance(deck, cards, told):
    _, warnings = started(model_of(deck, "0 0.1 0.1", f"MASS 2 1 0 0 0 1 1 1\n{cards}"))
    (text,) = [str(fault) for fault in warnings if "estimates" in fault.message]
    for words in told:
        assert words in text


def test_rough_estimates_are_no_warn():
    deck = FREE.replace("0 0 0 1 0 0 0\n1 0", "1.05 0 0 1 0 0 0\n1 0")
    cards = "MASS 2 1 0 0 0 1 1 1\nELEMENTS\n  JOINT sphsph-1 sphsph from=0(0,0,0) to=2(0,0,0) length=1\n"
    assert started(model_of(deck, "0 0.1 0.1", cards))[1] == []
