"""`flexmb verify` of YOUNG and VSDF decks: two formulations agree, and an error in one of them shows.

The second formulation of YOUNG decks is checked by itself against closed forms.
"""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from flexmb_cli.cli.verify import verify_text
from flexmb_cli.model import laws
from flexmb_cli.model.loads import AppliedForce, AppliedTorque, DynamicModel, MassProperties
from flexmb_cli.model.mechanism import Body, Joint, Mechanism, TimeGrid
from flexmb_cli.run.outcome import RunOptions
from flexmb_cli.run.verify.verify import Size, largest_difference, verify_deck
from flexmb_cli.solvers.natural_coordinates import motion
from flexmb_cli.solvers.natural_coordinates.motion import NaturalMotion, coordinates_of, speeds_of
from tests.fe.trusses import truss, write_matrix

YOUNG = Path(__file__).resolve().parents[3] / "decks/young"
PENDULUM = """2 0 0 0 0 1 0 0 0 0 0 1
0 0 0 1 0 0 0
0.3 0 0 1 0 0 0
1 2 0 0 0 -0.3 0 0 0 1 0.2 -0.3 1 0.2
1 0 0 0 0 0 0
0 0.4 0.1
DYNAMICS forward
MASS 2 1.5 0.02 0.01 0.03 0.02 0.05 0.06 0.001 0.002 -0.003
GRAVITY 0.3 -9.81 0.5
FORCE 2 0.1 0.05 0 1 2 -1 1
TORQUE 2 0.1 0.2 0.3
SPRING 1 2 0.5 0.5 0.1 0.1 0 0 40 0.3 0.7
"""


def verified(path, tolerance=1e-9, **options):
    return verify_deck(str(path), RunOptions(**options), tolerance)


# A ball of 0.5 kg, thrown against a plane with friction.
BALL = """    1    3
DFMB BALL
    1    3    1    1    1
    1    3    1    1    1
    0
    0
   20
   0.02000
CONN
    0
MASS
    1   0.50000
INER
    1 5.000E-04 5.000E-04 5.000E-04
EULT
    1       0.0       0.0       0.0       1.0
EULL
    1       0.0       0.0       0.0       1.0
Y(L)
    0.0000    0.0000    0.0000    0.3000    0.0000
   -1.0000    0.0000    0.0000    0.0000    0.0000
    0.0000    0.2000
GRAV
    0    0.0000    0.0000   -9.8100
TOLR
    1.000E-08    1.000E-09
ELEMENTS
  CONTACT floor plane-sphere from=0(0,0,0) to=1(0,0,0) normal=(0,0,1) radius_to=0.05
    stiffness=1e4 damping=0.3 friction=0.3
END
STAR
STOP
"""


def test_a_contact_of_a_tree_agrees_in_both_formulations(tmp_path):
    """Kane's equations in hinge coordinates, and absolute coordinates: forces and work of the contact too."""
    deck = tmp_path / "BALL.DAT"
    deck.write_text(BALL)
    found = verified(deck)
    assert found.outcome.exit_code == 0, [each for each in found.differences if each.relative > 1e-9]
    scales = {each.name: each.scale for each in found.differences}
    assert scales["element effort"] > 10.0 and scales["element work"] > 0.1


def test_a_contact_of_a_young_deck_is_named_as_what_the_second_formulation_lacks():
    found = verified(YOUNG / "dynamics/IN-BALL.dat")
    assert found.outcome.exit_code == 2
    assert any(
        "natural coordinates hold no block ELEMENTS" in fault.message for fault in found.outcome.faults
    )


@pytest.mark.parametrize("name", ["IN2-1-1", "IN5BODY", "dynamics/IN4-BAR-MASS"])
def test_driven_mechanisms_agree_in_natural_coordinates(name):
    found = verified(YOUNG / f"{name}.dat", 1e-11)
    assert found.outcome.exit_code == 0, [each for each in found.differences if each.relative > 1e-11]
    names = {each.name for each in found.differences if each.scale > 0}
    assert names >= {"body position", "body angular velocity", "body acceleration"}
    assert ("driver effort" in names) == name.endswith("MASS")


@pytest.mark.long_motion
def test_a_motion_under_loads_agrees_and_the_text_names_what_was_compared(tmp_path):
    """Springs, dampers, a force that follows its body, a torque, an inertia with all elements."""
    deck = tmp_path / "IN.dat"
    deck.write_text(PENDULUM)
    found = verified(deck)
    assert found.outcome.exit_code == 0, [each for each in found.differences if each.relative > 1e-9]
    assert "Euler parameters and natural coordinates, 5 rows" in verify_text(found)


@pytest.mark.long_motion
def test_an_error_in_one_of_the_formulations_shows(tmp_path, monkeypatch):
    deck = tmp_path / "IN.dat"
    deck.write_text(PENDULUM)
    right = motion.mass_matrix
    monkeypatch.setattr(motion, "mass_matrix", lambda model: right(model) * 1.001)
    assert verified(deck).outcome.exit_code == 1


TURNTABLE = Path(__file__).resolve().parents[2] / "solvers/linearisation/turning/turntable.dat"


@pytest.mark.parametrize("driver", ["2 6 0 3 0", "2 6 0 0 0"], ids=["turning", "at rest"])
def test_a_mass_that_rests_between_springs_agrees_though_all_its_motion_is_round_off(tmp_path, driver):
    """Newton's first law: 100 N/m from both sides leave the mass of a turntable in its centre."""
    deck = tmp_path / "IN.dat"
    deck.write_text(TURNTABLE.read_text().replace("2 6 0 3 0", driver))
    found = verified(deck, 1e-6)
    assert found.outcome.exit_code == 0, found.differences
    speed = next(each for each in found.differences if each.name == "body velocity")
    assert speed.difference < 1e-12 < speed.scale


@pytest.mark.long_motion
def test_a_truss_that_rests_between_springs_agrees_in_both_frames(deck):
    """Two springs pull at one node with 100 N to either side."""
    position = truss(5)[0][16 - 11] + [0.1, 0.2, 0.3]
    nodes = [position + [side, 0.0, 0.0] for side in (-2.0, 2.0)]
    cards = [f"{0:5d}{k:5d}" + "".join(f"{x:10.6f}" for x in node) for k, node in enumerate(nodes, 1)]
    springs = [f"{k:5d}    1   16    0{k:5d}     100.0       0.0       1.0" for k in (1, 2)]
    head, tail = TRUSS.split("VELO\n")[0], TRUSS[TRUSS.index("TIME\n") :]
    deck.write_text("\n".join([head + "NODE", *cards, "SPRI", *springs, tail]))
    found = verified(deck, 1e-6)
    assert found.outcome.exit_code == 0, found.differences


def test_a_motion_far_slower_than_the_size_of_the_mechanism_is_compared_by_itself():
    """A millionth of the length in the time of the run is the least speed that counts; 1e-4 is above it."""
    size = Size(length=2.0, time=4.0, mass=3.0)
    slow = largest_difference("v", "m/s", np.zeros(2), np.full(2, 1e-4), np.full(2, 1.1e-4), size)
    assert slow.relative == pytest.approx(0.1)
    rest = largest_difference("v", "m/s", np.zeros(2), np.full(2, 1e-17), np.full(2, -1e-17), size)
    assert rest.scale == 2.0 / 4.0 * 1e-6
    assert size.least("m, rad") == 2e-6 and size.least("N, N m") == 1e-3 * 3.0 * 2.0 / 16.0 * 2.0


def test_screws_are_refused_by_name():
    found = verified(YOUNG / "IN2-6-1.dat")
    assert found.outcome.exit_code == 2
    assert "screw joint 1: a screw joint is not carried over" in found.outcome.faults[-1].sentence


def test_natural_coordinates_let_a_free_top_precess_as_in_the_closed_form():
    """Euler's equations of a symmetric body, I1 = I2: its axis goes round L at the rate L / I1."""
    I1, I3, spin, tilt = 0.4, 0.7, 3.0, 0.9
    mechanism = Mechanism((Body("body 1", (0.0,) * 3, (1.0, 0, 0, 0)),), TimeGrid(0.0, 1.0, 0.25))
    model = DynamicModel(mechanism, masses=(MassProperties("mass 1", 0, 2.0, inertia=(I1, I1, I3, 0, 0, 0)),))
    omega = np.array([tilt, 0.0, spin])
    L = np.array([I1 * tilt, 0.0, I3 * spin])
    X = coordinates_of(np.zeros((1, 3)), np.array([[1.0, 0, 0, 0]]))
    rows = NaturalMotion(mechanism, model).forward(X, speeds_of(X, np.zeros((1, 3)), omega[None]))
    along, rate = L / np.linalg.norm(L), np.linalg.norm(L) / I1
    axis = np.array([0.0, 0.0, 1.0])
    for t, found in zip(rows.time, rows.X[:, 9:12], strict=True):
        c, s = np.cos(rate * t), np.sin(rate * t)
        expected = c * axis + s * np.cross(along, axis) + (1 - c) * (along @ axis) * along
        np.testing.assert_allclose(found, expected, atol=1e-8)


def test_loads_in_natural_coordinates_do_the_work_of_forces_and_torques():
    """Power Q · V of a moving body: F · v_P, T · ω and the pull of a spring by its own formula."""
    bodies = tuple(Body(f"body {k}", (0.0,) * 3, (1.0, 0, 0, 0)) for k in (1, 2))
    joint = Joint("spherical", "spherical joint 1", 0, 1, (0.0,) * 3, (0.0,) * 3)
    mechanism = Mechanism(bodies, TimeGrid(0.0, 1.0, 1.0), (joint,))
    random = np.random.default_rng(4)
    P, F, T, R = random.uniform(-1, 1, (4, 3))
    p = random.standard_normal((2, 4))
    r, v, w = random.uniform(-1, 1, (3, 2, 3))
    X = coordinates_of(r, p)
    V = speeds_of(X, v, w)
    D = X.reshape(2, 4, 3)[:, 1:].transpose(0, 2, 1)
    model = DynamicModel(mechanism)

    def power(**loads):
        return NaturalMotion(mechanism, replace(model, **loads)).forces(X, V) @ V

    at_P = v[1] + np.cross(w[1], D[1] @ P)
    assert power(forces=(AppliedForce("f", 1, tuple(F), tuple(P), True),)) == pytest.approx(D[1] @ F @ at_P)
    assert power(forces=(AppliedForce("f", 1, tuple(F), tuple(P)),)) == pytest.approx(F @ at_P)
    assert power(torques=(AppliedTorque("t", 1, tuple(T), True),)) == pytest.approx(D[1] @ T @ w[1])
    spring = laws.spring("s", laws.Line(0, 1, tuple(R), tuple(P)), 30.0, 0.4, 2.0)
    d, rate = r[1] + D[1] @ P - r[0] - D[0] @ R, at_P - v[0] - np.cross(w[0], D[0] @ R)
    length = np.linalg.norm(d)
    pull = 30.0 * (length - 0.4) + 2.0 * (d @ rate) / length
    assert power(springs=(spring,)) == pytest.approx(-pull * (d @ rate) / length)


TRUSS = """VSDF A TRUSS ON A ROD
BODY
    1 FLEX    0   12   15   17
    2 RIGD
FEMN
    1 TXT  nodes.txt
FEMM
    1 MM   M.mtx
FEMK
    1 MM   K.mtx
RIGI
2,2.0,0.1,0.2,0.0
0.1,0.2,0.2
POSI
1,0.1,0.2,0.3
VELO
1,0.3,-0.2,0.1,0.5,-0.4,0.8
NODE
    2    1       0.0       0.0       0.0
JOIN
    1 SPHE    1   13         2    1
FORC
    1   16       0.4       0.3      -0.5    1
GRAV
       0.0       0.5     -9.81
TIME
       0.2      0.05
INTG
 RK45    1.0E-9
OUTN
    1   11   14
END
STAR
STOP
"""


@pytest.fixture
def deck(tmp_path):
    """A truss of seven nodes in all its modes, hung on a rigid body, with a force that follows it."""
    r, _, M, K = truss(5)
    write_matrix(tmp_path / "M.mtx", M)
    write_matrix(tmp_path / "K.mtx", K)
    lines = [f"{11 + k} {x:.17g} {y:.17g} {z:.17g}" for k, (x, y, z) in enumerate(r)]
    (tmp_path / "nodes.txt").write_text("\n".join(lines) + "\n")
    joint = r[13 - 11] + [0.1, 0.2, 0.3]
    text = TRUSS.replace("POSI\n", "POSI\n2," + ",".join(f"{x:.17g}" for x in joint) + "\n")
    path = tmp_path / "truss.vsdf"
    path.write_text(text)
    return path


@pytest.mark.long_motion
def test_two_floating_frames_of_a_flexible_body_are_one_model(deck):
    """The bars of the truss are soft: it deforms by a tenth of its size, and the frames part."""
    found = verified(deck, 1e-6)
    assert found.outcome.faults == [] and found.outcome.exit_code == 0, found.differences
    assert {"point position", "strain energy", "reaction force"} <= {each.name for each in found.differences}
    assert "two floating frames" in verify_text(found)
    strain = next(each for each in found.differences if each.name == "strain energy")
    assert strain.scale > 0


def test_reduced_bodies_have_no_second_frame(deck):
    deck.write_text(TRUSS.replace("FLEX    0", "FLEX    5"))
    found = verified(deck)
    assert found.outcome.exit_code == 2
    assert "takes all modes: give 0 modes" in found.outcome.faults[-1].sentence


@pytest.mark.parametrize("name", ["frame_on_shaft", "beam_on_crank", "hinge_moment", "shell_panel"])
def test_bodies_in_mean_axes_are_refused_at_their_card(name):
    path = YOUNG.parent / f"vsdf/{name}.vsdf"
    found = verified(path)
    (fault,) = [fault for fault in found.outcome.faults if "give three" in fault.sentence]
    assert found.outcome.exit_code == 2 and found.differences == ()
    assert path.read_text().splitlines()[fault.place.line - 1].strip().startswith(f"{fault.subject[-1]},FLEX")
